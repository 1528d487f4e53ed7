#include "firmware.h"

#include <math.h>

#include "clock.h"
#include "controller.h"
#include "link.h"
#include "odometry.h"
#include "student.h"
#include "uart.h"

static struct controller controller;
static struct odometry odometry;
static struct wheels set_points;
static uint16_t ticks;
static uint16_t heard_at_ms;
static bool silent;

static void start_anew(void)
{
    controller_reset(&controller);
    odometry_reset(&odometry);
}

void firmware_begin(void)
{
    start_anew();
    set_points = (struct wheels){0.0f, 0.0f};
    ticks = 0;
    silent = true;
    clock_begin();
    uart_begin();
    link_begin();
}

static int16_t thousandths(float value)
{
    float scaled = 1000.0f * value;
    return (int16_t)lroundf(fmaxf(-32767.0f, fminf(32767.0f, scaled)));
}

void firmware_tick(const struct tick *tick, struct reply *reply)
{
    if (tick->start)
        start_anew();
    odometry_step(&odometry, tick->sensors.right_counts, tick->sensors.left_counts);
    struct motion motion = {0.0f, 0.0f};
    if (tick->run)
        motion = controller_step(&controller, &tick->sensors, odometry.pose);
    set_points = wheel_speeds(motion);
    if (ticks < UINT16_MAX)
        ticks++;
    heard_at_ms = clock_ms();
    silent = false;
    reply->state = (uint8_t)controller.state;
    reply->right_mrad_s = thousandths(set_points.right_rad_s);
    reply->left_mrad_s = thousandths(set_points.left_rad_s);
    reply->v_mm_s = thousandths(motion.v_m_s);
    reply->w_mrad_s = thousandths(motion.w_rad_s);
    reply->line_lost = controller.line_lost;
    reply->ticks = ticks;
}

void firmware_poll(void)
{
    uint8_t byte;
    while (uart_read(&byte))
        link_receive(byte);
    if (!silent && (uint16_t)(clock_ms() - heard_at_ms) >= SILENCE_MS) {
        silent = true;
        set_points = (struct wheels){0.0f, 0.0f};
    }
}

struct wheels firmware_set_points(void)
{
    return set_points;
}
