/* Numbers from text: strict, correctly rounded, independent of the locale.
 *
 * A decimal number is a whole number of up to 19 digits times a power of ten. Where both fit a double
 * exactly, one operation gives the result (Clinger 1990). Else 128 bits of the power decide (after Lemire
 * 2021), and where they do not, because the number lies too close to the middle between two doubles, strtod
 * does. */
#include "io/stream_private.h"

#include <float.h>
#include <math.h>
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

/* A decimal number taken apart: digits * 10^power; exact unless there are more than 19 digits. */
struct decimal {
    const char *begin, *end; /* the text */
    uint64_t digits;
    int64_t power;
    bool negative;
    bool exact;
};

/* Take apart the decimal number at `at`; false when there is none. */
static bool scan_decimal(const char *at, const char *end, struct decimal *decimal)
{
    const char *c = at;
    uint64_t digits = 0;
    decimal->negative = c < end && *c == '-';
    c += c < end && (*c == '-' || *c == '+');
    const char *whole = c;
    for (; c < end && is_digit(*c); c++) {
        digits = 10 * digits + (uint64_t)(*c - '0');
    }
    int64_t count = c - whole;
    int64_t power = 0;
    if (c < end && *c == '.') {
        const char *fraction = ++c;
        for (; c < end && is_digit(*c); c++) {
            digits = 10 * digits + (uint64_t)(*c - '0');
        }
        power = fraction - c;
        count -= power;
    }
    if (count == 0) {
        return false;
    }
    if (count > 19) { /* leading zeros do not count */
        const char *first = whole;
        while (first < c && (*first == '0' || *first == '.')) {
            count -= *first++ == '0';
        }
    }
    decimal->exact = count <= 19;
    if (c < end && (*c == 'e' || *c == 'E')) {
        c++;
        bool negative = c < end && *c == '-';
        c += c < end && (*c == '-' || *c == '+');
        if (c == end || !is_digit(*c)) {
            return false;
        }
        int64_t exponent = 0;
        for (; c < end && is_digit(*c); c++) {
            exponent = exponent < 100000 ? 10 * exponent + (*c - '0') : exponent;
        }
        power += negative ? -exponent : exponent;
    }
    decimal->begin = at;
    decimal->end = c;
    decimal->digits = digits;
    decimal->power = power;
    return ends_number(c, end) && c - at <= NUMBER_LIMIT;
}

/* Whole numbers and powers of ten that doubles hold exactly. */
static bool convert_exact(const struct decimal *decimal, double *value)
{
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (decimal->digits == 0) {
        *value = decimal->negative ? -0.0 : 0.0;
        return true;
    }
    if (decimal->digits > UINT64_C(1) << DBL_MANT_DIG || decimal->power < -22 || decimal->power > 22) {
        return false;
    }
    double magnitude = (double)decimal->digits;
    magnitude = decimal->power < 0 ? magnitude / powers[-decimal->power] : magnitude * powers[decimal->power];
    *value = decimal->negative ? -magnitude : magnitude;
    return true;
}

__extension__ typedef unsigned __int128 uint128;

/* Normal numbers by 128 bits of the power of ten; false where they do not decide. digits > 0. */
static bool convert_wide(const struct decimal *decimal, double *value)
{
    enum { SURPLUS = 128 - DBL_MANT_DIG, MARGIN = 2 * (POWER_ERROR + 1) };
    uint64_t high, low;
    if (decimal->power < POWER_LEAST || decimal->power > POWER_MOST) {
        return false;
    }
    power_of_ten((int)decimal->power, &high, &low);
    int shift = __builtin_clzll(decimal->digits);
    uint64_t digits = decimal->digits << shift;
    /* number * 2^exponent <= magnitude < (number + POWER_ERROR + 1) * 2^exponent */
    uint128 number = (uint128)digits * high + (uint64_t)(((uint128)digits * low) >> 64);
    int exponent = power_exponent((int)decimal->power) - shift + 64;
    if (number >> 127 == 0) {
        number <<= 1;
        exponent--;
    }
    uint128 half = (uint128)1 << (SURPLUS - 1);
    uint128 remainder = number & (2 * half - 1);
    if (remainder + MARGIN >= half && remainder <= half) {
        return false;
    }
    uint64_t mantissa = (uint64_t)(number >> SURPLUS) + (remainder > half);
    exponent += SURPLUS;
    if (mantissa >> DBL_MANT_DIG != 0) {
        mantissa >>= 1;
        exponent++;
    }
    int biased = exponent + DBL_MANT_DIG - 1 + DBL_MAX_EXP - 1;
    if (biased < 1 || biased > 2 * DBL_MAX_EXP - 2) {
        return false;
    }
    uint64_t bits = (uint64_t)decimal->negative << 63 | (uint64_t)biased << (DBL_MANT_DIG - 1) |
                    (mantissa & ((UINT64_C(1) << (DBL_MANT_DIG - 1)) - 1));
    memcpy(value, &bits, sizeof bits);
    return true;
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

/* The text of the number, ended by a zero, for strtod. */
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
        return parse_special(at, end, value);
    }
    if (decimal.exact && (convert_exact(&decimal, value) || convert_wide(&decimal, value))) {
        return decimal.end;
    }
    *value = strtod(decimal_text(&decimal, text), NULL);
    return isfinite(*value) ? decimal.end : NULL;
}

/* Rounding a double again is right unless it lies exactly in the middle between two normal floats. */
static bool narrow(double wide, float *value)
{
    uint64_t bits;
    double magnitude = fabs(wide);
    memcpy(&bits, &wide, sizeof bits);
    enum { DROPPED = DBL_MANT_DIG - FLT_MANT_DIG };
    if (magnitude != 0 && (magnitude < (double)FLT_MIN || magnitude > (double)FLT_MAX ||
                           (bits & ((UINT64_C(1) << DROPPED) - 1)) == UINT64_C(1) << (DROPPED - 1))) {
        return false;
    }
    *value = (float)wide;
    return true;
}

const char *number_parse_float(const char *at, const char *end, float *value)
{
    char text[NUMBER_LIMIT + 1];
    struct decimal decimal;
    double wide;
    if (!scan_decimal(at, end, &decimal)) {
        const char *behind = parse_special(at, end, &wide);
        *value = behind != NULL ? (float)wide : 0;
        return behind;
    }
    if (decimal.exact && (convert_exact(&decimal, &wide) || convert_wide(&decimal, &wide)) &&
        narrow(wide, value)) {
        return decimal.end;
    }
    *value = strtof(decimal_text(&decimal, text), NULL);
    return isfinite(*value) ? decimal.end : NULL;
}
