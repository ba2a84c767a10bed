/* Streams: MB/s of reading and writing a table of doubles, binary and text, from and to a file and through a
 * pipe. */
#include "bench.h"

#include "base/memory.h"
#include "io/stream/stream.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A stream, a temporary file that holds it, and which way to go. */
struct way {
    struct stream stream;
    FILE *file;
    bool text, write, pipe;
    int ends[2];
    enum status other; /* outcome of the other end of the pipe */
};

static enum status rewind_file(struct way *way, struct error *error)
{
    if (lseek(fileno(way->file), 0, SEEK_SET) != 0) {
        return fail(error, STATUS_SYSTEM, "temporary file: %s", strerror(errno));
    }
    return STATUS_OK;
}

static enum status write_file(struct way *way, struct error *error)
{
    enum status status = rewind_file(way, error);
    return status != STATUS_OK ? status : stream_write(&way->stream, way->file, way->text, error);
}

static enum status read_from(int descriptor, struct error *error)
{
    struct stream copy;
    enum status status = stream_read(&copy, descriptor, "bench", error);
    stream_free(&copy);
    return status;
}

static void *writer(void *context)
{
    struct way *way = context;
    struct error error;
    FILE *file = fdopen(way->ends[1], "w");
    way->other = file != NULL ? stream_write(&way->stream, file, way->text, &error) : STATUS_SYSTEM;
    file != NULL ? fclose(file) : close(way->ends[1]);
    return NULL;
}

static enum status through_pipe(struct way *way, struct error *error)
{
    pthread_t thread;
    if (pipe(way->ends) != 0 || pthread_create(&thread, NULL, writer, way) != 0) {
        return fail(error, STATUS_SYSTEM, "pipe: %s", strerror(errno));
    }
    enum status status = read_from(way->ends[0], error);
    close(way->ends[0]);
    pthread_join(thread, NULL);
    return status != STATUS_OK ? status : way->other;
}

static enum status run(void *context, struct error *error)
{
    struct way *way = context;
    if (way->pipe) {
        return through_pipe(way, error);
    }
    if (way->write) {
        return write_file(way, error);
    }
    enum status status = rewind_file(way, error);
    return status != STATUS_OK ? status : read_from(fileno(way->file), error);
}

/* Doubles of full length: 17 digits as text. */
static enum status fill(struct stream *stream, int64_t rows, struct error *error)
{
    double *values = NULL;
    uint64_t state = 1;
    stream_init(stream);
    RETURN_IF_ERROR(NEW_ARRAY(&values, rows * 3, error));
    for (int64_t i = 0; i < rows * 3; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        values[i] = (double)(state >> 11) / 9007199254740992.0 - 0.5;
    }
    return stream_put(stream, "shape.dphi", TYPE_F8, rows, 3, "unit=1/m", values, true, error);
}

static void bench(const char *kernel, bool text, bool write, bool pipe, int64_t rows, double seconds)
{
    struct way way = {.text = text, .write = write, .pipe = pipe, .file = tmpfile()};
    struct error error;
    struct bench_times times;
    char size[64];
    if (way.file == NULL) {
        bench_check(fail(&error, STATUS_SYSTEM, "temporary file: %s", strerror(errno)), &error);
    }
    bench_check(fill(&way.stream, rows, &error), &error);
    bench_check(write_file(&way, &error), &error);
    off_t bytes = lseek(fileno(way.file), 0, SEEK_CUR);
    bench_repeat(pipe ? BENCH_WALL : BENCH_CPU, seconds, run, &way, &times);
    snprintf(size, sizeof size, "%lld rows of 3 f8", (long long)rows);
    struct bench_row row = {.kernel = kernel,
                            .size = size,
                            .threads = 1,
                            .pairs = (double)rows,
                            .bytes = (double)bytes,
                            .rate = (double)bytes / 1e6,
                            .unit = "MB/s"};
    bench_print(&row, &times);
    fclose(way.file);
    stream_free(&way.stream);
}

/* bench-stream [SECONDS]: time spent on each row. */
int main(int argc, char *argv[])
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1.0;
    bench("stream-read", false, false, false, 4000000, seconds);
    bench("stream-write", false, true, false, 4000000, seconds);
    bench("stream-pipe", false, false, true, 4000000, seconds);
    bench("stream-read-text", true, false, false, 400000, seconds);
    bench("stream-write-text", true, true, false, 400000, seconds);
    return 0;
}
