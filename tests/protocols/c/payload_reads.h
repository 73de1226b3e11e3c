/* The payload of a message of any type, read by the function that belongs to it. */
#include "armodal_host.h"

static bool reads(unsigned type, const uint8_t *bytes, size_t n)
{
    ab_configuration configuration;
    ab_range range;
    ab_status status;
    ab_block_info info;
    ab_data data;
    uint32_t id;
    uint16_t total, offset;
    uint8_t code;
    const uint8_t *reason;
    size_t size;

    switch (type) {
    case AB_CONFIGURE:
        return ab_read_configuration(bytes, n, &configuration);
    case AB_RESEND:
        return ab_read_range(bytes, n, &range);
    case AB_RELEASE:
        return ab_read_block_id(bytes, n, &id);
    case AB_HELLO | AB_REPLY:
        return ab_read_fragment(bytes, n, &total, &offset);
    case AB_STATUS | AB_REPLY:
        return ab_read_status(bytes, n, &status);
    case AB_BLOCK_READY:
        return ab_read_block_info(bytes, n, &info);
    case AB_STREAM:
    case AB_BLOCK_DATA:
        return ab_read_data((uint8_t)type, bytes, n, &data);
    default:
        return ab_read_reply(bytes, n, &code, &reason, &size);
    }
}
