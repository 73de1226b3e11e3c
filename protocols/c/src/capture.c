/*
 * Trigger, pre-trigger and blocks, section 8.
 *
 * The block buffer is cut into slots of one block each. Samples go round in one free slot until
 * the trigger comes, so that the slot already holds the pre-trigger; then the slot is filled to
 * its length and the block stands in it, beginning at `oldest`. The next free slot is given the
 * end of the block as its own pre-trigger. No memory is needed beside the slots.
 *
 * While all slots are held, samples go nowhere. After a RELEASE the pre-trigger has to be
 * gathered anew: a crossing before that has no block buffer and is counted as missed.
 */
#include "internal.h"

uint8_t *ab_slot(const ab_board *board, uint32_t slot)
{
    return board->config->block_buffer +
           (size_t)slot * board->wanted.block_length * ab_sample_bytes(board);
}

ab_block *ab_find_block(const ab_board *board, uint32_t id)
{
    if (id != 0)
        for (uint32_t i = 0; i < board->n_slots; i++)
            if (board->config->blocks[i].id == id)
                return &board->config->blocks[i];
    return NULL;
}

/* Ticks that n samples last; the rest is carried exactly, however long the run. */
uint64_t ab_ticks_of(const ab_board *board, uint32_t n_samples)
{
    return n_samples * board->ticks_whole +
           (uint64_t)n_samples * board->ticks_rest / board->wanted.rate_hz_numerator;
}

void ab_capture_configure(ab_board *board)
{
    const ab_configuration *wanted = &board->wanted;
    const uint64_t ticks = (uint64_t)board->head.tick_hz * wanted->rate_hz_denominator;
    uint32_t fit;

    board->n_columns = ab_n_columns(wanted->channel_mask);
    fit = board->head.block_capacity / (wanted->block_length * ab_sample_bytes(board));
    board->n_slots = fit < board->config->n_blocks ? fit : board->config->n_blocks;
    board->ticks_whole = ticks / wanted->rate_hz_numerator;
    board->ticks_rest = (uint32_t)(ticks % wanted->rate_hz_numerator);
}

void ab_capture_start(ab_board *board)
{
    ab_capture_stop(board);
    board->next_sample = 0;
    board->armed_from = board->wanted.pretrigger;
    board->has_last = false;
    board->triggers_missed = 0;
    board->adc_overruns = 0;
}

void ab_capture_stop(ab_board *board)
{
    board->slot = board->n_slots;
    board->slot_left = 0;
}

/* Let samples go to a slot that holds no block, if there is one. */
static void take_free_slot(ab_board *board)
{
    board->slot_at = 0;
    board->slot_valid = 0;
    for (board->slot = 0; board->slot < board->n_slots; board->slot++)
        if (board->config->blocks[board->slot].id == 0)
            return;
}

static void miss(ab_board *board)
{
    board->triggers_missed++;
    board->overflow |= AB_OVERFLOW_BLOCK;
}

/* The block is complete: keep it, and begin the next slot with its end. */
static void complete(ab_board *board)
{
    const uint32_t length = board->wanted.block_length;
    const uint32_t before = board->wanted.pretrigger;
    const uint32_t sample_bytes = ab_sample_bytes(board);
    const uint8_t *from = ab_slot(board, board->slot);
    const uint32_t end = board->slot_at; /* also where the block begins */
    const uint32_t straight = before < end ? before : end;
    ab_block *block = &board->config->blocks[board->slot];

    block->id = ++board->last_block;
    block->oldest = end;
    take_free_slot(board);
    if (board->slot < board->n_slots && before > 0) {
        uint8_t *to = ab_slot(board, board->slot);
        const size_t early = (size_t)(before - straight) * sample_bytes;

        memcpy(to, from + (size_t)(length - (before - straight)) * sample_bytes, early);
        memcpy(to + early, from + (size_t)(end - straight) * sample_bytes,
               (size_t)straight * sample_bytes);
        board->slot_at = before;
        board->slot_valid = before;
    }
}

static bool crosses(const ab_board *board, int32_t count)
{
    const int32_t level = board->wanted.trigger_level_counts;

    if (!board->has_last)
        return false;
    return board->wanted.slope == AB_FALLING ? board->last_count > level && level >= count
                                 : board->last_count < level && level <= count;
}

/* The sample just taken is a trigger: open a block around it. */
static void trigger(ab_board *board, uint64_t ticks)
{
    const uint32_t length = board->wanted.block_length;
    const uint32_t before = board->wanted.pretrigger;
    const uint64_t first = board->next_sample - before;

    if (board->slot == board->n_slots || board->slot_valid <= before) {
        miss(board);
        board->armed_from = first + length;
        return;
    }
    board->config->blocks[board->slot].first_sample = first;
    board->config->blocks[board->slot].trigger_ticks = ticks;
    board->slot_left = length - before - 1;
    if (board->slot_left == 0)
        complete(board);
}

void ab_capture_sample(ab_board *board, const uint8_t *packed, int32_t count, uint64_t ticks)
{
    if (board->slot == board->n_slots)
        take_free_slot(board);
    if (board->slot < board->n_slots) {
        const uint32_t sample_bytes = ab_sample_bytes(board);

        memcpy(ab_slot(board, board->slot) + (size_t)board->slot_at * sample_bytes, packed,
               sample_bytes);
        if (++board->slot_at == board->wanted.block_length)
            board->slot_at = 0;
        if (board->slot_valid < board->wanted.block_length)
            board->slot_valid++;
    }
    if (board->slot_left > 0) {
        if (--board->slot_left == 0)
            complete(board);
    } else if (crosses(board, count) && board->next_sample >= board->armed_from) {
        trigger(board, ticks);
    }
    board->last_count = count;
    board->has_last = true;
    board->next_sample++;
}

void ab_capture_lost(ab_board *board, uint32_t n)
{
    if (board->slot_left > 0)
        miss(board);
    board->slot_left = 0;
    board->slot_valid = 0;
    board->has_last = false;
    board->next_sample += n;
    board->armed_from = board->next_sample + board->wanted.pretrigger;
    board->adc_overruns++;
    board->overflow |= AB_OVERFLOW_ADC;
}
