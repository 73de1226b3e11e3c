/* COBS decoding, section 2; the encoder is part of the frame encoder, which fills pieces. */
#include "internal.h"

size_t ab_cobs_decode(uint8_t *bytes, size_t n)
{
    size_t from = 0;
    size_t to = 0;

    while (from < n) {
        const uint8_t code = bytes[from++];
        const size_t end = from + code - 1u;

        if (code == 0 || end > n)
            return SIZE_MAX;
        while (from < end) {
            const uint8_t byte = bytes[from++];

            if (byte == 0)
                return SIZE_MAX;
            bytes[to++] = byte;
        }
        if (code != 255 && from < n)
            bytes[to++] = 0;
    }
    return to;
}
