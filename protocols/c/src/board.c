/* The board: boot, and the four functions its main loop calls. */
#include "internal.h"

ab_init_result ab_set_dictionary(ab_board *board, const uint8_t *dictionary,
                                 uint16_t dictionary_size)
{
    ab_dictionary_head head;

    if (!ab_dictionary_check(dictionary, dictionary_size, &head) ||
        (board->dictionary != NULL && head.n_channels != board->head.n_channels))
        return AB_INIT_DICTIONARY;
    if (head.block_capacity > board->config->block_buffer_size)
        return AB_INIT_BUFFERS;
    board->head = head;
    board->dictionary = dictionary;
    board->dictionary_size = dictionary_size;
    board->dictionary_hash = (uint16_t)ab_crc32(0, dictionary, dictionary_size);
    board->greeting = false; /* two dictionaries must not mix: the host asks again */
    return AB_INIT_OK;
}

ab_init_result ab_init(ab_board *board, const ab_config *config, const uint8_t *dictionary,
                       uint16_t dictionary_size, uint32_t session)
{
    ab_init_result result;
    unsigned channels;

    memset(board, 0, sizeof *board);
    board->config = config;
    board->session = session;
    board->receiver.buffer = config->receive;
    board->receiver.size = config->receive_size;
    result = ab_set_dictionary(board, dictionary, dictionary_size);
    if (result != AB_INIT_OK)
        return result;
    channels = board->head.n_channels;
    if (config->n_blocks == 0 || config->receive_size < AB_RECEIVE_BYTES ||
        config->transmit_size < AB_TRANSMIT_BYTES(channels) ||
        config->preview_size < AB_PREVIEW_BYTES(channels, 1u))
        return AB_INIT_BUFFERS;
    ab_forget_all_blocks(board);
    return AB_INIT_OK;
}

size_t ab_receive(ab_board *board, const uint8_t *bytes, size_t n)
{
    size_t used = 0;

    while (used < n && board->command == 0) {
        used += ab_receiver_take(&board->receiver, bytes + used, n - used, &board->command);
        if (board->command != 0)
            (void)ab_poll(board);
    }
    return used;
}

void ab_samples(ab_board *board, const int32_t *counts, uint32_t n, uint64_t ticks)
{
    uint8_t packed[3 * AB_MAX_CHANNELS];
    const uint32_t mask = board->wanted.channel_mask;

    for (uint32_t i = 0; i < n && board->state == AB_RUNNING; i++) {
        const uint64_t ready = ticks + ab_ticks_of(board, i);
        uint8_t *at = packed;

        for (unsigned channel = 0; channel < board->head.n_channels; channel++)
            if (mask >> channel & 1)
                at = ab_write_count(at, counts[channel]);
        if (board->wanted.stream)
            ab_preview_sample(board, packed, ready);
        ab_capture_sample(board, packed, counts[board->wanted.trigger_channel], ready);
        counts += board->head.n_channels;
    }
}

void ab_lost(ab_board *board, uint32_t n)
{
    if (board->state != AB_RUNNING || n == 0)
        return;
    ab_preview_end_frame(board);
    ab_capture_lost(board, n);
}

bool ab_poll(ab_board *board)
{
    while (ab_flush(board) && ab_answer(board)) {
    }
    ab_send_data(board);
    return board->transmit_at < board->transmit_end;
}
