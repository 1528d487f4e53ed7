#include "path_follower.h"

#include <math.h>

#include "paths.h"
#include "settings.h"

#define TWO_PI 6.2831853f

/* The squares of two such distances add up within 32 bits. */
#define FARTHEST 46340

struct offset {
    float x_m;
    float y_m;
};

void path_begin(struct path_follower *follower, struct path path, struct pose start)
{
    *follower = (struct path_follower){path, start, cosf(start.yaw_rad), sinf(start.yaw_rad), 0, 0.0f};
}

bool path_finished(const struct path_follower *follower)
{
    return follower->nearest + 2 >= follower->path.count;
}

bool path_on_the_way_back(const struct path_follower *follower)
{
    return follower->nearest >= follower->path.back_begins;
}

static struct offset in_path_frame(const struct path_follower *follower, struct pose odometry)
{
    float dx = odometry.x_m - follower->start.x_m, dy = odometry.y_m - follower->start.y_m;
    float c = follower->start_cos, s = follower->start_sin;
    struct offset offset = {c * dx + s * dy, c * dy - s * dx};
    return offset;
}

static int32_t in_path_units(float length_m)
{
    float units = PATH_UNITS_PER_M * length_m;
    return lroundf(fmaxf(-1e6f, fminf(1e6f, units)));
}

static uint16_t apart(int32_t one, int32_t another)
{
    int32_t distance = one > another ? one - another : another - one;
    return distance < FARTHEST ? (uint16_t)distance : FARTHEST;
}

/* Squared distance of point `index` from x, y, in path units. */
static uint32_t squared(const struct path *path, uint16_t index, int32_t x, int32_t y)
{
    struct flash_pair point = flash_pair(path->points, index);
    uint16_t dx = apart(point.first, x), dy = apart(point.second, y);
    return (uint32_t)dx * dx + (uint32_t)dy * dy;
}

/* Strides over points that are too far off to hold the nearest, the longest first. */
#define STRIDES 3
static const uint8_t STRIDE[STRIDES] = {128, 32, 8};

/* Squared distances beyond which none of the next STRIDE points can be nearer than `least`: from one point to the next the
   distance changes by no more than the spacing; 3 units more than make up for all rounding. */
static void set_bounds(uint32_t bounds[STRIDES], const struct path *path, uint32_t least)
{
    float spacing = 1.001f * PATH_UNITS_PER_M * path->spacing_m, nearest = 1.001f * sqrtf((float)least) + 3.0f;
    for (uint8_t i = 0; i < STRIDES; i++) {
        float bound = nearest + (float)STRIDE[i] * spacing;
        bounds[i] = bound < 65000.0f ? (uint32_t)(bound * bound) : UINT32_MAX;
    }
}

static uint8_t stride(const uint32_t bounds[STRIDES], uint32_t distance)
{
    for (uint8_t i = 0; i < STRIDES; i++) {
        if (distance > bounds[i])
            return STRIDE[i];
    }
    return 0;
}

/* The nearest point among the next few. A look at each of them, in floats, would take most of a tick. */
static void find_nearest(struct path_follower *follower, float x_m, float y_m)
{
    const struct path *path = &follower->path;
    int32_t x = in_path_units(x_m - follower->shift_m), y = in_path_units(path->mirror * y_m);
    uint16_t end = follower->nearest + path->window_points;
    if (end > path->count)
        end = path->count;
    uint32_t least = UINT32_MAX, bounds[STRIDES];
    bool bounded = false;
    uint16_t at = follower->nearest;
    for (uint16_t i = follower->nearest; i < end; i++) {
        uint32_t distance = squared(path, i, x, y);
        if (distance < least) {
            least = distance;
            at = i;
            bounded = false;
            continue;
        }
        if (!bounded)
            set_bounds(bounds, path, least);
        bounded = true;
        i += stride(bounds, distance);
    }
    follower->nearest = at;
}

/* From the robot to the point of the path a look-ahead further on, in the frame of the start. */
static struct offset goal(struct path_follower *follower, struct pose odometry, bool obstacle_beside)
{
    const struct path *path = &follower->path;
    struct offset robot = in_path_frame(follower, odometry);
    if (obstacle_beside && !path_on_the_way_back(follower)) {
        float back_x_m = (float)flash_pair(path->points, path->back_begins).first / PATH_UNITS_PER_M;
        float at_back_begins = back_x_m + follower->shift_m;
        follower->shift_m += fmaxf(0.0f, robot.x_m - at_back_begins + AVOIDANCE_LOOK_AHEAD_M);
    }
    find_nearest(follower, robot.x_m, robot.y_m);
    uint16_t last = path->count - 1;
    uint16_t left = last - follower->nearest;
    uint16_t index = left < path->ahead_points ? last : follower->nearest + path->ahead_points;
    float beyond_m = fmaxf(0.0f, AVOIDANCE_LOOK_AHEAD_M - path->spacing_m * (float)left);
    struct flash_pair point = flash_pair(path->points, index);
    float x_m = (float)point.first / PATH_UNITS_PER_M;
    float y_m = path->mirror * (float)point.second / PATH_UNITS_PER_M;
    struct offset ahead = {x_m + follower->shift_m + beyond_m - robot.x_m, y_m - robot.y_m};
    return ahead;
}

float path_curvature(struct path_follower *follower, struct pose odometry, bool obstacle_beside)
{
    struct offset ahead = goal(follower, odometry, obstacle_beside);
    float yaw = odometry.yaw_rad - follower->start.yaw_rad;
    float lateral = -sinf(yaw) * ahead.x_m + cosf(yaw) * ahead.y_m;
    return 2.0f * lateral / fmaxf(ahead.x_m * ahead.x_m + ahead.y_m * ahead.y_m, 1e-6f);
}

float path_bearing(struct path_follower *follower, struct pose odometry)
{
    struct offset ahead = goal(follower, odometry, false);
    float angle = atan2f(ahead.y_m, ahead.x_m) - odometry.yaw_rad + follower->start.yaw_rad;
    return angle - TWO_PI * (float)lroundf(angle / TWO_PI);
}
