/*
 * A half-sine push of 250 N every two seconds, the first a second after the start, and what a
 * structure of two modes answers, each channel with noise. Amplitudes belong to the scales of
 * board.c. Samples are computed when read: what has come due in the meantime is a DMA's buffer of
 * RING_SAMPLES, and what is older is lost and told.
 */
#include "bsp.h"
#include "table_adc.h"

enum {
    CHANNELS = 4,
    BASE_HZ = 51200,
    PERIOD = 2 * BASE_HZ,  /* from push to push */
    FIRST = BASE_HZ,       /* into the period, at the start */
    PUSH = 154,            /* 3 ms */
    ANSWER = 3 * BASE_HZ / 2,  /* then it has decayed */
    RING_SAMPLES = 65536,
    PUSH_COUNTS = 105042,  /* 250 N at 0.00238 N a count */
    NOISE_MASK = 511,      /* uniform noise, 256 counts both ways */
    AT_ONCE = 64
};

static int32_t push[PUSH];
static int32_t answer[ANSWER];
static uint64_t started;
static uint64_t taken;
static uint32_t divisor;
static uint32_t noise = 0x9E3779B9u;

/* Recursions that need no library of functions. The push: rotation by pi / 154 a sample, with
   2 sin(pi / 154 / 2). Modes of 20 Hz with 5 % and 47 Hz with 4 % damping: impulse responses of
   x[n] = a x[n-1] + b x[n-2], a = 2 r cos(w), b = -r^2, r = exp(-zeta w0 / 51200),
   w = w0 sqrt(1 - zeta^2) / 51200. */
static void fill(void)
{
    static const float turn = 0.0203995986f;
    static const double a1 = 1.9997485700048594, b1 = -0.9997545931911166;
    static const double a2 = 1.9995054256386446, b2 = -0.9995386850174962;
    float s = 0.0f, c = 1.0f;
    double x1 = 0.0, y1 = 1.0, x2 = 0.0, y2 = 1.0;
    uint32_t i;

    for (i = 0; i < PUSH; i++) {
        push[i] = (int32_t)((float)PUSH_COUNTS * s);
        s += turn * c;
        c -= turn * s;
    }
    for (i = 0; i < ANSWER; i++) {
        double z1 = a1 * y1 + b1 * x1, z2 = a2 * y2 + b2 * x2;
        answer[i] = (int32_t)(700.0 * x1 + 900.0 * x2);
        x1 = y1;
        y1 = z1;
        x2 = y2;
        y2 = z2;
    }
}

static int32_t noisy(int32_t counts)
{
    noise ^= noise << 13;
    noise ^= noise >> 17;
    noise ^= noise << 5;
    return counts + (int32_t)(noise & NOISE_MASK) - NOISE_MASK / 2;
}

static uint64_t due_at(uint64_t sample)
{
    uint64_t at = sample * divisor * table_clock_hz();
    return started + at / BASE_HZ + (at % BASE_HZ != 0u);
}

static uint64_t ready_samples(void)
{
    return (table_clock() - started) * BASE_HZ / ((uint64_t)table_clock_hz() * divisor) + 1u;
}

bool table_adc_behind(void)
{
    return divisor != 0u && ready_samples() - taken > AT_ONCE;
}

/* By what 51200 Hz is divided, 1 to 512; 0 where no such number makes the rate. */
static uint32_t divisor_of(uint32_t numerator, uint32_t denominator)
{
    uint32_t wanted = 512;
    while (wanted != 0u && (uint64_t)numerator * wanted != (uint64_t)BASE_HZ * denominator) {
        wanted--;
    }
    return wanted;
}

const char *bsp_adc_refusal(uint32_t numerator, uint32_t denominator)
{
    return divisor_of(numerator, denominator) == 0u ? "the converter makes 51200 Hz over 1 to 512"
                                                    : NULL;
}

void bsp_adc_start(uint32_t numerator, uint32_t denominator)
{
    if (push[1] == 0) {
        fill();
    }
    divisor = divisor_of(numerator, denominator);
    started = table_clock();
    taken = 0;
}

void bsp_adc_stop(void)
{
    divisor = 0;
}

uint32_t bsp_adc_read(int32_t *counts, uint32_t most, uint64_t *ticks, uint32_t *lost)
{
    uint64_t ready, at;
    uint32_t n, i;

    *lost = 0;
    *ticks = 0;
    if (divisor == 0u) {
        return 0;
    }
    ready = ready_samples();
    if (ready - taken > RING_SAMPLES) {
        *lost = (uint32_t)(ready - taken) - RING_SAMPLES;
        taken += *lost;
    }
    n = ready - taken < most ? (uint32_t)(ready - taken) : most;
    *ticks = due_at(taken) / (table_clock_hz() / 1000000u);
    at = (taken * divisor + FIRST) % PERIOD;
    for (i = 0; i < n; i++) {
        uint32_t now = (uint32_t)at;
        int32_t x = now < ANSWER ? answer[now] : 0;
        *counts++ = noisy(now < PUSH ? push[now] : 0);
        *counts++ = noisy(x);
        *counts++ = noisy(x / 3);
        *counts++ = noisy(-x / 2);
        at = (at + divisor) % PERIOD;
    }
    taken += n;
    return n;
}

/* Its sensors have supplies that work, and no data sheets. */
const uint8_t *bsp_teds(uint32_t channel, uint16_t *size)
{
    (void)channel;
    *size = 0;
    return NULL;
}

uint8_t bsp_iepe(uint32_t channel)
{
    (void)channel;
    return 1;
}
