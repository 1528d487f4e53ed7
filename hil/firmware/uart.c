#ifdef __AVR__

#include "uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "build_settings.h"

/* At double speed the rate is F_CPU / (8 (UBRR + 1)): exact at 250000, 500000 and 1000000, 2.1 % fast at 115200. */
#define UBRR_OF(baud) ((F_CPU + 4UL * (baud)) / (8UL * (baud)) - 1UL)

/* Powers of two, so that indices wrap by themselves; one byte of each stays empty. */
#define INCOMING 256
#define OUTGOING 64

static volatile uint8_t incoming[INCOMING], in_head, in_tail;
static volatile uint8_t outgoing[OUTGOING], out_head, out_tail;

void uart_begin(void)
{
    UBRR0 = (uint16_t)UBRR_OF(BAUD);
    UCSR0A = _BV(U2X0);
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

/* A byte that finds the buffer full is lost; its frame is damaged and dropped. */
ISR(USART0_RX_vect)
{
    uint8_t byte = UDR0, next = (uint8_t)(in_head + 1);
    if (next == in_tail)
        return;
    incoming[in_head] = byte;
    in_head = next;
}

ISR(USART0_UDRE_vect)
{
    if (out_tail == out_head) {
        UCSR0B &= (uint8_t)~_BV(UDRIE0);
        return;
    }
    UDR0 = outgoing[out_tail];
    out_tail = (out_tail + 1) % OUTGOING;
}

bool uart_has_byte(void)
{
    return in_tail != in_head;
}

bool uart_read(uint8_t *byte)
{
    if (!uart_has_byte())
        return false;
    *byte = incoming[in_tail];
    in_tail = (uint8_t)(in_tail + 1);
    return true;
}

void uart_write(uint8_t byte)
{
    uint8_t next = (out_head + 1) % OUTGOING;
    while (next == out_tail)
        ;
    outgoing[out_head] = byte;
    out_head = next;
    cli(); /* the interrupt clears a bit of the same register */
    UCSR0B |= _BV(UDRIE0);
    sei();
}

#endif
