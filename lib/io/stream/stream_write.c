/* Writing a stream, as text or binary. */
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <zlib.h>

enum status stream_writer_flush(struct stream_writer *writer, struct error *error)
{
    errno = 0;
    return fflush(writer->file) == 0 && ferror(writer->file) == 0
               ? STATUS_OK
               : fail(error, STATUS_SYSTEM, "cannot write: %s", strerror(errno != 0 ? errno : EIO));
}

static void put_bytes(struct stream_writer *writer, const void *bytes, size_t size)
{
    writer->offset += (int64_t)size;
    (void)fwrite(bytes, 1, size, writer->file);
}

/* Write text outside of payloads. */
static void put_text(struct stream_writer *writer, const char *text)
{
    writer->crc = crc32_z(writer->crc, (const Bytef *)text, strlen(text));
    put_bytes(writer, text, strlen(text));
}

/* Write the header line; before a binary payload it is padded with blanks to the alignment. */
static enum status put_header(struct stream_writer *writer, const struct section *section, uLong *crc,
                              struct error *error)
{
    size_t room = strlen(section->name) + strlen(section->attributes) + 128 + PAYLOAD_ALIGNMENT;
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
    line[length] = '\0';
    *crc = crc32_z(0, (const Bytef *)line, length);
    put_text(writer, line);
    return STATUS_OK;
}

static void put_rows(FILE *file, const struct section *section, int64_t *offset)
{
    char block[1 << 16];
    size_t held = 0;
    int64_t count = section->rows * section->cols;
    for (int64_t index = 0, column = 1; index < count && ferror(file) == 0; index++, column++) {
        held += section_print(section, index, block + held);
        block[held++] = column < section->cols ? ' ' : '\n';
        column = column < section->cols ? column : 0;
        if (held > sizeof block - SECTION_NUMBER - 1 || index + 1 == count) {
            (void)fwrite(block, 1, held, file);
            *offset += (int64_t)held;
            held = 0;
        }
    }
}

static void put_binary(struct stream_writer *writer, const struct section *section, uLong header_crc)
{
    char line[32];
    size_t bytes = (size_t)(section->rows * section->cols) * element_size(section->type);
    uLong crc = bytes > 0 ? crc32_z(header_crc, section->data, bytes) : header_crc;
    snprintf(line, sizeof line, "# crc32 %08lx\n", crc);
    put_bytes(writer, section->data, bytes);
    put_bytes(writer, "\n", 1);
    put_text(writer, line);
}

/* Write a line "KIND TEXT". */
static void put_line(struct stream_writer *writer, const char *kind, const char *text)
{
    put_text(writer, kind);
    put_text(writer, text);
    put_text(writer, "\n");
}

void stream_writer_begin(struct stream_writer *writer, FILE *file, bool text, const struct stream *provenance)
{
    *writer = (struct stream_writer){.file = file, .text = text};
    if (provenance != NULL) {
        put_text(writer, FIRST_LINE);
    }
    for (int64_t i = 0; provenance != NULL && i < provenance->provenance.count; i++) {
        put_line(writer, "# @ ", provenance->provenance.name[i]);
    }
}

enum status stream_writer_put(struct stream_writer *writer, const struct stream *stream, int64_t i,
                              struct error *error)
{
    const struct section *section = &stream->sections[i];
    uLong crc;
    RETURN_IF_ERROR(put_header(writer, section, &crc, error));
    if (writer->text) {
        put_rows(writer->file, section, &writer->offset);
        put_bytes(writer, "\n\n", 2);
    } else {
        put_binary(writer, section, crc);
    }
    section_give_back(stream, section, false);
    writer->section_count++;
    return STATUS_OK;
}

enum status stream_writer_end(struct stream_writer *writer, const char *stopped, struct error *error)
{
    char line[64];
    if (stopped != NULL) {
        put_line(writer, "# stopped ", stopped);
    } else {
        snprintf(line, sizeof line, "# end %" PRId64, writer->section_count);
        put_text(writer, line);
        snprintf(line, sizeof line, " crc32=%08lx\n", writer->crc);
        put_text(writer, writer->text || writer->section_count == 0 ? "\n" : line);
    }
    return stream_writer_flush(writer, error);
}

enum status stream_write(const struct stream *stream, FILE *file, bool text, struct error *error)
{
    struct stream_writer writer;
    stream_writer_begin(&writer, file, text, stream);
    for (int64_t i = 0; i < stream->section_count; i++) {
        RETURN_IF_ERROR(stream_writer_put(&writer, stream, i, error));
    }
    return stream_writer_end(&writer, NULL, error);
}

void stream_write_rows(const struct section *section, FILE *file)
{
    put_rows(file, section, &(int64_t){0});
}
