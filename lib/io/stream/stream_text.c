/* Numbers from and to text: strict syntax, correctly rounded by the C library; and the rows of a section that
 * are text. */
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- numbers ---- */

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

/* ---- rows ---- */

enum status fail_short(const struct section *section, int64_t row, struct error *error)
{
    return fail(error, STATUS_INPUT, "%s: row %jd of %jd: cut short (did an earlier stage fail?)",
                section->name, row, section->rows);
}

/* Parse the number at `at` into element `index` of the payload; returns the byte behind it, or NULL. */
static const char *parse_element(enum element_type type, const char *at, const char *end, void *data,
                                 int64_t index)
{
    int64_t integer = 0;
    switch (type) {
    case TYPE_I4:
        at = number_parse_integer(at, end, INT32_MIN, INT32_MAX, &integer);
        ((int32_t *)data)[index] = (int32_t)integer;
        return at;
    case TYPE_I8:
        return number_parse_integer(at, end, INT64_MIN, INT64_MAX, (int64_t *)data + index);
    case TYPE_F4:
        return number_parse_float(at, end, (float *)data + index);
    case TYPE_F8:
        return number_parse_double(at, end, (double *)data + index);
    }
    return NULL;
}

/* The error of the word at input->at, where a number of `section` is expected. */
static enum status fail_word(const struct input *input, const struct section *section, int64_t row,
                             int64_t column, struct error *error)
{
    int length = 0;
    const char *word = input->at;
    while (length < 40 && word + length < input->end && strchr(" \t\n", word[length]) == NULL) {
        length++;
    }
    if (length == 0) {
        if (word == input->end) {
            return fail_short(section, row, error);
        }
        return fail(error, STATUS_INPUT, "%s: row %jd: %jd numbers instead of %jd", section->name, row,
                    column, section->cols);
    }
    if (word[0] == '#') {
        return fail(error, STATUS_INPUT, "%s: row %jd: a header line: fewer rows than the %jd announced",
                    section->name, row, section->rows);
    }
    if (memchr(word, ',', (size_t)length) != NULL) {
        return fail(error, STATUS_INPUT, "%s: row %jd: '%.*s': write a decimal point, not a comma",
                    section->name, row, length, word);
    }
    return fail(error, STATUS_INPUT, "%s: row %jd: '%.*s' is not a number of type %s", section->name, row,
                length, word, element_type_name(section->type));
}

static void skip_blanks(struct input *input)
{
    while (input->at < input->end && (*input->at == ' ' || *input->at == '\t')) {
        input->at++;
    }
}

/* Read the end of a line of text: blanks, then the newline. */
static enum status row_end(struct input *input, const struct section *section, int64_t row,
                           struct error *error)
{
    skip_blanks(input);
    if (input->at == input->end) {
        return fail_short(section, row, error);
    }
    if (*input->at == '\n') {
        input->at++;
        return STATUS_OK;
    }
    return fail(error, STATUS_INPUT, "%s: row %jd: more than %jd numbers", section->name, row, section->cols);
}

static enum status text_row(struct input *input, const struct section *section, int64_t row,
                            struct error *error)
{
    for (int64_t column = 0; column < section->cols; column++) {
        skip_blanks(input);
        const char *behind =
            parse_element(section->type, input->at, input->end, section->data, row * section->cols + column);
        if (behind == NULL) {
            return fail_word(input, section, row, column, error);
        }
        input->at = behind;
    }
    return row_end(input, section, row, error);
}

enum status payload_read_text(struct input *input, struct section *section, struct error *error)
{
    /* A number takes a byte and another one behind it: more than this the input does not hold. */
    int64_t total = section->rows * section->cols, most = (input->end - input->at) / 2 + 1;
    section->data = array_new(total < most ? total : most, element_size(section->type));
    section->owned = true;
    if (section->data == NULL) {
        return fail_memory(error, "payload");
    }
    for (int64_t row = 0; row < section->rows; row++) {
        RETURN_IF_ERROR(text_row(input, section, row, error));
    }
    for (int64_t blank = 0; blank < 2; blank++) {
        skip_blanks(input);
        if (input->at < input->end && *input->at != '\n') {
            return fail(error, STATUS_INPUT, "%s: more than %jd rows, or not two blank lines behind them",
                        section->name, section->rows);
        }
        RETURN_IF_ERROR(row_end(input, section, section->rows, error));
    }
    return STATUS_OK;
}
