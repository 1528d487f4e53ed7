/* The serial line to the simulator: USART 0, which is the USB port of an Arduino Mega; 8 data bits, no parity, 1 stop bit. */
#ifndef UART_H
#define UART_H

#include <stdbool.h>
#include <stdint.h>

void uart_begin(void);

/* The next byte that has come in, if there is one. */
bool uart_read(uint8_t *byte);
bool uart_has_byte(void);

/* Waits while the buffer is full. */
void uart_write(uint8_t byte);

#endif
