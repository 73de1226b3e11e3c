/* See ads131m04.h. */
#include "ads131m04.h"

#include <string.h>

enum {
    WORD = 3,
    COMMAND_RESET = 0x0011,
    COMMAND_READ = 0xA000,
    COMMAND_WRITE = 0x6000,
    ACKNOWLEDGE_RESET = 0xFF24, /* FF20 with the number of channels */
    REGISTER_ID = 0x00,
    REGISTER_MODE = 0x02,
    REGISTER_CLOCK = 0x03,
    REGISTER_GAIN = 0x04,
    ID_CHANNELS = 0x0F00,
    ID_FOUR = 0x0400,
    MODE_24_BITS = 0x0110,  /* words of 24 bits, time-out on; the flag RESET is cleared */
    CLOCK_ALL_HIGH = 0x0F02, /* four channels on, high-resolution power */
    STATUS_RESYNC = 0x4000,
    STATUS_CRC = 0x1000,
    STATUS_RESET = 0x0400,
    STATUS_NEW = 0x000F
};

/* CRC-16 CCITT, 0x1021, beginning with ones: over all words of a frame, filling included. */
static uint16_t crc_of(const uint8_t *bytes, size_t n)
{
    uint16_t crc = 0xFFFFu;
    size_t i;
    int bit;
    for (i = 0; i < n; i++) {
        crc = (uint16_t)(crc ^ (uint16_t)((uint16_t)bytes[i] << 8));
        for (bit = 0; bit < 8; bit++) {
            const uint16_t high = crc & 0x8000u;
            crc = (uint16_t)(crc << 1);
            crc = (uint16_t)(high != 0u ? crc ^ 0x1021u : crc);
        }
    }
    return crc;
}

static uint16_t word16(const uint8_t *at)
{
    return (uint16_t)((uint16_t)at[0] << 8 | at[1]);
}

static int frame_is_whole(const uint8_t *frame)
{
    return crc_of(frame, ADS_FRAME_BYTES - WORD) == word16(frame + ADS_FRAME_BYTES - WORD);
}

/* Send a command with one word behind it; what comes back answers the command before. */
static ads_result exchange(const ads_port *port, uint16_t command, uint16_t value,
                           uint16_t *answer)
{
    uint8_t out[ADS_FRAME_BYTES] = {0}, in[ADS_FRAME_BYTES];
    out[0] = (uint8_t)(command >> 8);
    out[1] = (uint8_t)command;
    out[WORD] = (uint8_t)(value >> 8);
    out[WORD + 1] = (uint8_t)value;
    port->transfer(port->context, out, in, sizeof in);
    *answer = word16(in);
    return frame_is_whole(in) ? ADS_OK : ADS_CRC;
}

static ads_result read_register(const ads_port *port, uint16_t address, uint16_t *value)
{
    uint16_t before;
    ads_result result = exchange(port, (uint16_t)(COMMAND_READ | address << 7), 0, &before);
    return result != ADS_OK ? result : exchange(port, 0, 0, value);
}

static ads_result write_register(const ads_port *port, uint16_t address, uint16_t value)
{
    uint16_t before, held;
    ads_result result = exchange(port, (uint16_t)(COMMAND_WRITE | address << 7), value, &before);
    if (result == ADS_OK) {
        result = read_register(port, address, &held);
    }
    return result != ADS_OK ? result : held == value ? ADS_OK : ADS_REGISTER;
}

ads_result ads_begin(const ads_port *port, ads_osr osr, const uint8_t gains[ADS_CHANNELS])
{
    uint16_t answer, gain = 0;
    ads_result result;
    int i;

    /* What is answered here is of a chip whose state nobody knows: not looked at. */
    (void)exchange(port, COMMAND_RESET, 0, &answer);
    result = exchange(port, 0, 0, &answer);
    if (result != ADS_OK || answer != ACKNOWLEDGE_RESET) {
        return ADS_SILENT;
    }
    result = read_register(port, REGISTER_ID, &answer);
    if (result == ADS_OK && (answer & ID_CHANNELS) != ID_FOUR) {
        result = ADS_SILENT;
    }
    for (i = 0; i < ADS_CHANNELS; i++) {
        gain = (uint16_t)(gain | (uint16_t)((gains[i] & 7u) << (4 * i)));
    }
    if (result == ADS_OK) {
        result = write_register(port, REGISTER_MODE, MODE_24_BITS);
    }
    if (result == ADS_OK) {
        result = write_register(port, REGISTER_CLOCK, (uint16_t)(CLOCK_ALL_HIGH | osr << 2));
    }
    if (result == ADS_OK) {
        result = write_register(port, REGISTER_GAIN, gain);
    }
    return result;
}

