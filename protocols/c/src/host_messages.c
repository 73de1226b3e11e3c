/* Made by `python -m armodal.protocols.board.generate`; change records.py instead. */
/* Fixed fields of the messages as a host reads and writes them. */
#include "armodal_host.h"

#include "internal.h"

void ab_write_configuration(uint8_t to[AB_CONFIGURATION_BYTES], const ab_configuration *m)
{
    (void)ab_put_u32(to, m->rate_hz_numerator);
    (void)ab_put_u32(to + 4, m->rate_hz_denominator);
    (void)ab_put_u32(to + 8, m->channel_mask);
    to[12] = m->trigger_channel;
    to[13] = m->slope;
    to[14] = m->stream;
    to[15] = 0;
    (void)ab_put_u32(to + 16, (uint32_t)m->trigger_level_counts);
    (void)ab_put_u32(to + 20, m->pretrigger);
    (void)ab_put_u32(to + 24, m->block_length);
}

void ab_write_resend(uint8_t to[AB_RESEND_BYTES], const ab_resend *m)
{
    (void)ab_put_u32(to, m->block_id);
    (void)ab_put_u32(to + 4, m->first);
    (void)ab_put_u32(to + 8, m->count);
}

void ab_write_release(uint8_t to[AB_RELEASE_BYTES], const ab_release *m)
{
    (void)ab_put_u32(to, m->block_id);
}

bool ab_read_fragment_head(const uint8_t *from, size_t n, ab_fragment_head *m)
{
    if (n < AB_FRAGMENT_HEAD_BYTES)
        return false;
    m->total = ab_get_u16(from);
    m->offset = ab_get_u16(from + 2);
    return m->total != 0 &&
           m->offset < m->total;
}

bool ab_read_board_status(const uint8_t *from, size_t n, ab_board_status *m)
{
    if (n != AB_BOARD_STATUS_BYTES)
        return false;
    m->state = from[0];
    m->next_sequence = ab_get_u32(from + 1);
    m->next_sample = ab_get_u64(from + 5);
    m->buffered_blocks = ab_get_u32(from + 13);
    m->oldest_block = ab_get_u32(from + 17);
    m->stream_samples_dropped = ab_get_u64(from + 21);
    m->triggers_missed = ab_get_u32(from + 29);
    m->adc_overruns = ab_get_u32(from + 33);
    return m->state <= 2;
}

bool ab_read_stream_head(const uint8_t *from, size_t n, ab_stream_head *m)
{
    if (n < AB_STREAM_HEAD_BYTES)
        return false;
    m->n_samples = ab_get_u16(from);
    m->n_channels = from[2];
    return m->n_samples != 0 &&
           m->n_channels != 0 &&
           from[3] == 3;
}

bool ab_read_block_info(const uint8_t *from, size_t n, ab_block_info *m)
{
    if (n != AB_BLOCK_INFO_BYTES)
        return false;
    m->block_id = ab_get_u32(from);
    m->length = ab_get_u32(from + 4);
    m->first_sample = ab_get_u64(from + 8);
    m->trigger_sample = ab_get_u64(from + 16);
    m->trigger_ticks = ab_get_u64(from + 24);
    return m->block_id != 0 &&
           m->trigger_sample - m->first_sample < m->length;
}

bool ab_read_block_data_head(const uint8_t *from, size_t n, ab_block_data_head *m)
{
    if (n < AB_BLOCK_DATA_HEAD_BYTES)
        return false;
    m->n_samples = ab_get_u16(from);
    m->n_channels = from[2];
    m->block_id = ab_get_u32(from + 4);
    return m->n_samples != 0 &&
           m->n_channels != 0 &&
           from[3] == 3 &&
           m->block_id != 0;
}

bool ab_fixed_payload_valid(unsigned type, const uint8_t *from, size_t n)
{
    const uint8_t *reason;
    size_t size;
    uint8_t code;

    switch (type) {
    case AB_HELLO:
        return n == 0;
    case AB_CONFIGURE: {
        ab_configuration configuration;

        return ab_read_configuration(from, n, &configuration);
    }
    case AB_CONFIGURE | AB_REPLY:
        return ab_read_reply(from, n, &code, &reason, &size);
    case AB_START:
        return n == 0;
    case AB_START | AB_REPLY:
        return ab_read_reply(from, n, &code, &reason, &size);
    case AB_STOP:
        return n == 0;
    case AB_STOP | AB_REPLY:
        return ab_read_reply(from, n, &code, &reason, &size);
    case AB_STATUS:
        return n == 0;
    case AB_STATUS | AB_REPLY: {
        ab_board_status board_status;

        return ab_is_answer(from, n) && ab_read_board_status(from + 2, n - 2, &board_status);
    }
    case AB_RESEND: {
        ab_resend resend;

        return ab_read_resend(from, n, &resend);
    }
    case AB_RESEND | AB_REPLY:
        return ab_read_reply(from, n, &code, &reason, &size);
    case AB_RELEASE: {
        ab_release release;

        return ab_read_release(from, n, &release);
    }
    case AB_RELEASE | AB_REPLY:
        return ab_read_reply(from, n, &code, &reason, &size);
    case AB_BLOCK_READY: {
        ab_block_info block_info;

        return ab_read_block_info(from, n, &block_info);
    }
    default:
        return false;
    }
}
