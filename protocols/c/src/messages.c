/* Payloads as the board reads and writes them, sections 6 to 9. */
#include "internal.h"

bool ab_read_configuration(const uint8_t *payload, size_t n, ab_configuration *wanted)
{
    if (n != 28)
        return false;
    wanted->rate_numerator = ab_get_u32(payload);
    wanted->rate_denominator = ab_get_u32(payload + 4);
    wanted->channel_mask = ab_get_u32(payload + 8);
    wanted->trigger_channel = payload[12];
    wanted->falling = payload[13];
    wanted->stream = payload[14];
    wanted->trigger_level = (int32_t)ab_get_u32(payload + 16);
    wanted->pretrigger = ab_get_u32(payload + 20);
    wanted->block_length = ab_get_u32(payload + 24);
    return wanted->rate_numerator != 0 && wanted->rate_denominator != 0 &&
           wanted->falling <= 1 && wanted->stream <= 1 && payload[15] == 0;
}

bool ab_read_range(const uint8_t *payload, size_t n, ab_range *range)
{
    if (n != 12)
        return false;
    range->block_id = ab_get_u32(payload);
    range->first = ab_get_u32(payload + 4);
    range->count = ab_get_u32(payload + 8);
    return true;
}

bool ab_read_block_id(const uint8_t *payload, size_t n, uint32_t *id)
{
    if (n != 4)
        return false;
    *id = ab_get_u32(payload);
    return true;
}

void ab_write_status(uint8_t to[AB_STATUS_BYTES], const ab_status *status)
{
    to[0] = AB_OK;
    to[1] = 0;
    to[2] = status->state;
    (void)ab_put_u32(to + 3, status->next_sequence);
    (void)ab_put_u64(to + 7, status->next_sample);
    (void)ab_put_u32(to + 15, status->buffered_blocks);
    (void)ab_put_u32(to + 19, status->oldest_block);
    (void)ab_put_u64(to + 23, status->stream_samples_dropped);
    (void)ab_put_u32(to + 31, status->triggers_missed);
    (void)ab_put_u32(to + 35, status->adc_overruns);
}

void ab_write_block_info(uint8_t to[AB_BLOCK_INFO_BYTES], const ab_block_info *info)
{
    (void)ab_put_u32(to, info->block_id);
    (void)ab_put_u32(to + 4, info->length);
    (void)ab_put_u64(to + 8, info->first_sample);
    (void)ab_put_u64(to + 16, info->trigger_sample);
    (void)ab_put_u64(to + 24, info->trigger_ticks);
}

size_t ab_write_data_prefix(uint8_t to[8], uint16_t n_samples, uint8_t n_channels,
                            uint32_t block_id)
{
    (void)ab_put_u16(to, n_samples);
    to[2] = n_channels;
    to[3] = 3;
    if (block_id == 0)
        return 4;
    (void)ab_put_u32(to + 4, block_id);
    return 8;
}

uint8_t *ab_write_count(uint8_t *to, int32_t count)
{
    uint32_t bits;

    count = count > 8388607 ? 8388607 : count < -8388608 ? -8388608 : count;
    bits = (uint32_t)count;
    to[0] = (uint8_t)bits;
    to[1] = (uint8_t)(bits >> 8);
    to[2] = (uint8_t)(bits >> 16);
    return to + 3;
}
