/* Buffered input of a stream: a regular file is mapped, everything else is read in large blocks. */
#include "io/stream/stream_private.h"
#include "io/files/descriptor.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* Map a regular file that is at its beginning. The mapping is private and writable: changes of a payload
 * never reach the file. */
static bool map_file(struct input *input, struct stream *stream)
{
    struct stat file;
    if (fstat(input->descriptor, &file) != 0 || !S_ISREG(file.st_mode) || file.st_size <= 0 ||
        lseek(input->descriptor, 0, SEEK_CUR) != 0) {
        return false;
    }
    size_t size = (size_t)file.st_size;
    void *mapping =
        mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_NORESERVE, input->descriptor, 0);
    if (mapping == MAP_FAILED) {
        return false;
    }
    stream->mapping = mapping;
    stream->mapping_size = size;
    input->at = input->start = mapping;
    input->end = input->at + size;
    input->ended = true;
    return true;
}

enum status input_open(struct input *input, struct stream *stream, int descriptor, struct error *error)
{
    *input = (struct input){.descriptor = descriptor};
    if (map_file(input, stream)) {
        return STATUS_OK;
    }
    (void)fcntl(descriptor, F_SETPIPE_SZ, BLOCK_SIZE); /* fewer context switches for a pipe, if granted */
    input->capacity = 2 * BLOCK_SIZE;
    input->buffer = malloc(input->capacity);
    if (input->buffer == NULL) {
        return fail_memory(error, "input");
    }
    input->at = input->end = input->start = input->buffer;
    return STATUS_OK;
}

void input_close(struct input *input)
{
    free(input->buffer);
    *input = (struct input){.descriptor = -1};
}

int64_t input_offset(const struct input *input)
{
    return input->start_offset + (input->at - input->start);
}

static enum status read_some(struct input *input, void *destination, size_t size, size_t *got,
                             struct error *error)
{
    RETURN_IF_ERROR(descriptor_read(input->descriptor, destination, size, got, error));
    input->ended = *got == 0;
    return STATUS_OK;
}

enum status input_fill(struct input *input, size_t wanted, struct error *error)
{
    size_t held = (size_t)(input->end - input->at);
    if (held >= wanted || input->ended) {
        return STATUS_OK;
    }
    /* Not mapped: move the bytes at hand to the front and read behind them. `wanted` is at most LINE_LIMIT.
     */
    input->start_offset = input_offset(input);
    memmove(input->buffer, input->at, held);
    input->at = input->start = input->buffer;
    while (held < wanted && !input->ended) {
        size_t got;
        RETURN_IF_ERROR(read_some(input, input->buffer + held, input->capacity - held, &got, error));
        held += got;
        input->end = input->buffer + held;
    }
    return STATUS_OK;
}

enum status input_line(struct input *input, const char **line, size_t *length, struct error *error)
{
    size_t searched = 0;
    for (;;) {
        size_t held = (size_t)(input->end - input->at);
        size_t bound = held < LINE_LIMIT ? held : LINE_LIMIT;
        const char *newline = memchr(input->at + searched, '\n', bound - searched);
        if (newline != NULL) {
            *line = input->at;
            *length = (size_t)(newline - input->at);
            input->at = newline + 1;
            return STATUS_OK;
        }
        if (bound == LINE_LIMIT) {
            return fail(error, STATUS_INPUT, "a line longer than %d bytes: not an mts stream", LINE_LIMIT);
        }
        if (input->ended) {
            return fail(error, STATUS_INPUT,
                        "ends without its end line: cut short (did an earlier stage fail?)");
        }
        searched = held;
        RETURN_IF_ERROR(input_fill(input, held + 1, error));
    }
}

enum status input_copy(struct input *input, void *destination, size_t size, size_t *got, struct error *error)
{
    size_t held = (size_t)(input->end - input->at);
    *got = held < size ? held : size;
    if (*got > 0) {
        memcpy(destination, input->at, *got);
    }
    input->at += *got;
    while (*got < size && !input->ended) {
        size_t more;
        RETURN_IF_ERROR(read_some(input, (char *)destination + *got, size - *got, &more, error));
        *got += more;
        input->start_offset += (int64_t)more;
    }
    return STATUS_OK;
}
