/* Frames with sequence number and checksum: COBS(type, sequence, payload, CRC-16) and a zero, numbers little endian.
   A frame of another length, type or checksum is dropped and counted; every zero starts afresh. */
#include "build_settings.h"

#ifndef FRAMING_SIMTWO

#include <stdbool.h>

#include "firmware.h"
#include "link.h"
#include "uart.h"

enum { TYPE_SENSORS = 'S', TYPE_COMMAND = 'C', TYPE_HELLO = 'H', TYPE_HELLO_BACK = 'h' };
enum { HEAD = 2, CHECKSUM = 2, SENSORS = 19, COMMAND = 14, HELLO_BACK = 10, LONGEST = HEAD + SENSORS + CHECKSUM };
enum { FLAG_RUN = 1, FLAG_START = 2, FLAG_BITS = 2 };

#define PROTOCOL_VERSION 1

static uint8_t encoded[LONGEST + 1];
static uint8_t received;
static bool too_long;
static uint8_t dropped; /* since the last reply */

static const uint8_t firmware_id[8] = FIRMWARE_ID;

void link_begin(void)
{
    received = 0;
    too_long = false;
    dropped = 0;
}

/* CRC-16/IBM-3740: polynomial 0x1021, first 0xFFFF, nothing reflected. The eight steps of a byte are taken together. */
static uint16_t checksum(const uint8_t *bytes, uint8_t length)
{
    uint16_t crc = 0xFFFF;
    for (uint8_t i = 0; i < length; i++) {
        uint8_t top = (uint8_t)(crc >> 8) ^ bytes[i];
        top ^= top >> 4;
        crc = (uint16_t)(crc << 8) ^ (uint16_t)((uint16_t)top << 12) ^ (uint16_t)((uint16_t)top << 5) ^ top;
    }
    return crc;
}

static uint8_t *put16(uint8_t *at, uint16_t value)
{
    *at++ = (uint8_t)value;
    *at++ = (uint8_t)(value >> 8);
    return at;
}

static uint16_t get16(const uint8_t *at)
{
    return (uint16_t)(at[0] | (uint16_t)at[1] << 8);
}

/* Consistent overhead byte stuffing of a frame shorter than 254 bytes: each zero is replaced by the way to the next. */
static void send(uint8_t type, uint8_t sequence, const uint8_t *payload, uint8_t length)
{
    uint8_t frame[LONGEST + 1];
    frame[0] = type;
    frame[1] = sequence;
    for (uint8_t i = 0; i < length; i++)
        frame[HEAD + i] = payload[i];
    length += HEAD;
    put16(frame + length, checksum(frame, length));
    length += CHECKSUM;
    uart_write(0); /* ends what noise may have left on the line, so that it spoils no frame */
    uint8_t begin = 0;
    for (uint8_t end = 0; end <= length; end++) {
        if (end < length && frame[end] != 0)
            continue;
        uart_write(end - begin + 1);
        for (uint8_t i = begin; i < end; i++)
            uart_write(frame[i]);
        begin = end + 1;
    }
    uart_write(0);
}

/* Undo the stuffing in place; the length of the frame, or 0 where it is none. */
static uint8_t unstuff(uint8_t *bytes, uint8_t length)
{
    uint8_t from = 0, to = 0;
    while (from < length) {
        uint8_t code = bytes[from++];
        if (code - 1 > length - from)
            return 0;
        for (uint8_t i = 1; i < code; i++)
            bytes[to++] = bytes[from++];
        if (from < length)
            bytes[to++] = 0;
    }
    return to;
}

static void answer_sensors(uint8_t sequence, const uint8_t *payload)
{
    struct tick tick;
    struct reply reply;
    struct sensors *sensors = &tick.sensors;
    tick.run = payload[0] & FLAG_RUN;
    tick.start = payload[0] & FLAG_START;
    sensors->right_counts = (int16_t)get16(payload + 1);
    sensors->left_counts = (int16_t)get16(payload + 3);
    for (uint8_t i = 0; i < CHANNELS; i++)
        sensors->line[i] = payload[5 + i];
    sensors->front_mm = get16(payload + 13);
    sensors->left_mm = get16(payload + 15);
    sensors->right_mm = get16(payload + 17);
    firmware_tick(&tick, &reply);
    uint8_t answer[COMMAND];
    uint8_t *at = answer;
    *at++ = reply.state;
    at = put16(at, (uint16_t)reply.right_mrad_s);
    at = put16(at, (uint16_t)reply.left_mrad_s);
    at = put16(at, (uint16_t)reply.v_mm_s);
    at = put16(at, (uint16_t)reply.w_mrad_s);
    at = put16(at, reply.line_lost);
    at = put16(at, reply.ticks);
    *at = dropped;
    dropped = 0;
    send(TYPE_COMMAND, sequence, answer, COMMAND);
}

static void answer_hello(uint8_t sequence)
{
    uint8_t answer[HELLO_BACK] = {PROTOCOL_VERSION};
    for (uint8_t i = 0; i < sizeof firmware_id; i++)
        answer[1 + i] = firmware_id[i];
    answer[HELLO_BACK - 1] = BAUD_INDEX;
    send(TYPE_HELLO_BACK, sequence, answer, HELLO_BACK);
}

/* Six bits of the flags are those of a sum; nothing else tells the sensors of a damaged frame that the CRC lets pass. */
static bool adds_up(const uint8_t *frame)
{
    uint8_t sum = frame[1];
    for (uint8_t i = 1; i < SENSORS; i++)
        sum += frame[HEAD + i];
    return frame[HEAD] >> FLAG_BITS == (sum & 0x3F);
}

/* Whether the frame was a message, which has then been answered. */
static bool understand(uint8_t *frame, uint8_t length)
{
    if (length < HEAD + CHECKSUM)
        return false;
    uint8_t payload = length - HEAD - CHECKSUM;
    if (checksum(frame, HEAD + payload) != get16(frame + HEAD + payload))
        return false;
    if (frame[0] == TYPE_SENSORS && payload == SENSORS && adds_up(frame))
        answer_sensors(frame[1], frame + HEAD);
    else if (frame[0] == TYPE_HELLO && payload == 0)
        answer_hello(frame[1]);
    else
        return false;
    return true;
}

void link_receive(uint8_t byte)
{
    if (byte != 0) {
        if (received < sizeof encoded)
            encoded[received++] = byte;
        else
            too_long = true;
        return;
    }
    bool frame = received > 0;
    bool understood = !too_long && understand(encoded, unstuff(encoded, received));
    if (frame && !understood && dropped < UINT8_MAX)
        dropped++;
    received = 0;
    too_long = false;
}

#endif
