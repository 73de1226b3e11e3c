/* Registers as functions of the test's: what ports/stm32g474/registers.h declares for a host. */
#include "bsp.h"
#include "stm32g474/registers.h"

uint32_t (*host_read)(uint32_t address);
void (*host_write)(uint32_t address, uint32_t value);
uint32_t (*host_place)(const void *memory);
void (*host_halt)(void);

uint32_t reg_read(uint32_t address)
{
    return host_read(address);
}

void reg_write(uint32_t address, uint32_t value)
{
    host_write(address, value);
}

uint8_t reg_read8(uint32_t address)
{
    return (uint8_t)host_read(address);
}

void reg_write8(uint32_t address, uint8_t value)
{
    host_write(address, value);
}

uint32_t dma_address(const void *memory)
{
    return host_place(memory);
}

void bsp_halt(void)
{
    for (;;) {
        host_halt();
    }
}
