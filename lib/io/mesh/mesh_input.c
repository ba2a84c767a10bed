/* Numbers, words and names, as readers of mesh files take them. */
#include "io/mesh/msh_private.h"

#include "io/stream/stream_private.h"

#include <math.h>
#include <search.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
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
        r->status = fail(r->error, STATUS_INPUT, "%s: %s %jd: %s", r->section, r->kind, r->record, message);
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

static void next_bytes(struct msh_reader *r, const char *what, size_t size, void *bytes)
{
    if ((size_t)(r->end - r->at) < size) {
        msh_fail(r, "%s: the file ends here: it is truncated", what);
        return;
    }
    memcpy(bytes, r->at, size);
    r->at += size;
}

static int64_t within(struct msh_reader *r, const char *what, int64_t number, int64_t least, int64_t most)
{
    if (number < least || number > most) {
        msh_fail(r, "%s: %jd is not within [%jd, %jd]", what, number, least, most);
    }
    return r->status == STATUS_OK ? number : least;
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
    return within(r, what, number, least, most);
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

int64_t msh_count_line(struct msh_reader *r, const char *what)
{
    bool binary = r->binary;
    r->binary = false;
    int64_t count = msh_size(r, what, 0, INT64_MAX);
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

/* ---- other programs ---- */

int64_t input_whole(struct msh_reader *r, const char *what, const char *word, int64_t length, int64_t least,
                    int64_t most)
{
    int64_t number = least;
    const char *end = word + length;
    if (number_parse_integer(word, end, -INT64_MAX, INT64_MAX, &number) != end) {
        msh_fail(r, "%s: '%.*s' is not a whole number", what, length < 64 ? (int)length : 64, word);
    }
    return within(r, what, number, least, most);
}

double input_real(struct msh_reader *r, const char *what, const char *word, int64_t length)
{
    char text[64] = "";
    double number = 0;
    size_t size = length < (int64_t)sizeof text ? (size_t)length : 0;
    for (size_t i = 0; i < size; i++) {
        text[i] = word[i];
        if (word[i] == 'D' || word[i] == 'd') {
            text[i] = 'e';
        }
    }
    if (number_parse_double(text, text + size, &number) != text + size || !isfinite(number)) {
        msh_fail(r, "%s: '%.*s' is not a finite number", what, length < 64 ? (int)length : 64, word);
    }
    return r->status == STATUS_OK ? number : 0;
}

int input_type(int dim, int node_count)
{
    for (int type = 1; msh_type(type).name != NULL; type++) {
        if (msh_type(type).dim == dim && msh_type(type).node_count == node_count) {
            return type;
        }
    }
    return 0;
}

const char *input_word(const char **at, const char *end, char comma, int64_t *length)
{
    const char *word = *at;
    while (word < end && (input_is_blank(*word) || *word == comma)) {
        word++;
    }
    const char *behind = word;
    while (behind < end && !input_is_blank(*behind) && *behind != comma) {
        behind++;
    }
    *at = behind;
    *length = behind - word;
    return *length > 0 ? word : NULL;
}

int64_t input_add_group(struct msh_reader *r, int dim, const char *text, int64_t length)
{
    if (length < 1 || length > INPUT_NAME || memchr(text, '\0', (size_t)length) != NULL) {
        msh_fail(r, "a name is empty or longer than %d bytes", INPUT_NAME);
    }
    MSH_GROW(r, &r->names, r->name_count + 1, &r->name_room);
    if (r->status != STATUS_OK) {
        return 0;
    }
    char *copy = strndup(text, (size_t)length);
    r->status = owned_add(&r->texts, copy, "names", r->error);
    int64_t key = msh_key(dim, r->name_count + 1);
    r->names[r->name_count++] = (struct msh_name){key, copy, (int)length};
    return key;
}

struct name {
    int64_t number;
    int kind;
    char text[INPUT_NAME + 1];
};

static int compare_names(const void *left, const void *right)
{
    const struct name *a = left, *b = right;
    return a->kind != b->kind ? a->kind - b->kind : strcmp(a->text, b->text);
}

int64_t *input_name(struct msh_reader *r, int kind, const char *text, size_t length)
{
    struct name wanted = {.kind = kind};
    if (length < 1 || length > INPUT_NAME) {
        msh_fail(r, "a name is empty or longer than %d bytes", INPUT_NAME);
    }
    if (r->status != STATUS_OK) {
        return &r->no_number;
    }
    memcpy(wanted.text, text, length);
    struct name *const *found = tfind(&wanted, &r->numbered, compare_names);
    if (found != NULL) {
        return &(*found)->number;
    }
    SCRATCH struct name *name = malloc(sizeof *name);
    if (name == NULL || (*name = wanted, tsearch(name, &r->numbered, compare_names)) == NULL) {
        r->status = fail_memory(r->error, "names");
        return &r->no_number;
    }
    return &((struct name *)array_take(&name))->number;
}

int64_t input_group(struct msh_reader *r, int dim, const char *text)
{
    int64_t *key = input_name(r, dim, text, strlen(text));
    if (*key == 0) {
        *key = input_add_group(r, dim, text, (int64_t)strlen(text));
    }
    return *key;
}

void input_take_member(struct msh_reader *r)
{
    if (r->members-- <= 0) {
        msh_fail(r, "the sets have too many members for the size of the file");
    }
}

void input_leave_out(struct msh_reader *r, const char *what)
{
    char item[80] = ", ";
    text_append(item, sizeof item, "%s", what);
    const char *found = strstr(r->left_out, item);
    size_t length = strlen(item);
    bool is_new = found == NULL || (found[length] != '\0' && found[length] != ',');
    if (is_new && strlen(r->left_out) + length < sizeof r->left_out) {
        text_append(r->left_out, sizeof r->left_out, "%s", item);
    }
}

bool msh_next_line(struct msh_reader *r, const char **at, const char **end)
{
    if (r->status != STATUS_OK || r->at == r->end) {
        return false;
    }
    const char *newline = memchr(r->at, '\n', (size_t)(r->end - r->at));
    *at = r->at;
    *end = newline != NULL ? newline : r->end;
    r->at = newline != NULL ? newline + 1 : r->end;
    return true;
}
