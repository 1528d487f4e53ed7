/* The state machine at work: which behaviour drives the robot, and what it commands. */
#ifndef CONTROLLER_H
#define CONTROLLER_H

#include "bends.h"
#include "curve_follower.h"
#include "path_follower.h"
#include "robot.h"
#include "settings.h"
#include "states.h"

enum following { FOLLOWING_NOTHING, FOLLOWING_STRAIGHT, FOLLOWING_CURVE };

struct controller {
    enum state state;
    enum state return_state; /* before the avoidance */
    enum following following;
    struct path_follower straight;
#if HAS_CURVES
    struct curve_follower curve;
    struct bends bends;
#endif
    struct pose entered_at;
    float last_line_error;
    uint16_t line_lost; /* ticks in the line state without any channel on the line */
};

void controller_reset(struct controller *controller);

/* Choose the state for this tick, then drive by it. */
struct motion controller_step(struct controller *controller, const struct sensors *seen, struct pose odometry);

#endif
