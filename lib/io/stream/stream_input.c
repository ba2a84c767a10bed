/* The bytes of a stream: a regular file is mapped, everything else is read. */
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

static bool is_stream(const char *bytes, size_t size)
{
    return starts_with(bytes, size, FIRST_LINE);
}

enum status input_open(struct input *input, struct stream *stream, int descriptor, struct error *error)
{
    char *bytes = NULL;
    enum status status = STATUS_OK;
    if (!map_file(descriptor, stream)) {
        (void)fcntl(descriptor, F_SETPIPE_SZ, BLOCK_SIZE); /* fewer context switches for a pipe, if granted */
        status = descriptor_read_all(descriptor, SIZE_MAX, is_stream, &bytes, &stream->mapping_size, error);
        stream->mapping = bytes;
    }
    input->at = input->start = stream->mapping;
    input->end = input->start + stream->mapping_size;
    return status;
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
