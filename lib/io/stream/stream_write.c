/* Writing a stream, as text or binary, in large blocks. */
#include "io/stream/stream_private.h"

#include "base/memory.h"
#include "io/files/descriptor.h"

#include <inttypes.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static enum status write_all(const struct stream_writer *writer, const char *bytes, size_t size,
                             struct error *error)
{
    return fail_in(error, descriptor_write(writer->descriptor, bytes, size, error), "cannot write");
}

enum status stream_writer_flush(struct stream_writer *writer, struct error *error)
{
    size_t held = writer->held;
    writer->held = 0;
    return write_all(writer, writer->block, held, error);
}

static enum status put_bytes(struct stream_writer *writer, const void *bytes, size_t size,
                             struct error *error)
{
    writer->offset += (int64_t)size;
    if (size > BLOCK_SIZE - writer->held) {
        RETURN_IF_ERROR(stream_writer_flush(writer, error));
    }
    if (size >= BLOCK_SIZE) {
        return write_all(writer, bytes, size, error);
    }
    if (size > 0) {
        memcpy(writer->block + writer->held, bytes, size);
        writer->held += size;
    }
    return STATUS_OK;
}

/* Write bytes outside of payloads. */
static enum status put_frame(struct stream_writer *writer, const void *bytes, size_t size,
                             struct error *error)
{
    writer->crc = crc32_z(writer->crc, bytes, size);
    return put_bytes(writer, bytes, size, error);
}

static enum status put_text(struct stream_writer *writer, const char *text, struct error *error)
{
    return put_frame(writer, text, strlen(text), error);
}

/* Write the header line; before a binary payload it is padded with blanks to the alignment. */
static enum status put_header(struct stream_writer *writer, const struct section *section, uLong *crc,
                              struct error *error)
{
    size_t room = strlen(section->name) + strlen(section->attributes) + 128 + PAYLOAD_ALIGNMENT;
    RETURN_IF_ERROR(section_validate(section->name, section->type, section->rows, section->cols,
                                     section->attributes, error));
    NEW_SCRATCH(char, line, (int64_t)room, error);
    int printed = snprintf(line, room, "# %s %s %" PRId64 " %" PRId64 " enc=%s%s%s", section->name,
                           element_type_name(section->type), section->rows, section->cols,
                           writer->text ? "text" : "bin", section->attributes[0] != '\0' ? " " : "",
                           section->attributes);
    size_t length = (size_t)printed;
    if (!writer->text) {
        while ((writer->offset + (int64_t)length + 1) % PAYLOAD_ALIGNMENT != 0) {
            line[length++] = ' ';
        }
    }
    line[length++] = '\n';
    *crc = crc32_z(0, (const Bytef *)line, length);
    return put_frame(writer, line, length, error);
}

static enum status format_rows(struct stream_writer *writer, const struct section *section,
                               struct error *error)
{
    int64_t index = 0;
    for (int64_t row = 0; row < section->rows; row++) {
        for (int64_t column = 0; column < section->cols; column++, index++) {
            if (BLOCK_SIZE - writer->held < SECTION_NUMBER + 1) {
                RETURN_IF_ERROR(stream_writer_flush(writer, error));
            }
            char *at = writer->block + writer->held;
            size_t length = section_print(section, index, at);
            at[length++] = column + 1 < section->cols ? ' ' : '\n';
            writer->held += length;
            writer->offset += (int64_t)length;
        }
    }
    return STATUS_OK;
}

/* Numbers are written in the C locale, whatever the calling program has set. */
static enum status put_rows(struct stream_writer *writer, const struct section *section, struct error *error)
{
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c_locale == (locale_t)0) {
        return fail_memory(error, "output");
    }
    locale_t previous = uselocale(c_locale);
    enum status status = format_rows(writer, section, error);
    uselocale(previous);
    freelocale(c_locale);
    return status;
}

static enum status put_payload_text(struct stream_writer *writer, const struct section *section,
                                    struct error *error)
{
    RETURN_IF_ERROR(put_rows(writer, section, error));
    return put_bytes(writer, "\n\n", 2, error);
}

