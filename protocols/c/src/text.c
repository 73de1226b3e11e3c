/* The reason of a refusal, put together without a library. */
#include "internal.h"

ab_text ab_text_begin(char *buffer, size_t size)
{
    ab_text text = {buffer, buffer + size - 1};
    *buffer = '\0';
    return text;
}

void ab_text_add(ab_text *text, const char *words)
{
    while (*words != '\0' && text->at < text->end)
        *text->at++ = *words++;
    *text->at = '\0';
}

void ab_text_say(ab_text *text, const char *words, uint64_t value)
{
    char digits[21];
    char *at = digits + sizeof digits - 1;

    ab_text_add(text, words);
    *at = '\0';
    do {
        *--at = (char)('0' + (int)(value % 10));
        value /= 10;
    } while (value != 0);
    ab_text_add(text, at);
}

void ab_text_signed(ab_text *text, int32_t value)
{
    ab_text_say(text, value < 0 ? "-" : "", value < 0 ? 0u - (uint32_t)value : (uint32_t)value);
}

void ab_text_hex(ab_text *text, uint32_t value)
{
    char digits[11] = "0x";

    for (int i = 0; i < 8; i++)
        digits[2 + i] = "0123456789abcdef"[value >> (28 - 4 * i) & 15];
    digits[10] = '\0';
    ab_text_add(text, digits);
}
