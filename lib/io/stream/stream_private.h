/* Declarations shared by the files of the stream: limits, buffered input, header lines, numbers as text. */
#pragma once

#include "io/stream/stream.h"

#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "binary payloads are little-endian and used in place");

enum {
    NAME_LIMIT = 127,       /* bytes of a section's name */
    KEY_LIMIT = 63,         /* bytes of an attribute's key */
    LINE_LIMIT = 1 << 20,   /* bytes of a header or provenance line with its newline */
    COLUMN_LIMIT = 1 << 20, /* columns of a section */
    NUMBER_LIMIT = 2048,    /* bytes of a number in text */
    PAYLOAD_ALIGNMENT = 64, /* of a binary payload, from the start of the stream */
    BLOCK_SIZE = 1 << 20    /* bytes read or written at once */
};

/* stream.c: bounds that hold for every section, whether read or put. */
MUST_CHECK enum status section_validate(const struct section *section, struct error *error);

/* stream.c: take over a section, valid and in memory from malloc, in place of one of its name or as the last
 * one. It becomes empty; on failure it stays the caller's. */
MUST_CHECK enum status stream_add(struct stream *stream, struct section *section, struct error *error);

/* stream.c: release what a section owns; it becomes empty. */
void section_free(struct section *section);

/* stream.c: release the bytes of the input. */
void stream_free_input(struct stream *stream);

/* stream.c: release the pages of a section that is in the mapping: those of a file, which are read again when
 * needed, or `for_good` all. */
void section_give_back(const struct stream *stream, const struct section *section, bool for_good);

#define FIRST_LINE "# mts 1\n"

/* The bytes of the stream's input: the first byte, the next one, behind the last one. */
struct input {
    const char *start, *at, *end;
};

/* Whether a line of `length` bytes, not zero-terminated, starts with a prefix. */
static inline bool starts_with(const char *line, size_t length, const char *prefix)
{
    size_t size = strlen(prefix);
    return length >= size && memcmp(line, prefix, size) == 0;
}

/* stream_text.c: read rows of text and the two blank lines behind. The section owns what was read, also on
 * failure. */
MUST_CHECK enum status payload_read_text(struct input *input, struct section *section, struct error *error);

/* stream_text.c: the error of an input that ends in this row. */
enum status fail_short(const struct section *section, int64_t row, struct error *error);

/* stream_text.c: parse one number that ends at a blank, a line end or `end`. Returns the byte behind it, or
 * NULL if it is not a number of that type, or out of range. */
const char *number_parse_integer(const char *at, const char *end, int64_t least, int64_t most,
                                 int64_t *value);
const char *number_parse_double(const char *at, const char *end, double *value);
const char *number_parse_float(const char *at, const char *end, float *value);
