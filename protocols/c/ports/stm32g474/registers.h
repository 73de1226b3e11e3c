/*
 * Registers of an STM32G474RE that the board uses, by ST's reference manual RM0440 and data sheet
 * DS12288 (pins). With BSP_ON_HOST they are functions that a test gives: a model of the chip.
 */
#ifndef STM32G474_REGISTERS_H
#define STM32G474_REGISTERS_H

#include <stdint.h>

#ifdef BSP_ON_HOST
uint32_t reg_read(uint32_t address);
void reg_write(uint32_t address, uint32_t value);
void reg_write8(uint32_t address, uint8_t value);
uint8_t reg_read8(uint32_t address);
/* The address by which DMA knows a place in memory. */
uint32_t dma_address(const void *memory);
#else
static inline uint32_t reg_read(uint32_t address)
{
    return *(volatile uint32_t *)address;
}

static inline void reg_write(uint32_t address, uint32_t value)
{
    *(volatile uint32_t *)address = value;
}

static inline uint8_t reg_read8(uint32_t address)
{
    return *(volatile uint8_t *)address;
}

static inline void reg_write8(uint32_t address, uint8_t value)
{
    *(volatile uint8_t *)address = value;
}

static inline uint32_t dma_address(const void *memory)
{
    return (uint32_t)memory;
}
#endif

static inline void reg_change(uint32_t address, uint32_t clear, uint32_t set)
{
    reg_write(address, (reg_read(address) & ~clear) | set);
}

#define BIT(n) (1u << (n))

/* Chapter 7, RCC */
#define RCC 0x40021000u
#define RCC_CR (RCC + 0x00u)
#define RCC_CFGR (RCC + 0x08u)
#define RCC_PLLCFGR (RCC + 0x0Cu)
#define RCC_AHB1ENR (RCC + 0x48u)
#define RCC_AHB2ENR (RCC + 0x4Cu)
#define RCC_APB1ENR1 (RCC + 0x58u)
#define RCC_APB1ENR2 (RCC + 0x5Cu)
#define RCC_APB2ENR (RCC + 0x60u)
#define RCC_CRRCR (RCC + 0x98u)

/* Chapter 3, flash */
#define FLASH_ACR 0x40022000u

/* Chapter 9, GPIO: MODER, OTYPER, OSPEEDR, PUPDR, IDR, ODR, BSRR, AFRL, AFRH */
#define GPIOA 0x48000000u
#define GPIOB 0x48000400u
#define GPIOC 0x48000800u
#define GPIO_MODER(port) ((port) + 0x00u)
#define GPIO_OTYPER(port) ((port) + 0x04u)
#define GPIO_OSPEEDR(port) ((port) + 0x08u)
#define GPIO_PUPDR(port) ((port) + 0x0Cu)
#define GPIO_IDR(port) ((port) + 0x10u)
#define GPIO_BSRR(port) ((port) + 0x18u)
#define GPIO_AFR(port, pin) ((port) + 0x20u + 4u * ((pin) / 8u))

/* Chapters 12 and 13, DMA and its multiplexer; channels from 1 on */
#define DMA1 0x40020000u
#define DMA_IFCR (DMA1 + 0x04u)
#define DMA_CCR(channel) (DMA1 + 0x08u + 20u * ((channel) - 1u))
#define DMA_CNDTR(channel) (DMA1 + 0x0Cu + 20u * ((channel) - 1u))
#define DMA_CPAR(channel) (DMA1 + 0x10u + 20u * ((channel) - 1u))
#define DMA_CMAR(channel) (DMA1 + 0x14u + 20u * ((channel) - 1u))
#define DMAMUX_CCR(channel) (0x40020800u + 4u * ((channel) - 1u))

/* Chapter 21, ADC */
#define ADC1 0x50000000u
#define ADC_ISR (ADC1 + 0x00u)
#define ADC_CR (ADC1 + 0x08u)
#define ADC_SMPR1 (ADC1 + 0x14u)
#define ADC_SQR1 (ADC1 + 0x30u)
#define ADC_DR (ADC1 + 0x40u)
#define ADC12_CCR 0x50000308u

/* Chapter 26, RNG */
#define RNG_CR 0x50060800u
#define RNG_SR 0x50060804u
#define RNG_DR 0x50060808u

/* Chapter 30, TIM2 */
#define TIM2 0x40000000u
#define TIM_CR1 (TIM2 + 0x00u)
#define TIM_SMCR (TIM2 + 0x08u)
#define TIM_DIER (TIM2 + 0x0Cu)
#define TIM_SR (TIM2 + 0x10u)
#define TIM_EGR (TIM2 + 0x14u)
#define TIM_CCMR1 (TIM2 + 0x18u)
#define TIM_CCER (TIM2 + 0x20u)
#define TIM_CNT (TIM2 + 0x24u)
#define TIM_PSC (TIM2 + 0x28u)
#define TIM_ARR (TIM2 + 0x2Cu)
#define TIM_CCR2 (TIM2 + 0x38u)

/* Chapter 38, LPUART1 */
#define LPUART1 0x40008000u
#define UART_CR1 (LPUART1 + 0x00u)
#define UART_CR3 (LPUART1 + 0x08u)
#define UART_BRR (LPUART1 + 0x0Cu)
#define UART_RDR (LPUART1 + 0x24u)
#define UART_TDR (LPUART1 + 0x28u)

/* Chapter 39, SPI1 */
#define SPI1 0x40013000u
#define SPI_CR1 (SPI1 + 0x00u)
#define SPI_CR2 (SPI1 + 0x04u)
#define SPI_SR (SPI1 + 0x08u)
#define SPI_DR (SPI1 + 0x0Cu)

/* Cortex-M4 (ARMv7-M Architecture Reference Manual): NVIC, cycle counter */
#define NVIC_ISER0 0xE000E100u
#define NVIC_IPR(line) (0xE000E400u + (line))
#define DEMCR 0xE000EDFCu
#define DWT_CTRL 0xE0001000u
#define DWT_CYCCNT 0xE0001004u

#endif
