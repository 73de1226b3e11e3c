/*
 * The preview, section 10: a ring of frames that wait for the link, dropped whole where it is
 * full. A frame in the ring: its length, its first sample, its ticks, its counts.
 */
#include "internal.h"

enum { RECORD_BYTES = 18, LATEST_PER_S = 50 /* no sample is held back longer than 20 ms */ };

static uint8_t *frame_at(const ab_board *board, unsigned place)
{
    const unsigned i = (board->preview_head + place) % board->preview_slots;

    return board->config->preview +
           i * (RECORD_BYTES + (size_t)board->preview_wanted * ab_sample_bytes(board));
}

void ab_preview_start(ab_board *board)
{
    const uint16_t full = ab_frame_samples(board->n_columns);
    const uint64_t n = board->wanted.rate_hz_numerator /
                       ((uint64_t)board->wanted.rate_hz_denominator * LATEST_PER_S);
    size_t slots;

    board->preview_wanted = n < 1 ? 1 : n < full ? (uint16_t)n : full;
    slots = board->config->preview_size /
            (RECORD_BYTES + (size_t)board->preview_wanted * ab_sample_bytes(board));
    board->preview_slots = (uint16_t)(slots < UINT16_MAX ? slots : UINT16_MAX);
    board->preview_head = 0;
    board->preview_count = 0;
    board->preview_gathered = 0;
    board->stream_dropped = 0;
}

void ab_preview_sample(ab_board *board, const uint8_t *packed, uint64_t ticks)
{
    const uint32_t sample_bytes = ab_sample_bytes(board);

    if (board->preview_gathered == 0) {
        /* An answer that waits goes first, so the link is only tried where none does. */
        if (board->preview_count == board->preview_slots && !board->greeting &&
            board->command == 0)
            ab_send_data(board);
        board->preview_dropping = board->preview_count == board->preview_slots;
        if (!board->preview_dropping) {
            uint8_t *record = frame_at(board, board->preview_count);

            (void)ab_put_u64(ab_put_u64(record + 2, board->next_sample), ticks);
        }
    }
    if (!board->preview_dropping)
        memcpy(frame_at(board, board->preview_count) + RECORD_BYTES +
                   board->preview_gathered * (size_t)sample_bytes,
               packed, sample_bytes);
    if (++board->preview_gathered == board->preview_wanted)
        ab_preview_end_frame(board);
}

/* Let the frame go as it is, though it may not be full. */
void ab_preview_end_frame(ab_board *board)
{
    if (board->preview_gathered == 0)
        return;
    if (board->preview_dropping) {
        board->stream_dropped += board->preview_gathered;
        board->overflow |= AB_OVERFLOW_STREAM;
    } else {
        (void)ab_put_u16(frame_at(board, board->preview_count), board->preview_gathered);
        board->preview_count++;
    }
    board->preview_gathered = 0;
}

/* Compose the oldest frame that waits; false where none does. */
bool ab_preview_send(ab_board *board)
{
    const uint8_t *record;
    uint8_t prefix[AB_STREAM_HEAD_BYTES];
    ab_stream_head head;
    ab_piece pieces[2];
    ab_header header = {0};
    uint16_t n;

    if (board->preview_count == 0)
        return false;
    record = frame_at(board, 0);
    n = ab_get_u16(record);
    head.n_samples = n;
    head.n_channels = board->n_columns;
    ab_write_stream_head(prefix, &head);
    pieces[0].bytes = prefix;
    pieces[0].n = sizeof prefix;
    pieces[1].bytes = record + RECORD_BYTES;
    pieces[1].n = (size_t)n * ab_sample_bytes(board);
    header.type = AB_STREAM;
    header.first_sample = ab_get_u64(record + 2);
    header.ticks = ab_get_u64(record + 10);
    ab_compose(board, &header, pieces, 2);
    board->preview_head = (uint16_t)((board->preview_head + 1u) % board->preview_slots);
    board->preview_count--;
    return true;
}
