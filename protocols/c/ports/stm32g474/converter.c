/*
 * The converter ADS131M04 on SPI1: PA5 clock, PA6 in, PA7 out, PB6 chip select. Data-ready latches
 * TIM2 and starts two channels of DMA, which put a frame into the ring of ads131m04.c and send
 * nothing; when it is whole the next may follow. No byte passes through the processor.
 */
#include "../ads131m04.h"
#include "bsp.h"
#include "registers.h"
#include "stm32g474.h"

enum {
    SELECT = 6,
    MODE_1_MASTER = 0x0005, /* CPHA, MSTR */
    CLOCK_BY_8 = 2 << 3,    /* 18.75 MHz; the chip takes 25 */
    SOFT_SELECT = 3 << 8,   /* SSM, SSI */
    ENABLED = 1 << 6,
    BYTES = 0x1700, /* words of 8 bits, RXNE at each */
    BY_DMA = 3,
    REQUEST_IN = 10, /* DMAMUX: SPI1_RX, SPI1_TX */
    REQUEST_OUT = 11,
    RECEIVE = 0x2083, /* high priority, memory counts up, interrupt when done, on */
    SEND = 0x2091,
    FLAGS = 15,
    BASE_HZ = CONVERTER_HZ / 2 / 128,
    RATES = 4, /* oversampling 128 to 1024: all of one kind of filter, sinc3 */
    BYTE_US = 100
};

static ads_ring ring;
static const uint8_t nothing[ADS_FRAME_BYTES];
static ads_result found = ADS_SILENT;
static bool running;
static volatile bool busy, due;
static uint64_t ready_ticks, frame_ticks;

static void transfer(void *context, const uint8_t *out, uint8_t *in, size_t n)
{
    size_t i;
    (void)context;
    reg_write(GPIO_BSRR(GPIOB), BIT(SELECT + 16));
    for (i = 0; i < n; i++) {
        reg_write8(SPI_DR, out[i]);
        in[i] = wait_for(SPI_SR, BIT(0), BIT(0), BYTE_US) ? reg_read8(SPI_DR) : 0u;
    }
    reg_write(GPIO_BSRR(GPIOB), BIT(SELECT));
    wait_us(10); /* a reset takes 5 us: SBAS890, section 6.6, t_REGACQ */
}

static const ads_port port = {.context = NULL, .transfer = transfer};
static const uint8_t gains[ADS_CHANNELS];

/* By how many halvings of 32000 Hz a rate comes; RATES where by none. */
static uint32_t halvings(uint32_t numerator, uint32_t denominator)
{
    uint32_t i = 0;
    while (i < RATES && numerator != (uint64_t)(BASE_HZ >> i) * denominator) {
        i++;
    }
    return i;
}

void converter_begin(void)
{
    pin(GPIOB, SELECT, PIN_OUTPUT, 0);
    reg_write(GPIO_BSRR(GPIOB), BIT(SELECT));
    pin(GPIOA, 5, PIN_FUNCTION, 5);
    pin(GPIOA, 6, PIN_FUNCTION, 5);
    pin(GPIOA, 7, PIN_FUNCTION, 5);
    reg_write(SPI_CR2, BYTES);
    reg_write(SPI_CR1, MODE_1_MASTER | CLOCK_BY_8 | SOFT_SELECT | ENABLED);
    reg_write(DMAMUX_CCR(DMA_CONVERTER_IN), REQUEST_IN);
    reg_write(DMAMUX_CCR(DMA_CONVERTER_OUT), REQUEST_OUT);
    reg_write(DMA_CPAR(DMA_CONVERTER_IN), SPI_DR);
    reg_write(DMA_CPAR(DMA_CONVERTER_OUT), SPI_DR);
    found = ads_begin(&port, ADS_OSR_1024, gains);
}

const char *bsp_adc_refusal(uint32_t numerator, uint32_t denominator)
{
    if (!ticks_are_the_converters()) {
        return "no clock of 8.192 MHz at PA15: check the converter's supply and wiring";
    }
    if (found != ADS_OK) {
        return "the converter does not answer on SPI1: check its supply and wiring";
    }
    return halvings(numerator, denominator) == RATES
               ? "the converter makes 32000, 16000, 8000 and 4000 Hz"
               : NULL;
}

void bsp_adc_start(uint32_t numerator, uint32_t denominator)
{
    const uint32_t half = halvings(numerator, denominator);

    bsp_adc_stop();
    found = ads_begin(&port, (ads_osr)half, gains);
    ads_ring_begin(&ring, (256u * (CONVERTER_HZ / PRESCALER / BASE_HZ)) << half);
    running = found == ADS_OK;
    if (running) {
        ready_ticks = bsp_ticks64();
        reg_write(SPI_CR2, BYTES | BY_DMA);
        (void)reg_read(TIM_CCR2); /* takes an older capture's flag away */
        reg_write(TIM_DIER, BIT(2));
    }
}

void bsp_adc_stop(void)
{
    reg_write(TIM_DIER, 0);
    running = false;
    wait_us(20); /* a frame takes 8 us */
    reg_write(DMA_CCR(DMA_CONVERTER_OUT), 0);
    reg_write(DMA_CCR(DMA_CONVERTER_IN), 0);
    reg_write(SPI_CR2, BYTES);
    reg_write(GPIO_BSRR(GPIOB), BIT(SELECT));
    busy = false;
    due = false;
}

uint32_t bsp_adc_read(int32_t *counts, uint32_t most, uint64_t *ticks, uint32_t *lost)
{
    *ticks = 0;
    *lost = 0;
    return running ? ads_ring_read(&ring, counts, most, ticks, lost) : 0u;
}

static void fetch(uint64_t ticks)
{
    busy = true;
    frame_ticks = ticks;
    reg_write(GPIO_BSRR(GPIOB), BIT(SELECT + 16));
    reg_write(DMA_CMAR(DMA_CONVERTER_IN), dma_address(ads_ring_next(&ring)));
    reg_write(DMA_CNDTR(DMA_CONVERTER_IN), ADS_FRAME_BYTES);
    reg_write(DMA_CCR(DMA_CONVERTER_IN), RECEIVE);
    reg_write(DMA_CMAR(DMA_CONVERTER_OUT), dma_address(nothing));
    reg_write(DMA_CNDTR(DMA_CONVERTER_OUT), ADS_FRAME_BYTES);
    reg_write(DMA_CCR(DMA_CONVERTER_OUT), SEND);
}

void on_tim2(void)
{
    /* Reading the capture takes its flag away. Data-readies in between show in the ticks. */
    ready_ticks += (uint32_t)(reg_read(TIM_CCR2) - (uint32_t)ready_ticks);
    if (busy) {
        due = true;
    } else {
        fetch(ready_ticks);
    }
}

void on_dma_converter(void)
{
    reg_write(DMA_IFCR, (uint32_t)FLAGS << (4 * (DMA_CONVERTER_IN - 1)));
    reg_write(DMA_CCR(DMA_CONVERTER_OUT), 0);
    reg_write(DMA_CCR(DMA_CONVERTER_IN), 0);
    reg_write(GPIO_BSRR(GPIOB), BIT(SELECT));
    busy = false;
    if (ads_ring_done(&ring, frame_ticks) != 0) {
        fetch(frame_ticks);
    } else if (due) {
        due = false;
        fetch(ready_ticks);
    }
}
