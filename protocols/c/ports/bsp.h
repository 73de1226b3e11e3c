/* What a board support package brings to board.c (docs/porting.md, section 2). None waits. */
#ifndef ARMODAL_BSP_H
#define ARMODAL_BSP_H

#include <stddef.h>
#include <stdint.h>

/* What the link sustains (docs/porting.md, section 3): here USB full speed. */
#ifndef BSP_LINK_BYTES_PER_S
#define BSP_LINK_BYTES_PER_S 800000u
#endif

/* Frames of the preview that wait for the link: 4 are 5 ms at 51200 Hz. */
#ifndef BSP_PREVIEW_FRAMES
#define BSP_PREVIEW_FRAMES 4
#endif

/* Give and take bytes of the link; how many were taken and given. */
size_t bsp_link_write(const uint8_t *bytes, size_t n);
size_t bsp_link_read(uint8_t *bytes, size_t n);

/* Microseconds since boot, never backwards. */
uint64_t bsp_ticks64(void);

/* Convert at 51200 Hz / divisor, and stop. */
void bsp_adc_start(uint32_t divisor);
void bsp_adc_stop(void);

/* At most `most` samples of all channels that are ready; how many. *ticks is when the first of them
   was ready, *lost how many samples were lost before it. */
uint32_t bsp_adc_read(int32_t *counts, uint32_t most, uint64_t *ticks, uint32_t *lost);

/* Not 0, and another number after every boot. */
uint32_t bsp_random(void);

/* The board cannot run: stop here. */
void bsp_halt(void);

#endif
