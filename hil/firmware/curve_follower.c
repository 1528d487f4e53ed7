#include "curve_follower.h"

#include <math.h>

#include "settings.h"

#if HAS_CURVES

void curve_begin(struct curve_follower *curve, const struct curve_pass *chosen, struct pose start)
{
    struct path path = chosen->inner ? inner_path(chosen->bend) : outer_path(chosen->bend);
    curve->phase = CURVE_FACE;
    facing_begin(&curve->facing, start, chosen->bend, chosen->near_mm);
    path_begin(&curve->follower, path, start);
    curve->turn = sign_of(chosen->side);
    curve->line_seen_at = start;
    curve->met_error = 0.0f;
    curve->since = start;
}

bool curve_finished(const struct curve_follower *curve)
{
    return curve->phase == CURVE_DONE;
}

static float apart_m(struct pose one, struct pose another)
{
    return hypotf(one.x_m - another.x_m, one.y_m - another.y_m);
}

static enum curve_phase after_crossing(const struct curve_follower *curve, struct pose odometry, bool line_seen,
                                       float error)
{
    /* A line still on the side that the robot heads for is not crossed yet, or bends back under the robot. */
    bool ahead = line_seen && curve->turn * error <= -CURVES_IN_THE_MIDDLE;
    if (apart_m(odometry, curve->since) < AVOIDANCE_CURVES_CROSS_M * (ahead ? 4.0f : 1.0f))
        return CURVE_CROSS;
    /* Met at a small angle, the line comes in from ahead; one that moves out there lies across. */
    bool came_in = line_seen && curve->turn * (error - curve->met_error) > 0.0f;
    bool in_the_middle = line_seen && fabsf(error) < CURVES_IN_THE_MIDDLE;
    return in_the_middle && came_in ? CURVE_DONE : CURVE_TURN;
}

static enum curve_phase next_phase(const struct curve_follower *curve, struct pose odometry, bool line_seen, float error)
{
    switch (curve->phase) {
    case CURVE_FACE:
        return curve->facing.phase == FACING_DONE ? CURVE_PATH : CURVE_FACE;
    case CURVE_PATH:
        if (line_seen && apart_m(odometry, curve->line_seen_at) > AVOIDANCE_CURVES_LINE_AFTER_M)
            return CURVE_CROSS;
        return path_finished(&curve->follower) ? CURVE_DONE : CURVE_PATH;
    case CURVE_CROSS:
        return after_crossing(curve, odometry, line_seen, error);
    case CURVE_TURN:
        if (line_seen && fabsf(error) < CURVES_IN_THE_MIDDLE)
            return CURVE_DONE;
        return fabsf(odometry.yaw_rad - curve->since.yaw_rad) > CURVES_FULL_SEARCH_RAD ? CURVE_DONE : CURVE_TURN;
    default:
        return CURVE_DONE;
    }
}

static struct motion drive_path(struct curve_follower *curve, struct pose odometry)
{
    const float rate = AVOIDANCE_CURVES_TURN_RATE_RAD_S;
    float bearing = path_bearing(&curve->follower, odometry);
    if (fabsf(bearing) > AVOIDANCE_CURVES_TURN_ABOVE_RAD)
        return (struct motion){0.0f, bearing < 0.0f ? -rate : rate};
    float curvature = path_curvature(&curve->follower, odometry, false);
    float speed = fminf(AVOIDANCE_SPEED_M_S, rate / fmaxf(fabsf(curvature), 1e-6f));
    return (struct motion){speed, speed * curvature};
}

struct motion curve_step(struct curve_follower *curve, const struct sensors *seen, struct pose odometry, bool line_seen,
                         float error)
{
    struct motion facing = {0.0f, 0.0f};
    if (curve->phase == CURVE_FACE)
        facing = facing_step(&curve->facing, seen, odometry);
    enum curve_phase following = next_phase(curve, odometry, line_seen, error);
    if (following != curve->phase) {
        curve->phase = following;
        curve->since = odometry;
        curve->line_seen_at = odometry;
        curve->met_error = line_seen ? error : 0.0f;
        if (following == CURVE_PATH)
            path_begin(&curve->follower, curve->follower.path, odometry);
    }
    if (line_seen)
        curve->line_seen_at = odometry;
    switch (curve->phase) {
    case CURVE_FACE:
        return facing;
    case CURVE_PATH:
        return drive_path(curve, odometry);
    case CURVE_CROSS:
        return (struct motion){AVOIDANCE_SPEED_M_S, 0.0f};
    default:
        return (struct motion){0.0f, curve->turn * AVOIDANCE_CURVES_TURN_RATE_RAD_S};
    }
}

#endif
