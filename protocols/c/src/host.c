/* What a host sends and reads; not needed on a board. */
#include "armodal_host.h"

#include "internal.h"

void ab_write_configuration(uint8_t to[28], const ab_configuration *wanted)
{
    (void)ab_put_u32(to, wanted->rate_numerator);
    (void)ab_put_u32(to + 4, wanted->rate_denominator);
    (void)ab_put_u32(to + 8, wanted->channel_mask);
    to[12] = wanted->trigger_channel;
    to[13] = wanted->falling;
    to[14] = wanted->stream;
    to[15] = 0;
    (void)ab_put_u32(to + 16, (uint32_t)wanted->trigger_level);
    (void)ab_put_u32(to + 20, wanted->pretrigger);
    (void)ab_put_u32(to + 24, wanted->block_length);
}

void ab_write_range(uint8_t to[12], const ab_range *range)
{
    (void)ab_put_u32(to, range->block_id);
    (void)ab_put_u32(to + 4, range->first);
    (void)ab_put_u32(to + 8, range->count);
}

void ab_write_block_id(uint8_t to[4], uint32_t id)
{
    (void)ab_put_u32(to, id);
}

bool ab_read_reply(const uint8_t *payload, size_t n, uint8_t *code, const uint8_t **reason,
                   size_t *reason_size)
{
    if (n < 2 || payload[0] > AB_WRONG_SESSION || payload[1] > n - 2)
        return false;
    *code = payload[0];
    *reason = payload + 2;
    *reason_size = payload[1];
    return ab_is_utf8(*reason, *reason_size);
}

bool ab_read_status(const uint8_t *payload, size_t n, ab_status *status)
{
    if (n != AB_STATUS_BYTES || payload[0] != AB_OK || payload[1] != 0)
        return false;
    status->state = payload[2];
    status->next_sequence = ab_get_u32(payload + 3);
    status->next_sample = ab_get_u64(payload + 7);
    status->buffered_blocks = ab_get_u32(payload + 15);
    status->oldest_block = ab_get_u32(payload + 19);
    status->stream_samples_dropped = ab_get_u64(payload + 23);
    status->triggers_missed = ab_get_u32(payload + 31);
    status->adc_overruns = ab_get_u32(payload + 35);
    return status->state <= AB_RUNNING;
}

bool ab_read_block_info(const uint8_t *payload, size_t n, ab_block_info *info)
{
    if (n != AB_BLOCK_INFO_BYTES)
        return false;
    info->block_id = ab_get_u32(payload);
    info->length = ab_get_u32(payload + 4);
    info->first_sample = ab_get_u64(payload + 8);
    info->trigger_sample = ab_get_u64(payload + 16);
    info->trigger_ticks = ab_get_u64(payload + 24);
    return info->block_id != 0 && info->trigger_sample >= info->first_sample &&
           info->trigger_sample - info->first_sample < info->length;
}

bool ab_read_data(uint8_t type, const uint8_t *payload, size_t n, ab_data *data)
{
    const size_t prefix = type == AB_BLOCK_DATA ? 8 : 4;

    if (n < prefix || payload[3] != 3)
        return false;
    data->n_samples = ab_get_u16(payload);
    data->n_channels = payload[2];
    data->block_id = type == AB_BLOCK_DATA ? ab_get_u32(payload + 4) : 0;
    data->counts = payload + prefix;
    if (data->n_samples == 0 || data->n_channels == 0)
        return false;
    if (type == AB_BLOCK_DATA && data->block_id == 0)
        return false;
    return n - prefix == 3u * data->n_samples * data->n_channels;
}

bool ab_read_fragment(const uint8_t *payload, size_t n, uint16_t *total, uint16_t *offset)
{
    if (n < 5)
        return false;
    *total = ab_get_u16(payload);
    *offset = ab_get_u16(payload + 2);
    return *offset + (n - 4) <= *total;
}

static const uint8_t *after_text(const uint8_t *text)
{
    return text + 1 + *text;
}

bool ab_dictionary_channel(const uint8_t *dictionary, unsigned index, ab_channel_view *channel)
{
    const uint8_t *at = after_text(after_text(dictionary + 22));

    if (index >= dictionary[1])
        return false;
    for (unsigned i = 0; i <= index; i++) {
        channel->iepe = at[0];
        channel->scale = ab_get_u64(at + 1);
        channel->full_scale = ab_get_u64(at + 9);
        channel->highpass_hz = ab_get_u64(at + 17);
        at += 25;
        for (unsigned k = 0; k < 5; k++) {
            channel->texts[k] = at;
            at = after_text(at);
        }
        channel->teds_size = ab_get_u16(at);
        channel->teds = at + 2;
        at += 2u + channel->teds_size;
    }
    return true;
}

int64_t ab_sequence_gap(uint32_t expected, uint32_t sequence)
{
    const uint32_t gap = sequence - expected;

    return gap < 0x80000000u ? (int64_t)gap : (int64_t)gap - 0x100000000;
}
