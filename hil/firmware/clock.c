#ifdef __AVR__

#include "clock.h"

#include <avr/interrupt.h>
#include <avr/io.h>

static volatile uint16_t milliseconds;

/* Timer 5, which neither the Arduino core nor its serial library use. */
void clock_begin(void)
{
    milliseconds = 0;
    TCCR5A = 0;
    TCCR5B = _BV(WGM52) | _BV(CS51) | _BV(CS50); /* from 0 to OCR5A at F_CPU / 64 */
    OCR5A = (uint16_t)(F_CPU / 64 / 1000 - 1);
    TCNT5 = 0;
    TIMSK5 = _BV(OCIE5A);
}

ISR(TIMER5_COMPA_vect)
{
    milliseconds++;
}

uint16_t clock_ms(void)
{
    uint8_t flags = SREG;
    cli();
    uint16_t now = milliseconds;
    SREG = flags;
    return now;
}

#endif
