/* What a board must refuse, and the reason with both numbers, section 6. */
#include "internal.h"

enum { NOMINAL_SAMPLES = 64, LARGEST_COUNT = 8388607, TRANSFER_LIMIT_S = 10 };

uint8_t ab_n_columns(uint32_t channel_mask)
{
    uint8_t n = 0;

    for (; channel_mask != 0; channel_mask &= channel_mask - 1)
        n++;
    return n;
}

uint16_t ab_frame_samples(uint8_t n_columns)
{
    const unsigned fit = (AB_MAX_PAYLOAD - 8u) / (3u * n_columns);

    return (uint16_t)(fit < NOMINAL_SAMPLES ? fit : NOMINAL_SAMPLES);
}

uint32_t ab_sample_bytes(const ab_board *board)
{
    return 3u * board->n_columns;
}

static ab_code bad_value(const ab_configuration *wanted, uint8_t n_channels, ab_text *reason)
{
    const uint32_t mask = wanted->channel_mask;
    const int32_t level = wanted->trigger_level_counts;

    if (mask == 0 || (n_channels < 32 && mask >> n_channels != 0)) {
        ab_text_add(reason, "channel mask ");
        ab_text_hex(reason, mask);
        ab_text_say(reason, " must name some of the channels and no other; there are ", n_channels);
    } else if (wanted->trigger_channel >= n_channels || !(mask >> wanted->trigger_channel & 1)) {
        ab_text_say(reason, "trigger channel ", wanted->trigger_channel);
        ab_text_add(reason, " is not in channel mask ");
        ab_text_hex(reason, mask);
    } else if (level < -LARGEST_COUNT || level > LARGEST_COUNT) {
        ab_text_add(reason, "trigger level ");
        ab_text_signed(reason, level);
        ab_text_add(reason, " counts is outside -8388607...8388607");
    } else if (wanted->pretrigger >= wanted->block_length) {
        ab_text_say(reason, "pre-trigger ", wanted->pretrigger);
        ab_text_say(reason, " must be shorter than the block of ", wanted->block_length);
        ab_text_add(reason, " samples");
    } else {
        return AB_OK;
    }
    return AB_BAD_VALUE;
}

ab_code ab_refusal(const ab_configuration *wanted, const ab_dictionary_head *head, ab_text *reason)
{
    const uint8_t columns = ab_n_columns(wanted->channel_mask);
    uint32_t n, left;
    uint64_t bytes, frame, wire, per_numerator;
    const uint32_t link = head->link_bytes_per_s;

    if (bad_value(wanted, head->n_channels, reason) != AB_OK)
        return AB_BAD_VALUE;
    bytes = (uint64_t)wanted->block_length * (3u * columns);
    if (bytes > head->block_capacity) {
        ab_text_say(reason, "", wanted->block_length);
        ab_text_say(reason, " samples x ", columns);
        ab_text_say(reason, " channels x 3 B = ", bytes);
        ab_text_say(reason, " B, block buffer ", head->block_capacity);
        ab_text_add(reason, " B");
        return AB_CAPACITY;
    }
    n = ab_frame_samples(columns);
    /* rate / n * frame > link, without a fraction: a > link * b where (a - 1) / b >= link. */
    frame = AB_WIRE_BYTES(4u + 3u * columns * n);
    per_numerator = wanted->rate_hz_numerator * frame;
    if (wanted->stream && (per_numerator - 1) / ((uint64_t)wanted->rate_hz_denominator * n) >= link) {
        ab_text_say(reason, "stream takes ",
                    per_numerator / ((uint64_t)wanted->rate_hz_denominator * n));
        ab_text_say(reason, " B/s, link ", link);
        ab_text_add(reason, " B/s");
        return AB_LINK;
    }
    left = wanted->block_length % n;
    wire = (uint64_t)(wanted->block_length / n) * AB_WIRE_BYTES(8u + 3u * columns * n);
    wire += left == 0 ? 0 : AB_WIRE_BYTES(8u + 3u * columns * left);
    if (wire > (uint64_t)TRANSFER_LIMIT_S * link) {
        ab_text_say(reason, "block takes ", wire);
        ab_text_say(reason, " B on the wire, link ", link);
        ab_text_add(reason, " B/s: longer than 10 s");
        return AB_LINK;
    }
    return AB_OK;
}

ab_code ab_limits(const ab_configuration *wanted, const ab_dictionary_head *head,
                  char reason[AB_REASON_BYTES])
{
    ab_text text = ab_text_begin(reason, AB_REASON_BYTES);

    return ab_refusal(wanted, head, &text);
}
