/* Turning until an obstacle stands straight ahead at a known distance, so that one stored path fits every encounter. */
#ifndef FACING_H
#define FACING_H

#include "robot.h"

/* Readings of one sweep over an obstacle; a robot that takes more ticks for it stands still. */
#define SWEEP 128

enum facing_phase { FACING_BACK, FACING_TURN_OUT, FACING_SWEEP_IN, FACING_FACE, FACING_TRIM, FACING_DONE };

struct facing {
    enum facing_phase phase;
    float inward; /* +1 where the obstacle lies to the left if it is not ahead, -1 to the right */
    struct pose since;
    float heading_rad;
    uint8_t swept;
    struct {
        uint16_t front_mm;
        float yaw_rad;
    } sweep[SWEEP];
};

/* Start at `start`; `near_mm` is what the sensor that has seen the obstacle reads: too near, the robot backs off first. */
void facing_begin(struct facing *facing, struct pose start, enum side bend, uint16_t near_mm);

/* How to drive at this tick; zero when done. */
struct motion facing_step(struct facing *facing, const struct sensors *seen, struct pose odometry);

#endif
