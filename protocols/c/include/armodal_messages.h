/* Made by `python -m armodal.protocols.board.generate`; change records.py instead. */
/* Messages of the board protocol: types, fixed fields, their readers and writers. */
#ifndef ARMODAL_MESSAGES_H
#define ARMODAL_MESSAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum {
    AB_HELLO = 0x01,
    AB_CONFIGURE = 0x02,
    AB_START = 0x03,
    AB_STOP = 0x04,
    AB_STATUS = 0x05,
    AB_RESEND = 0x06,
    AB_RELEASE = 0x07,
    AB_REPLY = 0x80, /* added to a command's type */
    AB_STREAM = 0x90,
    AB_BLOCK_READY = 0x91,
    AB_BLOCK_DATA = 0x92
} ab_type;

typedef enum {
    AB_OK = 0,
    AB_BAD_VALUE = 1,
    AB_CAPACITY = 2,
    AB_LINK = 3,
    AB_WRONG_STATE = 4,
    AB_UNKNOWN_BLOCK = 5,
    AB_UNKNOWN_COMMAND = 6,
    AB_WRONG_SESSION = 7
} ab_code;

typedef enum {
    AB_OVERFLOW_STREAM = 1,
    AB_OVERFLOW_BLOCK = 2,
    AB_OVERFLOW_ADC = 4
} ab_overflow;

typedef enum {
    AB_RISING = 0,
    AB_FALLING = 1
} ab_slope;

typedef enum {
    AB_IDLE = 0,
    AB_CONFIGURED = 1,
    AB_RUNNING = 2
} ab_state;

enum {
    AB_RECEIVE_BYTES = 65,
    AB_ANSWER_BYTES = 37,
    AB_HEADER_BYTES = 32,
    AB_FRAGMENT_HEAD_BYTES = 4,
    AB_CONFIGURATION_BYTES = 28,
    AB_BOARD_STATUS_BYTES = 37,
    AB_RESEND_BYTES = 12,
    AB_RELEASE_BYTES = 4,
    AB_STREAM_HEAD_BYTES = 4,
    AB_BLOCK_INFO_BYTES = 32,
    AB_BLOCK_DATA_HEAD_BYTES = 8
};

/* The header of every frame, section 3. */
typedef struct {
    uint8_t version; /* of the protocol; 1 */
    uint8_t type; /* section 4; bit 7 set: from board to host */
    /* board: hash of its dictionary (section 5). Host: 0 or that hash; the board ignores it */
    uint16_t dictionary_hash;
    uint32_t session; /* board: its session id. Host: the session id it talks to; 0 in a HELLO */
    uint32_t sequence; /* number of this frame among the sender's frames */
    uint16_t overflow; /* board: flags below. Host: 0 */
    uint16_t tag; /* command: chosen by the host. Reply: that of its command. Otherwise 0 */
    uint64_t first_sample; /* STREAM, BLOCK_DATA: index of the first sample carried. Otherwise 0 */
    uint64_t ticks; /* board: its clock. Host: 0 (ticks) */
} ab_header;

/* HELLO_REPLY: what stands before its bytes of the dictionary, section 5. */
typedef struct {
    uint16_t total; /* length of the array (bytes); 1 or more */
    uint16_t offset; /* of this fragment (bytes) */
} ab_fragment_head;

/* CONFIGURE, section 6. */
typedef struct {
    uint32_t rate_hz_numerator; /* the exact quotient: 51200/31 is 51200 and 31 (Hz); 1 or more */
    uint32_t rate_hz_denominator; /* over it */
    uint32_t channel_mask; /* bit i: channel i; not 0; only channels of the dictionary */
    uint8_t trigger_channel; /* index into the dictionary; must be in the mask */
    uint8_t slope; /* sign of the crossing that triggers; 0 RISING, 1 FALLING */
    uint8_t stream; /* preview wanted; 0 or 1 */
    /* on the trigger channel; its magnitude at most 8388607 (counts) */
    int32_t trigger_level_counts;
    uint32_t pretrigger; /* before the trigger sample; below block_length (samples) */
    uint32_t block_length; /* pre-trigger included (samples) */
} ab_configuration;

