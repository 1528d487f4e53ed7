/* What the robot senses and does, in the units of the simulator: metres, radians, seconds. */
#ifndef ROBOT_H
#define ROBOT_H

#include <stdbool.h>
#include <stdint.h>

#define CHANNELS 8

enum side { SIDE_LEFT, SIDE_RIGHT };

static inline enum side other(enum side side)
{
    return side == SIDE_LEFT ? SIDE_RIGHT : SIDE_LEFT;
}

/* +1 left, -1 right: the direction in which y and yaw grow. */
static inline float sign_of(enum side side)
{
    return side == SIDE_LEFT ? 1.0f : -1.0f;
}

/* All sensors at one control tick. */
struct sensors {
    int16_t right_counts; /* of the wheel encoders since the tick before */
    int16_t left_counts;
    uint8_t line[CHANNELS]; /* reflectance, right to left; 255 is white, 0 is black */
    uint16_t front_mm;      /* ranges; a large number where nothing is seen */
    uint16_t left_mm;
    uint16_t right_mm;
};

static inline uint16_t side_mm(const struct sensors *seen, enum side side)
{
    return side == SIDE_LEFT ? seen->left_mm : seen->right_mm;
}

/* Where the robot believes to be, in the frame of its start; yaw does not wrap. */
struct pose {
    float x_m;
    float y_m;
    float yaw_rad;
};

/* Forward speed, and yaw rate, positive to the left. */
struct motion {
    float v_m_s;
    float w_rad_s;
};

/* Angular speeds of the wheels. */
struct wheels {
    float right_rad_s;
    float left_rad_s;
};

#endif
