/* Frames: 00 | COBS(header, payload, CRC-32) | 00, section 2. */
#include "internal.h"

enum { CRC_BYTES = 4, OVERHEAD = AB_HEADER_BYTES + CRC_BYTES };

static void put(ab_encoder *encoder, const uint8_t *bytes, size_t n)
{
    uint8_t *wire = encoder->wire;
    size_t at = encoder->at;
    size_t code_at = encoder->code_at;
    unsigned code = encoder->code;
    size_t i = 0;

    /* A code byte for every 254 bytes, and one byte for the delimiter at the end. */
    if (n == 0 || encoder->overrun)
        return;
    if (encoder->size - at < n + (code + n - 2) / 254 + 1) {
        encoder->overrun = true;
        return;
    }
    while (i < n) {
        size_t end;

        if (code == 255) { /* the piece is full and more follows */
            wire[code_at] = 255;
            code_at = at++;
            code = 1;
        }
        end = n - i < 255 - code ? n : i + (255 - code);
        for (; i < end && bytes[i] != 0; code++)
            wire[at++] = bytes[i++];
        if (i < end) { /* a zero ends the piece */
            wire[code_at] = (uint8_t)code;
            code_at = at++;
            code = 1;
            i++;
        }
    }
    encoder->at = at;
    encoder->code_at = code_at;
    encoder->code = (uint8_t)code;
}

void ab_encoder_begin(ab_encoder *encoder, uint8_t *wire, size_t size, const ab_header *header)
{
    uint8_t bytes[AB_HEADER_BYTES];

    encoder->wire = wire;
    encoder->size = size;
    encoder->at = 2;
    encoder->code_at = 1;
    encoder->code = 1;
    encoder->crc = 0;
    encoder->overrun = size < 3;
    if (encoder->overrun)
        return;
    wire[0] = 0;
    ab_write_header(bytes, header);
    ab_encoder_add(encoder, bytes, sizeof bytes);
}

void ab_encoder_add(ab_encoder *encoder, const uint8_t *bytes, size_t n)
{
    encoder->crc = ab_crc32(encoder->crc, bytes, n);
    put(encoder, bytes, n);
}

size_t ab_encoder_end(ab_encoder *encoder)
{
    uint8_t crc[CRC_BYTES];

    (void)ab_put_u32(crc, encoder->crc);
    put(encoder, crc, sizeof crc);
    if (encoder->overrun)
        return 0;
    encoder->wire[encoder->code_at] = encoder->code;
    encoder->wire[encoder->at++] = 0;
    return encoder->at;
}

ab_frame_result ab_frame_decode(uint8_t *encoded, size_t n, ab_header *header,
                                const uint8_t **payload, size_t *payload_size)
{
    const size_t size = ab_cobs_decode(encoded, n);
    const uint8_t *bytes = encoded;

    if (size == SIZE_MAX)
        return AB_FRAME_COBS;
    if (size < OVERHEAD)
        return AB_FRAME_SHORT;
    if (size > OVERHEAD + AB_MAX_PAYLOAD)
        return AB_FRAME_LONG;
    if (ab_crc32(0, bytes, size - CRC_BYTES) != ab_get_u32(bytes + size - CRC_BYTES))
        return AB_FRAME_CRC;
    ab_read_header(bytes, header);
    *payload = bytes + AB_HEADER_BYTES;
    *payload_size = size - OVERHEAD;
    if (header->version != AB_VERSION)
        return AB_FRAME_VERSION;
    return ab_type_known(header->type) ? AB_FRAME_OK : AB_FRAME_TYPE;
}

size_t ab_receiver_take(ab_receiver *receiver, const uint8_t *bytes, size_t n, size_t *stretch)
{
    size_t length = 0;

    while (length < n && bytes[length] != 0)
        length++;
    *stretch = 0;
    if (!receiver->skipping && length > receiver->size - receiver->used) {
        receiver->skipping = true;
        receiver->bad_frames++;
        receiver->garbage_bytes += receiver->used;
        receiver->used = 0;
    }
    if (receiver->skipping) {
        receiver->garbage_bytes += length;
    } else {
        memcpy(receiver->buffer + receiver->used, bytes, length);
        receiver->used += length;
    }
    if (length == n)
        return n;
    *stretch = receiver->used;
    receiver->used = 0;
    receiver->skipping = false;
    return length + 1;
}

ab_frame_result ab_receiver_decode(ab_receiver *receiver, size_t stretch, ab_header *header,
                                   const uint8_t **payload, size_t *payload_size)
{
    const ab_frame_result result =
        ab_frame_decode(receiver->buffer, stretch, header, payload, payload_size);

    if (result != AB_FRAME_OK) {
        receiver->bad_frames++;
        receiver->garbage_bytes += stretch;
    }
    return result;
}
