/* Fault 25: whichever allocation fails, reading, writing and changing a stream reports it and leaves nothing
 * behind. */
#include <stdint.h> /* says whether this is glibc, which the next one asks */

#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR
#include "stream_fixture.h"

static struct stream sample;
static int descriptor; /* of the sample, written */
static off_t begin;    /* where it begins: what does not begin its file is read, not mapped */

static enum status try_read(struct error *error)
{
    FREED_BY(stream_free) struct stream stream = {0};
    enum status status = stream_read(&stream, descriptor, "input", error);
    lseek(descriptor, begin, SEEK_SET);
    return status;
}

static enum status try_write(struct error *error)
{
    int sink = memfd_create("sink", 0);
    enum status status = stream_write(&sample, sink, true, error);
    if (status == STATUS_OK) {
        status = stream_write(&sample, sink, false, error);
    }
    close(sink);
    return status;
}

static enum status try_change(struct error *error)
{
    static char *command[] = {"tool", "a b"};
    FREED_BY(stream_free) struct stream stream = {0};
    RETURN_IF_ERROR(stream_add_provenance(&stream, 2, command, error));
    RETURN_IF_ERROR(stream_add_provenance(&stream, 1, command, error));
    RETURN_IF_ERROR(stream_put(&stream, "x", TYPE_F8, 1, 1, "a=b", sample_f8, false, error));
    for (int i = 0; i < 2; i++) { /* put, then replaced */
        double *data = array_new(3, sizeof *data);
        RETURN_IF_ERROR(data == NULL ? fail_memory(error, "test") : STATUS_OK);
        RETURN_IF_ERROR(stream_put(&stream, "y", TYPE_F8, 3, 1, "", data, true, error));
    }
    return STATUS_OK;
}

TEST(read_text_and_binary)
{
    for (int form = 0; form < 4; form++) {
        descriptor = memfd_create("stream", 0);
        begin = form / 2;
        lseek(descriptor, begin, SEEK_SET);
        GOOD(stream_write(&sample, descriptor, form % 2 == 0, &error));
        lseek(descriptor, begin, SEEK_SET);
        fail_each(try_read, 12);
        close(descriptor);
    }
}

TEST(written)
{
    fail_each(try_write, 10);
}

TEST(changed)
{
    fail_each(try_change, 12);
}

static int make(void **state)
{
    (void)state;
    sample = sample_stream();
    return 0;
}

static int drop(void **state)
{
    (void)state;
    stream_free(&sample);
    return 0;
}

RUN_TESTS(make, drop)

#else
RUN_TESTS(NULL, NULL)
#endif