ads_result ads_decode(const uint8_t frame[ADS_FRAME_BYTES], int32_t counts[ADS_CHANNELS])
{
    uint16_t status = word16(frame);
    int i;
    if (!frame_is_whole(frame)) {
        return ADS_CRC;
    }
    if ((status & (STATUS_RESYNC | STATUS_CRC | STATUS_RESET)) != 0 ||
        (status & STATUS_NEW) != STATUS_NEW) {
        return ADS_FAULT;
    }
    for (i = 0; i < ADS_CHANNELS; i++) {
        const uint8_t *at = frame + WORD * (i + 1);
        int32_t value = (int32_t)((uint32_t)at[0] << 16 | (uint32_t)at[1] << 8 | at[2]);
        counts[i] = value >= 0x800000 ? value - 0x1000000 : value;
    }
    return ADS_OK;
}

void ads_ring_begin(ads_ring *ring, uint32_t period_x256)
{
    memset(ring, 0, sizeof *ring);
    ring->period_x256 = period_x256;
}

uint8_t *ads_ring_next(ads_ring *ring)
{
    return ring->frames[ring->written % ADS_RING_FRAMES];
}

/* Samples that came due between two ticks, beside the one at the end; none before the first. */
static uint32_t missed(const ads_ring *ring, uint64_t from, uint64_t to)
{
    uint64_t periods;
    if (from == 0u) {
        return 0u;
    }
    periods = ((to - from) * 256u + ring->period_x256 / 2u) / ring->period_x256;
    return periods > 1u ? (uint32_t)(periods - 1u) : 0u;
}

int ads_ring_done(ads_ring *ring, uint64_t ready_ticks)
{
    const int is_emptied = ring->is_emptying;
    if (is_emptied == 0) {
        ring->is_emptying =
            ring->done_ticks == 0u || missed(ring, ring->done_ticks, ready_ticks) != 0u;
        ring->done_ticks = ready_ticks;
    } else {
        ring->is_emptying = 0;
    }
    if (is_emptied != 0 || ring->is_emptying != 0) {
        return ring->is_emptying;
    }
    ring->ticks[ring->written % ADS_RING_FRAMES] = ready_ticks;
    ring->written = ring->written + 1u;
    return 0;
}

uint32_t ads_ring_read(ads_ring *ring, int32_t *counts, uint32_t most, uint64_t *ticks,
                       uint32_t *lost)
{
    uint32_t n = 0;
    *lost = 0;
    *ticks = 0;
    while (n < most && ring->read != ring->written) {
        /* One place less than there are: interrupts may be filling the next. What was overwritten
           shows in the ticks, as what was not fetched. */
        const uint32_t newest = ring->written;
        if (newest - ring->read >= ADS_RING_FRAMES) {
            if (ring->last_ticks == 0u) {
                *lost += newest - (ADS_RING_FRAMES - 1u) - ring->read; /* no ticks tell of them */
            }
            ring->read = newest - (ADS_RING_FRAMES - 1u);
        }
        const uint32_t at = ring->read % ADS_RING_FRAMES;
        const uint64_t now = ring->ticks[at];
        const uint32_t gone = missed(ring, ring->last_ticks, now);
        const ads_result result = ads_decode(ring->frames[at], counts + ADS_CHANNELS * n);
        if (n != 0u && (gone != 0u || result != ADS_OK)) {
            return n; /* the gap is told before the next samples */
        }
        ring->read++;
        ring->last_ticks = now;
        *lost += gone;
        if (result != ADS_OK) {
            ring->bad_frames++;
            *lost += 1u;
            continue;
        }
        if (n == 0u) {
            *ticks = now;
        }
        n++;
    }
    return n;
}
