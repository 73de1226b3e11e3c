/*
 * Bytes of any kind under sanitizers. On standard input: a length in four bytes, the least first,
 * and as many bytes, again and again. Each is taken as a stream in portions, as a dictionary, and
 * as the payload of every message. Every byte string lies in a heap block of exactly its length.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "armodal_host.h"

static unsigned long long n_bytes, n_inputs, n_frames, n_payloads, n_dictionaries;

static uint8_t *exact(const uint8_t *bytes, size_t n)
{
    uint8_t *copy = malloc(n > 0 ? n : 1);

    memcpy(copy, bytes, n);
    return copy;
}

static void as_payload(unsigned type, const uint8_t *bytes, size_t n)
{
    uint8_t *copy = exact(bytes, n);

    n_payloads += ab_payload_valid(type, copy, n);
    free(copy);
}

static void as_stream(const uint8_t *bytes, size_t n)
{
    const size_t portion = 1 + n_inputs % 97;
    ab_receiver receiver = {0};
    size_t stretch, size;
    const uint8_t *payload;
    ab_header header;

    receiver.buffer = malloc(AB_MAX_ENCODED);
    receiver.size = AB_MAX_ENCODED;
    for (size_t at = 0; at < n;) {
        const size_t offered = portion < n - at ? portion : n - at;

        at += ab_receiver_take(&receiver, bytes + at, offered, &stretch);
        if (stretch > 0 &&
            ab_receiver_decode(&receiver, stretch, &header, &payload, &size) == AB_FRAME_OK) {
            n_frames++;
            as_payload(header.type, payload, size);
        }
    }
    free(receiver.buffer);
}

static void as_dictionary(const uint8_t *bytes, size_t n)
{
    ab_dictionary_head head;
    ab_channel_view channel;
    unsigned i = 0;

    if (!ab_dictionary_check(bytes, n, &head))
        return;
    n_dictionaries++;
    while (ab_dictionary_channel(bytes, i, &channel))
        i++;
    if (i != head.n_channels)
        abort();
}

static void take(const uint8_t *bytes, size_t n)
{
    static const uint8_t types[] = {AB_CONFIGURE, AB_RESEND, AB_RELEASE, AB_HELLO | AB_REPLY,
                                    AB_STATUS | AB_REPLY, AB_BLOCK_READY, AB_STREAM,
                                    AB_BLOCK_DATA, AB_START | AB_REPLY};

    as_stream(bytes, n);
    as_dictionary(bytes, n);
    for (size_t i = 0; i < sizeof types; i++)
        as_payload(types[i], bytes, n);
    n_bytes += n;
    n_inputs++;
}

#ifdef LIBFUZZER

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    n_inputs = 0; /* the same bytes come in the same portions */
    take(bytes, n);
    return 0;
}

#else

int main(void)
{
    uint8_t head[4];

    while (fread(head, 1, sizeof head, stdin) == sizeof head) {
        const size_t n = head[0] | (size_t)head[1] << 8 | (size_t)head[2] << 16 |
                         (size_t)head[3] << 24;
        uint8_t *bytes = malloc(n > 0 ? n : 1);

        if (fread(bytes, 1, n, stdin) != n)
            return 1;
        take(bytes, n);
        free(bytes);
    }
    printf("%llu %llu %llu %llu %llu\n", n_bytes, n_inputs, n_frames, n_payloads, n_dictionaries);
    return 0;
}

#endif
