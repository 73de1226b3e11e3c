/* See dma_link.h. */
#include "dma_link.h"

void dma_link_begin(dma_link *link, const dma_port *port, uint8_t *ring, uint32_t ring_size,
                    uint8_t *out, uint32_t out_size)
{
    link->port = port;
    link->ring = ring;
    link->ring_size = ring_size;
    link->laps = 0u;
    link->seen = 0u;
    link->read = 0u;
    link->overruns = 0u;
    link->out = out;
    link->out_size = out_size;
    link->queued = 0u;
    link->sent = 0u;
    link->under_way = 0u;
}

/* Begin to send what waits, as far as it lies in one piece. */
static void send_next(dma_link *link)
{
    const uint32_t at = link->sent & (link->out_size - 1u);
    const uint32_t waiting = link->queued - link->sent;
    const uint32_t straight = link->out_size - at;

    if (waiting != 0u) {
        link->under_way = waiting < straight ? waiting : straight;
        link->port->send(link->port->context, link->out + at, link->under_way);
    }
}

size_t dma_link_write(dma_link *link, const uint8_t *bytes, size_t n)
{
    size_t taken = 0;

    while (taken < n && link->queued - link->sent < link->out_size) {
        link->out[link->queued & (link->out_size - 1u)] = bytes[taken++];
        link->queued = link->queued + 1u; /* the byte is there before it counts */
    }
    if (link->under_way == 0u) {
        send_next(link);
    }
    return taken;
}

void dma_link_sent(dma_link *link)
{
    link->sent = link->sent + link->under_way;
    link->under_way = 0u;
    send_next(link);
}

void dma_link_lap(dma_link *link)
{
    link->laps = link->laps + 1u;
}

/* Bytes that have come since the start. */
static uint64_t come(dma_link *link)
{
    uint32_t laps, left, again = link->laps;
    uint64_t position;

    do { /* a lap between the two readings would be taken for one more or one less */
        laps = again;
        left = link->port->left(link->port->context);
        again = link->laps;
    } while (laps != again);
    position = (uint64_t)laps * link->ring_size + (link->ring_size - left);
    if (position < link->seen) {
        position += link->ring_size; /* the counter has begun anew, its interrupt is still due */
    }
    return position;
}

size_t dma_link_read(dma_link *link, uint8_t *bytes, size_t n)
{
    size_t given = 0;

    link->seen = come(link);
    if (link->seen - link->read > link->ring_size) {
        link->overruns++;
        link->read = link->seen;
    }
    while (given < n && link->read != link->seen) {
        bytes[given++] = link->ring[link->read & (link->ring_size - 1u)];
        link->read++;
    }
    return given;
}
