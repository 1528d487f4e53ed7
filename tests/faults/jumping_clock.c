/* A wall clock that jumps, for a process that loads this library first: hours back and ahead, over the ends of years and
   of leap years, to 1970 and to 2100. The clock that only runs ahead is left alone, as it is when somebody sets a clock. */

#define _GNU_SOURCE
#include <stdatomic.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

enum { CALLS_BETWEEN_JUMPS = 7 };

static const time_t JUMPS[] = {
    0, -5 * 3600, 5 * 3600, -400 * 86400, 400 * 86400,
};

/* Of time since 1970: 2026-12-31 23:59:59, 2028-02-29 23:59:59, 2027-01-01, the start of all, 1979, 2038-01-19, 2100. */
static const time_t INSTANTS[] = {
    1798761599, 1835481599, 1798761600, 0, 283996800, 2147483647, 4102444800,
};

static atomic_uint calls;

static void jump(struct timespec *now) {
    const unsigned jumps = sizeof JUMPS / sizeof *JUMPS, instants = sizeof INSTANTS / sizeof *INSTANTS;
    unsigned turn = atomic_fetch_add(&calls, 1) / CALLS_BETWEEN_JUMPS % (jumps + instants);
    if (turn < jumps)
        now->tv_sec += JUMPS[turn];
    else
        now->tv_sec = INSTANTS[turn - jumps];
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    int failed = syscall(SYS_clock_gettime, clock, now);
    if (!failed && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
        jump(now);
    return failed;
}

int gettimeofday(struct timeval *restrict now, void *restrict zone) {
    struct timespec wall;
    (void)zone;
    clock_gettime(CLOCK_REALTIME, &wall);
    now->tv_sec = wall.tv_sec;
    now->tv_usec = wall.tv_nsec / 1000;
    return 0;
}

time_t time(time_t *now) {
    struct timespec wall;
    clock_gettime(CLOCK_REALTIME, &wall);
    if (now)
        *now = wall.tv_sec;
    return wall.tv_sec;
}
