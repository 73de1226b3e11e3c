/*
 * The device side of the armodal board protocol, version 1 (docs/board-protocol.md).
 *
 * Portable C99 without heap, threads or dependencies. A board supplies its buffers (ab_config)
 * and five functions (ab_port; a sixth may be NULL), and calls four functions from one place, its
 * main loop:
 *
 *     ab_receive   what came from the host
 *     ab_samples   what came from the converter
 *     ab_lost      that the converter lost samples
 *     ab_poll      now and then: sends what is waiting
 *
 * None of them waits, none may be called from an interrupt while another one runs. All integers
 * in these structures are in the machine's own order; the bytes of the wire are little endian.
 */
#ifndef ARMODAL_BOARD_H
#define ARMODAL_BOARD_H

#include "armodal_messages.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Wire size of a frame with p payload bytes, delimiters included (section 6). */
#define AB_WIRE_BYTES(p) (36u + (p) + (36u + (p) + 253u) / 254u + 2u)
/* Most bytes of counts in one frame of a board with c channels. */
#define AB_COUNT_BYTES(c) ((c) <= 10u ? 192u * (c) : 2040u)
/* Smallest transmit buffer: one frame of data, or one fragment of the dictionary. */
#define AB_TRANSMIT_BYTES(c) AB_WIRE_BYTES((c) < 3u ? 516u : 8u + AB_COUNT_BYTES(c))
/* Preview buffer of f frames; one is the least. */
#define AB_PREVIEW_BYTES(c, f) ((f) * (18u + AB_COUNT_BYTES(c)))

enum {
    AB_VERSION = 1,
    AB_MAX_PAYLOAD = 2048,
    AB_MAX_CHANNELS = 32,
    AB_MAX_ENCODED = 2093,   /* the longest frame between its delimiters */
    AB_PIECE_BYTES = 512,    /* of the dictionary in one HELLO_REPLY */
    AB_REASON_BYTES = 120,   /* of a refusal's text, its final zero included */
    AB_RESEND_QUEUE = 8
};

/* ---- Frames: crc32.c, cobs.c, frame.c ---------------------------------------------------- */

/* What a stretch between two delimiters is; with VERSION and TYPE the header is filled in. */
typedef enum {
    AB_FRAME_OK = 0,
    AB_FRAME_COBS = 1,
    AB_FRAME_SHORT = 2,
    AB_FRAME_LONG = 3,
    AB_FRAME_CRC = 4,
    AB_FRAME_VERSION = 5,
    AB_FRAME_TYPE = 6
} ab_frame_result;

/* CRC-32 of zlib: begin with 0, hand the last result on to go on. */
uint32_t ab_crc32(uint32_t crc, const uint8_t *bytes, size_t n);

/* A frame being composed in a buffer; a body may be added in pieces. */
typedef struct {
    uint8_t *wire;
    size_t size;
    size_t at;      /* next byte to write */
    size_t code_at; /* where the code byte of the open piece goes */
    uint32_t crc;
    uint8_t code; /* length of the open piece + 1 */
    bool overrun;
} ab_encoder;

void ab_encoder_begin(ab_encoder *encoder, uint8_t *wire, size_t size, const ab_header *header);
void ab_encoder_add(ab_encoder *encoder, const uint8_t *bytes, size_t n);
/* Close the frame; its bytes on the wire, or 0 where the buffer was too small. */
size_t ab_encoder_end(ab_encoder *encoder);

/* Decode in place what stood between two delimiters; the payload points into it. */
ab_frame_result ab_frame_decode(uint8_t *encoded, size_t n, ab_header *header,
                                const uint8_t **payload, size_t *payload_size);

/* Cuts a stream of bytes at its delimiters. */
typedef struct {
    uint8_t *buffer;
    size_t size;
    size_t used;
    bool skipping; /* the stretch is longer than the buffer: drop it up to the next delimiter */
    uint32_t bad_frames;
    uint64_t garbage_bytes;
} ab_receiver;

