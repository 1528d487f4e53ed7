/* Where the robot is, from the encoders of its wheels alone (Eq. 1 to 5). */
#ifndef ODOMETRY_H
#define ODOMETRY_H

#include "robot.h"

struct odometry {
    struct pose pose;
    int32_t turned_counts; /* right less left since the start: yaw without the rounding of a running sum */
};

void odometry_reset(struct odometry *odometry);

/* One tick's encoder counts. */
void odometry_step(struct odometry *odometry, int16_t right_counts, int16_t left_counts);

#endif
