/* Numbers from and to text: strict, correctly rounded by the C library. */
#include "io/stream_private.h"

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

/* A number in text: digits * 10^power; exact unless there are more than 19 digits. */
struct decimal {
    const char *begin, *end;
    uint64_t digits;
    int64_t power;
    bool negative, exact, special; /* special: nan or inf */
};

/* nan or inf with or without a sign, in any case. */
static bool scan_special(const char *first, const char *end, struct decimal *decimal)
{
    decimal->special = true;
    decimal->end = first + 3;
    return end - first >= 3 && ends_number(first + 3, end) &&
           (strncasecmp(first, "nan", 3) == 0 || strncasecmp(first, "inf", 3) == 0);
}

/* Take apart the number at `at`; false when there is none. (strtod would accept blanks before it, hexadecimal
 * numbers, "infinity", "nan(...)".) */
static bool scan_decimal(const char *at, const char *end, struct decimal *decimal)
{
    int64_t count = 0; /* of digits, without leading zeros */
    bool any = false, in_fraction = false;
    const char *first = skip_sign(at, end), *c = first;
    *decimal = (struct decimal){.begin = at, .negative = first > at && *at == '-'};
    for (; c < end && (is_digit(*c) || (*c == '.' && !in_fraction)); c++) {
        if (*c == '.') {
            in_fraction = true;
            continue;
        }
        decimal->digits = 10 * decimal->digits + (uint64_t)(*c - '0');
        decimal->power -= in_fraction;
        count += count > 0 || *c != '0';
        any = true;
    }
    if (!any) {
        return scan_special(first, end, decimal);
    }
    decimal->exact = count <= 19;
    if (c < end && (*c == 'e' || *c == 'E')) {
        const char *sign = c + 1, *digits = skip_sign(sign, end);
        int64_t exponent = 0;
        for (c = digits; c < end && is_digit(*c); c++) {
            exponent = exponent < 100000 ? 10 * exponent + (*c - '0') : exponent;
        }
        if (c == digits) {
            return false;
        }
        decimal->power += *sign == '-' ? -exponent : exponent;
    }
    decimal->end = c;
    return ends_number(c, end) && c - at <= NUMBER_LIMIT;
}

__extension__ typedef unsigned __int128 uint128;

static uint64_t power_of_five(int64_t power)
{
    uint64_t result = 1, square = 5;
    for (; power > 0; power /= 2) {
        result *= power % 2 == 1 ? square : 1;
        square *= square;
    }
    return result;
}

/* Correctly rounded, by whole numbers: 10^p = 5^p 2^p, and 5^27 has 63 bits. False where that does not do. A
 * field in text is read in half the time that strtod takes. */
static bool convert_short(const struct decimal *decimal, double *value)
{
    enum { MOST_POWER = 27 };
    int64_t power = decimal->power;
    if (!decimal->exact || power < -MOST_POWER || power > MOST_POWER) {
        return false;
    }
    uint128 number = decimal->digits;
    int exponent = (int)power;
    if (power >= 0) {
        number *= power_of_five(power);
    } else if (number > 0) {
        uint64_t divisor = power_of_five(-power);
        int shift = 63 + __builtin_clzll(decimal->digits);
        number <<= shift;
        /* The quotient has 63 bits or more: the last one may stand for all that follow. */
        number = number / divisor | (number % divisor != 0);
        exponent -= shift;
    }
    *value = ldexp((double)number, exponent);
    *value = decimal->negative ? -*value : *value;
    return true;
}

/* The number's text, ended by a zero, for strtod. */
static const char *decimal_text(const struct decimal *decimal, char text[NUMBER_LIMIT + 1])
{
    size_t length = (size_t)(decimal->end - decimal->begin);
    memcpy(text, decimal->begin, length);
    text[length] = '\0';
    return text;
}

const char *number_parse_double(const char *at, const char *end, double *value)
{
    char text[NUMBER_LIMIT + 1];
    struct decimal decimal;
    if (!scan_decimal(at, end, &decimal)) {
        return NULL;
    }
    if (decimal.special || !convert_short(&decimal, value)) {
        *value = strtod(decimal_text(&decimal, text), NULL);
    }
    return decimal.special || isfinite(*value) ? decimal.end : NULL;
}

const char *number_parse_float(const char *at, const char *end, float *value)
{
    char text[NUMBER_LIMIT + 1];
    struct decimal decimal;
    if (!scan_decimal(at, end, &decimal)) {
        return NULL;
    }
    *value = strtof(decimal_text(&decimal, text), NULL);
    return decimal.special || isfinite(*value) ? decimal.end : NULL;
}

size_t number_format_integer(char *text, int64_t value)
{
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%" PRId64, value);
}

/* -nan is written as nan: the sign of a NaN means nothing. */
size_t number_format_double(char *text, double value)
{
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%.17g", isnan(value) ? NAN : value);
}

size_t number_format_float(char *text, float value)
{
    return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%.9g", isnan(value) ? (double)NAN : (double)value);
}
