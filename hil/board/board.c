/* A simulated board: an AVR with its firmware on libsimavr, its first serial port towards the program that started it.
 *
 *   board lockstep MCU HZ ELF BAUD   the board runs when told to, so many cycles at a time; same bytes, same answer
 *   board pty MCU HZ ELF BAUD        the board runs in real time behind a pty, whose path is the first line said
 *
 * In lock-step a request is one letter and its operands, little endian:
 *   'T' cycles u32, n u16, n bytes   put the bytes on the wire, run so many cycles
 *      -> 'T', cycle u64, overrun u32, unheard u32, n u16, n x (cycle u64), n bytes
 *   'R'                              reset the board -> 'R'
 * A board that stops answers 'E', length u16, text, and the process ends with status 3. It also ends when its standard
 * input does, so that it never outlives who started it.
 *
 * The wire is that of an 8N1 line: bytes take ten bits of the sender's clock, and are read with the receiver's. Too
 * different clocks give wrong bytes, a receiver that is off hears nothing, and one that is read too late loses bytes.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#define BITS 10            /* start, eight of data, stop */
#define UNREAD_MOST 3      /* two in the receive buffer and one in the shift register (ATmega2560, section 22.7.1) */
#define QUEUE 16384        /* bytes; a power of two */
#define BEHIND_MAX_NS 100000000LL
#define BUSY_NS 5000000LL

typedef struct {
    uint8_t byte[QUEUE];
    uint64_t cycle[QUEUE]; /* at which the stop bit ends; of sent bytes only */
    uint32_t read, write;
} queue_t;

static avr_t *avr;
static avr_uart_t *uart;
static avr_irq_t *receiver;
static queue_t to_board, from_board;
static uint64_t baud;
static uint64_t wire_free;  /* when the line to the board is free, in cycles times baud */
static uint64_t sent_until; /* when the board's transmitter is free, in cycles */
static uint32_t overrun, unheard;
static int feeding, slice_over;
static int said; /* what the program says goes here; simavr prints to stdout, which is turned away */

static uint32_t waiting(const queue_t *queue) { return queue->write - queue->read; }

static void say(const void *data, size_t length)
{
    const char *at = data;
    while (length) {
        ssize_t taken = write(said, at, length);
        if (taken < 0 && errno == EINTR)
            continue;
        if (taken <= 0)
            exit(0); /* nobody listens any more */
        at += taken;
        length -= (size_t)taken;
    }
}

static void stop(const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length >= (int)sizeof text)
        length = sizeof text - 1;
    uint8_t head[3] = {'E', (uint8_t)length, (uint8_t)(length >> 8)};
    say(head, sizeof head);
    say(text, (size_t)length);
    exit(3);
}

static void quiet(avr_t *of, const int level, const char *format, va_list arguments)
{
    (void)of;
    if (level <= LOG_ERROR)
        vfprintf(stderr, format, arguments);
}

static void no_sleep(avr_t *of, avr_cycle_count_t cycles)
{
    (void)of;
    (void)cycles;
}

/* Cycles of a bit by the board's baud rate register. */
static uint64_t board_bit(void)
{
    uint32_t divider = (uint32_t)(avr->data[uart->ubrrl.reg] | (avr->data[uart->ubrrh.reg] & 0x0F) << 8);
    return (uint64_t)(divider + 1) * (avr_regbit_get(avr, uart->u2x) ? 8 : 16);
}

/* What a receiver with bits of `reading` reads of a byte sent with bits of `sending`, sampled in the middle. */
static uint8_t resampled(uint8_t byte, uint64_t sending, uint64_t reading)
{
    uint32_t levels = 0xFFFFFE00u | (uint32_t)byte << 1; /* start bit 0, data, stop bit and idle line 1 */
    levels |= 1u << 9;
    uint8_t read = 0;
    for (int bit = 0; bit < 8; bit++) {
        uint64_t at = (2 * (uint64_t)bit + 3) * reading / (2 * sending);
        if (at > 31 || levels >> at & 1)
            read |= (uint8_t)(1 << bit);
    }
    return read;
}

