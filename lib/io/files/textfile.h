/* Untrusted files that are read whole: scenes, tables, surfaces; reading by descriptors, where interrupted
 * transfers are continued. */
#pragma once

#include "base/status.h"

#include <stddef.h>

/* The bytes of a text file: lines that end with '\n', none of them with '\r' or NUL inside. */
struct textfile {
    char *text; /* size bytes and a closing NUL */
    size_t size;
};

/* Read the file `path` of at most `most` bytes. Only regular files and pipes are opened, so that a path in an
 * untrusted scene cannot touch a device. Errors, as `PATH:LINE: ...`: STATUS_SYSTEM for a read
 * failure; STATUS_INPUT for a file that cannot be opened, a folder or device, more than `most` bytes, an
 * empty file, a byte order mark, CRLF line ends, NUL and other control characters, and a last line without
 * newline (the mark of a truncated file). To be freed also on failure. */
MUST_CHECK enum status textfile_read(const char *path, size_t most, struct textfile *file,
                                     struct error *error);

/* The same for a binary file: only kind and size are checked, and that it is not empty. */
MUST_CHECK enum status bytefile_read(const char *path, size_t most, struct textfile *file,
                                     struct error *error);

/* Release the text; the struct becomes empty. */
void textfile_free(struct textfile *file);

/* The next word of a line, between blanks and tabs, which is cut there; *at moves behind it. "": there is
 * none.
 */
char *text_word(char **at);

/* Read to the end, or beyond `most` bytes: (*bytes)[*size], to be freed, also on failure, and ROOM_BEHIND
 * bytes of 0. Unless goes_on is NULL, reading ends where it does not accept the first 64 KiB. */
enum { ROOM_BEHIND = 8 };
MUST_CHECK enum status descriptor_read_all(int descriptor, size_t most,
                                           bool (*goes_on)(const char *bytes, size_t size), char **bytes,
                                           size_t *size, struct error *error);

/* Close it, unless it is -1 or standard input: for FREED_BY. */
void descriptor_close(const int *descriptor);
