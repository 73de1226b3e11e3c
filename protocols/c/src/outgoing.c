/* What goes to the host: one frame at a time, blocks before the preview, section 10. */
#include "internal.h"

/* Give the frame in the transmit buffer to the link; true where the buffer is free. */
bool ab_flush(ab_board *board)
{
    const ab_port *port = &board->config->port;

    while (board->transmit_at < board->transmit_end) {
        const size_t taken =
            port->send(port->context, board->config->transmit + board->transmit_at,
                       board->transmit_end - board->transmit_at);

        if (taken == 0)
            return false;
        board->transmit_at += taken;
    }
    return true;
}

void ab_compose(ab_board *board, ab_header *header, const ab_piece *pieces, size_t n)
{
    ab_encoder encoder;

    header->version = AB_VERSION;
    header->dictionary_hash = board->dictionary_hash;
    header->session = board->session;
    header->sequence = board->sequence++;
    header->overflow = board->overflow;
    ab_encoder_begin(&encoder, board->config->transmit, board->config->transmit_size, header);
    for (size_t i = 0; i < n; i++)
        ab_encoder_add(&encoder, pieces[i].bytes, pieces[i].n);
    board->transmit_at = 0;
    board->transmit_end = ab_encoder_end(&encoder);
}

void ab_compose_now(ab_board *board, uint8_t type, uint16_t tag, const uint8_t *payload, size_t n)
{
    const ab_port *port = &board->config->port;
    const ab_piece piece = {payload, n};
    ab_header header = {0};

    header.type = type;
    header.tag = tag;
    header.ticks = port->ticks(port->context);
    ab_compose(board, &header, &piece, 1);
}

/* Choose what is sent next: complete blocks in their order, then what was asked for again. */
static bool choose_range(ab_board *board)
{
    const ab_block *oldest = NULL;

    for (uint32_t i = 0; i < board->n_slots; i++) {
        const ab_block *block = &board->config->blocks[i];

        if (block->id > board->last_sent && (oldest == NULL || block->id < oldest->id))
            oldest = block;
    }
    if (oldest != NULL) {
        board->last_sent = oldest->id;
        board->sending.block_id = oldest->id;
        board->sending.first = 0;
        board->sending.count = board->wanted.block_length;
    } else if (board->n_resend > 0) {
        board->sending = board->resend[0];
        board->n_resend--;
        for (unsigned i = 0; i < board->n_resend; i++)
            board->resend[i] = board->resend[i + 1];
    } else {
        return false;
    }
    board->announce = true;
    return true;
}

static void compose_ready(ab_board *board, const ab_block *block)
{
    uint8_t payload[AB_BLOCK_INFO_BYTES];
    const ab_block_info info = {
        block->id,
        board->wanted.block_length,
        block->first_sample,
        block->first_sample + board->wanted.pretrigger,
        block->trigger_ticks,
    };

    ab_write_block_info(payload, &info);
    ab_compose_now(board, AB_BLOCK_READY, 0, payload, sizeof payload);
}

/* Compose the first frame of the range in hand, straight from the block, and shorten it. */
static void compose_block_data(ab_board *board, const ab_block *block)
{
    const uint32_t length = board->wanted.block_length;
    const uint32_t before = board->wanted.pretrigger;
    const uint32_t sample_bytes = ab_sample_bytes(board);
    const uint8_t *counts = ab_slot(board, (uint32_t)(block - board->config->blocks));
    const uint32_t most = ab_frame_samples(board->n_columns);
    const uint32_t first = board->sending.first;
    const uint32_t n = board->sending.count < most ? board->sending.count : most;
    /* The block stands in its buffer as in a ring: it may begin anew at the buffer's start. */
    const uint32_t to_end = length - block->oldest;
    const uint32_t at = first < to_end ? block->oldest + first : first - to_end;
    const uint32_t straight = n < length - at ? n : length - at;
    uint8_t prefix[AB_BLOCK_DATA_HEAD_BYTES];
    const ab_block_data_head head = {(uint16_t)n, board->n_columns, block->id};
    const ab_piece pieces[3] = {
        {prefix, sizeof prefix},
        {counts + (size_t)at * sample_bytes, (size_t)straight * sample_bytes},
        {counts, (size_t)(n - straight) * sample_bytes},
    };
    ab_header header = {0};

    ab_write_block_data_head(prefix, &head);
    header.type = AB_BLOCK_DATA;
    header.first_sample = block->first_sample + first;
    header.ticks = first < before ? block->trigger_ticks - ab_ticks_of(board, before - first)
                                  : block->trigger_ticks + ab_ticks_of(board, first - before);
    ab_compose(board, &header, pieces, 3);
    board->sending.first += n;
    board->sending.count -= n;
}

static bool compose_block(ab_board *board)
{
    const ab_block *block;

    if (board->sending.block_id == 0 && !choose_range(board))
        return false;
    block = ab_find_block(board, board->sending.block_id);
    if (block == NULL) { /* cannot be: ab_forget_block ends the range as well */
        board->sending.block_id = 0;
        return false;
    }
    if (board->announce) {
        board->announce = false;
        compose_ready(board, block);
    } else {
        compose_block_data(board, block);
    }
    if (board->sending.count == 0)
        board->sending.block_id = 0;
    return true;
}

void ab_send_data(ab_board *board)
{
    while (ab_flush(board) && (compose_block(board) || ab_preview_send(board))) {
    }
}

/* Free a block's buffer and take back what is queued of it; any id is allowed. */
void ab_forget_block(ab_board *board, uint32_t id)
{
    ab_block *block = ab_find_block(board, id);
    uint8_t kept = 0;

    if (block != NULL)
        block->id = 0;
    if (board->sending.block_id == id)
        board->sending.block_id = 0;
    for (unsigned i = 0; i < board->n_resend; i++)
        if (board->resend[i].block_id != id)
            board->resend[kept++] = board->resend[i];
    board->n_resend = kept;
}

void ab_forget_all_blocks(ab_board *board)
{
    for (uint32_t i = 0; i < board->config->n_blocks; i++)
        board->config->blocks[i].id = 0;
    board->sending.block_id = 0;
    board->n_resend = 0;
}
