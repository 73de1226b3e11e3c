/*
 * Random lives of boards under sanitizers: sanitized_life SEED LIVES.
 *
 * Each board has random channels and the smallest buffers that are allowed, each in a heap block
 * of its own, and lives through commands good and bad, garbage, samples, lost samples and a link
 * that takes a few bytes at a time. Whatever it sends must be frames without a gap, and every
 * count in them the one that was fed for that sample and channel.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "armodal_host.h"

enum { STEPS = 400, SESSION = 77 };

static uint64_t random_state;

static uint32_t random_below(uint32_t n)
{
    /* splitmix64: Steele, Lea and Flood, OOPSLA 2014 */
    uint64_t z = random_state += 0x9E3779B97F4A7C15u;

    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (uint32_t)((z ^ z >> 31) % n);
}

/* What channel c carries at sample i: it goes up and down through 0, and uses all 24 bits. */
static int32_t count_of(uint64_t i, unsigned channel)
{
    uint64_t x = (i * 33 + channel) * 0x9E3779B97F4A7C15u;
    const int32_t size = (x >> 40 & 3) == 0 ? 0x7FFFFF : 9;

    return (int32_t)(x >> 44) % (size + 1) * ((x >> 39 & 1) != 0 ? 1 : -1);
}

typedef struct {
    ab_board board;
    uint32_t room;
    uint64_t now;
    /* what the host has seen */
    ab_receiver receiver;
    uint32_t next_sequence;
    uint32_t mask;
    uint32_t asked_mask[256]; /* by the tag of the CONFIGURE */
    uint16_t tag;
    unsigned long frames, data_frames, blocks, refused;
} life;

static void want(int holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "%s\n", what);
        exit(1);
    }
}

static void check_data(life *host, const ab_header *header, const uint8_t *payload, size_t n)
{
    ab_data data;
    const uint8_t *at;

    want(ab_read_data(header->type, payload, n, &data), "a data frame breaks a rule");
    at = data.counts;
    for (unsigned i = 0; i < data.n_samples; i++)
        for (unsigned channel = 0; channel < 32; channel++)
            if (host->mask >> channel & 1) {
                uint8_t packed[3];

                (void)ab_write_count(packed, count_of(header->first_sample + i, channel));
                want(at < payload + n && memcmp(at, packed, 3) == 0, "a count is another one");
                at += 3;
            }
    want(at == payload + n, "other channels than those of the mask");
    host->data_frames++;
}

static void check_frame(life *host, const ab_header *header, const uint8_t *payload, size_t n)
{
    uint8_t code;
    const uint8_t *reason;
    size_t size;
    ab_block_info info;

    want(header->sequence == host->next_sequence++, "a gap in the sequence");
    want(header->session == SESSION, "another session");
    host->frames++;
    if (header->type == AB_STREAM || header->type == AB_BLOCK_DATA) {
        check_data(host, header, payload, n);
    } else if (header->type == AB_BLOCK_READY) {
        want(ab_read_block_info(payload, n, &info), "BLOCK_READY breaks a rule");
        host->blocks++;
    } else if (header->type != (AB_HELLO | AB_REPLY) && header->type != (AB_STATUS | AB_REPLY)) {
        want(ab_read_reply(payload, n, &code, &reason, &size), "a reply breaks a rule");
        want(code == AB_OK ? size == 0 : size > 0, "a refusal without reason");
        host->refused += code != AB_OK;
        if (header->type == (AB_CONFIGURE | AB_REPLY) && code == AB_OK)
            host->mask = host->asked_mask[header->tag % 256];
    }
}

static size_t send_bytes(void *context, const uint8_t *bytes, size_t n)
{
    life *host = context;
    const size_t taken = n < host->room ? n : host->room;
    size_t at = 0;

    host->room -= (uint32_t)taken;
    while (at < taken) {
        size_t stretch, size;
        const uint8_t *payload;
        ab_header header;

        at += ab_receiver_take(&host->receiver, bytes + at, taken - at, &stretch);
        if (stretch > 0) {
            const ab_frame_result result =
                ab_receiver_decode(&host->receiver, stretch, &header, &payload, &size);

            want(result == AB_FRAME_OK || (result == AB_FRAME_TYPE && header.type >= AB_REPLY),
                 "not a frame");
            check_frame(host, &header, payload, size);
        }
    }
    return taken;
}

