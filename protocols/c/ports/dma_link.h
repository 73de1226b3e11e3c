/*
 * A UART by DMA as the link of board.c: two rings, and nothing that waits.
 *
 * The board gives two functions, and calls from two places:
 *
 *     main loop      dma_link_write and dma_link_read, as bsp_link_write and bsp_link_read
 *     interrupts     dma_link_lap when the receiving DMA (circular) has filled its ring and begins
 *                    anew; dma_link_sent when a transfer is done
 *
 * The receiving DMA never stops. Where the main loop reads is known by the DMA's counter and the
 * laps; who comes too late loses bytes, which is counted, and the frames in them are asked for
 * again by the protocol. Bytes that are being sent are not touched.
 */
#ifndef DMA_LINK_H
#define DMA_LINK_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    void *context;
    /* Bytes that the receiving DMA still writes before its ring begins anew: its counter. */
    uint32_t (*left)(void *context);
    /* Send n bytes from memory by DMA; none is under way when this is called. */
    void (*send)(void *context, const uint8_t *bytes, size_t n);
} dma_port;

typedef struct {
    const dma_port *port;
    uint8_t *ring; /* the receiving DMA writes here */
    uint32_t ring_size;
    volatile uint32_t laps; /* by interrupt */
    uint64_t seen; /* bytes known to have come, since the start */
    uint64_t read; /* of these taken, or lost */
    uint32_t overruns; /* times that bytes were lost */
    uint8_t *out;
    uint32_t out_size;
    volatile uint32_t queued;    /* bytes put into `out`; wraps */
    volatile uint32_t sent;      /* of these sent; wraps */
    volatile uint32_t under_way; /* bytes of the transfer in hand; 0: none */
} dma_link;

/* The sizes are powers of two; the rings stay where they are. */
void dma_link_begin(dma_link *link, const dma_port *port, uint8_t *ring, uint32_t ring_size,
                    uint8_t *out, uint32_t out_size);

/* How many bytes were taken; the others find no room yet. */
size_t dma_link_write(dma_link *link, const uint8_t *bytes, size_t n);
/* How many bytes were given, at most n. */
size_t dma_link_read(dma_link *link, uint8_t *bytes, size_t n);

void dma_link_lap(dma_link *link);
void dma_link_sent(dma_link *link);

#endif
