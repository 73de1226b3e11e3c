/* 150 MHz from the board's crystal of 24 MHz, or from the chip's own oscillator without one. */
#include "registers.h"
#include "stm32g474.h"

enum {
    WAIT_STATES = 4,      /* 120 to 150 MHz in range 1: RM0440, table 29 */
    FLASH_CACHES = 0x700, /* prefetch, instructions, data */
    PLL_HSE = 3,
    PLL_HSI16 = 2,
    PLL_IN_HZ = 4000000, /* 2.66 to 16 MHz; 4 MHz * 75 / 2 */
    PLL_N = 75,
    SYSTEM_PLL = 3,
    HALF = 8, /* AHB prescaler 2 */
    CRYSTAL_US = 10000, /* the crystal starts in 2 ms: DS12288, table 41 */
    READY_US = 1000
};

void wait_us(uint32_t us)
{
    const uint32_t begun = reg_read(DWT_CYCCNT);
    while (reg_read(DWT_CYCCNT) - begun < us * (CPU_HZ / 1000000u)) {
    }
}

bool wait_for(uint32_t address, uint32_t mask, uint32_t value, uint32_t most_us)
{
    const uint32_t begun = reg_read(DWT_CYCCNT);
    while ((reg_read(address) & mask) != value) {
        if (reg_read(DWT_CYCCNT) - begun > most_us * (CPU_HZ / 1000000u)) {
            return false;
        }
    }
    return true;
}

void pin(uint32_t port, uint32_t number, uint32_t mode, uint32_t function)
{
    const uint32_t at = 4u * (number % 8u);
    reg_change(GPIO_AFR(port, number), 15u << at, function << at);
    reg_change(GPIO_OSPEEDR(port), 3u << (2u * number), 2u << (2u * number));
    reg_change(GPIO_MODER(port), 3u << (2u * number), mode << (2u * number));
}

void clock_begin(void)
{
    uint32_t source = PLL_HSE, source_hz = 24000000u;

    reg_change(DEMCR, 0, BIT(24)); /* the cycle counter runs */
    reg_change(DWT_CTRL, 0, BIT(0));
    reg_change(FLASH_ACR, 15u, WAIT_STATES | FLASH_CACHES);
    (void)wait_for(FLASH_ACR, 15u, WAIT_STATES, READY_US);
    reg_change(RCC_CR, 0, BIT(16)); /* HSEON */
    if (!wait_for(RCC_CR, BIT(17), BIT(17), CRYSTAL_US)) {
        source = PLL_HSI16; /* within 1 %: close enough for the UART */
        source_hz = 16000000u;
    }
    reg_write(RCC_PLLCFGR, source | (source_hz / PLL_IN_HZ - 1u) << 4 | PLL_N << 8 | BIT(24));
    reg_change(RCC_CR, 0, BIT(24)); /* PLLON */
    (void)wait_for(RCC_CR, BIT(25), BIT(25), READY_US);
    /* Above 80 MHz by way of half the speed for a microsecond: RM0440, section 7.2.7. */
    reg_change(RCC_CFGR, 15u << 4, HALF << 4);
    reg_change(RCC_CFGR, 3u, SYSTEM_PLL);
    (void)wait_for(RCC_CFGR, 3u << 2, SYSTEM_PLL << 2, READY_US);
    wait_us(2);
    reg_change(RCC_CFGR, 15u << 4, 0);

    reg_change(RCC_AHB1ENR, 0, BIT(0) | BIT(2));                        /* DMA1, its multiplexer */
    reg_change(RCC_AHB2ENR, 0, BIT(0) | BIT(1) | BIT(2) | BIT(13) | BIT(26)); /* GPIOA-C, ADC, RNG */
    reg_change(RCC_APB1ENR1, 0, BIT(0));                                /* TIM2 */
    reg_change(RCC_APB1ENR2, 0, BIT(0));                                /* LPUART1 */
    reg_change(RCC_APB2ENR, 0, BIT(12));                                /* SPI1 */
    reg_change(RCC_CRRCR, 0, BIT(0)); /* HSI48, by which the RNG runs */
    (void)wait_for(RCC_CRRCR, BIT(1), BIT(1), READY_US);
}