static uint64_t read_ticks(void *context)
{
    return ((life *)context)->now++;
}

static bool makes_rate(void *context, uint32_t numerator, uint32_t denominator, char *reason,
                       size_t size)
{
    (void)context;
    if (numerator >= denominator)
        return true;
    (void)snprintf(reason, size, "at least 1 Hz, and this goes on until there is no room %0200d", 0);
    return false;
}

static void start_converter(void *context, uint32_t numerator, uint32_t denominator)
{
    (void)context;
    want(numerator >= denominator, "a rate that was refused");
}

static void stop_converter(void *context)
{
    (void)context;
}

/* Hand bytes over as long as the board takes them, from a heap block of exactly their length. */
static void give(life *host, const uint8_t *bytes, size_t n)
{
    while (n > 0) {
        uint8_t *copy = malloc(n);
        size_t taken;

        memcpy(copy, bytes, n);
        taken = ab_receive(&host->board, copy, n);
        want(taken <= n, "took more than there was");
        free(copy);
        bytes += taken;
        n -= taken;
        if (n > 0) {
            host->room += 50;
            (void)ab_poll(&host->board);
        }
    }
}

static void command(life *host, unsigned n_channels)
{
    static const uint8_t types[] = {0, 1, 2, 2, 2, 3, 3, 4, 5, 6, 6, 7, 7, 8, 0x42, 0x81, 0x90};
    uint8_t payload[AB_CONFIGURATION_BYTES] = {0};
    uint8_t wire[200];
    size_t n = 0;
    ab_header header = {0};
    ab_encoder encoder;
    ab_resend range;

    header.version = random_below(20) == 0 ? 2 : 1;
    header.type = types[random_below(sizeof types)];
    header.session = random_below(30) == 0 ? 1 : SESSION;
    header.tag = ++host->tag;
    if (header.type == AB_CONFIGURE) {
        ab_configuration asked;

        asked.rate_hz_numerator = random_below(10) == 0 ? random_below(3) : 51200;
        asked.rate_hz_denominator = 1 + random_below(60);
        asked.channel_mask = random_below(1u << (n_channels < 31 ? n_channels : 31));
        asked.trigger_channel = (uint8_t)random_below(n_channels);
        asked.channel_mask |= 1u << asked.trigger_channel;
        asked.trigger_level_counts = (int32_t)random_below(9) - 4;
        asked.block_length = random_below(400);
        asked.pretrigger = random_below(asked.block_length + 1);
        asked.slope = (uint8_t)random_below(2);
        asked.stream = (uint8_t)random_below(2);
        host->asked_mask[host->tag % 256] = asked.channel_mask;
        ab_write_configuration(payload, &asked);
        n = sizeof payload;
    } else if (header.type == AB_RESEND || header.type == AB_RELEASE) {
        range.block_id = host->board.last_block + 1 - random_below(4);
        range.first = random_below(400);
        range.count = random_below(400);
        ab_write_resend(payload, &range);
        n = header.type == AB_RESEND ? 12 : 4;
    }
    if (random_below(40) == 0)
        n = random_below(sizeof payload);
    ab_encoder_begin(&encoder, wire, sizeof wire, &header);
    ab_encoder_add(&encoder, payload, n);
    n = ab_encoder_end(&encoder);
    if (random_below(20) == 0)
        wire[random_below((uint32_t)n)] ^= (uint8_t)(1 + random_below(255));
    give(host, wire, n);
}

static void garbage(life *host)
{
    uint8_t bytes[3000];
    const uint32_t n = random_below(random_below(20) == 0 ? sizeof bytes : 40);
    const uint32_t values = random_below(2) == 0 ? 256 : 4;

    for (uint32_t i = 0; i < n; i++)
        bytes[i] = (uint8_t)random_below(values);
    give(host, bytes, n);
}

