/* Tables in program memory: on the board beyond the reach of pointers, elsewhere in memory like all others. */
#ifndef FLASH_H
#define FLASH_H

#include <stdint.h>

struct flash_pair {
    int16_t first;
    int16_t second;
};

#ifdef __AVR__

#include <avr/pgmspace.h>

#define IN_FLASH PROGMEM
typedef uint_farptr_t flash_address;
#define FLASH_ADDRESS(table) pgm_get_far_address(table)

/* Numbers 2 `index` and 2 `index` + 1 of a table. */
static inline struct flash_pair flash_pair(flash_address table, uint16_t index)
{
    uint32_t both = pgm_read_dword_far(table + 4 * (flash_address)index);
    struct flash_pair pair = {(int16_t)(uint16_t)both, (int16_t)(uint16_t)(both >> 16)};
    return pair;
}

#else

#define IN_FLASH
typedef const int16_t *flash_address;
#define FLASH_ADDRESS(table) (&(table)[0])

static inline struct flash_pair flash_pair(flash_address table, uint16_t index)
{
    struct flash_pair pair = {table[2 * (uint32_t)index], table[2 * (uint32_t)index + 1]};
    return pair;
}

#endif

#endif
