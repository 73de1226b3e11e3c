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

void ab_write_configuration(uint8_t to[28], const ab_configuration *wanted);
void ab_write_range(uint8_t to[12], const ab_range *range);
void ab_write_block_id(uint8_t to[4], uint32_t id);

/* False where the payload breaks a rule of its type. */
bool ab_read_reply(const uint8_t *payload, size_t n, uint8_t *code, const uint8_t **reason,
                   size_t *reason_size);
bool ab_read_status(const uint8_t *payload, size_t n, ab_status *status);
bool ab_read_block_info(const uint8_t *payload, size_t n, ab_block_info *info);
bool ab_read_data(uint8_t type, const uint8_t *payload, size_t n, ab_data *data);
bool ab_read_fragment(const uint8_t *payload, size_t n, uint16_t *total, uint16_t *offset);

/* Channel `index` of a dictionary that ab_dictionary_check accepts; false past the last. */
bool ab_dictionary_channel(const uint8_t *dictionary, unsigned index, ab_channel_view *channel);

/* Frames missing before `sequence`, negative where it is an old one, section 3. */
int64_t ab_sequence_gap(uint32_t expected, uint32_t sequence);

#endif