static void samples(life *host, unsigned n_channels)
{
    const uint32_t n = random_below(200);
    int32_t *counts = malloc(sizeof *counts * n * n_channels + 1);

    for (uint32_t i = 0; i < n; i++)
        for (unsigned channel = 0; channel < n_channels; channel++)
            counts[i * n_channels + channel] = count_of(host->board.next_sample + i, channel);
    ab_samples(&host->board, counts, n, host->now);
    free(counts);
}

static void live(unsigned long totals[4])
{
    const unsigned n_channels = 1 + random_below(random_below(4) == 0 ? 32 : 5);
    const uint32_t capacity = 1 + random_below(40000);
    const uint16_t n_blocks = (uint16_t)(1 + random_below(8));
    ab_channel channels[32];
    char names[32][12];
    uint8_t scratch[4096];
    uint8_t *encoded[2];
    uint16_t size;
    ab_dictionary dictionary = {"a board", "1", 1u << 30, capacity, 1000000, 1.5, channels, 0};
    ab_config config = {0};
    life host = {0};

    dictionary.n_channels = (uint8_t)n_channels;
    for (unsigned i = 0; i < n_channels; i++) {
        const ab_channel channel = {names[i], "force", "N", "", "2024-02-29", -1.0, 1.0, 0.0,
                                    NULL,     0,       0};

        (void)snprintf(names[i], sizeof names[i], "c%u", i);
        channels[i] = channel;
    }
    for (unsigned i = 0; i < 2; i++) {
        channels[0].iepe = (uint8_t)i;
        size = (uint16_t)ab_dictionary_encode(scratch, sizeof scratch, &dictionary);
        want(size > 0, "the dictionary");
        encoded[i] = malloc(size);
        memcpy(encoded[i], scratch, size);
    }
    config.port.context = &host;
    config.port.send = send_bytes;
    config.port.ticks = read_ticks;
    config.port.rate = makes_rate;
    config.port.start = start_converter;
    config.port.stop = stop_converter;
    config.block_buffer = malloc(config.block_buffer_size = capacity);
    config.blocks = malloc(sizeof *config.blocks * (config.n_blocks = n_blocks));
    config.receive = malloc(config.receive_size = AB_RECEIVE_BYTES);
    config.transmit = malloc(config.transmit_size = AB_TRANSMIT_BYTES(n_channels));
    config.preview =
        malloc(config.preview_size = AB_PREVIEW_BYTES(n_channels, 1 + random_below(4)));
    host.receiver.buffer = malloc(host.receiver.size = AB_MAX_ENCODED);
    want(ab_init(&host.board, &config, encoded[0], size, SESSION) == AB_INIT_OK, "boot");
    for (unsigned step = 0; step < STEPS; step++) {
        switch (random_below(6)) {
        case 0:
        case 1:
            command(&host, n_channels);
            break;
        case 2:
        case 3:
            samples(&host, n_channels);
            break;
        case 4:
            host.room = random_below(3) == 0 ? 0 : random_below(10000);
            (void)ab_poll(&host.board);
            break;
        default:
            if (random_below(4) != 0)
                break;
            garbage(&host);
            ab_lost(&host.board, random_below(100));
            want(ab_set_dictionary(&host.board, encoded[random_below(2)], size) == AB_INIT_OK,
                 "another dictionary");
        }
    }
    totals[0] += host.frames;
    totals[1] += host.data_frames;
    totals[2] += host.blocks;
    totals[3] += host.refused;
    free(host.receiver.buffer);
    free(config.preview);
    free(config.transmit);
    free(config.receive);
    free(config.blocks);
    free(config.block_buffer);
    free(encoded[1]);
    free(encoded[0]);
}

int main(int argc, char **argv)
{
    unsigned long totals[4] = {0, 0, 0, 0};

    want(argc == 3, "sanitized_life SEED LIVES");
    random_state = strtoul(argv[1], NULL, 10);
    for (unsigned long i = strtoul(argv[2], NULL, 10); i > 0; i--)
        live(totals);
    printf("%lu frames, %lu with samples, %lu blocks, %lu refusals\n", totals[0], totals[1],
           totals[2], totals[3]);
    return 0;
}
