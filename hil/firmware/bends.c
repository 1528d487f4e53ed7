#include "bends.h"

#include <math.h>

#include "settings.h"

#if HAS_CURVES

/* A robot that creeps adds a place only now and then, so that the memory holds the whole stretch at any speed. */
#define BEND_SPACING_M (AVOIDANCE_CURVES_MEMORY_M / (REMEMBERED - 4))

static bool is_straight(const struct bends *bends)
{
    return fabsf(bends->turned_rad) < AVOIDANCE_CURVES_STRAIGHT_BELOW_RAD;
}

void bends_reset(struct bends *bends)
{
    *bends = (struct bends){0};
}

static uint8_t place(const struct bends *bends, uint8_t index)
{
    return (uint8_t)(bends->oldest + index) % REMEMBERED;
}

static void remember(struct bends *bends, float yaw_rad)
{
    if (bends->count > 0) {
        uint8_t newest = place(bends, bends->count - 1);
        if (bends->travelled_m - bends->recent[newest].travelled_m < BEND_SPACING_M)
            return;
    }
    if (bends->count == REMEMBERED) {
        bends->oldest = place(bends, 1);
        bends->count--;
    }
    uint8_t next = place(bends, bends->count);
    bends->recent[next].travelled_m = bends->travelled_m;
    bends->recent[next].yaw_rad = yaw_rad;
    bends->count++;
}

void bends_update(struct bends *bends, struct pose odometry)
{
    if (bends->moved)
        bends->travelled_m += hypotf(odometry.x_m - bends->last.x_m, odometry.y_m - bends->last.y_m);
    bends->moved = true;
    bends->last = odometry;
    remember(bends, odometry.yaw_rad);
    while (bends->count > 0 &&
           bends->travelled_m - bends->recent[bends->oldest].travelled_m > AVOIDANCE_CURVES_MEMORY_M) {
        bends->oldest = place(bends, 1);
        bends->count--;
    }
    bends->turned_rad = bends->count > 0 ? odometry.yaw_rad - bends->recent[bends->oldest].yaw_rad : 0.0f;
    if (!is_straight(bends)) {
        bends->bent = true;
        bends->bend = bends->turned_rad > 0.0f ? SIDE_LEFT : SIDE_RIGHT;
    }
}

static struct curve_pass beside(const struct bends *bends, const struct sensors *seen, enum side side)
{
    struct curve_pass pass = {false, false, side, side, 0};
    uint16_t range_mm = side_mm(seen, side);
    uint16_t farther_mm = range_mm > seen->front_mm ? range_mm : seen->front_mm;
    bool straight = is_straight(bends);
    if (bends->bent && bends->bend != side)
        return pass;
    if (range_mm < AVOIDANCE_CURVES_SIDE_BELOW_MM) {
        pass = (struct curve_pass){true, !straight, straight ? other(side) : side, side, range_mm};
    } else if (straight && farther_mm < AVOIDANCE_CURVES_BOTH_BELOW_MM) {
        /* Between the beams it is nearer than either says. */
        pass = (struct curve_pass){true, false, other(side), side, 0};
    }
    return pass;
}

struct curve_pass curve_pass(const struct bends *bends, const struct sensors *seen)
{
    uint16_t ahead_mm = is_straight(bends) ? AVOIDANCE_CURVES_AHEAD_BELOW_MM : AVOIDANCE_FRONT_BELOW_MM;
    if (seen->front_mm < ahead_mm) {
        enum side freer = seen->left_mm >= seen->right_mm ? SIDE_LEFT : SIDE_RIGHT;
        enum side side = bends->bent ? bends->bend : freer;
        return (struct curve_pass){true, true, side, side, seen->front_mm};
    }
    struct curve_pass left = beside(bends, seen, SIDE_LEFT);
    return left.found ? left : beside(bends, seen, SIDE_RIGHT);
}

#endif
