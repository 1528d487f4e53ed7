#include "controller.h"

#include <math.h>

#include "student.h"

static const struct gains LINE_GAINS = {LINE_K1_M_S, LINE_K2_RAD_S, LINE_K3_M_S};
static const struct gains WALL_GAINS = {WALL_GAINS_K1_M_S, WALL_GAINS_K2_RAD_S, WALL_GAINS_K3_M_S};

void controller_reset(struct controller *controller)
{
    controller->state = STATE_LINE;
    controller->return_state = STATE_LINE;
    controller->following = FOLLOWING_NOTHING;
    controller->entered_at = (struct pose){0.0f, 0.0f, 0.0f};
    controller->last_line_error = 0.0f;
    controller->line_lost = 0;
#if HAS_CURVES
    bends_reset(&controller->bends);
#endif
}

/* The curve path for an obstacle in the way; only on a line. */
static struct curve_pass way_past(struct controller *controller, const struct sensors *seen, struct pose odometry)
{
#if HAS_CURVES
    if (controller->state == STATE_LINE) {
        bends_update(&controller->bends, odometry);
        return curve_pass(&controller->bends, seen);
    }
#else
    (void)controller, (void)seen, (void)odometry;
#endif
    return (struct curve_pass){false, false, SIDE_LEFT, SIDE_LEFT, 0};
}

static struct view what_is_known(const struct controller *controller, const struct sensors *seen, bool line_seen,
                                 const struct curve_pass *curve)
{
    struct view view = {seen, line_seen, false, false, controller->return_state, curve->found, curve->side};
    if (controller->following == FOLLOWING_STRAIGHT) {
        view.straight_path_goes_back = path_on_the_way_back(&controller->straight);
        view.path_finished = path_finished(&controller->straight);
    }
#if HAS_CURVES
    if (controller->following == FOLLOWING_CURVE)
        view.path_finished = curve_finished(&controller->curve);
#endif
    return view;
}

static void enter(struct controller *controller, enum state state, struct pose odometry, const struct curve_pass *curve)
{
    /* Where a curve path ends without a line, the line is on the side of the obstacle. */
    if (controller->following == FOLLOWING_CURVE)
        controller->last_line_error = controller->state == STATE_AVOID_LEFT ? -MAX_ERROR : MAX_ERROR;
    controller->following = FOLLOWING_NOTHING;
    if (curve->found) {
#if HAS_CURVES
        controller->return_state = controller->state;
        controller->following = FOLLOWING_CURVE;
        curve_begin(&controller->curve, curve, odometry);
#endif
    } else if (state == STATE_AVOID_LEFT || state == STATE_AVOID_RIGHT) {
        controller->return_state = controller->state;
        controller->following = FOLLOWING_STRAIGHT;
        enum side side = state == STATE_AVOID_LEFT ? SIDE_LEFT : SIDE_RIGHT;
        path_begin(&controller->straight, straight_path(side), odometry);
    }
    controller->state = state;
    controller->entered_at = odometry;
}

/* Towards the side of a lost wall: at first nearly straight on, as beyond a gap. */
static float search_rate(const struct controller *controller, struct pose odometry)
{
    float gone_m = hypotf(odometry.x_m - controller->entered_at.x_m, odometry.y_m - controller->entered_at.y_m);
    return gone_m < LOST_GAP_M ? LOST_GAP_TURN_RATE_RAD_S : LOST_TURN_RATE_RAD_S;
}

static struct motion avoid(struct controller *controller, const struct sensors *seen, struct pose odometry,
                           bool line_seen, float error)
{
#if HAS_CURVES
    if (controller->following == FOLLOWING_CURVE)
        return curve_step(&controller->curve, seen, odometry, line_seen, error);
#else
    (void)line_seen, (void)error;
#endif
    enum side obstacle = controller->state == STATE_AVOID_LEFT ? SIDE_RIGHT : SIDE_LEFT;
    bool beside = side_mm(seen, obstacle) < AVOIDANCE_BEHIND_BEYOND_MM;
    float curvature = path_curvature(&controller->straight, odometry, beside);
    return (struct motion){AVOIDANCE_SPEED_M_S, AVOIDANCE_SPEED_M_S * curvature};
}

static float metres(uint16_t range_mm)
{
    return (float)range_mm / 1000.0f;
}

static struct motion drive(struct controller *controller, const struct sensors *seen, struct pose odometry,
                           bool line_seen, float error)
{
    switch (controller->state) {
    case STATE_LINE:
        return follow(controller->last_line_error, LINE_GAINS);
    case STATE_RIGHT_WALL:
        return follow(wall_error(metres(seen->right_mm)), WALL_GAINS);
    case STATE_LEFT_WALL:
        return follow(-wall_error(metres(seen->left_mm)), WALL_GAINS);
    case STATE_TURN_LEFT:
        return (struct motion){0.0f, CORNER_TURN_RATE_RAD_S};
    case STATE_TURN_RIGHT:
        return (struct motion){0.0f, -CORNER_TURN_RATE_RAD_S};
    case STATE_LOST_LEFT_WALL:
        return (struct motion){LOST_SPEED_M_S, search_rate(controller, odometry)};
    case STATE_LOST_RIGHT_WALL:
        return (struct motion){LOST_SPEED_M_S, -search_rate(controller, odometry)};
    case STATE_AVOID_LEFT:
    case STATE_AVOID_RIGHT:
        return avoid(controller, seen, odometry, line_seen, error);
    }
    return (struct motion){0.0f, 0.0f};
}

struct motion controller_step(struct controller *controller, const struct sensors *seen, struct pose odometry)
{
    float error = 0.0f;
    bool line_seen = line_error(seen->line, &error);
    struct curve_pass curve = way_past(controller, seen, odometry);
    struct view view = what_is_known(controller, seen, line_seen, &curve);
    enum state following = next_state(controller->state, &view);
    if (following != controller->state)
        enter(controller, following, odometry, &curve);
    if (line_seen)
        controller->last_line_error = error;
    else if (controller->state == STATE_LINE && controller->line_lost < UINT16_MAX)
        controller->line_lost++;
    return drive(controller, seen, odometry, line_seen, error);
}
