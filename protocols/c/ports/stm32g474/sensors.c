/*
 * Supplies and data sheets of the sensors, channel by channel: PC6 to PC9 switch a supply of 4 mA
 * and 24 V on, PC0 to PC3 see the sensor's bias voltage by a divider of 11, PB10 to PB13 are the
 * lines of the sensors' memories, whose polarity the front end reverses while a supply is off.
 */
#include "../teds_wire.h"
#include "bsp.h"
#include "registers.h"
#include "stm32g474.h"

enum {
    CHANNELS = 4,
    SWITCH = 6,
    MEMORY = 10,
    INPUT = 6, /* ADC1_IN6 to IN9 are PC0 to PC3 */
    SUPPLY_MV = 24000,
    FULL_MV = 3300 * 11, /* of 4096 counts */
    SHORT_MV = 2000,
    OPEN_MV = SUPPLY_MV - 2000,
    SETTLE_US = 3000000, /* coupling capacitors charge slowly */
    MEAN_OF = 256, /* readings: a hit that drives a sensor to its rail is no broken cable */
    CONVERT_US = 1000,
    TEDS_BYTES = 128
};

static uint8_t sheets[CHANNELS][TEDS_BYTES];
static uint16_t sheet_bytes[CHANNELS];
static uint32_t level[CHANNELS]; /* counts times MEAN_OF */
static uint32_t looked_at;

static void pull(void *context, bool down)
{
    const uint32_t bit = MEMORY + *(const uint32_t *)context;
    reg_write(GPIO_BSRR(GPIOB), down ? BIT(bit + 16u) : BIT(bit));
}

static bool is_up(void *context)
{
    return (reg_read(GPIO_IDR(GPIOB)) >> (MEMORY + *(const uint32_t *)context) & 1u) != 0u;
}

static void wait(void *context, uint32_t us)
{
    (void)context;
    wait_us(us);
}

static void converter_on(void)
{
    reg_write(ADC12_CCR, 3u << 16); /* the bus clock over 4: 37.5 MHz of at most 60 */
    reg_write(ADC_CR, 0);           /* out of deep sleep first */
    reg_write(ADC_CR, BIT(28));     /* then its regulator on: RM0440, section 21.4.6 */
    wait_us(20);
    reg_write(ADC_CR, BIT(28) | BIT(31)); /* calibrate */
    (void)wait_for(ADC_CR, BIT(31), 0, CONVERT_US);
    wait_us(1); /* four of its clocks: RM0440, section 21.4.8 */
    reg_write(ADC_ISR, BIT(0));
    reg_write(ADC_CR, BIT(28) | BIT(0));
    (void)wait_for(ADC_ISR, BIT(0), BIT(0), CONVERT_US);
    reg_write(ADC_SMPR1, 0xFFFu << 18); /* inputs 6 to 9: 640.5 clocks */
}

static void look_at(uint32_t channel)
{
    looked_at = channel;
    reg_write(ADC_SQR1, (INPUT + channel) << 6);
    reg_change(ADC_CR, 0, BIT(2));
}

void sensors_begin(void)
{
    uint32_t i;

    for (i = 0; i < CHANNELS; i++) {
        pin(GPIOC, i, PIN_ANALOG, 0);
        reg_write(GPIO_BSRR(GPIOC), BIT(SWITCH + i + 16u));
        pin(GPIOC, SWITCH + i, PIN_OUTPUT, 0);
        reg_write(GPIO_BSRR(GPIOB), BIT(MEMORY + i));
        reg_change(GPIO_OTYPER(GPIOB), 0, BIT(MEMORY + i)); /* open drain */
        pin(GPIOB, MEMORY + i, PIN_OUTPUT, 0);
    }
    for (i = 0; i < CHANNELS; i++) {
        const teds_wire memory = {.context = &i, .pull = pull, .is_up = is_up, .wait_us = wait};
        sheet_bytes[i] = (uint16_t)teds_wire_read(&memory, sheets[i], TEDS_BYTES);
    }
    for (i = 0; i < CHANNELS; i++) {
        reg_write(GPIO_BSRR(GPIOC), BIT(SWITCH + i));
    }
    wait_us(SETTLE_US);
    converter_on();
    for (i = 0; i < CHANNELS; i++) {
        look_at(i);
        (void)wait_for(ADC_ISR, BIT(2), BIT(2), CONVERT_US);
        level[i] = reg_read(ADC_DR) * MEAN_OF;
    }
    look_at(0);
}

const uint8_t *bsp_teds(uint32_t channel, uint16_t *size)
{
    *size = sheet_bytes[channel];
    return sheets[channel];
}

uint8_t bsp_iepe(uint32_t channel)
{
    uint32_t mv;

    if ((reg_read(ADC_ISR) & BIT(2)) != 0u) { /* done; reading takes the flag away */
        level[looked_at] += reg_read(ADC_DR) - level[looked_at] / MEAN_OF;
        look_at((looked_at + 1u) % CHANNELS);
    }
    mv = level[channel] / MEAN_OF * FULL_MV / 4096u;
    return mv < SHORT_MV ? 3 : mv > OPEN_MV ? 2 : 1;
}
