#ifdef __AVR__

#include "board.h"

#include <avr/interrupt.h>
#include <avr/sleep.h>

#include "firmware.h"
#include "uart.h"

void board_begin(void)
{
    firmware_begin();
    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
}

void board_round(void)
{
    firmware_poll();
    cli();
    if (!uart_has_byte()) {
        sleep_enable();
        sei(); /* takes effect after the next instruction, so that no byte comes in between */
        sleep_cpu();
        sleep_disable();
    }
    sei();
}

#endif
