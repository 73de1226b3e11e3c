/* board.c as a program of Linux: its link is a pseudo-terminal, whose name it prints. */
#define _XOPEN_SOURCE 700
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "bsp.h"
#include "table_adc.h"

static int line = -1;

/* The side of the program that talks to us is kept open too: it may come and go. */
void bsp_begin(void)
{
    struct termios raw;
    int other;

    line = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (line < 0 || grantpt(line) != 0 || unlockpt(line) != 0) {
        bsp_halt();
    }
    other = open(ptsname(line), O_RDWR | O_NOCTTY);
    if (other < 0 || tcgetattr(other, &raw) != 0) {
        bsp_halt();
    }
    raw.c_iflag = 0;
    raw.c_oflag = 0;
    raw.c_lflag = 0;
    raw.c_cflag = CS8 | CREAD | CLOCAL;
    tcsetattr(other, TCSANOW, &raw);
    printf("%s\n", ptsname(line));
    fflush(stdout);
}

size_t bsp_link_write(const uint8_t *bytes, size_t n)
{
    ssize_t taken = write(line, bytes, n);
    return taken < 0 ? 0u : (size_t)taken;
}

size_t bsp_link_read(uint8_t *bytes, size_t n)
{
    struct pollfd wait = {.events = POLLIN};
    const int rest_ms = table_adc_behind() ? 0 : 1;
    ssize_t came;

    wait.fd = line;
    (void)poll(&wait, 1, rest_ms); /* the only place where the program rests */
    came = read(line, bytes, n);
    return came < 0 ? 0u : (size_t)came;
}

uint64_t table_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

uint32_t table_clock_hz(void)
{
    return 1000000000u;
}

uint64_t bsp_ticks64(void)
{
    return table_clock() / 1000u;
}

uint32_t bsp_random(void)
{
    uint32_t drawn = 0;
    FILE *source = fopen("/dev/urandom", "rb");
    while (source != NULL && drawn == 0u && fread(&drawn, sizeof drawn, 1, source) == 1u) {
    }
    if (drawn == 0u) {
        bsp_halt();
    }
    return drawn;
}

void bsp_halt(void)
{
    fprintf(stderr, "the board halts: %s\n", strerror(errno));
    exit(2);
}
