/* Whether a dictionary is one that a host accepts, section 5. */
#include "internal.h"

enum { LAYOUT = 1, HEAD_BYTES = 22, CHANNEL_BYTES = 25, LARGEST = 65535 };

/* A cursor that never goes past the end, and is at NULL once it would have. */
typedef struct {
    const uint8_t *at;
    size_t left;
} reader;

static const uint8_t *next(reader *from, size_t n)
{
    const uint8_t *at = from->at;

    if (at == NULL || n > from->left) {
        from->at = NULL;
        from->left = 0;
        return NULL;
    }
    from->at += n;
    from->left -= n;
    return at;
}

/* U+0000 to U+001F and U+007F to U+009F; the text is UTF-8. */
static bool has_control(const uint8_t *text, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        if (text[i] < 0x20 || text[i] == 0x7F || (text[i] == 0xC2 && text[i + 1] < 0xA0))
            return true;
    return false;
}

/* The next text, its length byte first; NULL where it is cut short, no UTF-8, or not plain. */
static const uint8_t *next_text(reader *from)
{
    const uint8_t *length = next(from, 1);
    const uint8_t *text = length == NULL ? NULL : next(from, *length);

    if (text == NULL || !ab_is_utf8(text, *length) || has_control(text, *length))
        return NULL;
    return length;
}

/* Doubles are judged by their bits, so that no floating point is needed. */
static bool is_finite(uint64_t bits)
{
    return (bits >> 52 & 0x7FF) != 0x7FF;
}

static bool is_zero(uint64_t bits)
{
    return bits << 1 == 0;
}

static bool is_at_least_zero(uint64_t bits)
{
    return is_finite(bits) && (bits >> 63 == 0 || is_zero(bits));
}

static unsigned digits(const uint8_t *text, unsigned n)
{
    unsigned value = 0;

    for (unsigned i = 0; i < n; i++) {
        if (text[i] < '0' || text[i] > '9')
            return 0; /* no year, month or day is 0 */
        value = 10 * value + (unsigned)(text[i] - '0');
    }
    return value;
}

/* YYYY-MM-DD of the Gregorian calendar. */
static bool is_date(const uint8_t *text, unsigned n)
{
    unsigned year, month, day, days;

    if (n != 10 || text[4] != '-' || text[7] != '-')
        return false;
    year = digits(text, 4);
    month = digits(text + 5, 2);
    day = digits(text + 8, 2);
    days = month == 2 ? 28 : 30 + ((month + (month > 7)) & 1);
    if (month == 2 && year % 4 == 0 && (year % 100 != 0 || year % 400 == 0))
        days = 29;
    return year >= 1 && month >= 1 && month <= 12 && day >= 1 && day <= days;
}

/* Read one channel; *name is its name with the length byte. */
static bool check_channel(reader *from, const uint8_t **name)
{
    const uint8_t *fixed = next(from, CHANNEL_BYTES);
    const uint8_t *quantity, *unit, *serial_number, *date, *teds_size;

    *name = next_text(from);
    quantity = next_text(from);
    unit = next_text(from);
    serial_number = next_text(from);
    date = next_text(from);
    teds_size = next(from, 2);
    if (teds_size == NULL || next(from, ab_get_u16(teds_size)) == NULL)
        return false;
    if (*name == NULL || quantity == NULL || unit == NULL || serial_number == NULL || date == NULL)
        return false;
    if (fixed[0] > 3 || !is_finite(ab_get_u64(fixed + 1)) || is_zero(ab_get_u64(fixed + 1)))
        return false;
    if (!is_at_least_zero(ab_get_u64(fixed + 9)) || is_zero(ab_get_u64(fixed + 9)))
        return false;
    if (!is_at_least_zero(ab_get_u64(fixed + 17)))
        return false;
    return **name > 0 && *quantity > 0 && *unit > 0 && (*date == 0 || is_date(date + 1, *date));
}

/* Whether one of the first `n` channels, from `from` on, has this name. */
static bool has_name(reader from, unsigned n, const uint8_t *name)
{
    const uint8_t *other;

    for (unsigned i = 0; i < n; i++)
        if (check_channel(&from, &other) && memcmp(other, name, *name + 1u) == 0)
            return true;
    return false;
}

bool ab_dictionary_check(const uint8_t *bytes, size_t n, ab_dictionary_head *head)
{
    reader all = {bytes, n};
    reader channels;
    const uint8_t *fixed = next(&all, HEAD_BYTES);
    const uint8_t *name;

    if (fixed == NULL || n > LARGEST || fixed[0] != LAYOUT)
        return false;
    head->n_channels = fixed[1];
    head->link_bytes_per_s = ab_get_u32(fixed + 2);
    head->block_capacity = ab_get_u32(fixed + 6);
    head->tick_hz = ab_get_u32(fixed + 10);
    if (head->n_channels < 1 || head->n_channels > AB_MAX_CHANNELS)
        return false;
    if (head->link_bytes_per_s == 0 || head->block_capacity == 0 || head->tick_hz == 0)
        return false;
    if (!is_at_least_zero(ab_get_u64(fixed + 14)))
        return false;
    if (next_text(&all) == NULL || next_text(&all) == NULL)
        return false;
    channels = all;
    for (unsigned i = 0; i < head->n_channels; i++)
        if (!check_channel(&all, &name) || has_name(channels, i, name))
            return false;
    return all.left == 0;
}
