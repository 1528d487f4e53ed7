/* The pre-computed paths round obstacles, kept in flash for the left-hand side and mirrored for the right. */
#ifndef PATH_STORE_H
#define PATH_STORE_H

#include "flash.h"
#include "robot.h"

/* Evenly spaced points in the frame of the robot where avoidance began: x forward, y left. */
struct path {
    flash_address points; /* x, y, x, y, ... in units of 1 / PATH_UNITS_PER_M */
    float mirror;         /* -1 where y is to be turned round */
    float spacing_m;
    uint16_t count;
    uint16_t back_begins;   /* index of the first point of the way back; `count` where there is none */
    uint16_t ahead_points;  /* in a look-ahead */
    uint16_t window_points; /* in which the nearest point is looked for */
};

/* Past an obstacle in a straight line, out to `side` (Fig. 7a). */
struct path straight_path(enum side side);

/* Past an obstacle on a line that bends to `bend`: inside of the bend (Fig. 7c), or outside (Fig. 7b). */
struct path inner_path(enum side bend);
struct path outer_path(enum side bend);

#endif