/* STATUS_REPLY, section 7. */
typedef struct {
    uint8_t state; /* section 4.1; 0 IDLE, 1 CONFIGURED, 2 RUNNING */
    uint32_t next_sequence; /* sequence number of the frame after this one */
    uint64_t next_sample; /* index the next sample will get */
    uint32_t buffered_blocks; /* complete blocks held */
    uint32_t oldest_block; /* id of the oldest of them; 0 where none is held */
    uint64_t stream_samples_dropped; /* that were not put into the preview, since START (samples) */
    /* triggers without a free buffer and blocks given up for ADC, since START */
    uint32_t triggers_missed;
    uint32_t adc_overruns; /* times the converter lost samples, since START */
} ab_board_status;

/* RESEND, section 8. */
typedef struct {
    uint32_t block_id; /* of the block */
    uint32_t first; /* offset in the block of the first sample wanted (samples) */
    uint32_t count; /* wanted; 0 asks for BLOCK_READY alone (samples) */
} ab_resend;

/* RELEASE, section 8. */
typedef struct {
    uint32_t block_id; /* of the block */
} ab_release;

/* STREAM: what stands before its counts, section 9. */
typedef struct {
    uint16_t n_samples; /* samples; 1 or more */
    uint8_t n_channels; /* channels; 1 or more */
} ab_stream_head;

/* BLOCK_READY, section 8. */
typedef struct {
    uint32_t block_id; /* of the block; 1 or more */
    uint32_t length; /* of the block (samples) */
    uint64_t first_sample; /* index of its first sample */
    uint64_t trigger_sample; /* index of the trigger sample */
    uint64_t trigger_ticks; /* clock when the trigger sample was ready (ticks) */
} ab_block_info;

/* BLOCK_DATA: what stands before its counts, section 9. */
typedef struct {
    uint16_t n_samples; /* samples; 1 or more */
    uint8_t n_channels; /* channels; 1 or more */
    uint32_t block_id; /* of the block; 1 or more */
} ab_block_data_head;

/* For a board: messages.c. False where the payload is malformed. */
void ab_write_header(uint8_t to[AB_HEADER_BYTES], const ab_header *m);
void ab_write_fragment_head(uint8_t to[AB_FRAGMENT_HEAD_BYTES], const ab_fragment_head *m);
void ab_write_board_status(uint8_t to[AB_BOARD_STATUS_BYTES], const ab_board_status *m);
void ab_write_stream_head(uint8_t to[AB_STREAM_HEAD_BYTES], const ab_stream_head *m);
void ab_write_block_info(uint8_t to[AB_BLOCK_INFO_BYTES], const ab_block_info *m);
void ab_write_block_data_head(uint8_t to[AB_BLOCK_DATA_HEAD_BYTES], const ab_block_data_head *m);
void ab_read_header(const uint8_t from[AB_HEADER_BYTES], ab_header *m);
bool ab_read_configuration(const uint8_t *from, size_t n, ab_configuration *m);
bool ab_read_resend(const uint8_t *from, size_t n, ab_resend *m);
bool ab_read_release(const uint8_t *from, size_t n, ab_release *m);
/* Whether the table of messages has a type. */
bool ab_type_known(unsigned type);
/* Whether a command of the table carries nothing. */
bool ab_command_is_bare(unsigned type);
/* Bytes of the record behind code and reason of a command's answer; 0 without one. */
size_t ab_answer_bytes(unsigned type);

/* For a host: host_messages.c. */
void ab_write_configuration(uint8_t to[AB_CONFIGURATION_BYTES], const ab_configuration *m);
void ab_write_resend(uint8_t to[AB_RESEND_BYTES], const ab_resend *m);
void ab_write_release(uint8_t to[AB_RELEASE_BYTES], const ab_release *m);
bool ab_read_fragment_head(const uint8_t *from, size_t n, ab_fragment_head *m);
bool ab_read_board_status(const uint8_t *from, size_t n, ab_board_status *m);
bool ab_read_stream_head(const uint8_t *from, size_t n, ab_stream_head *m);
bool ab_read_block_info(const uint8_t *from, size_t n, ab_block_info *m);
bool ab_read_block_data_head(const uint8_t *from, size_t n, ab_block_data_head *m);
/* The same by type, where nothing of varying length follows but a reply's reason. */
bool ab_fixed_payload_valid(unsigned type, const uint8_t *from, size_t n);

#endif
