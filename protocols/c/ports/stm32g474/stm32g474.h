/* The parts of the board with an STM32G474RE, which bsp.c puts together. */
#ifndef STM32G474_H
#define STM32G474_H

#include <stdbool.h>
#include <stdint.h>

enum { CPU_HZ = 150000000, CONVERTER_HZ = 8192000, PRESCALER = 8 };
enum { DMA_CONVERTER_IN = 1, DMA_CONVERTER_OUT = 2, DMA_LINK_IN = 3, DMA_LINK_OUT = 4 };
enum { IRQ_DMA_CONVERTER = 11, IRQ_DMA_LINK_IN = 13, IRQ_DMA_LINK_OUT = 14, IRQ_TIM2 = 28 };
enum { PIN_INPUT = 0, PIN_OUTPUT = 1, PIN_FUNCTION = 2, PIN_ANALOG = 3 };

/* clock.c */
void clock_begin(void);
void wait_us(uint32_t us);
/* Whether the masked bits of a register came to be `value` within so many microseconds. */
bool wait_for(uint32_t address, uint32_t mask, uint32_t value, uint32_t most_us);
void pin(uint32_t port, uint32_t number, uint32_t mode, uint32_t function);

/* ticks.c */
void ticks_begin(void);
bool ticks_are_the_converters(void);

/* converter.c */
void converter_begin(void);

/* link.c */
void link_begin(void);

/* sensors.c: data sheets first, with the supplies off; then the supplies. */
void sensors_begin(void);

/* Interrupts, named by startup.c */
void on_tim2(void);
void on_dma_converter(void);
void on_dma_link_in(void);
void on_dma_link_out(void);

#endif
