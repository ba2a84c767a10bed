#include "io/files/descriptor.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

enum status descriptor_read(int descriptor, void *bytes, size_t size, size_t *got, struct error *error)
{
    ssize_t count;
    do {
        count = read(descriptor, bytes, size);
    } while (count < 0 && errno == EINTR);
    *got = count > 0 ? (size_t)count : 0;
    return count >= 0        ? STATUS_OK
           : errno == EISDIR ? fail(error, STATUS_INPUT, "is a directory")
                             : fail(error, STATUS_SYSTEM, "cannot read: %s", strerror(errno));
}

enum status descriptor_write(int descriptor, const void *bytes, size_t size, struct error *error)
{
    for (const char *at = bytes, *end = at + size; at < end;) {
        ssize_t count = write(descriptor, at, (size_t)(end - at));
        if (count == 0 || (count < 0 && errno != EINTR)) {
            return fail(error, STATUS_SYSTEM, "%s", count < 0 ? strerror(errno) : "no progress");
        }
        at += count > 0 ? count : 0;
    }
    return STATUS_OK;
}

void descriptor_close(const int *descriptor)
{
    if (*descriptor >= 0 && *descriptor != STDIN_FILENO) {
        close(*descriptor);
    }
}
