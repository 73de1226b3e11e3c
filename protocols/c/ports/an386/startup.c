/* Vector table and start of a Cortex-M4 whose image is loaded where it runs. */
#include <stdint.h>

extern uint32_t bss_start, bss_end;

int main(void);
void stack_top(void); /* an address of the linker's, no function: the table's first word */
void reset(void);
void stuck(void);
void wake(void);

void reset(void)
{
    uint32_t *word;
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: the floating point unit */
    for (word = &bss_start; word < &bss_end; word++) {
        *word = 0u;
    }
    (void)main();
    stuck();
}

void stuck(void)
{
    for (;;) {
    }
}

/* The system tick: to have come is all it does. */
void wake(void)
{
}

__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    stack_top, reset, stuck, stuck, stuck, stuck, stuck, stuck,
    stuck, stuck, stuck, stuck, stuck, stuck, stuck, wake};
