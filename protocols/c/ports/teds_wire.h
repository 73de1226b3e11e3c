/*
 * The memory of a sensor with an electronic data sheet, over its own two wires (IEEE 1451.4, class 1).
 *
 * While the sensor's supply is off its memory answers on a 1-Wire bus of reversed polarity; the
 * front end turns the polarity round. Memories DS2430A, DS2431, DS2433 and DS28EC20; slots and
 * commands by their data sheets and by Maxim's application notes 126 and 27.
 */
#ifndef TEDS_WIRE_H
#define TEDS_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    void *context;
    void (*pull)(void *context, bool down); /* pull the line down, or let it go */
    bool (*is_up)(void *context);
    void (*wait_us)(void *context, uint32_t us); /* at least so long; within a slot, 3 us more at most */
} teds_wire;

/* The data sheet, the checksum byte that begins each page of 32 taken out; how many bytes, at most
   `size`. 0: no sensor answers, its memory is of another kind, or two readings differ. */
size_t teds_wire_read(const teds_wire *wire, uint8_t *bytes, size_t size);

#endif
