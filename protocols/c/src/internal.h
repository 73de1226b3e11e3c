/* What the files of the board share and a firmware does not need. */
#ifndef ARMODAL_BOARD_INTERNAL_H
#define ARMODAL_BOARD_INTERNAL_H

#include "armodal_board.h"

/* The memory functions that a C compiler itself relies on and so every target has; declared here
   because a target without a C library has no string.h. */
void *memcpy(void *restrict to, const void *restrict from, size_t n);
void *memset(void *to, int byte, size_t n);
int memcmp(const void *a, const void *b, size_t n);

/* bytes.c: little endian fields; put returns the place behind the field. */
uint8_t *ab_put_u16(uint8_t *to, uint16_t value);
uint8_t *ab_put_u32(uint8_t *to, uint32_t value);
uint8_t *ab_put_u64(uint8_t *to, uint64_t value);
uint16_t ab_get_u16(const uint8_t *from);
uint32_t ab_get_u32(const uint8_t *from);
uint64_t ab_get_u64(const uint8_t *from);
bool ab_is_utf8(const uint8_t *text, size_t n);

/* text.c: a refusal's reason, cut where it is full, zero at its end. */
typedef struct {
    char *at;
    char *end; /* where the final zero must stand at the latest */
} ab_text;

ab_text ab_text_begin(char *buffer, size_t size);
void ab_text_add(ab_text *text, const char *words);
/* Words and a number after them. */
void ab_text_say(ab_text *text, const char *words, uint64_t value);
void ab_text_signed(ab_text *text, int32_t value);
void ab_text_hex(ab_text *text, uint32_t value);

/* cobs.c: decode in place; the length, or SIZE_MAX where the bytes are not COBS. */
size_t ab_cobs_decode(uint8_t *bytes, size_t n);

/* limits.c: what must be refused, section 6. */
uint8_t ab_n_columns(uint32_t channel_mask);
uint16_t ab_frame_samples(uint8_t n_columns);
uint32_t ab_sample_bytes(const ab_board *board);
/* Write the words of a refusal at `reason`; a rate that the converter cannot make is not seen. */
ab_code ab_refusal(const ab_configuration *wanted, const ab_dictionary_head *head,
                   ab_text *reason);

/* commands.c: answer the command or go on with the dictionary; false where nothing waits. */
bool ab_answer(ab_board *board);

/* capture.c */
void ab_capture_configure(ab_board *board);
void ab_capture_start(ab_board *board);
void ab_capture_stop(ab_board *board);
void ab_capture_sample(ab_board *board, const uint8_t *packed, int32_t count, uint64_t ticks);
void ab_capture_lost(ab_board *board, uint32_t n);
uint64_t ab_ticks_of(const ab_board *board, uint32_t n_samples);
uint8_t *ab_slot(const ab_board *board, uint32_t slot);
ab_block *ab_find_block(const ab_board *board, uint32_t id);

/* preview.c */
void ab_preview_start(ab_board *board);
void ab_preview_sample(ab_board *board, const uint8_t *packed, uint64_t ticks);
void ab_preview_end_frame(ab_board *board);
bool ab_preview_send(ab_board *board);

/* outgoing.c: all below want the transmit buffer to be free, which ab_flush tells. */
typedef struct {
    const uint8_t *bytes;
    size_t n;
} ab_piece;

bool ab_flush(ab_board *board);
/* Compose a frame of header type, tag, first_sample and ticks; the rest is filled in. */
void ab_compose(ab_board *board, ab_header *header, const ab_piece *pieces, size_t n);
/* The same for all that carries no samples: the clock is read here. */
void ab_compose_now(ab_board *board, uint8_t type, uint16_t tag, const uint8_t *payload, size_t n);
void ab_send_data(ab_board *board);
void ab_forget_block(ab_board *board, uint32_t id);
void ab_forget_all_blocks(ab_board *board);

#endif
