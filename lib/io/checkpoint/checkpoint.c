#include "io/checkpoint/checkpoint.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

/* ---- what a run depends on: the scene with the files that it names, and the stream ---- */

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
        FREED_BY(textfile_free) struct textfile file = {0};
        RETURN_IF_ERROR(bytefile_read(scene->files.names[i], SIZE_MAX, &file, error));
        crc = crc32_z(crc, (const Bytef *)file.text, file.size);
    }
    identity->scene = (uint32_t)crc;
    identity->input = checkpoint_identify_input(input);
    return STATUS_OK;
}

/* ---- the state: the run's values are sections `state.NAME` ---- */

enum { NAME_SIZE = 112 };

static void section_name(const struct state_value *value, char name[NAME_SIZE])
{
    snprintf(name, NAME_SIZE, "state.%s", value->name);
}

/* Flags are saved as numbers. */
static enum status save(void *context, const struct state_value *value, struct error *error)
{
    char name[NAME_SIZE];
    int32_t *numbers;
    section_name(value, name);
    if (value->type != STATE_FLAGS) {
        return stream_put(context, name, value->type == STATE_NUMBERS ? TYPE_F8 : TYPE_I8, value->count, 1,
                          "", value->values, false, error);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&numbers, value->count, error));
    for (int64_t i = 0; i < value->count; i++) {
        numbers[i] = ((const bool *)value->values)[i];
    }
    return stream_put(context, name, TYPE_I4, value->count, 1, "", numbers, true, error);
}

static enum status restore(void *context, const struct state_value *value, struct error *error)
{
    static const enum element_type types[] = {
        [STATE_NUMBERS] = TYPE_F8, [STATE_COUNTS] = TYPE_I8, [STATE_FLAGS] = TYPE_I4};
    char name[NAME_SIZE];
    section_name(value, name);
    const struct section *section = stream_find(context, name);
    if (section == NULL || section->type != types[value->type] || section->rows != value->count ||
        section->cols != 1) {
        return fail(error, STATUS_INPUT, "checkpoint: section %s is missing or does not fit", name);
    }
    if (value->type == STATE_FLAGS) {
        for (int64_t i = 0; i < value->count; i++) {
            ((bool *)value->values)[i] = ((const int32_t *)section->data)[i] != 0;
        }
    } else if (value->count > 0) {
        memcpy(value->values, section->data, (size_t)value->count * element_size(section->type));
    }
    return STATUS_OK;
}

struct state checkpoint_state(const struct stream *stream)
{
    /* restore() does not change it. */
    return (struct state){.visit = restore, .context = (void *)(uintptr_t)stream};
}

enum status checkpoint_begin(struct stream *stream, const struct checkpoint_identity *identity, int64_t step,
                             struct state *state, struct error *error)
{
    char attributes[128];
    int64_t *value = NULL;
    *state = (struct state){.visit = save, .context = stream};
    RETURN_IF_ERROR(NEW_ARRAY(&value, 1, error));
    *value = step;
    snprintf(attributes, sizeof attributes,
             "version=" MTS_VERSION " scene=%08" PRIx32 " input=%08" PRIx32 " cols=step", identity->scene,
             identity->input);
    return stream_put(stream, "checkpoint", TYPE_I8, 1, 1, attributes, value, true, error);
}

static bool is_same(const struct section *section, const char *key, uint32_t checksum)
{
    char text[16], expected[16];
    snprintf(expected, sizeof expected, "%08" PRIx32, checksum);
    return section_attribute(section, key, text, sizeof text) && strcmp(text, expected) == 0;
}

/* Check that a checkpoint is of this version, scene and input. */
static enum status check_identity(const struct stream *stream, const char *name,
                                  const struct checkpoint_identity *identity, int64_t *step,
                                  struct error *error)
{
    char version[32] = "";
    const struct section *section = stream_find(stream, "checkpoint");
    if (section == NULL || section->type != TYPE_I8 || section->rows != 1 || section->cols != 1) {
        return fail(error, STATUS_INPUT, "%s: a stream, but not a checkpoint: name another file", name);
    }
    if (!section_attribute(section, "version", version, sizeof version) ||
        strcmp(version, MTS_VERSION) != 0) {
        return fail(error, STATUS_INPUT,
                    "%s: checkpoint of version %s, this is " MTS_VERSION ": remove it to begin anew", name,
                    version);
    }
    if (!is_same(section, "scene", identity->scene)) {
        return fail(error, STATUS_INPUT,
                    "%s: checkpoint of another scene, or its tables have changed: remove it to begin anew",
                    name);
    }
    if (!is_same(section, "input", identity->input)) {
        return fail(error, STATUS_INPUT,
                    "%s: checkpoint of another cloud or table of shape functions: remove it to begin anew",
                    name);
    }
    *step = *(const int64_t *)section->data;
    return STATUS_OK;
}

/* A device, folder or link must not be replaced. */
static enum status check_regular(const char *file, struct error *error)
{
    struct stat present;
    if (lstat(file, &present) == 0 && !S_ISREG(present.st_mode)) {
        return fail(error, STATUS_INPUT, "%s: is no regular file: name another one for the checkpoint", file);
    }
    return STATUS_OK;
}

enum status checkpoint_remove(const char *file, struct error *error)
{
    static const char *const endings[] = {".part", ".frames", ""};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        SCRATCH char *name = NULL;
        if (asprintf(&name, "%s%s", file, endings[i]) < 0) {
            name = NULL;
            return fail_memory(error, file);
        }
        if (unlink(name) != 0 && errno != ENOENT) {
            return fail_system(error, name);
        }
    }
    return STATUS_OK;
}

enum status checkpoint_read(const char *file, const struct checkpoint_identity *identity,
                            struct stream *stream, bool *exists, int64_t *step, struct error *error)
{
    stream_init(stream);
    RETURN_IF_ERROR(check_regular(file, error));
    FREED_BY(descriptor_close) int descriptor = open(file, O_RDONLY | O_CLOEXEC);
    *exists = descriptor >= 0 || errno != ENOENT;
    if (descriptor < 0) {
        return *exists ? fail_system(error, file) : STATUS_OK;
    }
    enum status status = stream_read(stream, descriptor, file, error);
    if (status == STATUS_INPUT) {
        text_append(error->text, sizeof error->text, "; remove it to begin anew");
    }
    RETURN_IF_ERROR(status);
    status = check_identity(stream, file, identity, step, error);
    if (status != STATUS_OK) {
        stream_free(stream);
    }
    return status;
}