/* One byte begins on the wire to the board; simavr lets the firmware have it a byte's time later, when it is over. */
static avr_cycle_count_t feed(avr_t *of, avr_cycle_count_t when, void *unused)
{
    (void)of;
    (void)unused;
    uint8_t byte = to_board.byte[to_board.read++ % QUEUE];
    uint64_t bit = board_bit();
    uart->cycles_per_byte = BITS * bit;
    if (!avr_regbit_get(avr, uart->rxen))
        unheard++;
    else if (((uart->input.write - uart->input.read) & (uart_fifo_fifo_size - 1)) >= UNREAD_MOST)
        overrun++;
    else
        avr_raise_irq(receiver, resampled(byte, avr->frequency, bit * baud));
    uint64_t now = when * baud;
    wire_free = (wire_free > now ? wire_free : now) + BITS * (uint64_t)avr->frequency;
    feeding = waiting(&to_board) > 0;
    return feeding ? (wire_free + baud - 1) / baud : 0;
}

static void feed_later(void)
{
    if (feeding || !waiting(&to_board))
        return;
    uint64_t free = (wire_free + baud - 1) / baud;
    feeding = 1;
    avr_cycle_timer_register(avr, free > avr->cycle ? free - avr->cycle : 1, feed, NULL);
}

/* The firmware hands a byte to its transmitter, which has sent it when those before it are sent. */
static void take(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq;
    (void)unused;
    uint64_t bit = board_bit();
    uart->cycles_per_byte = BITS * bit;
    sent_until = (sent_until > avr->cycle ? sent_until : avr->cycle) + BITS * bit;
    if (waiting(&from_board) == QUEUE)
        stop("the firmware sends more than anybody reads");
    from_board.byte[from_board.write % QUEUE] = resampled((uint8_t)value, bit * baud, avr->frequency);
    from_board.cycle[from_board.write % QUEUE] = sent_until;
    from_board.write++;
}

static avr_cycle_count_t end_slice(avr_t *of, avr_cycle_count_t when, void *unused)
{
    (void)of;
    (void)unused;
    slice_over = 1;
    return when + 1; /* with no timer left simavr would sleep for a thousand cycles more */
}

static void run_until(uint64_t cycle)
{
    if (cycle <= avr->cycle)
        return;
    slice_over = 0;
    avr_cycle_timer_register(avr, cycle - avr->cycle, end_slice, NULL);
    while (!slice_over) {
        int state = avr_run(avr);
        if (state == cpu_Done)
            stop("the firmware sleeps with interrupts off, from which nothing wakes it, at cycle %llu",
                 (unsigned long long)avr->cycle);
        if (state == cpu_Crashed)
            stop("the firmware crashed at address 0x%x, cycle %llu", avr->pc, (unsigned long long)avr->cycle);
    }
    avr_cycle_timer_cancel(avr, end_slice, NULL);
}

static void reset_board(void)
{
    avr_reset(avr);
    to_board.read = to_board.write;
    from_board.read = from_board.write;
    feeding = 0;
    sent_until = avr->cycle;
}

static int hear(void *data, size_t length)
{
    char *at = data;
    while (length) {
        ssize_t got = read(STDIN_FILENO, at, length);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return 0;
        at += got;
        length -= (size_t)got;
    }
    return 1;
}

static void tick(uint64_t *due)
{
    struct __attribute__((packed)) {
        uint32_t cycles;
        uint16_t length;
    } asked;
    static uint8_t bytes[65536];
    if (!hear(&asked, sizeof asked) || !hear(bytes, asked.length))
        exit(0);
    for (uint32_t i = 0; i < asked.length; i++) {
        if (waiting(&to_board) == QUEUE)
            stop("more bytes than the wire can hold");
        to_board.byte[to_board.write++ % QUEUE] = bytes[i];
    }
    feed_later();
    *due += asked.cycles; /* not from where the last instruction ended, so that ticks do not drift */
    run_until(*due);
    uint16_t sent = 0;
    while (sent < waiting(&from_board) && from_board.cycle[(from_board.read + sent) % QUEUE] <= *due)
        sent++;
    struct __attribute__((packed)) {
        uint8_t kind;
        uint64_t cycle;
        uint32_t overrun, unheard;
        uint16_t length;
    } answer = {'T', *due, overrun, unheard, sent};
    static uint8_t reply[sizeof answer + QUEUE * 9];
    memcpy(reply, &answer, sizeof answer);
    for (uint16_t i = 0; i < sent; i++) {
        uint32_t at = from_board.read++ % QUEUE;
        memcpy(reply + sizeof answer + 8 * i, &from_board.cycle[at], 8);
        reply[sizeof answer + 8 * sent + i] = from_board.byte[at];
    }
    say(reply, sizeof answer + 9 * (size_t)sent);
}

