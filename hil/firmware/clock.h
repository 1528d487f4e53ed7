/* Time since the board was switched on. */
#ifndef CLOCK_H
#define CLOCK_H

#include <stdint.h>

void clock_begin(void);

/* Milliseconds; wraps after 65 s, so compare differences. */
uint16_t clock_ms(void);

#endif
