#include "facing.h"

#include <math.h>

#include "settings.h"

#if HAS_CURVES

void facing_begin(struct facing *facing, struct pose start, enum side bend, uint16_t near_mm)
{
    facing->phase = near_mm < AVOIDANCE_CURVES_FACE_BACK_BELOW_MM ? FACING_BACK : FACING_TURN_OUT;
    facing->inward = sign_of(bend);
    facing->since = start;
    facing->heading_rad = start.yaw_rad;
    facing->swept = 0;
}

static bool is_visible(const struct sensors *seen)
{
    return seen->front_mm < AVOIDANCE_CURVES_FACE_SEEN_BELOW_MM;
}

/* Near its edges the reading mixes with what lies behind; the middle of the obstacle is where it is nearest. */
static float heading_of_the_middle(const struct facing *facing)
{
    uint16_t nearest_mm = UINT16_MAX;
    for (uint8_t i = 0; i < facing->swept; i++) {
        if (facing->sweep[i].front_mm < nearest_mm)
            nearest_mm = facing->sweep[i].front_mm;
    }
    bool begun = false;
    float first = 0.0f, last = 0.0f;
    for (uint8_t i = 0; i < facing->swept; i++) {
        if (facing->sweep[i].front_mm <= nearest_mm + AVOIDANCE_CURVES_FACE_EDGE_MM) {
            last = facing->sweep[i].yaw_rad;
            first = begun ? first : last;
            begun = true;
        }
    }
    return 0.5f * (first + last);
}

static enum facing_phase sweep_in(struct facing *facing, const struct sensors *seen, float yaw, float turned_rad)
{
    bool visible = is_visible(seen);
    if (visible) {
        uint8_t at = facing->swept < SWEEP ? facing->swept++ : SWEEP - 1;
        facing->sweep[at].front_mm = seen->front_mm;
        facing->sweep[at].yaw_rad = yaw;
    }
    bool over = facing->swept > 0 && !visible;
    if (!over && turned_rad < AVOIDANCE_CURVES_FACE_MAX_IN_RAD)
        return FACING_SWEEP_IN;
    facing->heading_rad = facing->swept > 0 ? heading_of_the_middle(facing) : facing->since.yaw_rad;
    return FACING_FACE;
}

static bool is_at_the_distance(const struct sensors *seen)
{
    return seen->front_mm >= FACING_NEAREST_MM && seen->front_mm <= FACING_FARTHEST_MM;
}

static enum facing_phase next_phase(struct facing *facing, const struct sensors *seen, struct pose odometry)
{
    float travelled_m = hypotf(odometry.x_m - facing->since.x_m, odometry.y_m - facing->since.y_m);
    float turned_rad = fabsf(odometry.yaw_rad - facing->since.yaw_rad);
    switch (facing->phase) {
    case FACING_BACK:
        return travelled_m >= AVOIDANCE_CURVES_FACE_BACK_M ? FACING_TURN_OUT : FACING_BACK;
    case FACING_TURN_OUT:
        return !is_visible(seen) || turned_rad > AVOIDANCE_CURVES_FACE_MAX_OUT_RAD ? FACING_SWEEP_IN : FACING_TURN_OUT;
    case FACING_SWEEP_IN:
        return sweep_in(facing, seen, odometry.yaw_rad, turned_rad);
    case FACING_FACE:
        if (fabsf(odometry.yaw_rad - facing->heading_rad) < AVOIDANCE_CURVES_FACE_TOLERANCE_RAD)
            return FACING_TRIM;
        return turned_rad > AVOIDANCE_CURVES_FACE_MAX_IN_RAD ? FACING_TRIM : FACING_FACE;
    case FACING_TRIM:
        if (is_at_the_distance(seen) || travelled_m > AVOIDANCE_CURVES_FACE_MAX_TRIM_M)
            return FACING_DONE;
        return FACING_TRIM;
    default:
        return FACING_DONE;
    }
}

struct motion facing_step(struct facing *facing, const struct sensors *seen, struct pose odometry)
{
    const float rate = AVOIDANCE_CURVES_FACE_TURN_RATE_RAD_S, speed = AVOIDANCE_CURVES_FACE_SPEED_M_S;
    enum facing_phase following = next_phase(facing, seen, odometry);
    if (following != facing->phase) {
        facing->phase = following;
        facing->since = odometry;
    }
    struct motion motion = {0.0f, 0.0f};
    switch (facing->phase) {
    case FACING_BACK:
        motion.v_m_s = -speed;
        break;
    case FACING_TURN_OUT:
        motion.w_rad_s = -facing->inward * rate;
        break;
    case FACING_SWEEP_IN:
        motion.w_rad_s = facing->inward * rate;
        break;
    case FACING_FACE:
        motion.w_rad_s = AVOIDANCE_CURVES_FACE_FACE_GAIN_1_S * (facing->heading_rad - odometry.yaw_rad);
        motion.w_rad_s = fmaxf(-rate, fminf(rate, motion.w_rad_s));
        break;
    case FACING_TRIM:
        motion.v_m_s = seen->front_mm < AVOIDANCE_FRONT_BELOW_MM ? -speed : speed;
        break;
    case FACING_DONE:
        break;
    }
    return motion;
}

#endif
