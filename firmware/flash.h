/* Tables in program memory: on the board beyond the reach of pointers, elsewhere in memory like all others. */
#ifndef FLASH_H
#define FLASH_H

#include <stdint.h>

#ifdef __AVR__

#include <avr/pgmspace.h>

#define IN_FLASH PROGMEM
typedef uint_farptr_t flash_address;
#define FLASH_ADDRESS(table) pgm_get_far_address(table)

static inline int16_t flash_int16(flash_address table, uint16_t index)
{
    return (int16_t)pgm_read_word_far(table + 2 * (flash_address)index);
}

#else

#define IN_FLASH
typedef const int16_t *flash_address;
#define FLASH_ADDRESS(table) (&(table)[0])

static inline int16_t flash_int16(flash_address table, uint16_t index)
{
    return table[index];
}

#endif

#endif
