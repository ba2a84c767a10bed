#include "io/mesh/mesh_input.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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

void msh_skip_space(struct msh_reader *r)
{
    while (r->at < r->end && input_is_blank(*r->at)) {
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
        if (!input_is_blank(*r->at)) {
            msh_fail(r, "something follows on the line");
        }
    }
    msh_fail(r, "the file ends here: it is truncated");
}

/* The next word of a text file; NULL after a failure. */
static const char *next_word(struct msh_reader *r, const char *what, int64_t *length)
{
    const char *word = input_word(&r->at, r->end, ' ', length);
    if (word == NULL) {
        msh_fail(r, "%s: the file ends here: it is truncated", what);
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

static int64_t whole(struct msh_reader *r, const char *what, bool wide, int64_t least, int64_t most)
{
    int64_t number = 0, length;
    if (r->status != STATUS_OK) {
        return least;
    }
    if (!r->binary) {
        const char *word = next_word(r, what, &length);
        return word != NULL ? input_whole(r, what, word, length, least, most) : least;
    }
    if (wide) {
        next_bytes(r, what, sizeof number, &number);
    } else {
        int32_t narrow = 0;
        next_bytes(r, what, sizeof narrow, &narrow);
        number = narrow;
    }
    return input_within(r, what, number, least, most);
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
    int64_t length;
    if (r->status != STATUS_OK) {
        return 0;
    }
    if (!r->binary) {
        const char *word = next_word(r, what, &length);
        return word != NULL ? input_real(r, what, word, length) : 0;
    }
    next_bytes(r, what, sizeof number, &number);
    if (!isfinite(number)) {
        msh_fail(r, "%s: %g is not a finite number", what, number);
    }
    return number;
}