/* Take bytes up to the end of one stretch; return how many. *stretch is its length, else 0. */
size_t ab_receiver_take(ab_receiver *receiver, const uint8_t *bytes, size_t n, size_t *stretch);
/* Decode the stretch in the buffer and count it where it is bad. */
ab_frame_result ab_receiver_decode(ab_receiver *receiver, size_t stretch, ab_header *header,
                                   const uint8_t **payload, size_t *payload_size);

/* ---- Dictionary: dictionary.c ------------------------------------------------------------ */

typedef struct {
    const char *name;
    const char *quantity;
    const char *unit;
    const char *serial_number;
    const char *calibration_date;
    double scale;
    double full_scale;
    double highpass_hz;
    const uint8_t *teds;
    uint16_t teds_size;
    uint8_t iepe;
} ab_channel;

typedef struct {
    const char *board_id;
    const char *firmware;
    uint32_t link_bytes_per_s;
    uint32_t block_capacity;
    uint32_t tick_hz;
    double filter_group_delay_samples;
    const ab_channel *channels;
    uint8_t n_channels;
} ab_dictionary;

/* What the board itself reads from its dictionary. */
typedef struct {
    uint8_t n_channels;
    uint32_t link_bytes_per_s;
    uint32_t block_capacity;
    uint32_t tick_hz;
} ab_dictionary_head;

/* Lay out the constant array; its length, or 0 where it does not fit or breaks a rule. */
size_t ab_dictionary_encode(uint8_t *to, size_t size, const ab_dictionary *dictionary);
/* Whether the bytes are a dictionary that a host accepts; fills in the head. */
bool ab_dictionary_check(const uint8_t *bytes, size_t n, ab_dictionary_head *head);

/* ---- Samples and limits: bytes.c, limits.c ----------------------------------------------- */

/* Counts as 24 bits, clipped to them; the place behind them. */
uint8_t *ab_write_count(uint8_t *to, int32_t count);

/* Whether a board with this dictionary must refuse, section 6, and why, in words. */
ab_code ab_limits(const ab_configuration *wanted, const ab_dictionary_head *head,
                  char reason[AB_REASON_BYTES]);

/* ---- Porting layer ----------------------------------------------------------------------- */

typedef struct {
    void *context; /* handed to every function below */

    /* Give bytes to the link without waiting, as write() does; return how many were taken, 0
       where the link is busy. The bytes are those of whole frames, in order. */
    size_t (*send)(void *context, const uint8_t *bytes, size_t n);

    /* The board's clock, section 3: never backwards, 0 at boot. The converter's clock must come
       from the same oscillator: ticks within a block are counted on from its trigger. */
    uint64_t (*ticks)(void *context);

    /* Whether the converter makes exactly numerator / denominator Hz. If not, write into
       `reason` (of `size` bytes, zero at its end) which rates are the nearest. */
    bool (*rate)(void *context, uint32_t numerator, uint32_t denominator, char *reason,
                 size_t size);

    /* Start the converter at a rate that `rate` accepted, and stop it. */
    void (*start)(void *context, uint32_t numerator, uint32_t denominator);
    void (*stop)(void *context);

    /* Carry out a command of the table of messages that the library does not; ab_read_... reads
       its payload. AB_OK: the record of the answer was written at `answer` by ab_write_... Any
       other code refuses, and `reason` says why, as that of `rate` does. NULL: the board has no
       such command. */
    ab_code (*command)(void *context, uint8_t type, const uint8_t *payload, size_t n,
                       uint8_t *answer, char *reason, size_t size);
} ab_port;

/* A block in the buffer. */
typedef struct {
    uint64_t first_sample;
    uint64_t trigger_ticks;
    uint32_t id;     /* 0: the buffer is free, or is being filled */
    uint32_t oldest; /* where in the buffer its first sample stands */
} ab_block;

