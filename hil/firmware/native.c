/* The same program as a shared library of this machine: for tests, and to try student.c without a board. */
#ifndef __AVR__

#include <string.h>

#include "clock.h"
#include "controller.h"
#include "firmware.h"
#include "odometry.h"
#include "uart.h"

static struct controller controller;
static struct odometry odometry;

void native_reset(void)
{
    controller_reset(&controller);
    odometry_reset(&odometry);
}

/* `ticks` control ticks in a row. Of each tick: counts right, left; line 8; ranges front, left, right; then what comes of it:
   state; v [m/s], w [rad/s]; pose x [m], y [m], yaw [rad]; and of the path that is driven, its nearest point, or -1. */
void native_run(int32_t ticks, const int16_t *counts, const uint8_t *line, const uint16_t *ranges_mm, int32_t *state,
                float *motion, float *pose, int32_t *line_lost, int32_t *nearest)
{
    for (int32_t i = 0; i < ticks; i++) {
        struct sensors seen = {counts[2 * i], counts[2 * i + 1], {0}, ranges_mm[3 * i], ranges_mm[3 * i + 1],
                               ranges_mm[3 * i + 2]};
        memcpy(seen.line, line + CHANNELS * i, CHANNELS);
        odometry_step(&odometry, seen.right_counts, seen.left_counts);
        struct motion wanted = controller_step(&controller, &seen, odometry.pose);
        state[i] = (int32_t)controller.state;
        motion[2 * i] = wanted.v_m_s;
        motion[2 * i + 1] = wanted.w_rad_s;
        memcpy(pose + 3 * i, &odometry.pose, sizeof odometry.pose);
        line_lost[i] = controller.line_lost;
        nearest[i] = -1;
        if (controller.following == FOLLOWING_STRAIGHT)
            nearest[i] = controller.straight.nearest;
#if HAS_CURVES
        if (controller.following == FOLLOWING_CURVE)
            nearest[i] = controller.curve.follower.nearest;
#endif
    }
}

/* The serial line and the clock of the board, played by the caller. */

static const uint8_t *incoming;
static int32_t incoming_left;
static uint8_t outgoing[1 << 16];
static int32_t outgoing_length;
static uint16_t now_ms;

void uart_begin(void)
{
    outgoing_length = 0;
    incoming_left = 0;
}

bool uart_has_byte(void)
{
    return incoming_left > 0;
}

bool uart_read(uint8_t *byte)
{
    if (incoming_left == 0)
        return false;
    incoming_left--;
    *byte = *incoming++;
    return true;
}

void uart_write(uint8_t byte)
{
    if (outgoing_length < (int32_t)sizeof outgoing)
        outgoing[outgoing_length++] = byte;
}

void clock_begin(void)
{
    now_ms = 0;
}

uint16_t clock_ms(void)
{
    return now_ms;
}

void native_begin(void)
{
    firmware_begin();
}

/* `milliseconds` later, `length` bytes come in; up to 65536 bytes that go out are written to `answer`, their number is
   returned. */
int32_t native_exchange(uint16_t milliseconds, const uint8_t *bytes, int32_t length, uint8_t *answer)
{
    now_ms = (uint16_t)(now_ms + milliseconds);
    firmware_poll();
    incoming = bytes;
    incoming_left = length;
    outgoing_length = 0;
    firmware_poll();
    memcpy(answer, outgoing, (size_t)outgoing_length);
    return outgoing_length;
}

/* What the wheels are told, right and left [rad/s]. */
void native_set_points(float *wheels)
{
    struct wheels now = firmware_set_points();
    wheels[0] = now.right_rad_s;
    wheels[1] = now.left_rad_s;
}

#endif
