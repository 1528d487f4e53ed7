/* SimTwo's channels: a letter G-Z or g-z and eight upper-case hexadecimal digits, most significant first, no checksum.
   A character that does not fit drops the frame; a letter always begins the next one. */
#include "build_settings.h"

#ifdef FRAMING_SIMTWO

#include <stdbool.h>

#include "firmware.h"
#include "link.h"
#include "uart.h"

enum { DIGITS = 8, FLAG_RUN = 1, FLAG_START = 2 };

static char channel; /* 0: none begun */
static uint8_t digits;
static uint32_t value;
static struct tick tick;

void link_begin(void)
{
    channel = 0;
    tick = (struct tick){0};
}

static void send(char letter, uint32_t number)
{
    uart_write((uint8_t)letter);
    for (int8_t shift = 28; shift >= 0; shift -= 4)
        uart_write((uint8_t)"0123456789ABCDEF"[number >> shift & 0xF]);
}

static void set_line(uint8_t first)
{
    for (uint8_t i = 0; i < 4; i++)
        tick.sensors.line[first + i] = (uint8_t)(value >> (24 - 8 * i));
}

/* `G` is the last channel of a tick: the robot steps on it. */
static void step(void)
{
    struct reply reply;
    tick.run = value & FLAG_RUN;
    firmware_tick(&tick, &reply);
    /* Should the next ones be lost, nothing of this tick must count twice. */
    tick.start = false;
    tick.sensors.right_counts = 0;
    tick.sensors.left_counts = 0;
    send('s', reply.state);
    send('M', (uint32_t)(int32_t)reply.right_mrad_s);
    send('Q', (uint32_t)(int32_t)reply.left_mrad_s);
}

static void take_channel(void)
{
    struct sensors *sensors = &tick.sensors;
    switch (channel) {
    case 'R':
        sensors->right_counts = (int16_t)(uint16_t)(value >> 16);
        sensors->left_counts = (int16_t)(uint16_t)value;
        break;
    case 'I':
        set_line(0);
        break;
    case 'J':
        set_line(4);
        break;
    case 'H':
        sensors->front_mm = (uint16_t)(value >> 16);
        sensors->left_mm = (uint16_t)value;
        break;
    case 'K':
        sensors->right_mm = (uint16_t)(value >> 16);
        tick.start = value & FLAG_START;
        break;
    case 'G':
        step();
        break;
    default:
        break;
    }
}

static bool is_letter(uint8_t byte)
{
    return (byte >= 'G' && byte <= 'Z') || (byte >= 'g' && byte <= 'z');
}

void link_receive(uint8_t byte)
{
    bool decimal = byte >= '0' && byte <= '9', hexadecimal = byte >= 'A' && byte <= 'F';
    if (is_letter(byte)) {
        channel = (char)byte;
        digits = 0;
        value = 0;
    } else if (channel != 0 && (decimal || hexadecimal)) {
        value = value << 4 | (uint8_t)(decimal ? byte - '0' : byte - 'A' + 10);
        if (++digits == DIGITS) {
            take_channel();
            channel = 0;
        }
    } else {
        channel = 0;
    }
}

#endif
