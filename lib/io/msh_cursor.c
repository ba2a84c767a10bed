#include "io/msh_cursor.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TOKEN_SIZE = 64 };

enum status msh_cursor_fail(const struct msh_cursor *cursor, const char *format, ...)
{
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (cursor->record == 0) {
        return fail(cursor->error, STATUS_INPUT, "%s: %s", cursor->section, message);
    }
    return fail(cursor->error, STATUS_INPUT, "%s: %s %lld: %s", cursor->section, cursor->kind,
                (long long)cursor->record, message);
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

void msh_skip_space(struct msh_cursor *cursor)
{
    while (cursor->at < cursor->end && is_space(*cursor->at)) {
        cursor->at++;
    }
}

enum status msh_skip_line(struct msh_cursor *cursor)
{
    while (cursor->at < cursor->end && *cursor->at != '\n') {
        if (!is_space(*cursor->at++)) {
            return msh_cursor_fail(cursor, "something follows on the line");
        }
    }
    if (cursor->at == cursor->end) {
        return msh_cursor_fail(cursor, "the file ends here: it is truncated");
    }
    cursor->at++;
    return STATUS_OK;
}

/* The next word of an ASCII file. */
static enum status next_token(struct msh_cursor *cursor, const char *what, char token[TOKEN_SIZE])
{
    msh_skip_space(cursor);
    size_t length = 0;
    while (cursor->at < cursor->end && !is_space(*cursor->at)) {
        if (length + 1 == TOKEN_SIZE) {
            return msh_cursor_fail(cursor, "%s: no number", what);
        }
        token[length++] = *cursor->at++;
    }
    token[length] = '\0';
    if (length == 0) {
        return msh_cursor_fail(cursor, "%s: the file ends here: it is truncated", what);
    }
    return STATUS_OK;
}

static enum status next_bytes(struct msh_cursor *cursor, const char *what, size_t size, void *bytes)
{
    if ((size_t)(cursor->end - cursor->at) < size) {
        return msh_cursor_fail(cursor, "%s: the file ends here: it is truncated", what);
    }
    memcpy(bytes, cursor->at, size);
    cursor->at += size;
    return STATUS_OK;
}

/* Decimal digits, with or without a sign, that fit into 64 bits. */
static bool parse_whole(const char *token, int64_t *value)
{
    bool negative = token[0] == '-';
    const char *at = token + (negative || token[0] == '+');
    if (*at == '\0') {
        return false;
    }
    int64_t number = 0;
    for (; *at != '\0'; at++) {
        if (*at < '0' || *at > '9' || __builtin_mul_overflow(number, (int64_t)10, &number) ||
            __builtin_add_overflow(number, (int64_t)(*at - '0'), &number)) {
            return false;
        }
    }
    *value = negative ? -number : number;
    return true;
}

static enum status next_whole(struct msh_cursor *cursor, const char *what, bool wide, int64_t least,
                              int64_t most, int64_t *value)
{
    enum status status;
    if (!cursor->binary) {
        char token[TOKEN_SIZE];
        status = next_token(cursor, what, token);
        if (status == STATUS_OK && !parse_whole(token, value)) {
            return msh_cursor_fail(cursor, "%s: '%s' is not a whole number", what, token);
        }
    } else if (wide) {
        status = next_bytes(cursor, what, sizeof *value, value);
    } else {
        int32_t narrow = 0;
        status = next_bytes(cursor, what, sizeof narrow, &narrow);
        *value = narrow;
    }
    if (status == STATUS_OK && (*value < least || *value > most)) {
        return msh_cursor_fail(cursor, "%s: %lld is not within [%lld, %lld]", what, (long long)*value,
                               (long long)least, (long long)most);
    }
    return status;
}

enum status msh_next_int(struct msh_cursor *cursor, const char *what, int64_t least, int64_t most,
                         int64_t *value)
{
    return next_whole(cursor, what, false, least, most, value);
}

enum status msh_next_size(struct msh_cursor *cursor, const char *what, int64_t least, int64_t most,
                          int64_t *value)
{
    return next_whole(cursor, what, true, least, most, value);
}

enum status msh_next_count(struct msh_cursor *cursor, const char *what, int64_t ascii, int64_t binary,
                           int64_t *value)
{
    enum status status = msh_next_size(cursor, what, 0, INT64_MAX, value);
    int64_t left = cursor->end - cursor->at;
    if (status == STATUS_OK && *value > left / (cursor->binary ? binary : ascii)) {
        return msh_cursor_fail(cursor, "%s: %lld cannot be in the %lld bytes that are left", what,
                               (long long)*value, (long long)left);
    }
    return status;
}

enum status msh_next_count_line(struct msh_cursor *cursor, const char *what, int64_t least, int64_t *value)
{
    bool binary = cursor->binary;
    cursor->binary = false;
    enum status status = msh_next_count(cursor, what, least, least, value);
    cursor->binary = binary;
    return status == STATUS_OK ? msh_skip_line(cursor) : status;
}

enum status msh_next_real(struct msh_cursor *cursor, const char *what, double *value)
{
    if (cursor->binary) {
        return next_bytes(cursor, what, sizeof *value, value);
    }
    char token[TOKEN_SIZE];
    enum status status = next_token(cursor, what, token);
    if (status == STATUS_OK) {
        char *end = NULL;
        *value = strtod(token, &end);
        if (*end != '\0') {
            return msh_cursor_fail(cursor, "%s: '%s' is not a number", what, token);
        }
    }
    return status;
}
