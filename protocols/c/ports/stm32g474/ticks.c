/*
 * Ticks are the converter's own: its oscillator of 8.192 MHz is led to PA15 too, where TIM2 counts
 * every eighth period. Samples and ticks so cannot drift apart. PA1 is data-ready; its falling edge
 * latches the counter.
 */
#include "bsp.h"
#include "registers.h"
#include "stm32g474.h"

enum {
    EXTERNAL_CLOCK = 1 << 14, /* ECE: mode 2, by ETR */
    BY_EIGHT = 3 << 12,       /* ETPS; ETR then counts with at most a quarter of the timer's clock */
    INPUT_2 = 1 << 8,         /* CC2S: TI2 */
    CAPTURE_FALLING = 3 << 4, /* CC2E, CC2P */
    TICK_HZ = CONVERTER_HZ / PRESCALER
};

static bool external;
static uint32_t high, last;

void ticks_begin(void)
{
    uint32_t before;

    pin(GPIOA, 15, PIN_FUNCTION, 14); /* TIM2_ETR */
    pin(GPIOA, 1, PIN_FUNCTION, 1);   /* TIM2_CH2 */
    reg_write(TIM_ARR, 0xFFFFFFFFu);
    reg_write(TIM_CCMR1, INPUT_2);
    reg_write(TIM_CCER, CAPTURE_FALLING);
    reg_write(TIM_SMCR, EXTERNAL_CLOCK | BY_EIGHT);
    reg_write(TIM_CR1, BIT(0));
    before = reg_read(TIM_CNT);
    wait_us(1000);
    external = reg_read(TIM_CNT) - before > TICK_HZ / 2000u;
    if (!external) {
        /* The board answers all the same; no rate is accepted (converter.c). */
        reg_write(TIM_SMCR, 0);
        reg_write(TIM_PSC, CPU_HZ / TICK_HZ - 1u);
        reg_write(TIM_EGR, BIT(0));
    }
}

bool ticks_are_the_converters(void)
{
    return external;
}

/* Called far more often than the counter wraps, every 70 minutes. */
uint64_t bsp_ticks64(void)
{
    const uint32_t now = reg_read(TIM_CNT);
    if (now < last) {
        high++;
    }
    last = now;
    return (uint64_t)high << 32 | now;
}
