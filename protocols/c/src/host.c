/* What a host sends and reads; not needed on a board. */
#include "armodal_host.h"

#include "internal.h"

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

bool ab_read_data(uint8_t type, const uint8_t *payload, size_t n, ab_data *data)
{
    ab_block_data_head head = {0};
    size_t size = AB_BLOCK_DATA_HEAD_BYTES;

    if (type == AB_BLOCK_DATA) {
        if (!ab_read_block_data_head(payload, n, &head))
            return false;
    } else {
        ab_stream_head stream;

        if (!ab_read_stream_head(payload, n, &stream))
            return false;
        size = AB_STREAM_HEAD_BYTES;
        head.n_samples = stream.n_samples;
        head.n_channels = stream.n_channels;
    }
    data->n_samples = head.n_samples;
    data->n_channels = head.n_channels;
    data->block_id = head.block_id;
    data->counts = payload + size;
    return n - size == 3u * head.n_samples * head.n_channels;
}

bool ab_read_piece(const uint8_t *payload, size_t n, ab_fragment_head *head)
{
    return ab_read_fragment_head(payload, n, head) && n > AB_FRAGMENT_HEAD_BYTES &&
           n - AB_FRAGMENT_HEAD_BYTES <= (size_t)head->total - head->offset;
}

bool ab_is_answer(const uint8_t *payload, size_t n)
{
    return n >= 2 && payload[0] == AB_OK && payload[1] == 0;
}

bool ab_payload_valid(unsigned type, const uint8_t *payload, size_t n)
{
    ab_fragment_head head;
    ab_data data;

    switch (type) {
    case AB_HELLO | AB_REPLY:
        return ab_read_piece(payload, n, &head);
    case AB_STREAM:
    case AB_BLOCK_DATA:
        return ab_read_data((uint8_t)type, payload, n, &data);
    default:
        return ab_fixed_payload_valid(type, payload, n);
    }
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
