/* Vector table (RM0440, table 97) and start of an STM32G474RE whose image lies in its flash. */
#include <stdint.h>

#include "bsp.h"
#include "stm32g474.h"

extern uint32_t data_start, data_end, data_image, bss_start, bss_end;

int main(void);
void stack_top(void); /* an address of the linker's, no function: the table's first word */
void reset(void);

void reset(void)
{
    uint32_t *word;
    const uint32_t *image = &data_image;
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: the floating point unit */
    for (word = &data_start; word < &data_end; word++) {
        *word = *image++;
    }
    for (word = &bss_start; word < &bss_end; word++) {
        *word = 0u;
    }
    (void)main();
    bsp_halt();
}

void bsp_halt(void)
{
    for (;;) {
    }
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16 + 102])(void) = {
    stack_top, reset, bsp_halt, bsp_halt, bsp_halt, bsp_halt, bsp_halt, bsp_halt,
    bsp_halt, bsp_halt, bsp_halt, bsp_halt, bsp_halt, bsp_halt, bsp_halt, bsp_halt,
    [16 + IRQ_DMA_CONVERTER] = on_dma_converter,
    [16 + IRQ_DMA_LINK_IN] = on_dma_link_in,
    [16 + IRQ_DMA_LINK_OUT] = on_dma_link_out,
    [16 + IRQ_TIM2] = on_tim2};
