/*
 * The other direction of the payloads: what a host sends and what it reads.
 *
 * For test programs and for hosts written in C; a board does not need host.c.
 */
#ifndef ARMODAL_HOST_H
#define ARMODAL_HOST_H

#include "armodal_board.h"

/* Head of STREAM and BLOCK_DATA, section 9; block_id is 0 in STREAM. */
typedef struct {
    uint16_t n_samples;
    uint8_t n_channels;
    uint32_t block_id;
    const uint8_t *counts; /* 3 bytes each, sample by sample */
} ab_data;

/* A channel as it stands in a dictionary: texts begin with their length byte, doubles are the
   64 bits of IEEE 754. */
typedef struct {
    uint8_t iepe;
    uint64_t scale;
    uint64_t full_scale;
    uint64_t highpass_hz;
    const uint8_t *texts[5]; /* name, quantity, unit, serial_number, calibration_date */
    const uint8_t *teds;
    uint16_t teds_size;
} ab_channel_view;

/* False where the payload breaks a rule of its type. */
bool ab_read_reply(const uint8_t *payload, size_t n, uint8_t *code, const uint8_t **reason,
                   size_t *reason_size);
bool ab_read_data(uint8_t type, const uint8_t *payload, size_t n, ab_data *data);
/* HELLO_REPLY: the head, and n - AB_FRAGMENT_HEAD_BYTES bytes that lie in the dictionary. */
bool ab_read_piece(const uint8_t *payload, size_t n, ab_fragment_head *head);
/* The same by type, whatever it is. */
bool ab_payload_valid(unsigned type, const uint8_t *payload, size_t n);
/* Whether a reply says OK, without a reason: its record stands behind these two bytes. */
bool ab_is_answer(const uint8_t *payload, size_t n);

/* Channel `index` of a dictionary that ab_dictionary_check accepts; false past the last. */
bool ab_dictionary_channel(const uint8_t *dictionary, unsigned index, ab_channel_view *channel);

/* Frames missing before `sequence`, negative where it is an old one, section 3. */
int64_t ab_sequence_gap(uint32_t expected, uint32_t sequence);

#endif
