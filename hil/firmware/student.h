/* The part of the controller that is yours to write; student.c has a place for each function.

   The library calls them at every control tick, 20 times a second. Sensors, odometry, paths round obstacles and the
   conditions of conditions.h are there to be used. */
#ifndef STUDENT_H
#define STUDENT_H

#include "conditions.h"
#include "robot.h"
#include "states.h"

/* K1 [m/s], K2 [rad/s] and K3 [m/s] of Eq. 6 and 7. */
struct gains {
    float k1_m_s;
    float k2_rad_s;
    float k3_m_s;
};

/* Whether a line is seen; if so, `error` is set to how far to the left of the sensor's middle it lies, in channels:
   -3.5 at line[0], +3.5 at line[7] (Eq. 12). A channel is on the line where it reads below LINE_THRESHOLD. */
bool line_error(const uint8_t line[CHANNELS], float *error);

/* Error in the distance from a wall that a side sensor, turned by 45 degrees, sees at `measured_m`: positive when the robot
   is too close, in the range of the line's error (Eq. 13 and 14). */
float wall_error(float measured_m);

/* How to drive at an error, positive to the left: fast where it is small, turning towards it (Eq. 6 and 7). */
struct motion follow(float error, struct gains gains);

/* The wheels' angular speeds [rad/s] for a motion of the robot (Eq. 8 and 9). */
struct wheels wheel_speeds(struct motion motion);

/* The state for this tick, from the state of the tick before and what is seen; `state` itself to stay in it. */
enum state next_state(enum state state, const struct view *view);

#endif
