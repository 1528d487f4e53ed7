/* The robot between two messages: its controller, its odometry, and how it stops when nobody speaks to it. */
#ifndef FIRMWARE_H
#define FIRMWARE_H

#include "robot.h"

/* One control tick as the simulator tells it. */
struct tick {
    bool run;   /* else the robot stands still; odometry goes on */
    bool start; /* of a run: odometry, state and counters begin anew */
    struct sensors sensors;
};

/* What the robot answers. */
struct reply {
    uint8_t state;        /* the numbers of data.csv */
    int16_t right_mrad_s; /* set points of the wheels */
    int16_t left_mrad_s;
    int16_t v_mm_s;
    int16_t w_mrad_s;
    uint16_t line_lost; /* ticks in the line state without any channel on the line */
    uint16_t ticks;     /* accepted since the board was switched on, so that a new start of it is seen */
};

/* Without a message for so long the wheels are told to stand still. */
#define SILENCE_MS 150

void firmware_begin(void);

/* To be called again and again: takes what has come in, answers it, and watches for silence. */
void firmware_poll(void);

/* One accepted tick. */
void firmware_tick(const struct tick *tick, struct reply *reply);

/* What the wheels are told now. */
struct wheels firmware_set_points(void);

#endif
