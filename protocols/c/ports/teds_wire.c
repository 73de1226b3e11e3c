/* See teds_wire.h. */
#include "teds_wire.h"

enum {
    COMMAND_READ_ROM = 0x33,
    COMMAND_READ_MEMORY = 0xF0,
    COMMAND_READ_REGISTER = 0xC3, /* of the DS2430A: its application register, the basic data sheet */
    FAMILY_DS2430A = 0x14,
    FAMILY_DS2431 = 0x2D,
    FAMILY_DS2433 = 0x23,
    FAMILY_DS28EC20 = 0x43,
    ROM_BYTES = 8,
    REGISTER_BYTES = 8,
    PAGE_BYTES = 32,
    READINGS = 2
};

/* Whether anybody answers to a reset. */
static bool reset(const teds_wire *wire)
{
    bool there;
    wire->pull(wire->context, true);
    wire->wait_us(wire->context, 480);
    wire->pull(wire->context, false);
    wire->wait_us(wire->context, 70);
    there = !wire->is_up(wire->context);
    wire->wait_us(wire->context, 410);
    return there && wire->is_up(wire->context); /* a line that stays down is a short */
}

static void write_byte(const teds_wire *wire, uint8_t byte)
{
    int bit;
    for (bit = 0; bit < 8; bit++) {
        const bool one = (byte >> bit & 1) != 0;
        wire->pull(wire->context, true);
        wire->wait_us(wire->context, one ? 6 : 60);
        wire->pull(wire->context, false);
        wire->wait_us(wire->context, one ? 64 : 10);
    }
}

static uint8_t read_byte(const teds_wire *wire)
{
    unsigned byte = 0;
    int bit;
    for (bit = 0; bit < 8; bit++) {
        wire->pull(wire->context, true);
        wire->wait_us(wire->context, 6);
        wire->pull(wire->context, false);
        wire->wait_us(wire->context, 6);
        byte |= wire->is_up(wire->context) ? 1u << bit : 0u;
        wire->wait_us(wire->context, 58);
    }
    return (uint8_t)byte;
}

/* x^8 + x^5 + x^4 + 1, the lowest bit first: 0 over a number with its own sum. */
static uint8_t crc8(const uint8_t *bytes, size_t n)
{
    uint8_t crc = 0;
    size_t i;
    int bit;
    for (i = 0; i < n; i++) {
        crc = (uint8_t)(crc ^ bytes[i]);
        for (bit = 0; bit < 8; bit++) {
            crc = (uint8_t)((crc & 1) != 0 ? crc >> 1 ^ 0x8C : crc >> 1);
        }
    }
    return crc;
}

/* Begin a command to the only memory on the line; its family, 0 where none answers whole. */
static uint8_t address(const teds_wire *wire)
{
    uint8_t rom[ROM_BYTES];
    int i;
    if (!reset(wire)) {
        return 0;
    }
    write_byte(wire, COMMAND_READ_ROM);
    for (i = 0; i < ROM_BYTES; i++) {
        rom[i] = read_byte(wire);
    }
    return crc8(rom, ROM_BYTES) == 0 ? rom[0] : 0;
}

static size_t memory_bytes(uint8_t family)
{
    switch (family) {
    case FAMILY_DS2430A:
        return 32;
    case FAMILY_DS2431:
        return 128;
    case FAMILY_DS2433:
        return 512;
    case FAMILY_DS28EC20:
        return 2560;
    default:
        return 0;
    }
}

static size_t read_once(const teds_wire *wire, uint8_t *bytes, size_t size)
{
    const uint8_t family = address(wire);
    const size_t memory = memory_bytes(family);
    size_t n = 0, i;
    if (family == FAMILY_DS2430A) {
        write_byte(wire, COMMAND_READ_REGISTER);
        write_byte(wire, 0);
        for (i = 0; i < REGISTER_BYTES && n < size; i++) {
            bytes[n++] = read_byte(wire);
        }
        if (address(wire) != family) {
            return 0;
        }
    }
    if (memory == 0) {
        return 0;
    }
    write_byte(wire, COMMAND_READ_MEMORY);
    write_byte(wire, 0);
    if (family != FAMILY_DS2430A) {
        write_byte(wire, 0); /* the others' addresses have two bytes */
    }
    for (i = 0; i < memory && n < size; i++) {
        const uint8_t byte = read_byte(wire);
        if (i % PAGE_BYTES != 0) {
            bytes[n++] = byte;
        }
    }
    return n;
}

size_t teds_wire_read(const teds_wire *wire, uint8_t *bytes, size_t size)
{
    size_t n = 0, i;
    uint32_t sum[READINGS];
    int reading;
    for (reading = 0; reading < READINGS; reading++) {
        n = read_once(wire, bytes, size);
        sum[reading] = 2166136261u; /* FNV-1a: there is no room for a second copy */
        for (i = 0; i < n; i++) {
            sum[reading] = (sum[reading] ^ bytes[i]) * 16777619u;
        }
    }
    return sum[0] == sum[1] ? n : 0;
}
