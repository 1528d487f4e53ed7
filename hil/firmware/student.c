/* Yours to write. What each function is for stands in student.h; the numbers that you need, in settings.h. */
#include "student.h"

#include <math.h>

#include "settings.h"

#ifndef TODO_NEXT_STATE
#include "transitions.h"
#endif

bool line_error(const uint8_t line[CHANNELS], float *error)
{
#ifdef TODO_LINE_ERROR
    /* TODO: the mean weight of the channels on the line; false where no channel is. */
    (void)line;
    *error = 0.0f;
    return false;
#else
    float sum = 0.0f;
    uint8_t active = 0;
    for (uint8_t i = 0; i < CHANNELS; i++) {
        if (line[i] < LINE_THRESHOLD) {
            sum += (float)i - 0.5f * (CHANNELS - 1);
            active++;
        }
    }
    if (active > 0)
        *error = sum / (float)active;
    return active > 0;
#endif
}

float wall_error(float measured_m)
{
#ifdef TODO_WALL_ERROR
    /* TODO: the distance from the wall, its error times WALL_ERROR_SCALE_PER_M, held between -WALL_FAR_ERROR_LIMIT and
       MAX_ERROR. */
    (void)measured_m;
    return 0.0f;
#else
    float actual_m = 0.70710678f * measured_m;
    float error = WALL_ERROR_SCALE_PER_M * (WALL_TARGET_DISTANCE_M - actual_m);
    return fmaxf(-WALL_FAR_ERROR_LIMIT, fminf(MAX_ERROR, error));
#endif
}

struct motion follow(float error, struct gains gains)
{
#ifdef TODO_FOLLOW
    /* TODO: Eq. 6 and 7; the robot must not drive backwards. */
    (void)error;
    (void)gains;
    struct motion motion = {0.0f, 0.0f};
    return motion;
#else
    struct motion motion = {fmaxf(0.0f, gains.k1_m_s - gains.k3_m_s * fabsf(error)), gains.k2_rad_s * error};
    return motion;
#endif
}

struct wheels wheel_speeds(struct motion motion)
{
#ifdef TODO_WHEEL_SPEEDS
    /* TODO: Eq. 8 and 9 with TRACK_M, then from the speed of the rim to that of the wheel by WHEEL_RADIUS_M. */
    (void)motion;
    struct wheels wheels = {0.0f, 0.0f};
    return wheels;
#else
    float half_m_s = 0.5f * TRACK_M * motion.w_rad_s;
    struct wheels wheels = {(motion.v_m_s + half_m_s) / WHEEL_RADIUS_M, (motion.v_m_s - half_m_s) / WHEEL_RADIUS_M};
    return wheels;
#endif
}

enum state next_state(enum state state, const struct view *view)
{
#ifdef TODO_NEXT_STATE
    /* TODO: one line for each arrow of your state diagram, the most urgent first, such as
       if (state == STATE_LINE && line_ended_by_wall(view, SIDE_RIGHT)) return STATE_RIGHT_WALL; */
    (void)view;
    return state;
#else
    return next_by_table(state, view);
#endif
}
