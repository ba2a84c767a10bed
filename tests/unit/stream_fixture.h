/* A small stream with every type and the hard values of each, and reading from bytes, for the tests of the
 * stream. */
#pragma once

#include "unit.h"

#include "io/stream/stream.h"

#include <float.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

static int32_t sample_i4[] = {0, -1, INT32_MIN, INT32_MAX, 7, 1000000};
static int64_t sample_i8[] = {INT64_MIN, INT64_MAX, 0};
static float sample_f4[] = {0.1F, -0.0F, FLT_MAX, FLT_MIN, 1e-45F, 16777216.0F};
static double sample_f8[] = {0.1,  -0.0, DBL_MAX, DBL_MIN,   5e-324,   1.0 / 3.0,
                             1e22, 1e23, NAN,     -INFINITY, INFINITY, 2.2250738585072011e-308};

static inline void put_sample(struct stream *stream, const char *name, enum element_type type, int64_t rows,
                              int64_t cols, const char *attributes, void *data)
{
    GOOD(stream_put(stream, name, type, rows, cols, attributes, data, false, &error));
}

static inline struct stream sample_stream(void)
{
    struct stream stream = {0};
    char *command[] = {"/usr/bin/nodes", "-u", "mm", "it's a file", "", "line\nend"};
    GOOD(stream_add_provenance(&stream, 6, command, &error));
    put_sample(&stream, "a.i4", TYPE_I4, 3, 2, "unit=m cols=x,y", sample_i4);
    put_sample(&stream, "empty", TYPE_F8, 0, 3, "", sample_f8);
    put_sample(&stream, "b-i8", TYPE_I8, 3, 1, "names=a,b", sample_i8);
    put_sample(&stream, "c_f4", TYPE_F4, 1, 6, "", sample_f4);
    put_sample(&stream, "D.f8", TYPE_F8, 6, 2, "text=a=b", sample_f8);
    return stream;
}

/* The bytes of a stream as they are written; free() them. */
static inline char *written_bytes(const struct stream *stream, bool text, size_t *size)
{
    char *bytes = NULL;
    FILE *file = open_memstream(&bytes, size);
    assert_non_null(file);
    GOOD(stream_write(stream, file, text, &error));
    assert_int_equal(fclose(file), 0);
    return bytes;
}

/* Read a stream from bytes in a file (which is mapped) or, up to 64 KiB, a pipe (which is not). */
static inline enum status read_bytes(const void *bytes, size_t size, bool from_pipe, struct stream *stream,
                                     struct error *error)
{
    int ends[2];
    if (from_pipe) {
        assert_true(size <= 65536);
        assert_int_equal(pipe(ends), 0);
        assert_int_equal(write(ends[1], bytes, size), size);
        close(ends[1]);
    } else {
        ends[0] = memfd_create("stream", 0);
        assert_int_equal(write(ends[0], bytes, size), size);
        assert_int_equal(lseek(ends[0], 0, SEEK_SET), 0);
    }
    enum status status = stream_read(stream, ends[0], "input", error);
    close(ends[0]);
    return status;
}

/* Equal to the last bit, but for the payload bits of NaN. */
static inline void assert_same_section(const struct section *a, const struct section *b)
{
    assert_string_equal(a->name, b->name);
    assert_string_equal(a->attributes, b->attributes);
    assert_int_equal(a->type, b->type);
    assert_int_equal(a->rows, b->rows);
    assert_int_equal(a->cols, b->cols);
    size_t size = element_size(a->type);
    for (int64_t i = 0; i < a->rows * a->cols; i++) {
        const char *left = (const char *)a->data + (size_t)i * size;
        const char *right = (const char *)b->data + (size_t)i * size;
        double x, y;
        if (a->type == TYPE_F8 && (memcpy(&x, left, 8), isnan(x))) {
            memcpy(&y, right, 8);
            assert_true(isnan(y));
        } else {
            assert_memory_equal(left, right, size);
        }
    }
}

static inline void assert_same_stream(const struct stream *a, const struct stream *b)
{
    assert_int_equal(a->section_count, b->section_count);
    assert_int_equal(a->provenance.count, b->provenance.count);
    for (int64_t i = 0; i < a->provenance.count; i++) {
        assert_string_equal(a->provenance.name[i], b->provenance.name[i]);
    }
    for (int64_t i = 0; i < a->section_count; i++) {
        assert_same_section(&a->sections[i], &b->sections[i]);
    }
}
