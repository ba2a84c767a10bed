/* Reading by descriptors; interrupted transfers are continued. */
#pragma once

#include "base/status.h"

/* Read up to `size` bytes, > 0; *got receives their number, 0 at the end. STATUS_INPUT for a folder,
 * STATUS_SYSTEM for other failures. */
MUST_CHECK enum status descriptor_read(int descriptor, void *bytes, size_t size, size_t *got,
                                       struct error *error);

/* Read to the end, or beyond `most` bytes: (*bytes)[*size], to be freed, also on failure, and ROOM_BEHIND
 * bytes of 0. Unless goes_on is NULL, reading ends where it does not accept the first 64 KiB. */
enum { ROOM_BEHIND = 8 };
MUST_CHECK enum status descriptor_read_all(int descriptor, size_t most,
                                           bool (*goes_on)(const char *bytes, size_t size), char **bytes,
                                           size_t *size, struct error *error);

/* Close it, unless it is -1 or standard input: for FREED_BY. */
void descriptor_close(const int *descriptor);
