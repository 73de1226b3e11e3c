/* Little-endian fields, counts, and whether a text is UTF-8. */
#include "internal.h"

uint8_t *ab_put_u16(uint8_t *to, uint16_t value)
{
    to[0] = (uint8_t)value;
    to[1] = (uint8_t)(value >> 8);
    return to + 2;
}

uint8_t *ab_put_u32(uint8_t *to, uint32_t value)
{
    return ab_put_u16(ab_put_u16(to, (uint16_t)value), (uint16_t)(value >> 16));
}

uint8_t *ab_put_u64(uint8_t *to, uint64_t value)
{
    return ab_put_u32(ab_put_u32(to, (uint32_t)value), (uint32_t)(value >> 32));
}

uint16_t ab_get_u16(const uint8_t *from)
{
    return (uint16_t)(from[0] | from[1] << 8);
}

uint32_t ab_get_u32(const uint8_t *from)
{
    return ab_get_u16(from) | (uint32_t)ab_get_u16(from + 2) << 16;
}

uint64_t ab_get_u64(const uint8_t *from)
{
    return ab_get_u32(from) | (uint64_t)ab_get_u32(from + 4) << 32;
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

/* RFC 3629: shortest forms only, no surrogates, nothing above U+10FFFF. */
bool ab_is_utf8(const uint8_t *text, size_t n)
{
    static const uint32_t smallest[4] = {0, 0x80, 0x800, 0x10000};
    size_t i = 0;

    while (i < n) {
        const uint8_t lead = text[i++];
        size_t more = 0;
        uint32_t point = lead;

        if (lead >= 0x80) {
            more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
            if (lead < 0xC0 || lead >= 0xF8 || more > n - i)
                return false;
            point = lead & (0x3Fu >> more);
        }
        for (size_t k = 0; k < more; k++, i++) {
            if ((text[i] & 0xC0) != 0x80)
                return false;
            point = point << 6 | (text[i] & 0x3Fu);
        }
        if (point < smallest[more] || point > 0x10FFFF || (point >= 0xD800 && point < 0xE000))
            return false;
    }
    return true;
}
