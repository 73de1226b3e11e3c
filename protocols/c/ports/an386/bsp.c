/*
 * board.c on an ARM Cortex-M4 of the MPS2 board with image AN386, which QEMU has as mps2-an386.
 * Its UART and counter are those of Arm's application note DAI 0386 and of the Cortex-M System
 * Design Kit (DDI 0479), chapter 4: UART, chapter 3 of the note: FPGA system registers.
 */
#include "bsp.h"
#include "table_adc.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define UART_DATA REGISTER(0x40004000u)
#define UART_STATE REGISTER(0x40004004u)
#define UART_CTRL REGISTER(0x40004008u)
#define UART_BAUDDIV REGISTER(0x40004010u)
#define FPGA_COUNTER REGISTER(0x40028018u) /* up, at the system clock of 25 MHz */

#define SYSTICK_CTRL REGISTER(0xE000E010u)
#define SYSTICK_RELOAD REGISTER(0xE000E014u)

enum { TX_FULL = 1, RX_FULL = 2, TX_ENABLE = 1, RX_ENABLE = 2, CLOCK_HZ = 25000000, TICK_ON = 7 };

static uint32_t counter_high;
static uint32_t counter_last;

/* The main loop calls far more often than the counter wraps, every 172 s. */
uint64_t table_clock(void)
{
    uint32_t now = FPGA_COUNTER;
    if (now < counter_last) {
        counter_high++;
    }
    counter_last = now;
    return (uint64_t)counter_high << 32 | now;
}

uint32_t table_clock_hz(void)
{
    return CLOCK_HZ;
}

uint64_t bsp_ticks64(void)
{
    return table_clock() / (CLOCK_HZ / 1000000);
}

void bsp_begin(void)
{
    UART_BAUDDIV = 16u; /* the smallest; in QEMU no bit takes time */
    UART_CTRL = TX_ENABLE | RX_ENABLE;
    SYSTICK_RELOAD = CLOCK_HZ / 2000 - 1; /* wakes what rests, every 0.5 ms */
    SYSTICK_CTRL = TICK_ON;
}

size_t bsp_link_write(const uint8_t *bytes, size_t n)
{
    size_t taken = 0;
    while (taken < n && (UART_STATE & TX_FULL) == 0u) {
        UART_DATA = bytes[taken++];
    }
    return taken;
}

size_t bsp_link_read(uint8_t *bytes, size_t n)
{
    size_t came = 0;
    while (came < n && (UART_STATE & RX_FULL) != 0u) {
        bytes[came++] = (uint8_t)UART_DATA;
    }
    if (came == 0 && !table_adc_behind()) {
        __asm__ volatile("wfi");
    }
    return came;
}

/* From how long the emulator takes for the same work again and again. A real board reads its
   generator of random numbers here. */
uint32_t bsp_random(void)
{
    uint32_t drawn = 0x811C9DC5u, i;
    for (i = 0; i < 4096u || drawn == 0u; i++) {
        drawn = (drawn ^ (FPGA_COUNTER & 0xFFFFu)) * 16777619u; /* FNV-1a */
    }
    return drawn;
}

void bsp_halt(void)
{
    for (;;) {
    }
}
