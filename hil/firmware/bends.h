/* Which curve path goes round an obstacle on a bending line, told from the ranges and the recent path by odometry. */
#ifndef BENDS_H
#define BENDS_H

#include "robot.h"

/* Places that are remembered; BEND_SPACING_M apart they span the stretch that is looked back over. */
#define REMEMBERED 128

/* How the path has turned lately, and to which side it last bent. */
struct bends {
    bool bent;        /* there was a bend, */
    enum side bend;   /* to this side */
    float turned_rad; /* over the last AVOIDANCE_CURVES_MEMORY_M of the path */
    bool moved;       /* there is a place before this one */
    struct pose last;
    float travelled_m;
    uint8_t oldest, count;
    struct {
        float travelled_m;
        float yaw_rad;
    } recent[REMEMBERED];
};

/* How an obstacle is to be passed. */
struct curve_pass {
    bool found;
    bool inner;       /* inside of the bend; else outside */
    enum side side;   /* of the obstacle on which the robot passes */
    enum side bend;   /* to which the line bends */
    uint16_t near_mm; /* what the sensor that has seen it reads */
};

void bends_reset(struct bends *bends);
void bends_update(struct bends *bends, struct pose odometry);

/* The way past the obstacle that is in the way now, if there is one. One straight ahead or at the end of the present bend is
   passed on the inside, where a tight line leaves most room; one beside a robot that has gone straight stands on the bend to
   come and is passed on the outside. */
struct curve_pass curve_pass(const struct bends *bends, const struct sensors *seen);

#endif
