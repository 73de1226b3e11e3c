/*
 * Lay out the constant array with which the board describes itself, section 5.
 *
 * A board whose array was made beforehand does not need this file.
 */
#include "internal.h"

/* IEEE 754 is assumed: a double is the eight bytes of the wire. */
typedef char ab_double_has_8_bytes[sizeof(double) == 8 ? 1 : -1];

enum { LAYOUT = 1, LARGEST = 65535 };

typedef struct {
    uint8_t *at;
    size_t left;
    bool overrun;
} writer;

static uint8_t *take(writer *to, size_t n)
{
    uint8_t *at = to->at;

    if (n > to->left) {
        to->overrun = true;
        return NULL;
    }
    to->at += n;
    to->left -= n;
    return at;
}

static void write_bytes(writer *to, const void *bytes, size_t n)
{
    uint8_t *at = take(to, n);

    if (at != NULL && n > 0)
        memcpy(at, bytes, n);
}

static void write_text(writer *to, const char *text)
{
    uint8_t length = 0;

    while (text[length] != '\0' && length < 255)
        length++;
    if (text[length] != '\0')
        to->overrun = true;
    write_bytes(to, &length, 1);
    write_bytes(to, text, length);
}

static void write_double(writer *to, double value)
{
    uint64_t bits;
    uint8_t *at = take(to, sizeof bits);

    memcpy(&bits, &value, sizeof bits);
    if (at != NULL)
        (void)ab_put_u64(at, bits);
}

static void write_channel(writer *to, const ab_channel *channel)
{
    uint8_t *size;

    write_bytes(to, &channel->iepe, 1);
    write_double(to, channel->scale);
    write_double(to, channel->full_scale);
    write_double(to, channel->highpass_hz);
    write_text(to, channel->name);
    write_text(to, channel->quantity);
    write_text(to, channel->unit);
    write_text(to, channel->serial_number);
    write_text(to, channel->calibration_date);
    size = take(to, 2);
    if (size != NULL)
        (void)ab_put_u16(size, channel->teds_size);
    write_bytes(to, channel->teds, channel->teds_size);
}

size_t ab_dictionary_encode(uint8_t *to, size_t size, const ab_dictionary *dictionary)
{
    writer all = {to, size < LARGEST ? size : LARGEST, false};
    uint8_t *head = take(&all, 14);
    ab_dictionary_head found;
    size_t length;

    if (head == NULL)
        return 0;
    head[0] = LAYOUT;
    head[1] = dictionary->n_channels;
    (void)ab_put_u32(head + 2, dictionary->link_bytes_per_s);
    (void)ab_put_u32(head + 6, dictionary->block_capacity);
    (void)ab_put_u32(head + 10, dictionary->tick_hz);
    write_double(&all, dictionary->filter_group_delay_samples);
    write_text(&all, dictionary->board_id);
    write_text(&all, dictionary->firmware);
    for (unsigned i = 0; i < dictionary->n_channels; i++)
        write_channel(&all, &dictionary->channels[i]);
    length = (size_t)(all.at - to);
    return !all.overrun && ab_dictionary_check(to, length, &found) ? length : 0;
}