/* The board's memory; constant, and there as long as the board runs. */
typedef struct {
    ab_port port;
    uint8_t *block_buffer; /* at least the dictionary's block_capacity */
    size_t block_buffer_size;
    ab_block *blocks; /* a record for each block held at the same time */
    uint16_t n_blocks;
    uint8_t *receive; /* AB_RECEIVE_BYTES or more */
    size_t receive_size;
    uint8_t *transmit; /* AB_TRANSMIT_BYTES(channels) or more */
    size_t transmit_size;
    uint8_t *preview; /* AB_PREVIEW_BYTES(channels, frames) */
    size_t preview_size;
} ab_config;

/* ---- The board --------------------------------------------------------------------------- */

/* State of a board. Its fields belong to the library. */
typedef struct {
    const ab_config *config;
    const uint8_t *dictionary;
    uint16_t dictionary_size;
    uint16_t dictionary_hash;
    ab_dictionary_head head;
    uint32_t session;
    uint32_t sequence;
    uint16_t overflow;
    uint8_t state;
    ab_configuration wanted;
    /* commands.c */
    ab_receiver receiver;
    size_t command; /* length of a command that waits to be answered, 0: none */
    bool greeting;  /* fragments of the dictionary are being sent */
    uint16_t greeting_tag;
    uint16_t greeting_at;
    /* outgoing.c */
    size_t transmit_at;
    size_t transmit_end;
    ab_resend sending;
    uint32_t last_sent; /* blocks up to this id were sent once */
    bool announce; /* BLOCK_READY comes before `sending` */
    ab_resend resend[AB_RESEND_QUEUE];
    uint8_t n_resend;
    /* capture.c */
    uint64_t next_sample;
    uint64_t armed_from; /* no trigger before this sample */
    uint64_t ticks_whole;  /* ticks per sample: whole part, and rest over rate_numerator */
    uint32_t ticks_rest;
    uint32_t last_block;
    uint32_t n_slots; /* blocks that fit */
    uint32_t slot;    /* the one samples go to; n_slots: none */
    uint32_t slot_at;    /* where in it the next sample goes */
    uint32_t slot_valid; /* samples in it that have no hole between them */
    uint32_t slot_left;  /* samples a triggered block still wants; 0: none is open */
    int32_t last_count; /* of the trigger channel */
    bool has_last;
    uint8_t n_columns; /* channels in the mask */
    uint32_t triggers_missed;
    uint32_t adc_overruns;
    /* preview.c */
    uint64_t stream_dropped;
    uint16_t preview_wanted;   /* samples in a frame */
    uint16_t preview_gathered; /* in the frame being filled */
    uint16_t preview_slots;
    uint16_t preview_head;
    uint16_t preview_count; /* frames that wait */
    bool preview_dropping;  /* no room for the frame being filled */
} ab_board;

typedef enum { AB_INIT_OK = 0, AB_INIT_DICTIONARY = 1, AB_INIT_BUFFERS = 2 } ab_init_result;

/* Boot: IDLE, silent. `session` is random and not 0; the dictionary stays where it is. */
ab_init_result ab_init(ab_board *board, const ab_config *config, const uint8_t *dictionary,
                       uint16_t dictionary_size, uint32_t session);

/* Describe the board from now on (a supply has failed, section 5). The channels stay as many. */
ab_init_result ab_set_dictionary(ab_board *board, const uint8_t *dictionary,
                                 uint16_t dictionary_size);

/* Take bytes from the host; return how many. Fewer than n: the link is busy, offer the rest
   again after ab_poll. */
size_t ab_receive(ab_board *board, const uint8_t *bytes, size_t n);

/* Take n consecutive samples of all channels of the dictionary, sample by sample; `ticks` is
   when the first of them was ready. Counts beyond 24 bits become the extreme count. */
void ab_samples(ab_board *board, const int32_t *counts, uint32_t n, uint64_t ticks);

/* The converter lost n samples: the index jumps (section 8). */
void ab_lost(ab_board *board, uint32_t n);

/* Send what is waiting, as far as the link takes it; true where something is left. */
bool ab_poll(ab_board *board);

#endif