static void lockstep(void)
{
    uint64_t due = avr->cycle;
    uint8_t request;
    while (hear(&request, 1)) {
        if (request == 'T') {
            tick(&due);
        } else if (request == 'R') {
            reset_board();
            say("R", 1);
        } else {
            stop("no such request: 0x%02x", request);
        }
    }
}

static int64_t now_ns(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (int64_t)time.tv_sec * 1000000000LL + time.tv_nsec;
}

static int open_pty(void)
{
    int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (master < 0 || grantpt(master) || unlockpt(master))
        stop("no pty: %s", strerror(errno));
    /* Held open, so that a reader may come and go without the master failing. */
    int slave = open(ptsname(master), O_RDWR | O_NOCTTY | O_CLOEXEC);
    struct termios settings;
    if (slave < 0 || tcgetattr(slave, &settings))
        stop("no pty: %s", strerror(errno));
    cfmakeraw(&settings);
    tcsetattr(slave, TCSANOW, &settings);
    fcntl(master, F_SETFL, O_NONBLOCK);
    say(ptsname(master), strlen(ptsname(master)));
    say("\n", 1);
    return master;
}

static void real_time(void)
{
    run_until(avr->cycle + avr->frequency / 20); /* it has booted when its port is named */
    int master = open_pty();
    int64_t began = now_ns() - (int64_t)(avr->cycle * 1000000000ULL / avr->frequency), heard = 0;
    struct pollfd watched[2] = {{master, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    for (;;) {
        int64_t now = now_ns();
        int64_t behind = now - began - (int64_t)((unsigned __int128)avr->cycle * 1000000000U / avr->frequency);
        if (behind > BEHIND_MAX_NS)
            began += behind; /* the machine slept; a board that races to catch up is no board */
        run_until((uint64_t)((unsigned __int128)(now - began) * avr->frequency / 1000000000U));
        while (waiting(&from_board) && from_board.cycle[from_board.read % QUEUE] <= avr->cycle)
            if (write(master, &from_board.byte[from_board.read++ % QUEUE], 1) < 0 && errno != EAGAIN)
                stop("the pty fails: %s", strerror(errno));
        uint8_t bytes[256]; /* on the wire from now on, not from when the board was last run */
        ssize_t got = QUEUE - waiting(&to_board) > sizeof bytes ? read(master, bytes, sizeof bytes) : 0;
        for (ssize_t i = 0; i < got; i++)
            to_board.byte[to_board.write++ % QUEUE] = bytes[i];
        if (got > 0) {
            heard = now;
            feed_later();
        }
        /* Awake often enough while the firmware has something to do, and seldom while it has not. */
        struct timespec rest = {0, now - heard < BUSY_NS || waiting(&from_board) ? 100000 : 2000000};
        ppoll(watched, 2, &rest, NULL);
        uint8_t request;
        if (watched[1].revents) {
            if (!hear(&request, 1))
                exit(0);
            if (request == 'R')
                reset_board();
        }
    }
}

static void make_board(const char *mcu, uint32_t hz, const char *elf)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    if (elf_read_firmware(elf, &firmware) || !firmware.flashsize)
        stop("%s is no firmware", elf);
    avr_global_logger_set(quiet);
    avr = avr_make_mcu_by_name(mcu);
    if (!avr)
        stop("simavr knows no %s", mcu);
    avr_init(avr);
    firmware.frequency = hz;
    avr_load_firmware(avr, &firmware);
    avr->frequency = hz;
    avr->run_cycle_limit = hz / 1000; /* instructions in a row while nothing is due; by default one */
    avr->sleep = no_sleep;
    for (avr_io_t *io = avr->io_port; io && !uart; io = io->next)
        if (!strcmp(io->kind, "uart") && ((avr_uart_t *)io)->name == '0')
            uart = (avr_uart_t *)io;
    if (!uart)
        stop("%s has no serial port 0", mcu);
    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    receiver = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), take, NULL);
}

int main(int count, char **arguments)
{
    said = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    if (count != 6 || said < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
        fprintf(stderr, "usage: board lockstep|pty MCU HZ ELF BAUD\n");
        return 2;
    }
    baud = strtoull(arguments[5], NULL, 10);
    if (!baud)
        stop("no baud rate: %s", arguments[5]);
    make_board(arguments[2], (uint32_t)strtoul(arguments[3], NULL, 10), arguments[4]);
    if (!strcmp(arguments[1], "pty"))
        real_time();
    else
        lockstep();
    return 0;
}