static enum status put_payload_binary(struct stream_writer *writer, const struct section *section,
                                      uLong header_crc, struct error *error)
{
    char line[32];
    size_t bytes = (size_t)(section->rows * section->cols) * element_size(section->type);
    uLong crc = bytes > 0 ? crc32_z(header_crc, section->data, bytes) : header_crc;
    snprintf(line, sizeof line, "# crc32 %08lx\n", crc);
    RETURN_IF_ERROR(put_bytes(writer, section->data, bytes, error));
    RETURN_IF_ERROR(put_bytes(writer, "\n", 1, error));
    return put_text(writer, line, error);
}

/* Write a line "KIND TEXT". */
static enum status put_line(struct stream_writer *writer, const char *kind, const char *text,
                            struct error *error)
{
    RETURN_IF_ERROR(put_text(writer, kind, error));
    RETURN_IF_ERROR(put_text(writer, text, error));
    return put_text(writer, "\n", error);
}

static enum status put_end(struct stream_writer *writer, struct error *error)
{
    char line[64];
    snprintf(line, sizeof line, "# end %" PRId64, writer->section_count);
    RETURN_IF_ERROR(put_text(writer, line, error));
    if (!writer->text && writer->section_count > 0) {
        snprintf(line, sizeof line, " crc32=%08lx", writer->crc);
        RETURN_IF_ERROR(put_bytes(writer, line, strlen(line), error));
    }
    return put_bytes(writer, "\n", 1, error);
}

static enum status allocate(struct stream_writer *writer, int descriptor, bool text, struct error *error)
{
    *writer = (struct stream_writer){.descriptor = descriptor, .text = text, .block = malloc(BLOCK_SIZE)};
    return writer->block != NULL ? STATUS_OK : fail_memory(error, "output");
}

enum status stream_writer_begin(struct stream_writer *writer, int descriptor, bool text,
                                const struct stream *provenance, struct error *error)
{
    RETURN_IF_ERROR(allocate(writer, descriptor, text, error));
    if (provenance == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(put_text(writer, "# mts 1\n", error));
    for (int64_t i = 0; i < provenance->provenance_count; i++) {
        RETURN_IF_ERROR(put_line(writer, "# @ ", provenance->provenance[i], error));
    }
    return STATUS_OK;
}

void stream_writer_free(struct stream_writer *writer)
{
    free(writer->block);
    *writer = (struct stream_writer){.descriptor = -1};
}

enum status stream_writer_put(struct stream_writer *writer, const struct stream *stream, int64_t i,
                              struct error *error)
{
    const struct section *section = &stream->sections[i];
    uLong crc;
    RETURN_IF_ERROR(put_header(writer, section, &crc, error));
    RETURN_IF_ERROR(writer->text ? put_payload_text(writer, section, error)
                                 : put_payload_binary(writer, section, crc, error));
    section_give_back(stream, section, false);
    writer->section_count++;
    return STATUS_OK;
}

enum status stream_writer_end(struct stream_writer *writer, const char *stopped, struct error *error)
{
    RETURN_IF_ERROR(stopped != NULL ? put_line(writer, "# stopped ", stopped, error)
                                    : put_end(writer, error));
    return stream_writer_flush(writer, error);
}

enum status stream_write(const struct stream *stream, int descriptor, bool text, struct error *error)
{
    FREED_BY(stream_writer_free) struct stream_writer writer = {0};
    RETURN_IF_ERROR(stream_writer_begin(&writer, descriptor, text, stream, error));
    for (int64_t i = 0; i < stream->section_count; i++) {
        RETURN_IF_ERROR(stream_writer_put(&writer, stream, i, error));
    }
    return stream_writer_end(&writer, NULL, error);
}

enum status stream_write_rows(const struct section *section, int descriptor, struct error *error)
{
    FREED_BY(stream_writer_free) struct stream_writer writer = {0};
    RETURN_IF_ERROR(allocate(&writer, descriptor, true, error));
    RETURN_IF_ERROR(put_rows(&writer, section, error));
    return stream_writer_flush(&writer, error);
}
