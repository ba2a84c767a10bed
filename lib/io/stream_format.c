/* Numbers to text, as printf's %.17g and %.9g, to the last digit.
 *
 * The number times a power of ten is a whole number of 17 (9) digits and a fraction, to be rounded. 128 bits
 * of the power decide how, but for numbers too close to a half; those are left to printf. */
#include "io/stream_private.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

__extension__ typedef unsigned __int128 uint128;

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

static size_t put_word(char *text, const char *word)
{
    size_t length = strlen(word);
    memcpy(text, word, length);
    return length;
}

/* magnitude = digits * 10^(exponent - precision + 1), rounded, with exactly `precision` digits; false where
 * 128 bits do not decide the rounding. magnitude > 0 and finite. */
static bool round_digits(double magnitude, int precision, uint64_t bound, uint64_t *digits, int *exponent)
{
    enum { MARGIN = POWER_ERROR + 1 };
    int binary;
    uint64_t mantissa =
        (uint64_t)ldexp(frexp(magnitude, &binary), 64); /* magnitude = mantissa * 2^(binary - 64) */
    /* The decimal exponent or one less: floor(log10(2^(binary - 1))). */
    *exponent = (int)(((int64_t)(binary - 1) * 78913) >> 18);
    for (;; ++*exponent) {
        uint64_t high, low;
        int power = precision - 1 - *exponent;
        power_of_ten(power, &high, &low);
        /* number / 2^shift <= magnitude * 10^power < (number + MARGIN) / 2^shift */
        uint128 number = (uint128)mantissa * high + (uint64_t)(((uint128)mantissa * low) >> 64);
        int shift = -(power_exponent(power) + binary);
        uint64_t whole = (uint64_t)(number >> shift);
        uint128 half = (uint128)1 << (shift - 1);
        uint128 fraction = number & (2 * half - 1);
        if (whole >= bound) {
            continue; /* one digit too many */
        }
        if (fraction <= half && fraction + MARGIN >= half) {
            return false;
        }
        *digits = whole + (fraction > half);
        if (*digits == bound) {
            *digits /= 10;
            ++*exponent;
        }
        return true;
    }
}

/* d.ddde+XX, without trailing zeros. */
static size_t put_scientific(char *text, const char *digits, size_t count, int exponent)
{
    size_t length = 0;
    text[length++] = digits[0];
    if (count > 1) {
        text[length++] = '.';
        memcpy(text + length, digits + 1, count - 1);
        length += count - 1;
    }
    text[length++] = 'e';
    text[length++] = exponent < 0 ? '-' : '+';
    int magnitude = exponent < 0 ? -exponent : exponent;
    if (magnitude >= 100) {
        text[length++] = (char)('0' + magnitude / 100);
    }
    text[length++] = (char)('0' + magnitude / 10 % 10);
    text[length++] = (char)('0' + magnitude % 10);
    return length;
}

/* ddd.ddd, 0.000ddd or ddd000, without trailing zeros; -5 < exponent < precision. */
static size_t put_fixed(char *text, const char *digits, size_t count, int exponent)
{
    size_t length = 0;
    if (exponent < 0) {
        length = put_word(text, "0.");
        memset(text + length, '0', (size_t)(-exponent - 1));
        length += (size_t)(-exponent - 1);
        memcpy(text + length, digits, count);
        return length + count;
    }
    size_t whole = (size_t)exponent + 1;
    if (count <= whole) {
        memcpy(text, digits, count);
        memset(text + count, '0', whole - count);
        return whole;
    }
    memcpy(text, digits, whole);
    text[whole] = '.';
    memcpy(text + whole + 1, digits + whole, count - whole);
    return count + 1;
}

/* As printf("%.*g", precision, value). `bound` is 10^precision. */
static size_t format_real(char *text, double value, int precision, uint64_t bound)
{
    char digits[DBL_DECIMAL_DIG];
    uint64_t number;
    int exponent;
    if (!isfinite(value)) {
        return put_word(text, isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
    }
    if (value == 0) {
        return put_word(text, signbit(value) ? "-0" : "0");
    }
    if (!round_digits(fabs(value), precision, bound, &number, &exponent)) {
        return (size_t)snprintf(text, NUMBER_TEXT_LIMIT, "%.*g", precision, value);
    }
    size_t sign = value < 0;
    text[0] = '-';
    for (int i = precision - 1; i >= 0; i--) {
        digits[i] = (char)('0' + number % 10);
        number /= 10;
    }
    size_t count = (size_t)precision;
    while (digits[count - 1] == '0') {
        count--;
    }
    return sign + (exponent < -4 || exponent >= precision
                       ? put_scientific(text + sign, digits, count, exponent)
                       : put_fixed(text + sign, digits, count, exponent));
}

size_t number_format_double(char *text, double value)
{
    return format_real(text, value, DBL_DECIMAL_DIG, UINT64_C(100000000000000000));
}

size_t number_format_float(char *text, float value)
{
    return format_real(text, (double)value, FLT_DECIMAL_DIG, UINT64_C(1000000000));
}
