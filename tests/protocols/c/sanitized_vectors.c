/*
 * The shared vectors under sanitizers. Lines on standard input, bytes in hexadecimal:
 *
 *     frame HEX                       decodes, and encodes to the same bytes again
 *     invalid RESULT HEX              is refused with this result
 *     payload VALID TYPE HEX          is read, or refused where VALID is 0
 *     dictionary VALID HEX            is accepted, or refused where VALID is 0
 *     stream BAD GARBAGE FRAMES HEX   gives so many frames in portions of any length
 *
 * Every byte string lies in a heap block of exactly its length, so that reading past it is seen.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "armodal_host.h"

static unsigned long line_number;

static void want(int holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "line %lu: %s\n", line_number, what);
        exit(1);
    }
}

/* The last word of a line as bytes on the heap. */
static uint8_t *bytes_of(const char *hex, size_t *n)
{
    uint8_t *bytes;

    *n = strlen(hex) / 2;
    bytes = malloc(*n > 0 ? *n : 1);
    for (size_t i = 0; i < *n; i++) {
        char digits[3] = {hex[2 * i], hex[2 * i + 1], '\0'};

        bytes[i] = (uint8_t)strtoul(digits, NULL, 16);
    }
    return bytes;
}

static void frame(const char *hex)
{
    size_t n, size, length;
    uint8_t *encoded = bytes_of(hex, &n);
    uint8_t *copy = bytes_of(hex, &n);
    uint8_t *wire = malloc(n + 2);
    const uint8_t *payload;
    ab_header header;
    ab_encoder encoder;

    want(ab_frame_decode(encoded, n, &header, &payload, &size) == AB_FRAME_OK, "a valid frame");
    ab_encoder_begin(&encoder, wire, n + 2, &header);
    ab_encoder_add(&encoder, payload, size);
    length = ab_encoder_end(&encoder);
    want(length == n + 2 && wire[0] == 0 && wire[n + 1] == 0, "the same length");
    want(memcmp(wire + 1, copy, n) == 0, "the same bytes");
    free(wire);
    free(copy);
    free(encoded);
}

static void invalid(int result, const char *hex)
{
    size_t n, size;
    uint8_t *encoded = bytes_of(hex, &n);
    const uint8_t *payload;
    ab_header header;

    want((int)ab_frame_decode(encoded, n, &header, &payload, &size) == result, "another result");
    free(encoded);
}

static void dictionary(int valid, const char *hex)
{
    size_t n;
    uint8_t *bytes = bytes_of(hex, &n);
    ab_dictionary_head head;
    ab_channel_view channel;

    want(ab_dictionary_check(bytes, n, &head) == (valid != 0), "the dictionary");
    for (unsigned i = 0; valid && i <= head.n_channels; i++)
        want(ab_dictionary_channel(bytes, i, &channel) == (i < head.n_channels), "its channels");
    free(bytes);
}

static void stream(unsigned bad, unsigned long garbage, unsigned frames, const char *hex)
{
    size_t n, stretch, size;
    uint8_t *bytes = bytes_of(hex, &n);
    const uint8_t *payload;
    ab_header header;

    for (size_t portion = 1; portion <= n; portion = 2 * portion + 1) {
        ab_receiver receiver = {0};
        unsigned found = 0;

        receiver.buffer = malloc(AB_MAX_ENCODED);
        receiver.size = AB_MAX_ENCODED;
        for (size_t at = 0; at < n;) {
            const size_t offered = portion < n - at ? portion : n - at;

            at += ab_receiver_take(&receiver, bytes + at, offered, &stretch);
            if (stretch > 0)
                found += ab_receiver_decode(&receiver, stretch, &header, &payload, &size) ==
                         AB_FRAME_OK;
        }
        want(found == frames, "the frames of the stream");
        want(receiver.bad_frames == bad && receiver.garbage_bytes == garbage, "its garbage");
        free(receiver.buffer);
    }
    free(bytes);
}

int main(void)
{
    static char line[65536];
    char kind[16];

    while (fgets(line, sizeof line, stdin) != NULL) {
        unsigned long number[3] = {0, 0, 0};
        char *at = line;
        int used = 0;
        unsigned wanted;

        line_number++;
        line[strcspn(line, "\n")] = '\0';
        want(sscanf(at, "%15s%n", kind, &used) == 1, "a kind");
        at += used;
        wanted = strcmp(kind, "stream") == 0    ? 3
                 : strcmp(kind, "payload") == 0 ? 2
                 : strcmp(kind, "frame") == 0   ? 0
                                                : 1;
        for (unsigned i = 0; i < wanted; i++)
            number[i] = strtoul(at, &at, 10);
        at += *at == ' ';
        if (strcmp(kind, "frame") == 0) {
            frame(at);
        } else if (strcmp(kind, "invalid") == 0) {
            invalid((int)number[0], at);
        } else if (strcmp(kind, "payload") == 0) {
            size_t n;
            uint8_t *bytes = bytes_of(at, &n);

            want(ab_payload_valid((unsigned)number[1], bytes, n) == (number[0] != 0), "the payload");
            free(bytes);
        } else if (strcmp(kind, "dictionary") == 0) {
            dictionary((int)number[0], at);
        } else if (strcmp(kind, "stream") == 0) {
            stream((unsigned)number[0], number[1], (unsigned)number[2], at);
        } else {
            want(0, "a known kind");
        }
    }
    printf("%lu vectors\n", line_number);
    return 0;
}
