/* Numbers out of a mesh file in memory, ASCII or binary alike. */
#ifndef IO_MSH_CURSOR_H
#define IO_MSH_CURSOR_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct msh_cursor {
    const char *at, *end; /* what is left of the file */
    bool binary;          /* numbers are raw little-endian values (int: 4 bytes, size: 8, real: 8) */
    const char *section;  /* for messages: "$Nodes", "node" */
    const char *kind;
    int64_t record; /* number of the record, from 1; 0: the head of the section */
    struct error *error;
};

/* Fail with "$Nodes: node 12: message". */
enum status msh_cursor_fail(const struct msh_cursor *cursor, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The next whole number, within [least, most]: an int, or a size_t in binary files. */
MUST_CHECK enum status msh_next_int(struct msh_cursor *cursor, const char *what, int64_t least, int64_t most,
                                    int64_t *value);
MUST_CHECK enum status msh_next_size(struct msh_cursor *cursor, const char *what, int64_t least, int64_t most,
                                     int64_t *value);

/* A number of records, each of which takes `ascii` or `binary` bytes at the least: refused when they cannot
 * all be in what is left of the file. */
MUST_CHECK enum status msh_next_count(struct msh_cursor *cursor, const char *what, int64_t ascii,
                                      int64_t binary, int64_t *value);

/* The same for the count at the head of a section of MSH 2, which is text on a line of its own also in binary
 * files; a record has at least so many bytes. */
MUST_CHECK enum status msh_next_count_line(struct msh_cursor *cursor, const char *what, int64_t least,
                                           int64_t *value);

/* The next real number; not necessarily finite. */
MUST_CHECK enum status msh_next_real(struct msh_cursor *cursor, const char *what, double *value);

/* Step over white space; over the rest of the line, which must be blank. */
void msh_skip_space(struct msh_cursor *cursor);
MUST_CHECK enum status msh_skip_line(struct msh_cursor *cursor);

#endif
