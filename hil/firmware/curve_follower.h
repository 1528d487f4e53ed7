/* Driving a curve path, and from its end onto the line whatever the angle at which the two meet. */
#ifndef CURVE_FOLLOWER_H
#define CURVE_FOLLOWER_H

#include "bends.h"
#include "facing.h"
#include "path_follower.h"

enum curve_phase { CURVE_FACE, CURVE_PATH, CURVE_CROSS, CURVE_TURN, CURVE_DONE };

struct curve_follower {
    enum curve_phase phase;
    struct facing facing;
    struct path_follower follower;
    float turn; /* into the line; +1 left, -1 right */
    struct pose line_seen_at;
    float met_error; /* line error where the line was met */
    struct pose since;
};

void curve_begin(struct curve_follower *curve, const struct curve_pass *chosen, struct pose start);

bool curve_finished(const struct curve_follower *curve);

/* Face the obstacle, path, straight on until the axle is over the line, then a turn on the spot into the line; `error` is the
   line's, where one is seen. */
struct motion curve_step(struct curve_follower *curve, const struct sensors *seen, struct pose odometry, bool line_seen,
                         float error);

#endif
