/* Headers of text, `key: value` (NRRD) or `key = value` (MetaImage), in front of the values or in a file of
 * their own; private to lib/io. */
#pragma once

#include "io/image/image_private.h"

#include <stdio.h>

/* A header that is read line by line. */
struct text_header {
    struct image_bytes *file;
    char separator;           /* ':' or '=' */
    char *line;               /* in the file */
    const int64_t *dimension; /* of the image, as the header gives it; 0: not yet */
    char *key;                /* of the field read last; NULL: the header has ended */
    char *value;
    bool is_pair;      /* it is KEY:=VALUE */
    bool cut;          /* the file has ended without an empty line */
    uint64_t given;    /* bit f: field f of the table of header_set was there */
    char unknown[200]; /* keys that are not in it, ", " before each */
};

/* Read a line into header->line, without its end and trailing blanks. STATUS_INPUT for a NUL. */
MUST_CHECK enum status header_line(struct text_header *header, struct error *error);

/* Read the next field; comment lines of NRRD are skipped. */
MUST_CHECK enum status header_next(struct text_header *header, struct error *error);

/* The keys of a field, A|B, and what takes its value: a function, NULL where only whether it is there counts;
 * or a place in the context: of a whole number (int64_t) from least to most, of numbers (double), one for
 * each dimension or pair of these; of an image_layout, for the type of the values or their file; of the
 * number (int) of one of some words, A|B each; of a pointer to the image, which it describes.
 * HEADER_LEFT: it is known, and means nothing here. */
struct header_field {
    const char *keys;
    enum {
        HEADER_SET,
        HEADER_INTEGER,
        HEADER_VECTOR,
        HEADER_MATRIX,
        HEADER_TYPE,
        HEADER_FILE,
        HEADER_WORD,
        HEADER_TEXT,
        HEADER_LEFT
    } kind;
    size_t at; /* offset in the context */
    int64_t least, most;
    const char *words; /* with blanks between them */
    enum status (*set)(void *context, const struct text_header *header, struct error *error);
};

/* Most bytes that may be skipped. */
#define HEADER_SKIP ((int64_t)1 << 50)

/* Take the value of the field read last, and note that it is there; the table has at most 64 fields.
 * STATUS_INPUT for one that stands twice. */
MUST_CHECK enum status header_set(struct text_header *header, const struct header_field *fields, size_t count,
                                  void *context, struct error *error);

/* Note in the image which keys were not in the table. */
void header_note_unknown(const struct text_header *header, struct image *image);

/* Whether field f of the table was there. */
static inline bool header_has(const struct text_header *header, int f)
{
    return (header->given >> f & 1) != 0;
}

/* fail() with STATUS_INPUT for the field read last: "header: KEY: VALUE: WHY". */
enum status header_fail(const struct text_header *header, const char *why, struct error *error);

/* Take `count` numbers, NAN among them, separated by blanks or commas, from *at on. */
bool header_numbers(const char **at, int count, double *numbers);

/* The value is a whole number from least to most. */
MUST_CHECK enum status header_integer(const struct text_header *header, int64_t least, int64_t most,
                                      int64_t *number, struct error *error);

/* Take a pair SegmentN_KEY:=VALUE of an NRRD header; others are left. */
MUST_CHECK enum status image_segment_field(struct image *image, const struct text_header *header,
                                           struct error *error);

/* Print the pairs of an image's segments. */
void image_segments_print(const struct image *image, FILE *file);

/* Set the sizes of an image, checked, and its type: components of 3 or 4 bytes are a colour if `colour`. */
MUST_CHECK enum status header_sizes(const double size[3], double components, bool colour,
                                    const struct image_layout *layout, struct image *image,
                                    struct error *error);
