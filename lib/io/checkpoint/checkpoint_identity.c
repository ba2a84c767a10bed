/* What a run depends on: the scene with the files that it names, and the stream. */
#include "io/checkpoint/checkpoint.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { BLOCK = 1 << 16 };

/* Update the checksum with the bytes of a file. */
static enum status add_file(const char *file, uLong *crc, struct error *error)
{
    ssize_t count = 0;
    NEW_SCRATCH(unsigned char, block, BLOCK, error);
    FREED_BY(descriptor_close) int descriptor = open(file, O_RDONLY | O_CLOEXEC);
    while (descriptor >= 0 && (count = read(descriptor, block, BLOCK)) > 0) {
        *crc = crc32_z(*crc, block, (size_t)count);
    }
    return descriptor < 0 || count < 0 ? fail(error, STATUS_SYSTEM, "%s: %s", file, strerror(errno))
                                       : STATUS_OK;
}

static uLong add_section(uLong crc, const struct section *section)
{
    const int64_t shape[] = {(int64_t)section->type, section->rows, section->cols};
    size_t bytes = (size_t)(section->rows * section->cols) * element_size(section->type);
    crc = crc32_z(crc, (const Bytef *)section->name, strlen(section->name) + 1);
    crc = crc32_z(crc, (const Bytef *)section->attributes, strlen(section->attributes) + 1);
    crc = crc32_z(crc, (const Bytef *)shape, sizeof shape);
    return bytes > 0 ? crc32_z(crc, section->data, bytes) : crc;
}

uint32_t checkpoint_identify_input(const struct stream *input)
{
    uLong sections = crc32_z(0, NULL, 0);
    for (int64_t i = 0; i < input->section_count; i++) {
        sections = add_section(sections, &input->sections[i]);
    }
    return (uint32_t)sections;
}

enum status checkpoint_identify(const struct scene *scene, const struct stream *input,
                                struct checkpoint_identity *identity, struct error *error)
{
    uLong crc = scene->checksum;
    for (int64_t i = 0; i < scene->files.count; i++) {
        RETURN_IF_ERROR(add_file(scene->files.names[i], &crc, error));
    }
    identity->scene = (uint32_t)crc;
    identity->input = checkpoint_identify_input(input);
    return STATUS_OK;
}
