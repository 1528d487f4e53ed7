/* Pure pursuit along a stored path, on odometry (section 4.3). */
#ifndef PATH_FOLLOWER_H
#define PATH_FOLLOWER_H

#include "path_store.h"
#include "robot.h"

struct path_follower {
    struct path path;
    struct pose start;
    float start_cos; /* of its yaw */
    float start_sin;
    uint16_t nearest; /* index of the path's point nearest to the robot */
    float shift_m;    /* by which the rest of the path was put off */
};

void path_begin(struct path_follower *follower, struct path path, struct pose start);

bool path_finished(const struct path_follower *follower);
bool path_on_the_way_back(const struct path_follower *follower);

/* Curvature [1/m] to drive at, positive to the left. While the obstacle is still beside the robot at the end of the stretch
   along it, the way back is put off: the rest of the path moves forward with the robot. */
float path_curvature(struct path_follower *follower, struct pose odometry, bool obstacle_beside);

/* Direction [rad] in which the robot sees the point of the path that it steers for, positive to the left. */
float path_bearing(struct path_follower *follower, struct pose odometry);

#endif
