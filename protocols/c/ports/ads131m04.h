/*
 * The converter ADS131M04: four channels of 24 bits at once, over SPI (mode 1), 24-bit words.
 * Registers, frames and CRC by TI's data sheet SBAS890, sections 8.5 and 8.6.
 *
 * The board gives one function, and calls from two places:
 *
 *     main loop            ads_begin, ads_ring_read
 *     interrupts           ads_ring_next when data is ready: where its DMA puts the frame;
 *                          ads_ring_done when the frame is there
 *
 * Ring and interrupts are a double buffer of any depth: while one frame is filled the others are
 * read. Nothing waits, and a sample that did not come whole is counted, never made up.
 */
#ifndef ADS131M04_H
#define ADS131M04_H

#include <stddef.h>
#include <stdint.h>

enum {
    ADS_CHANNELS = 4,
    ADS_FRAME_BYTES = 18, /* status, four channels, CRC, of 24 bits each */
    ADS_RING_FRAMES = 64
};

/* Samples a modulator clock's 64, 128, ... 16384; the rate is f_clkin / 2 over it. */
typedef enum {
    ADS_OSR_128 = 0,
    ADS_OSR_256 = 1,
    ADS_OSR_512 = 2,
    ADS_OSR_1024 = 3,
    ADS_OSR_2048 = 4,
    ADS_OSR_4096 = 5,
    ADS_OSR_8192 = 6,
    ADS_OSR_16384 = 7
} ads_osr;

typedef enum {
    ADS_OK = 0,
    ADS_SILENT = 1,   /* no acknowledge of RESET, or another chip */
    ADS_CRC = 2,      /* the CRC of a frame is wrong */
    ADS_REGISTER = 3, /* a register does not hold what was written */
    ADS_FAULT = 4     /* the status says reset, resynchronised, or no new data */
} ads_result;

typedef struct {
    void *context;
    /* Chip select low, n bytes both ways, chip select high. */
    void (*transfer)(void *context, const uint8_t *out, uint8_t *in, size_t n);
} ads_port;

/* Reset the chip, set oversampling and gains (1, 2, 4, ... 128 as 0, 1, 2, ... 7), and read all
   back. */
ads_result ads_begin(const ads_port *port, ads_osr osr, const uint8_t gains[ADS_CHANNELS]);

/* Take a frame apart; counts are valid with ADS_OK only. */
ads_result ads_decode(const uint8_t frame[ADS_FRAME_BYTES], int32_t counts[ADS_CHANNELS]);

typedef struct {
    uint8_t frames[ADS_RING_FRAMES][ADS_FRAME_BYTES];
    uint64_t ticks[ADS_RING_FRAMES];
    volatile uint32_t written; /* by interrupts */
    uint32_t read;             /* by the main loop */
    uint64_t done_ticks; /* of the last data-ready that was served */
    uint64_t last_ticks; /* of the last frame that was read */
    uint32_t period_x256; /* ticks of a sample, in 256ths */
    uint32_t bad_frames;  /* wrong CRC or fault, since the start */
    int is_emptying;      /* the frame under way is to be thrown away */
} ads_ring;

void ads_ring_begin(ads_ring *ring, uint32_t period_x256);
uint8_t *ads_ring_next(ads_ring *ring);
/* The frame is there; `ready_ticks` is when its data was ready. Not 0: it is the first, or data-readies
   were not served; then two samples may wait in the chip, and the frame be the older one's. Fetch one
   frame more at once, for the same ticks: both are thrown away, and the next data-ready finds its own
   sample alone, or none, which its status says. */
int ads_ring_done(ads_ring *ring, uint64_t ready_ticks);

/* At most `most` samples that are whole and follow one another; how many. *ticks is when the first
   of them was ready, *lost how many samples are missing before it: overwritten in the ring, not
   fetched in time by the ticks, or of a bad frame. */
uint32_t ads_ring_read(ads_ring *ring, int32_t *counts, uint32_t most, uint64_t *ticks,
                       uint32_t *lost);

#endif
