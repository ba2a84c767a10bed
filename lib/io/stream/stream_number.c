/* Numbers from and to text: strict syntax, correctly rounded by the C library. */
#include "io/stream/stream_private.h"

#include <inttypes.h>
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

static const char *skip_sign(const char *at, const char *end)
{
    return at + (at < end && (*at == '-' || *at == '+'));
}

const char *number_parse_integer(const char *at, const char *end, int64_t least, int64_t most, int64_t *value)
{
    bool negative = at < end && *at == '-';
    const char *digits = skip_sign(at, end);
    uint64_t magnitude = 0;
    for (at = digits; at < end && is_digit(*at); at++) {
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

/* The end of nan or inf, in upper or lower case; NULL: neither. */
static const char *skip_special(const char *first, const char *end)
{
    bool special = end - first >= 3 && ends_number(first + 3, end) &&
                   (strncasecmp(first, "nan", 3) == 0 || strncasecmp(first, "inf", 3) == 0);
    return special ? first + 3 : NULL;
}

static const char *skip_digits(const char *at, const char *end)
{
    while (at < end && is_digit(*at)) {
        at++;
    }
    return at;
}

/* The end of the decimal number that begins here, behind its sign; NULL: there is none. (strtod also accepts
 * leading blanks, hexadecimal numbers, "infinity", and "nan(...)".) */
static const char *skip_decimal(const char *first, const char *end)
{
    const char *at = skip_digits(first, end);
    int64_t digits = at - first;
    if (at < end && *at == '.') {
        const char *fraction = at + 1;
        at = skip_digits(fraction, end);
        digits += at - fraction;
    }
    if (digits > 0 && at < end && (*at == 'e' || *at == 'E')) {
        const char *exponent = skip_sign(at + 1, end);
        at = skip_digits(exponent, end);
        digits = at - exponent;
    }
    return digits > 0 && ends_number(at, end) ? at : NULL;
}

/* Copy the number at `at` into text[]; *special: it is nan or inf. Returns its end, or NULL: there is
 * none. */
static const char *copy_number(const char *at, const char *end, char text[NUMBER_LIMIT + 1], bool *special)
{
    const char *first = skip_sign(at, end), *last = skip_special(first, end);
    *special = last != NULL;
    last = *special ? last : skip_decimal(first, end);
    if (last == NULL || last - at > NUMBER_LIMIT) {
        return NULL;
    }
    memcpy(text, at, (size_t)(last - at));
    text[last - at] = '\0';
    return last;
}

const char *number_parse_double(const char *at, const char *end, double *value)
{
    char text[NUMBER_LIMIT + 1];
    bool special;
    const char *last = copy_number(at, end, text, &special);
    if (last == NULL) {
        return NULL;
    }
    *value = strtod(text, NULL);
    return special || isfinite(*value) ? last : NULL;
}

const char *number_parse_float(const char *at, const char *end, float *value)
{
    char text[NUMBER_LIMIT + 1];
    bool special;
    const char *last = copy_number(at, end, text, &special);
    if (last == NULL) {
        return NULL;
    }
    *value = strtof(text, NULL);
    return special || isfinite(*value) ? last : NULL;
}

size_t number_format_integer(char *text, int64_t value)
{
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%" PRId64, value);
}

/* -nan is written as nan: the sign of a NaN has no meaning. */
size_t number_format_double(char *text, double value)
{
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%.17g", isnan(value) ? NAN : value);
}

size_t number_format_float(char *text, float value)
{
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%.9g", isnan(value) ? (double)NAN : (double)value);
}
