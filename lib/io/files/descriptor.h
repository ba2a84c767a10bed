/* Reading and writing by descriptors; interrupted and partial transfers are continued. */
#pragma once

#include "base/status.h"

/* Read up to `size` bytes, > 0; *got receives their number, 0 at the end. STATUS_INPUT for a folder,
 * STATUS_SYSTEM for other failures. */
MUST_CHECK enum status descriptor_read(int descriptor, void *bytes, size_t size, size_t *got,
                                       struct error *error);

/* Write all `size` bytes. The message of a failure is the cause alone. */
MUST_CHECK enum status descriptor_write(int descriptor, const void *bytes, size_t size, struct error *error);

/* Close it, unless it is -1 or standard input: for FREED_BY. */
void descriptor_close(const int *descriptor);
