/* For compilers that bring no C library: what every one of them has within itself. */
#ifndef ARMODAL_FREESTANDING_STRING_H
#define ARMODAL_FREESTANDING_STRING_H

#include <stddef.h>

void *memcpy(void *restrict to, const void *restrict from, size_t n);
void *memmove(void *to, const void *from, size_t n);
void *memset(void *to, int byte, size_t n);
int memcmp(const void *a, const void *b, size_t n);

#endif
