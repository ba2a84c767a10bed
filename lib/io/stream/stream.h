/* The stream "mts 1" (see mts(5)): named, typed tables that travel through a pipe, as text or binary.
 * Rows count from 0, in messages too. As all readers and writers of lib/io, these need the locale "C" for
 * numbers, which a program has as long as it sets no other. */
#pragma once

#include "base/names.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define MTS_VERSION "0.2.0"

enum { STREAM_SECTION_LIMIT = 1 << 14 }; /* sections of a stream */

enum element_type { TYPE_I4, TYPE_I8, TYPE_F4, TYPE_F8 };

/* One table: rows x cols elements, row-major, at least 8-byte aligned (64 when owned or of a file). */
struct section {
    char *name; /* e.g. "nodes.x": letters, digits, '.', '_', '-'; unique in the stream */
    enum element_type type;
    int64_t rows, cols;
    char *attributes; /* "unit=m cols=x,y", without enc=; "" when none. Values hold no blanks. */
    void *data;       /* rows * cols elements of `type` */
    bool owned; /* data is freed with the section; else it is in the stream's mapping, or is the caller's and
                   must outlive the section */
};

struct stream {
    struct section *sections; /* in the order of the stream; adding a section never moves others, removing one
                                 moves those behind it */
    int64_t section_count;
    struct names provenance; /* "# @" lines without "# @ " and newline, oldest first */
    void *mapping;           /* the bytes of the input, or NULL: */
    size_t mapping_size;
    bool is_file; /* mapped from a file, else from malloc and the only copy */
};

/* An empty stream. */
void stream_init(struct stream *stream);

/* Release everything the stream owns; it becomes empty. */
void stream_free(struct stream *stream);

/* Read a whole stream from an open descriptor, which stays open. A regular file is mapped; binary payloads
 * are used in place. `name` is used in messages ("standard input", the file's name).
 * Errors: STATUS_INPUT for anything malformed, truncated, with a wrong CRC or without its end line;
 * STATUS_SYSTEM for read failures and memory. Nothing is allocated beyond a small multiple of the input read
 * so far. On failure the stream is empty. */
MUST_CHECK enum status stream_read(struct stream *stream, int descriptor, const char *name,
                                   struct error *error);

/* Read the sections before the place where a stream was stopped, truncated or damaged; *why receives the
 * fault, if there is one. STATUS_INPUT if no section is complete. */
MUST_CHECK enum status stream_recover(struct stream *stream, int descriptor, const char *name,
                                      struct error *why, struct error *error);

/* Write the stream, as text or binary, with the end line, and flush the file. Same stream, same bytes,
 * whether written to a pipe or a file. STATUS_SYSTEM with errno's text on a write error. */
MUST_CHECK enum status stream_write(const struct stream *stream, FILE *file, bool text, struct error *error);

/* The same section by section, so that not all of them need be in memory at once. */
struct stream_writer {
    FILE *file; /* errors stay in it until it is flushed */
    bool text;
    int64_t offset;        /* of the next byte, from the start of the stream */
    int64_t section_count; /* so far */
    unsigned long crc;     /* of the bytes outside the payloads */
};

/* Begin a stream, with the provenance of another one, unless that is NULL: then what is written continues one
 * that has been begun before. */
void stream_writer_begin(struct stream_writer *writer, FILE *file, bool text,
                         const struct stream *provenance);

/* Append section i of a stream; release its pages, if it is in a mapped input. */
MUST_CHECK enum status stream_writer_put(struct stream_writer *writer, const struct stream *stream, int64_t i,
                                         struct error *error);

/* Write what has been appended so far. */
MUST_CHECK enum status stream_writer_flush(struct stream_writer *writer, struct error *error);

/* End the stream. Where `stopped` is not NULL it is incomplete for this reason: it ends with "# stopped
 * REASON" in place of the end line, so that no reader takes it for complete. */
MUST_CHECK enum status stream_writer_end(struct stream_writer *writer, const char *stopped,
                                         struct error *error);

/* Write the rows of one section as bare text: a line per row, single blanks between the numbers. Errors of
 * the file stay in it. */
void stream_write_rows(const struct section *section, FILE *file);

/* The section of that name, or NULL. */
const struct section *stream_find(const struct stream *stream, const char *name);

/* The section `name`, which must exist and have this type and this number of columns (cols <= 0: any).
 * `producer` names the tool that makes it ("shapefn"), for the remedy in the message. */
MUST_CHECK enum status stream_need(const struct stream *stream, const char *name, enum element_type type,
                                   int64_t cols, const char *producer, const struct section **section,
                                   struct error *error);

/* Add a section, or replace the one of that name in its place. With owned = true the stream frees `data`
 * (from array_new or malloc), also when this call fails. */
MUST_CHECK enum status stream_put(struct stream *stream, const char *name, enum element_type type,
                                  int64_t rows, int64_t cols, const char *attributes, void *data, bool owned,
                                  struct error *error);

/* The same for a section of one column, whose attribute names= lists names. */
MUST_CHECK enum status stream_put_named(struct stream *stream, const char *name, enum element_type type,
                                        int64_t rows, const struct names *names, void *data, bool owned,
                                        struct error *error);

/* Remove a section, if it exists. */
void stream_remove(struct stream *stream, const char *name);

/* Release the pages of the mapped input, none of which has been changed: they are read again when needed. */
void stream_give_back(const struct stream *stream);

/* Append the provenance line "TOOL VERSION ARGV...", with arguments quoted for a shell if necessary. */
MUST_CHECK enum status stream_add_provenance(struct stream *stream, int argc, char *const argv[],
                                             struct error *error);

/* Copy the value of attribute `key` of a section into value[size]; false when absent or too long. */
bool section_attribute(const struct section *section, const char *key, char *value, size_t size);

/* Print an element, without a NUL, so that it reads back exactly; returns the length. */
enum { SECTION_NUMBER = 32 };
size_t section_print(const struct section *section, int64_t index, char text[SECTION_NUMBER]);

/* Bytes of one element. */
size_t element_size(enum element_type type);

/* "f8" etc. */
const char *element_type_name(enum element_type type);
