#include <string.h>
#include "armodal_board.h"
#include "bsp.h"

enum { CHANNELS = 4, CAPACITY = 96 * 1024, BLOCKS = 16, PREVIEW_FRAMES = BSP_PREVIEW_FRAMES };

static uint8_t block_buffer[CAPACITY];
static ab_block blocks[BLOCKS];
static uint8_t receive_buffer[AB_RECEIVE_BYTES];
static uint8_t transmit_buffer[AB_TRANSMIT_BYTES(CHANNELS)];
static uint8_t preview_buffer[AB_PREVIEW_BYTES(CHANNELS, PREVIEW_FRAMES)];
static uint8_t dictionary_bytes[1024];
static ab_board board;

static size_t send_bytes(void *context, const uint8_t *bytes, size_t n)
{
    (void)context;
    return bsp_link_write(bytes, n); /* copies what fits in the driver's queue, never waits */
}

static uint64_t read_ticks(void *context)
{
    (void)context;
    return bsp_ticks64(); /* a 32-bit timer, extended by its overflow interrupt */
}

static bool makes_rate(void *context, uint32_t numerator, uint32_t denominator, char *reason,
                       size_t size)
{
    const char *refusal = bsp_adc_refusal(numerator, denominator);
    size_t i;
    (void)context;
    for (i = 0; refusal != NULL && i + 1 < size && refusal[i] != '\0'; i++) {
        reason[i] = refusal[i];
    }
    if (refusal != NULL && size != 0) {
        reason[i] = '\0';
    }
    return refusal == NULL;
}

static void start_converter(void *context, uint32_t numerator, uint32_t denominator)
{
    (void)context;
    bsp_adc_start(numerator, denominator);
}

static void stop_converter(void *context)
{
    (void)context;
    bsp_adc_stop();
}

static const ab_config config = {
    .port = {.context = NULL,
             .send = send_bytes,
             .ticks = read_ticks,
             .rate = makes_rate,
             .start = start_converter,
             .stop = stop_converter},
    .block_buffer = block_buffer,
    .block_buffer_size = sizeof block_buffer,
    .blocks = blocks,
    .n_blocks = BLOCKS,
    .receive = receive_buffer,
    .receive_size = sizeof receive_buffer,
    .transmit = transmit_buffer,
    .transmit_size = sizeof transmit_buffer,
    .preview = preview_buffer,
    .preview_size = sizeof preview_buffer};

/* What is compiled in of the sensors; the data sheets that they carry are read at boot. */
static ab_channel channels[CHANNELS] = {
    {.name = "hammer", .quantity = "force", .unit = "N", .scale = 0.00238, .full_scale = 20000.0,
     .highpass_hz = 0.05, .serial_number = "H-1", .calibration_date = "2026-03-02", .iepe = 1},
    {.name = "acc_x", .quantity = "acceleration", .unit = "m/s^2", .scale = 1.19e-5,
     .full_scale = 100.0, .highpass_hz = 0.3, .serial_number = "A-1", .calibration_date = "",
     .iepe = 1},
    {.name = "acc_y", .quantity = "acceleration", .unit = "m/s^2", .scale = 1.19e-5,
     .full_scale = 100.0, .highpass_hz = 0.3, .serial_number = "A-1", .calibration_date = "",
     .iepe = 1},
    {.name = "acc_z", .quantity = "acceleration", .unit = "m/s^2", .scale = 1.19e-5,
     .full_scale = 100.0, .highpass_hz = 0.3, .serial_number = "A-1", .calibration_date = "",
     .iepe = 1}};

static const ab_dictionary dictionary = {.board_id = BSP_BOARD_ID,
                                         .firmware = "1.0",
                                         .link_bytes_per_s = BSP_LINK_BYTES_PER_S,
                                         .block_capacity = CAPACITY,
                                         .tick_hz = BSP_TICK_HZ,
                                         .filter_group_delay_samples = BSP_GROUP_DELAY_SAMPLES,
                                         .channels = channels,
                                         .n_channels = CHANNELS};

static uint16_t describe(void)
{
    size_t size = ab_dictionary_encode(dictionary_bytes, sizeof dictionary_bytes, &dictionary);

    if (size == 0) {
        bsp_halt();
    }
    return (uint16_t)size;
}

/* Look at one sensor's supply; describe the board anew if its state is another. */
static void watch_supply(uint32_t channel)
{
    const uint8_t state = bsp_iepe(channel);

    if (state != channels[channel].iepe) {
        channels[channel].iepe = state;
        (void)ab_set_dictionary(&board, dictionary_bytes, describe());
    }
}

int main(void)
{
    uint8_t bytes[64];
    size_t n = 0, taken;
    uint32_t i;

    bsp_begin();
    for (i = 0; i < CHANNELS; i++) {
        channels[i].teds = bsp_teds(i, &channels[i].teds_size);
        channels[i].iepe = bsp_iepe(i);
    }
    if (ab_init(&board, &config, dictionary_bytes, describe(), bsp_random()) != AB_INIT_OK) {
        bsp_halt();
    }
    for (i = 0;; i = (i + 1) % CHANNELS) {
        int32_t counts[64 * CHANNELS];
        uint32_t lost;
        uint64_t first_ticks;
        uint32_t n_samples = bsp_adc_read(counts, 64, &first_ticks, &lost);

        if (lost != 0) {
            ab_lost(&board, lost);
        }
        if (n_samples != 0) {
            ab_samples(&board, counts, n_samples, first_ticks);
        }
        n += bsp_link_read(bytes + n, sizeof bytes - n);
        taken = ab_receive(&board, bytes, n);
        memmove(bytes, bytes + taken, n - taken);
        n -= taken;
        watch_supply(i);
        ab_poll(&board);
    }
}
