/* Made by `python -m armodal.protocols.board.generate`; change records.py instead. */
/* Fixed fields of the messages as a board reads and writes them. */
#include "internal.h"

void ab_write_header(uint8_t to[AB_HEADER_BYTES], const ab_header *m)
{
    to[0] = m->version;
    to[1] = m->type;
    (void)ab_put_u16(to + 2, m->dictionary_hash);
    (void)ab_put_u32(to + 4, m->session);
    (void)ab_put_u32(to + 8, m->sequence);
    (void)ab_put_u16(to + 12, m->overflow);
    (void)ab_put_u16(to + 14, m->tag);
    (void)ab_put_u64(to + 16, m->first_sample);
    (void)ab_put_u64(to + 24, m->ticks);
}

void ab_write_fragment_head(uint8_t to[AB_FRAGMENT_HEAD_BYTES], const ab_fragment_head *m)
{
    (void)ab_put_u16(to, m->total);
    (void)ab_put_u16(to + 2, m->offset);
}

void ab_write_board_status(uint8_t to[AB_BOARD_STATUS_BYTES], const ab_board_status *m)
{
    to[0] = m->state;
    (void)ab_put_u32(to + 1, m->next_sequence);
    (void)ab_put_u64(to + 5, m->next_sample);
    (void)ab_put_u32(to + 13, m->buffered_blocks);
    (void)ab_put_u32(to + 17, m->oldest_block);
    (void)ab_put_u64(to + 21, m->stream_samples_dropped);
    (void)ab_put_u32(to + 29, m->triggers_missed);
    (void)ab_put_u32(to + 33, m->adc_overruns);
}

void ab_write_stream_head(uint8_t to[AB_STREAM_HEAD_BYTES], const ab_stream_head *m)
{
    (void)ab_put_u16(to, m->n_samples);
    to[2] = m->n_channels;
    to[3] = 3;
}

void ab_write_block_info(uint8_t to[AB_BLOCK_INFO_BYTES], const ab_block_info *m)
{
    (void)ab_put_u32(to, m->block_id);
    (void)ab_put_u32(to + 4, m->length);
    (void)ab_put_u64(to + 8, m->first_sample);
    (void)ab_put_u64(to + 16, m->trigger_sample);
    (void)ab_put_u64(to + 24, m->trigger_ticks);
}

void ab_write_block_data_head(uint8_t to[AB_BLOCK_DATA_HEAD_BYTES], const ab_block_data_head *m)
{
    (void)ab_put_u16(to, m->n_samples);
    to[2] = m->n_channels;
    to[3] = 3;
    (void)ab_put_u32(to + 4, m->block_id);
}

void ab_read_header(const uint8_t from[AB_HEADER_BYTES], ab_header *m)
{
    m->version = from[0];
    m->type = from[1];
    m->dictionary_hash = ab_get_u16(from + 2);
    m->session = ab_get_u32(from + 4);
    m->sequence = ab_get_u32(from + 8);
    m->overflow = ab_get_u16(from + 12);
    m->tag = ab_get_u16(from + 14);
    m->first_sample = ab_get_u64(from + 16);
    m->ticks = ab_get_u64(from + 24);
}

bool ab_read_configuration(const uint8_t *from, size_t n, ab_configuration *m)
{
    if (n != AB_CONFIGURATION_BYTES)
        return false;
    m->rate_hz_numerator = ab_get_u32(from);
    m->rate_hz_denominator = ab_get_u32(from + 4);
    m->channel_mask = ab_get_u32(from + 8);
    m->trigger_channel = from[12];
    m->slope = from[13];
    m->stream = from[14];
    m->trigger_level_counts = (int32_t)ab_get_u32(from + 16);
    m->pretrigger = ab_get_u32(from + 20);
    m->block_length = ab_get_u32(from + 24);
    return m->rate_hz_numerator != 0 &&
           m->rate_hz_denominator != 0 &&
           m->slope <= 1 &&
           m->stream <= 1 &&
           from[15] == 0;
}

bool ab_read_resend(const uint8_t *from, size_t n, ab_resend *m)
{
    if (n != AB_RESEND_BYTES)
        return false;
    m->block_id = ab_get_u32(from);
    m->first = ab_get_u32(from + 4);
    m->count = ab_get_u32(from + 8);
    return true;
}

bool ab_read_release(const uint8_t *from, size_t n, ab_release *m)
{
    if (n != AB_RELEASE_BYTES)
        return false;
    m->block_id = ab_get_u32(from);
    return true;
}

bool ab_type_known(unsigned type)
{
    switch (type) {
    case AB_HELLO:
    case AB_HELLO | AB_REPLY:
    case AB_CONFIGURE:
    case AB_CONFIGURE | AB_REPLY:
    case AB_START:
    case AB_START | AB_REPLY:
    case AB_STOP:
    case AB_STOP | AB_REPLY:
    case AB_STATUS:
    case AB_STATUS | AB_REPLY:
    case AB_RESEND:
    case AB_RESEND | AB_REPLY:
    case AB_RELEASE:
    case AB_RELEASE | AB_REPLY:
    case AB_STREAM:
    case AB_BLOCK_READY:
    case AB_BLOCK_DATA:
        return true;
    default:
        return false;
    }
}

bool ab_command_is_bare(unsigned type)
{
    switch (type) {
    case AB_HELLO:
    case AB_START:
    case AB_STOP:
    case AB_STATUS:
        return true;
    default:
        return false;
    }
}

size_t ab_answer_bytes(unsigned type)
{
    switch (type) {
    case AB_STATUS:
        return AB_BOARD_STATUS_BYTES;
    default:
        return 0;
    }
}
