/* Numbers as text: strict, independent of the locale, and exact in both directions. */
#include "io/stream_private.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool ends_number(const char *at, const char *end)
{
    return at == end || *at == ' ' || *at == '\t' || *at == '\n';
}

const char *number_parse_integer(const char *at, const char *end, int64_t least, int64_t most, int64_t *value)
{
    bool negative = at < end && *at == '-';
    at += at < end && (*at == '-' || *at == '+');
    const char *digits = at;
    uint64_t magnitude = 0;
    for (; at < end && is_digit(*at); at++) {
        if (__builtin_mul_overflow(magnitude, (uint64_t)10, &magnitude) ||
            __builtin_add_overflow(magnitude, (uint64_t)(*at - '0'), &magnitude)) {
            return NULL;
        }
    }
    uint64_t bound = negative ? 0 - (uint64_t)least : (uint64_t)most;
    if (at == digits || !ends_number(at, end) || magnitude > bound) {
        return NULL;
    }
    *value = negative ? (int64_t)(0 - magnitude) : (int64_t)magnitude;
    return at;
}

/* Length of a decimal number (digits with a point, an exponent) at `at`; 0 when there is none. */
static size_t decimal_length(const char *at, const char *end)
{
    const char *c = at;
    c += c < end && (*c == '-' || *c == '+');
    int64_t digits = 0;
    for (; c < end && is_digit(*c); c++) {
        digits++;
    }
    c += c < end && *c == '.';
    for (; c < end && is_digit(*c); c++) {
        digits++;
    }
    if (digits == 0) {
        return 0;
    }
    if (c < end && (*c == 'e' || *c == 'E')) {
        c++;
        c += c < end && (*c == '-' || *c == '+');
        if (c == end || !is_digit(*c)) {
            return 0;
        }
        while (c < end && is_digit(*c)) {
            c++;
        }
    }
    return (size_t)(c - at);
}

/* nan, inf, -inf, +inf, -nan, in any case. */
static const char *parse_special(const char *at, const char *end, double *value)
{
    bool negative = at < end && *at == '-';
    at += at < end && (*at == '-' || *at == '+');
    if (end - at < 3 || !ends_number(at + 3, end)) {
        return NULL;
    }
    if (strncasecmp(at, "nan", 3) == 0) {
        *value = NAN;
    } else if (strncasecmp(at, "inf", 3) == 0) {
        *value = negative ? -INFINITY : INFINITY;
    } else {
        return NULL;
    }
    return at + 3;
}

const char *number_parse_double(const char *at, const char *end, double *value)
{
    char text[NUMBER_LIMIT + 1];
    size_t length = decimal_length(at, end);
    if (length == 0) {
        return parse_special(at, end, value);
    }
    if (length > NUMBER_LIMIT || !ends_number(at + length, end)) {
        return NULL;
    }
    memcpy(text, at, length);
    text[length] = '\0';
    *value = strtod(text, NULL);
    return isfinite(*value) ? at + length : NULL;
}

const char *number_parse_float(const char *at, const char *end, float *value)
{
    char text[NUMBER_LIMIT + 1];
    size_t length = decimal_length(at, end);
    if (length == 0) {
        double special;
        const char *behind = parse_special(at, end, &special);
        *value = behind != NULL ? (float)special : 0;
        return behind;
    }
    if (length > NUMBER_LIMIT || !ends_number(at + length, end)) {
        return NULL;
    }
    memcpy(text, at, length);
    text[length] = '\0';
    *value = strtof(text, NULL);
    return isfinite(*value) ? at + length : NULL;
}

size_t number_format_integer(char *text, int64_t value)
{
    char digits[NUMBER_TEXT_LIMIT];
    size_t count = 0;
    uint64_t magnitude = value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
    do {
        digits[count++] = (char)('0' + magnitude % 10);
        magnitude /= 10;
    } while (magnitude > 0);
    size_t length = 0;
    if (value < 0) {
        text[length++] = '-';
    }
    while (count > 0) {
        text[length++] = digits[--count];
    }
    return length;
}

static size_t format_special(char *text, double value)
{
    const char *word = isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
    memcpy(text, word, strlen(word));
    return strlen(word);
}

size_t number_format_double(char *text, double value)
{
    if (!isfinite(value)) {
        return format_special(text, value);
    }
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%.17g", value);
}

size_t number_format_float(char *text, float value)
{
    if (!isfinite(value)) {
        return format_special(text, (double)value);
    }
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%.9g", (double)value);
}
