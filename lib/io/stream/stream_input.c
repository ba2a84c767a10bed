/* The bytes of a stream: a regular file is mapped, everything else is read into a mapping of its own. */
#include "io/files/textfile.h"
#include "io/stream/stream_private.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* Map a regular file that is at its beginning. The mapping is private and writable: changes of a payload
 * never reach the file. */
static bool map_file(int descriptor, struct stream *stream)
{
    struct stat file;
    if (fstat(descriptor, &file) != 0 || !S_ISREG(file.st_mode) || file.st_size <= 0 ||
        lseek(descriptor, 0, SEEK_CUR) != 0) {
        return false;
    }
    size_t size = (size_t)file.st_size;
    void *mapping = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_NORESERVE, descriptor, 0);
    if (mapping == MAP_FAILED) {
        return false;
    }
    stream->mapping = mapping;
    stream->mapping_size = size;
    stream->is_file = true;
    return true;
}

/* Double the mapping; new pages take memory when they are written. */
static enum status grow(struct stream *stream, struct error *error)
{
    size_t size = stream->mapping_size, larger = size > 0 ? 2 * size : BLOCK_SIZE;
    void *mapping = size > 0 ? mremap(stream->mapping, size, larger, MREMAP_MAYMOVE)
                             : mmap(NULL, larger, PROT_READ | PROT_WRITE,
                                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (mapping == MAP_FAILED) {
        return fail_memory(error, "input");
    }
    stream->mapping = mapping;
    stream->mapping_size = larger;
    return STATUS_OK;
}

/* Read to the end, or enough to tell that it is no stream. */
static enum status read_all(int descriptor, struct stream *stream, size_t *size, struct error *error)
{
    size_t got = 1;
    (void)fcntl(descriptor, F_SETPIPE_SZ, BLOCK_SIZE); /* fewer context switches for a pipe, if granted */
    for (*size = 0; got > 0; *size += got) {
        if (*size >= 64 && !starts_with(stream->mapping, *size, FIRST_LINE)) {
            return STATUS_OK;
        }
        if (*size == stream->mapping_size) {
            RETURN_IF_ERROR(grow(stream, error));
        }
        RETURN_IF_ERROR(descriptor_read(descriptor, (char *)stream->mapping + *size,
                                        stream->mapping_size - *size, &got, error));
    }
    return STATUS_OK;
}

enum status input_open(struct input *input, struct stream *stream, int descriptor, struct error *error)
{
    size_t size = 0;
    if (map_file(descriptor, stream)) {
        size = stream->mapping_size;
    } else {
        RETURN_IF_ERROR(read_all(descriptor, stream, &size, error));
    }
    input->at = input->start = stream->mapping;
    input->end = input->start + size;
    return STATUS_OK;
}

enum status input_line(struct input *input, const char **line, size_t *length, struct error *error)
{
    size_t held = (size_t)(input->end - input->at), bound = held < LINE_LIMIT ? held : LINE_LIMIT;
    const char *newline = memchr(input->at, '\n', bound);
    if (newline == NULL) {
        return bound == LINE_LIMIT
                   ? fail(error, STATUS_INPUT, "a line longer than %d bytes: not an mts stream", LINE_LIMIT)
                   : fail(error, STATUS_INPUT,
                          "ends without its end line: cut short (did an earlier stage fail?)");
    }
    *line = input->at;
    *length = (size_t)(newline - input->at);
    input->at = newline + 1;
    return STATUS_OK;
}
