/* Reading the rows of a section. The array grows with the data, so that a header alone allocates little. */
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* The array of a section while it grows. */
struct payload {
    char *data;     /* from array_new */
    int64_t room;   /* elements allocated */
    int64_t filled; /* elements present */
    int64_t total;  /* elements announced */
    size_t size;    /* bytes of one */
};

static enum status payload_grow(struct payload *payload, struct error *error)
{
    int64_t first = (int64_t)(4 * BLOCK_SIZE / payload->size);
    int64_t room = payload->room == 0 ? first : 2 * payload->room;
    room = room < payload->total ? room : payload->total;
    char *grown = array_new(room, payload->size);
    if (grown == NULL) {
        return fail_memory(error, "payload");
    }
    if (payload->filled > 0) {
        memcpy(grown, payload->data, (size_t)payload->filled * payload->size);
    }
    free(payload->data);
    payload->data = grown;
    payload->room = room;
    return STATUS_OK;
}

enum status fail_short(const struct section *section, int64_t row, struct error *error)
{
    return fail(error, STATUS_INPUT, "%s: row %lld of %lld: cut short (did an earlier stage fail?)",
                section->name, (long long)row, (long long)section->rows);
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
    const char *text = element_type_name(section->type);
    if (length == 0) {
        if (word == input->end) {
            return fail_short(section, row, error);
        }
        return fail(error, STATUS_INPUT, "%s: row %lld: %lld numbers instead of %lld", section->name,
                    (long long)row, (long long)column, (long long)section->cols);
    }
    if (word[0] == '#') {
        return fail(error, STATUS_INPUT, "%s: row %lld: a header line: fewer rows than the %lld announced",
                    section->name, (long long)row, (long long)section->rows);
    }
    if (memchr(word, ',', (size_t)length) != NULL) {
        return fail(error, STATUS_INPUT, "%s: row %lld: '%.*s': write a decimal point, not a comma",
                    section->name, (long long)row, length, word);
    }
    if (memchr(word, '\r', (size_t)length) != NULL) {
        return fail(error, STATUS_INPUT, "%s: row %lld: lines end in CR LF: remove them with tr -d '\\r'",
                    section->name, (long long)row);
    }
    return fail(error, STATUS_INPUT, "%s: row %lld: '%.*s' is not a number of type %s", section->name,
                (long long)row, length, word, text);
}

static void skip_blanks(struct input *input)
{
    while (input->at < input->end && (*input->at == ' ' || *input->at == '\t')) {
        input->at++;
    }
}

/* Make a whole number and the blanks around it available. */
static enum status refill(struct input *input, struct error *error)
{
    if (input->end - input->at >= 2 * NUMBER_LIMIT || input->ended) {
        return STATUS_OK;
    }
    return input_fill(input, 2 * NUMBER_LIMIT, error);
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
    if (*input->at == '\r') {
        return fail(error, STATUS_INPUT, "%s: row %lld: lines end in CR LF: remove them with tr -d '\\r'",
                    section->name, (long long)row);
    }
    return fail(error, STATUS_INPUT, "%s: row %lld: more than %lld numbers", section->name, (long long)row,
                (long long)section->cols);
}

static enum status text_row(struct input *input, const struct section *section, int64_t row,
                            struct payload *payload, struct error *error)
{
    for (int64_t column = 0; column < section->cols; column++) {
        if (payload->filled == payload->room) {
            RETURN_IF_ERROR(payload_grow(payload, error));
        }
        RETURN_IF_ERROR(refill(input, error));
        skip_blanks(input);
        const char *behind =
            parse_element(section->type, input->at, input->end, payload->data, payload->filled);
        if (behind == NULL) {
            return fail_word(input, section, row, column, error);
        }
        input->at = behind;
        payload->filled++;
    }
    RETURN_IF_ERROR(refill(input, error));
    return row_end(input, section, row, error);
}

enum status payload_read_text(struct input *input, struct section *section, struct error *error)
{
    struct payload payload = {.total = section->rows * section->cols, .size = element_size(section->type)};
    enum status status = STATUS_OK;
    TRY(payload_grow(&payload, error));
    for (int64_t row = 0; row < section->rows; row++) {
        TRY(text_row(input, section, row, &payload, error));
    }
    for (int64_t blank = 0; blank < 2; blank++) {
        TRY(refill(input, error));
        skip_blanks(input);
        if (input->at < input->end && *input->at != '\n' && *input->at != '\r') {
            TRY(fail(error, STATUS_INPUT, "%s: more than %lld rows, or not two blank lines behind them",
                     section->name, (long long)section->rows));
        }
        TRY(row_end(input, section, section->rows, error));
    }
done:
    section->data = payload.data;
    section->owned = true;
    return status;
}

enum status payload_read_binary(struct input *input, struct section *section, struct error *error)
{
    struct payload payload = {.total = section->rows * section->cols, .size = element_size(section->type)};
    enum status status = STATUS_OK;
    do {
        TRY(payload_grow(&payload, error));
        size_t got;
        size_t wanted = (size_t)(payload.room - payload.filled) * payload.size;
        TRY(input_copy(input, payload.data + (size_t)payload.filled * payload.size, wanted, &got, error));
        payload.filled += (int64_t)(got / payload.size);
        if (got < wanted) {
            TRY(fail_short(section, payload.filled / section->cols, error));
        }
    } while (payload.filled < payload.total);
done:
    section->data = payload.data;
    section->owned = true;
    return status;
}
