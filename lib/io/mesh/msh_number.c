#include "io/mesh/msh_private.h"
#include "io/stream/stream_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Longer words are not numbers. */
enum { LONGEST_WORD = 63 };

void msh_fail(struct msh_reader *r, const char *format, ...)
{
    char message[256];
    va_list arguments;
    if (r->status != STATUS_OK) {
        return;
    }
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (r->record == 0) {
        r->status = fail(r->error, STATUS_INPUT, "%s: %s", r->section, message);
    } else {
        r->status = fail(r->error, STATUS_INPUT, "%s: %s %lld: %s", r->section, r->kind, (long long)r->record,
                         message);
    }
}

static bool is_space(char c)
{
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

void msh_skip_space(struct msh_reader *r)
{
    while (r->at < r->end && is_space(*r->at)) {
        r->at++;
    }
}

void msh_skip_line(struct msh_reader *r)
{
    for (; r->status == STATUS_OK && r->at < r->end; r->at++) {
        if (*r->at == '\n') {
            r->at++;
            return;
        }
        if (!is_space(*r->at)) {
            msh_fail(r, "something follows on the line");
        }
    }
    msh_fail(r, "the file ends here: it is truncated");
}

/* Step over the next word of a text file and return it; *length is 0 if there is none, which is a failure. */
static const char *next_word(struct msh_reader *r, const char *what, int *length)
{
    msh_skip_space(r);
    const char *word = r->at;
    while (r->at < r->end && !is_space(*r->at) && r->at - word <= LONGEST_WORD) {
        r->at++;
    }
    *length = (int)(r->at - word);
    if (*length == 0) {
        msh_fail(r, "%s: the file ends here: it is truncated", what);
    } else if (*length > LONGEST_WORD) {
        msh_fail(r, "%s: no number", what);
    }
    return word;
}

/* The next bytes of a binary file. */
static void next_bytes(struct msh_reader *r, const char *what, size_t size, void *bytes)
{
    if ((size_t)(r->end - r->at) < size) {
        msh_fail(r, "%s: the file ends here: it is truncated", what);
        return;
    }
    memcpy(bytes, r->at, size);
    r->at += size;
}

/* Read decimal digits, with or without a sign, that fit into 64 bits. */
static int64_t whole_of_text(struct msh_reader *r, const char *what)
{
    int length;
    const char *word = next_word(r, what, &length);
    int64_t number = 0;
    if (number_parse_integer(word, word + length, -INT64_MAX, INT64_MAX, &number) == NULL) {
        msh_fail(r, "%s: '%.*s' is not a whole number", what, length, word);
    }
    return number;
}

static int64_t whole(struct msh_reader *r, const char *what, bool wide, int64_t least, int64_t most)
{
    int64_t number = 0;
    if (r->status != STATUS_OK) {
        return least;
    }
    if (!r->binary) {
        number = whole_of_text(r, what);
    } else if (wide) {
        next_bytes(r, what, sizeof number, &number);
    } else {
        int32_t narrow = 0;
        next_bytes(r, what, sizeof narrow, &narrow);
        number = narrow;
    }
    if (number < least || number > most) {
        msh_fail(r, "%s: %lld is not within [%lld, %lld]", what, (long long)number, (long long)least,
                 (long long)most);
    }
    return r->status == STATUS_OK ? number : least;
}

int64_t msh_int(struct msh_reader *r, const char *what, int64_t least, int64_t most)
{
    return whole(r, what, false, least, most);
}

int64_t msh_size(struct msh_reader *r, const char *what, int64_t least, int64_t most)
{
    return whole(r, what, true, least, most);
}

int64_t msh_tag(struct msh_reader *r, const char *what, int64_t least, int64_t most)
{
    return whole(r, what, r->msh4, least, most);
}

int64_t msh_count(struct msh_reader *r, const char *what, int64_t text, int64_t binary)
{
    int64_t count = msh_size(r, what, 0, INT64_MAX);
    int64_t left = r->end - r->at;
    if (count > left / (r->binary ? binary : text)) {
        msh_fail(r, "%s: %lld cannot be in the %lld bytes that are left", what, (long long)count,
                 (long long)left);
    }
    return r->status == STATUS_OK ? count : 0;
}

int64_t msh_count_line(struct msh_reader *r, const char *what, int64_t least)
{
    bool binary = r->binary;
    r->binary = false;
    int64_t count = msh_count(r, what, least, least);
    r->binary = binary;
    msh_skip_line(r);
    return count;
}

double msh_real(struct msh_reader *r, const char *what)
{
    double number = 0;
    if (r->status != STATUS_OK) {
        return 0;
    }
    if (r->binary) {
        next_bytes(r, what, sizeof number, &number);
        return number;
    }
    int length;
    char text[LONGEST_WORD + 1];
    const char *word = next_word(r, what, &length);
    if (r->status == STATUS_OK) {
        char *end;
        memcpy(text, word, (size_t)length);
        text[length] = '\0';
        number = strtod(text, &end);
        if (end != text + length) {
            msh_fail(r, "%s: '%s' is not a number", what, text);
        }
    }
    return number;
}
