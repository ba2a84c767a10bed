#include "io/files/descriptor.h"

#include "base/memory.h"

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

enum status descriptor_read_all(int descriptor, size_t most, bool (*goes_on)(const char *bytes, size_t size),
                                char **bytes, size_t *size, struct error *error)
{
    enum { HEAD = 1 << 16 };
    int64_t room = 0;
    size_t got = 1;
    for (*size = 0; got > 0 && *size <= most; *size += got) {
        if (*size >= HEAD && goes_on != NULL && !goes_on(*bytes, *size)) {
            break;
        }
        RETURN_IF_ERROR(GROW_ARRAY(bytes, (int64_t)*size + HEAD + ROOM_BEHIND, &room, error));
        RETURN_IF_ERROR(
            descriptor_read(descriptor, *bytes + *size, (size_t)room - *size - ROOM_BEHIND, &got, error));
    }
    memset(*bytes + *size, 0, ROOM_BEHIND);
    return STATUS_OK;
}

void descriptor_close(const int *descriptor)
{
    if (*descriptor >= 0 && *descriptor != STDIN_FILENO) {
        close(*descriptor);
    }
}
