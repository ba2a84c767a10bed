/* Numbers from and to text: strict syntax, correctly rounded by the C library. */
#include "io/stream/stream_private.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool ends_number(const char *at, const char *end)
{
    return at == end || *at == ' ' || *at == '\t' || *at == '\n';
}

const char *number_parse_integer(const char *at, const char *end, int64_t least, int64_t most, int64_t *value)
{
    bool negative = at < end && *at == '-';
    const char *digits = at + (at < end && (*at == '-' || *at == '+'));
    uint64_t magnitude = 0;
    for (at = digits; at < end && *at >= '0' && *at <= '9'; at++) {
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

/* Copy the word at `at`, which may be a number, into text[]; *special: it is nan or inf. Returns its end;
 * NULL: strtod would accept more than the numbers of a stream, as hexadecimal ones, "infinity", and
 * "nan(...)". */
static const char *copy_word(const char *at, const char *end, char text[NUMBER_LIMIT + 1], bool *special)
{
    size_t length = 0;
    while (length <= NUMBER_LIMIT && !ends_number(at + length, end)) {
        text[length] = at[length];
        length++;
    }
    if (length == 0 || length > NUMBER_LIMIT) {
        return NULL;
    }
    text[length] = '\0';
    const char *first = text + (text[0] == '-' || text[0] == '+');
    *special = strcasecmp(first, "nan") == 0 || strcasecmp(first, "inf") == 0;
    return *special || strspn(text, "+-.0123456789eE") == length ? at + length : NULL;
}

const char *number_parse_double(const char *at, const char *end, double *value)
{
    char text[NUMBER_LIMIT + 1], *last;
    bool special;
    const char *behind = copy_word(at, end, text, &special);
    *value = behind != NULL ? strtod(text, &last) : 0.0;
    return behind != NULL && *last == '\0' && (special || isfinite(*value)) ? behind : NULL;
}

const char *number_parse_float(const char *at, const char *end, float *value)
{
    char text[NUMBER_LIMIT + 1], *last;
    bool special;
    const char *behind = copy_word(at, end, text, &special);
    *value = behind != NULL ? strtof(text, &last) : 0.0F;
    return behind != NULL && *last == '\0' && (special || isfinite(*value)) ? behind : NULL;
}

/* -nan is printed as nan: the sign of a NaN has no meaning. */
static size_t print_real(char *text, const char *format, double value)
{
    return (size_t)snprintf(text, SECTION_NUMBER, format, isnan(value) ? NAN : value);
}

size_t section_print(const struct section *section, int64_t index, char text[SECTION_NUMBER])
{
    const void *data = section->data;
    switch (section->type) {
    case TYPE_F4:
        return print_real(text, "%.9g", (double)((const float *)data)[index]);
    case TYPE_F8:
        return print_real(text, "%.17g", ((const double *)data)[index]);
    default:
        return (size_t)snprintf(text, SECTION_NUMBER, "%" PRId64,
                                section->type == TYPE_I8 ? ((const int64_t *)data)[index]
                                                         : (int64_t)((const int32_t *)data)[index]);
    }
}
