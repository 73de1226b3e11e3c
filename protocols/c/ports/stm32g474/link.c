/* LPUART1 on PA2 and PA3, which a NUCLEO-G474RE leads to its ST-LINK, hence to USB. */
#include "../dma_link.h"
#include "bsp.h"
#include "registers.h"
#include "stm32g474.h"

enum {
    IN_BYTES = 1024,  /* 11 ms at 921 600 baud, 3 ms at 3 Mbaud */
    OUT_BYTES = 4096, /* five frames of a preview of four channels */
    REQUEST_IN = 34,  /* DMAMUX: LPUART1_RX, LPUART1_TX */
    REQUEST_OUT = 35,
    RECEIVE = 0x00A3, /* memory counts up, circular, interrupt when full, on */
    SEND = 0x0093,    /* memory counts up, to the peripheral, interrupt when done, on */
    FLAGS = 15,
    BY_DMA = 3 << 6,        /* DMAR, DMAT */
    KEEP_LATEST = 1 << 12,  /* OVRDIS: what is overrun is told by frames that are not whole */
    ON = 0x000D             /* UE, RE, TE */
};

static dma_link line;
static uint8_t in[IN_BYTES], out[OUT_BYTES];

static uint32_t left(void *context)
{
    (void)context;
    return reg_read(DMA_CNDTR(DMA_LINK_IN));
}

static void send(void *context, const uint8_t *bytes, size_t n)
{
    (void)context;
    reg_write(DMA_CMAR(DMA_LINK_OUT), dma_address(bytes));
    reg_write(DMA_CNDTR(DMA_LINK_OUT), (uint32_t)n);
    reg_write(DMA_CCR(DMA_LINK_OUT), SEND);
}

static const dma_port port = {.context = NULL, .left = left, .send = send};

void link_begin(void)
{
    dma_link_begin(&line, &port, in, IN_BYTES, out, OUT_BYTES);
    pin(GPIOA, 2, PIN_FUNCTION, 12);
    pin(GPIOA, 3, PIN_FUNCTION, 12);
    reg_change(GPIO_PUPDR(GPIOA), 3u << 6, 1u << 6); /* a line that nobody drives is idle */
    reg_write(DMAMUX_CCR(DMA_LINK_IN), REQUEST_IN);
    reg_write(DMAMUX_CCR(DMA_LINK_OUT), REQUEST_OUT);
    reg_write(DMA_CPAR(DMA_LINK_IN), UART_RDR);
    reg_write(DMA_CPAR(DMA_LINK_OUT), UART_TDR);
    reg_write(DMA_CMAR(DMA_LINK_IN), dma_address(in));
    reg_write(DMA_CNDTR(DMA_LINK_IN), IN_BYTES);
    reg_write(DMA_CCR(DMA_LINK_IN), RECEIVE);
    /* 256 clocks over the rate: RM0440, section 38.4.7. */
    reg_write(UART_BRR, (uint32_t)((256ull * CPU_HZ + BSP_BAUD / 2u) / BSP_BAUD));
    reg_write(UART_CR3, BY_DMA | KEEP_LATEST);
    reg_write(UART_CR1, ON);
}

size_t bsp_link_write(const uint8_t *bytes, size_t n)
{
    return dma_link_write(&line, bytes, n);
}

size_t bsp_link_read(uint8_t *bytes, size_t n)
{
    return dma_link_read(&line, bytes, n);
}

void on_dma_link_in(void)
{
    reg_write(DMA_IFCR, (uint32_t)FLAGS << (4 * (DMA_LINK_IN - 1)));
    dma_link_lap(&line);
}

void on_dma_link_out(void)
{
    reg_write(DMA_IFCR, (uint32_t)FLAGS << (4 * (DMA_LINK_OUT - 1)));
    reg_write(DMA_CCR(DMA_LINK_OUT), 0);
    dma_link_sent(&line);
}
