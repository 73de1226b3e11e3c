/* board.c on an STM32G474RE: a NUCLEO-G474RE with a front end for four IEPE sensors beside it. */
#include "bsp.h"
#include "registers.h"
#include "stm32g474.h"

void bsp_begin(void)
{
    clock_begin();
    link_begin();
    ticks_begin();
    sensors_begin();
    converter_begin();
    /* The converter's two interrupts do not interrupt one another, and go before the link's. */
    reg_write8(NVIC_IPR(IRQ_DMA_LINK_IN), 0x40);
    reg_write8(NVIC_IPR(IRQ_DMA_LINK_OUT), 0x40);
    reg_write(NVIC_ISER0, BIT(IRQ_DMA_CONVERTER) | BIT(IRQ_DMA_LINK_IN) | BIT(IRQ_DMA_LINK_OUT) |
                              BIT(IRQ_TIM2));
}

uint32_t bsp_random(void)
{
    uint32_t drawn = 0;

    reg_write(RNG_CR, BIT(2));
    while (drawn == 0u) {
        if (wait_for(RNG_SR, BIT(0), BIT(0), 1000)) {
            drawn = reg_read(RNG_DR);
        }
    }
    return drawn;
}
