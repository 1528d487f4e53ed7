#include "odometry.h"

#include <math.h>

#include "settings.h"

void odometry_reset(struct odometry *odometry)
{
    *odometry = (struct odometry){{0.0f, 0.0f, 0.0f}, 0};
}

void odometry_step(struct odometry *odometry, int16_t right_counts, int16_t left_counts)
{
    struct pose *pose = &odometry->pose;
    int32_t turned = (int32_t)right_counts - left_counts;
    odometry->turned_counts += turned;
    /* Mid-point rule: the way is driven along the yaw half-way through the turn. */
    float forward_m = 0.5f * METRES_PER_COUNT * (float)((int32_t)right_counts + left_counts);
    float middle = RADIANS_PER_COUNT * ((float)odometry->turned_counts - 0.5f * (float)turned);
    pose->x_m += forward_m * cosf(middle);
    pose->y_m += forward_m * sinf(middle);
    pose->yaw_rad = RADIANS_PER_COUNT * (float)odometry->turned_counts;
}
