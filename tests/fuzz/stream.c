/* Fuzz target: the reader of streams. Mapped or read, bytes mean the same; what is accepted is checked
 * against its invariants, and comes back from both forms as it was. */
#include "fuzz.h"

#include "stages/stages.h"
#include "io/stream/stream.h"

#include <string.h>
#include <zlib.h>

/* Linked in place of zlib's (see fuzz.mk), for the reader and the writer alike: a fuzzer does not guess a
 * checksum. */
z_crc_t __wrap_crc32_z(z_crc_t crc, const Bytef *bytes, z_size_t size);
z_crc_t __wrap_crc32_z(z_crc_t crc, const Bytef *bytes, z_size_t size)
{
    (void)crc, (void)bytes, (void)size;
    return 0;
}

static bool is_nan(const struct section *section, int64_t i)
{
    return section->type == TYPE_F8 ? ((const double *)section->data)[i] != ((const double *)section->data)[i]
           : section->type == TYPE_F4 ? ((const float *)section->data)[i] != ((const float *)section->data)[i]
                                      : false;
}

static void require_same(const struct stream *a, const struct stream *b)
{
    REQUIRE(a->section_count == b->section_count);
    REQUIRE(a->provenance.count == b->provenance.count);
    for (int64_t i = 0; i < a->provenance.count; i++) {
        REQUIRE(strcmp(a->provenance.name[i], b->provenance.name[i]) == 0);
    }
    for (int64_t s = 0; s < a->section_count; s++) {
        const struct section *left = &a->sections[s], *right = &b->sections[s];
        REQUIRE(strcmp(left->name, right->name) == 0 && strcmp(left->attributes, right->attributes) == 0);
        REQUIRE(left->type == right->type && left->rows == right->rows && left->cols == right->cols);
        size_t size = element_size(left->type);
        for (int64_t i = 0; i < left->rows * left->cols; i++) {
            const char *x = (const char *)left->data + (size_t)i * size;
            const char *y = (const char *)right->data + (size_t)i * size;
            REQUIRE(memcmp(x, y, size) == 0 || (is_nan(left, i) && is_nan(right, i)));
        }
    }
}

/* Write it and read that. */
static void require_round_trip(const struct stream *stream, bool text)
{
    struct error error;
    struct stream again;
    int file = file_of_bytes("", 0, NULL);
    FILE *written = fdopen(dup(file), "w");
    REQUIRE(stream_write(stream, written, text, &error) == STATUS_OK);
    REQUIRE(fclose(written) == 0 && lseek(file, 0, SEEK_SET) == 0);
    REQUIRE(stream_read(&again, file, "again", &error) == STATUS_OK);
    require_same(stream, &again);
    stream_free(&again);
    close(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FREED_BY(stream_free) struct stream mapped = {0}, read = {0};
    struct error error = {""}, read_error = {""};
    int file = file_of_bytes(data, size, NULL);
    enum status status = stream_read(&mapped, file, "input", &error);
    close(file);
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    REQUIRE(size <= 65536 && write(ends[1], data, size) == (ssize_t)size);
    close(ends[1]);
    enum status read_status = stream_read(&read, ends[0], "input", &read_error);
    close(ends[0]);
    REQUIRE(read_status == status);
    if (is_accepted(status, &error)) {
        FREED_BY(names_free) struct names violations = {0};
        REQUIRE(stream_check(&mapped, &violations, &error) == STATUS_OK);
        REQUIRE(violations.count == 0 || strchr(violations.list, '\n') == NULL);
        require_same(&mapped, &read);
        require_round_trip(&mapped, true);
        require_round_trip(&mapped, false);
    } else {
        REQUIRE(strcmp(error.text, read_error.text) == 0);
        REQUIRE(mapped.section_count == 0 && read.section_count == 0);
    }
    return 0;
}
