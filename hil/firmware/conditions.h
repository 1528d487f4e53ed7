/* Questions that the state machine may ask; each is true or false at this tick. */
#ifndef CONDITIONS_H
#define CONDITIONS_H

#include "robot.h"
#include "states.h"

/* What the conditions look at: what is seen, and what is remembered. */
struct view {
    const struct sensors *seen;
    bool line_seen;
    bool straight_path_goes_back; /* on the way back from an obstacle to the line or wall */
    bool path_finished;           /* false where no path is driven */
    enum state return_state;      /* in which the robot was before it began to avoid */
    bool curve_found;             /* an obstacle is in the way that is passed by a curve path, */
    enum side curve_side;         /* on this side of it */
};

bool on_line(const struct view *view);

/* A side sensor sees a wall that can be followed, with and without a line. */
bool wall_found(const struct view *view, enum side side);
bool line_ended_by_wall(const struct view *view, enum side side);

/* The wall of that side is gone; is there again; is gone while one on the other side is found. */
bool wall_lost(const struct view *view, enum side side);
bool wall_back(const struct view *view, enum side side);
bool wall_goes_on_opposite(const struct view *view, enum side side);

/* Something is ahead, and that side of the robot is free. */
bool obstacle_ahead(const struct view *view, enum side free_side);

/* An obstacle on a bending line is to be passed on that side of it. */
bool curve_beside(const struct view *view, enum side side);

/* A wall is right ahead; it is so no more and the one that is followed is beside the robot. */
bool corner_ahead(const struct view *view);
bool corner_turned(const struct view *view, enum side wall_side);

/* The path round an obstacle has met the line again; is at its end, and began in state `into`. */
bool line_met_on_the_way_back(const struct view *view);
bool avoided(const struct view *view, enum state into);

#endif
