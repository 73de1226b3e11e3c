/* What a board support package brings to board.c (docs/porting.md, section 2). None waits. */
#ifndef ARMODAL_BSP_H
#define ARMODAL_BSP_H

#include <stddef.h>
#include <stdint.h>

/* What the link sustains (docs/porting.md, section 3): a UART's rate over ten, else USB full speed. */
#ifdef BSP_BAUD
#define BSP_LINK_BYTES_PER_S (BSP_BAUD / 10u)
#else
#define BSP_LINK_BYTES_PER_S 800000u
#endif

/* Frames of the preview that wait for the link: 4 are 5 ms at 51200 Hz. */
#ifndef BSP_PREVIEW_FRAMES
#define BSP_PREVIEW_FRAMES 4
#endif

/* What the board is called, what its clock counts in a second, and by how many samples the counts
   lag the input (docs/porting.md, section 5). */
#ifndef BSP_BOARD_ID
#define BSP_BOARD_ID "my-board"
#endif
#ifndef BSP_TICK_HZ
#define BSP_TICK_HZ 1000000u
#endif
#ifndef BSP_GROUP_DELAY_SAMPLES
#define BSP_GROUP_DELAY_SAMPLES 34.0
#endif

/* Clocks, pins, what the sensors' memories hold, then their supplies. Called once, before all else;
   it may wait until the supplies have settled. */
void bsp_begin(void);

/* The data sheet of a channel's sensor without the memory's checksum bytes, and its bytes; it stays
   where it is. 0 bytes where the sensor has none. */
const uint8_t *bsp_teds(uint32_t channel, uint16_t *size);
/* State of a channel's supply: 0 off, 1 as it should be, 2 open, 3 short (docs, section 6). */
uint8_t bsp_iepe(uint32_t channel);

/* Give and take bytes of the link; how many were taken and given. */
size_t bsp_link_write(const uint8_t *bytes, size_t n);
size_t bsp_link_read(uint8_t *bytes, size_t n);

/* BSP_TICK_HZ a second since boot, never backwards. */
uint64_t bsp_ticks64(void);

/* Why the converter does not make numerator / denominator Hz exactly, and what it makes; else NULL. */
const char *bsp_adc_refusal(uint32_t numerator, uint32_t denominator);
/* Convert at a rate that was not refused, and stop. */
void bsp_adc_start(uint32_t numerator, uint32_t denominator);
void bsp_adc_stop(void);

/* At most `most` samples of all channels that are ready; how many. *ticks is when the first of them
   was ready, *lost how many samples were lost before it. */
uint32_t bsp_adc_read(int32_t *counts, uint32_t most, uint64_t *ticks, uint32_t *lost);

/* Not 0, and another number after every boot. */
uint32_t bsp_random(void);

/* The board cannot run: stop here. */
void bsp_halt(void);

#endif
