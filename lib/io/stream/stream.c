#include "io/stream/stream.h"
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static const struct {
    const char *name;
    size_t size;
} types[] = {[TYPE_I4] = {"i4", 4}, [TYPE_I8] = {"i8", 8}, [TYPE_F4] = {"f4", 4}, [TYPE_F8] = {"f8", 8}};

size_t element_size(enum element_type type)
{
    return types[type].size;
}

const char *element_type_name(enum element_type type)
{
    return types[type].name;
}

void stream_init(struct stream *stream)
{
    memset(stream, 0, sizeof *stream);
}

void section_free(struct section *section)
{
    FREE_ALL(section->name, section->attributes);
    if (section->owned) {
        free(section->data);
    }
    *section = (struct section){0};
}

void stream_free_input(struct stream *stream)
{
    if (stream->is_file) {
        munmap(stream->mapping, stream->mapping_size);
    } else {
        free(stream->mapping);
    }
    stream->mapping = NULL;
}

void stream_free(struct stream *stream)
{
    for (int64_t i = 0; i < stream->section_count; i++) {
        section_free(&stream->sections[i]);
    }
    free(stream->sections);
    names_free(&stream->provenance);
    stream_free_input(stream);
    stream_init(stream);
}

#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

/* The length of the name or key at `text`: a letter, then letters, digits, '.', '_', '-'. */
static size_t word_length(const char *text)
{
    return strspn(text, LETTERS) > 0 ? strspn(text, LETTERS "0123456789._-") : 0;
}

static enum status name_validate(const char *name, struct error *error)
{
    static const char *const reserved[] = {"mts", "end", "crc32", "stopped"};
    size_t length = word_length(name);
    if (length == 0 || name[length] != '\0' || length > NAME_LIMIT) {
        return fail(error, STATUS_INPUT,
                    "'%.40s' is no section name: a letter, then letters, digits, '.', '_' or '-', at most %d",
                    name, NAME_LIMIT);
    }
    for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++) {
        if (strcmp(name, reserved[i]) == 0) {
            return fail(error, STATUS_INPUT, "'%s' is reserved and names no section", name);
        }
    }
    return STATUS_OK;
}

/* Step to the next "key=value"; false at the end of the list. */
static bool next_attribute(const char **at, size_t *length)
{
    *at += strspn(*at, " ");
    *length = strcspn(*at, " ");
    return *length > 0;
}

/* The value of `key` in a list of attributes and its length, or NULL. */
static const char *find_attribute(const char *attributes, const char *key, size_t key_length,
                                  size_t *value_length)
{
    size_t length;
    for (const char *at = attributes; next_attribute(&at, &length); at += length) {
        if (length > key_length && at[key_length] == '=' && strncmp(at, key, key_length) == 0) {
            *value_length = length - key_length - 1;
            return at + key_length + 1;
        }
    }
    return NULL;
}

static bool has_control(const char *text)
{
    for (; *text != '\0'; text++) {
        if ((unsigned char)*text < 0x20 || *text == 0x7f) {
            return true;
        }
    }
    return false;
}

static enum status attributes_validate(const char *name, const char *attributes, struct error *error)
{
    if (strlen(attributes) > LINE_LIMIT / 2) {
        return fail(error, STATUS_INPUT, "%s: attributes longer than %d bytes", name, LINE_LIMIT / 2);
    }
    if (has_control(attributes)) {
        return fail(error, STATUS_INPUT, "%s: control character in the header", name);
    }
    size_t length;
    int64_t count = 0;
    for (const char *at = attributes; next_attribute(&at, &length); at += length) {
        size_t key = word_length(at);
        size_t ignored;
        if (key == 0 || key > KEY_LIMIT || key >= length || at[key] != '=') {
            return fail(error, STATUS_INPUT, "%s: '%.*s' in the header is not key=value", name,
                        (int)(length < 60 ? length : 60), at);
        }
        if (key == 3 && strncmp(at, "enc", 3) == 0) {
            return fail(error, STATUS_INPUT, "%s: attribute enc= is set by the stream itself", name);
        }
        if (find_attribute(attributes, at, key, &ignored) != at + key + 1) {
            return fail(error, STATUS_INPUT, "%s: attribute %.*s given twice", name, (int)key, at);
        }
        if (++count > 64) {
            return fail(error, STATUS_INPUT, "%s: more than 64 attributes", name);
        }
    }
    return STATUS_OK;
}

enum status section_validate(const struct section *section, struct error *error)
{
    int64_t bytes, rows = section->rows, cols = section->cols;
    RETURN_IF_ERROR(name_validate(section->name, error));
    RETURN_IF_ERROR(attributes_validate(section->name, section->attributes, error));
    if (rows < 0 || cols < 1 || cols > COLUMN_LIMIT || __builtin_mul_overflow(rows, cols, &bytes) ||
        __builtin_mul_overflow(bytes, (int64_t)element_size(section->type), &bytes)) {
        return fail(error, STATUS_INPUT, "%s: %jd rows of %jd columns are out of bounds", section->name, rows,
                    cols);
    }
    return STATUS_OK;
}

static struct section *find(const struct stream *stream, const char *name)
{
    for (int64_t i = 0; i < stream->section_count; i++) {
        if (strcmp(stream->sections[i].name, name) == 0) {
            return &stream->sections[i];
        }
    }
    return NULL;
}

const struct section *stream_find(const struct stream *stream, const char *name)
{
    return find(stream, name);
}

enum status stream_need(const struct stream *stream, const char *name, enum element_type type, int64_t cols,
                        const char *producer, const struct section **section, struct error *error)
{
    *section = stream_find(stream, name);
    if (*section == NULL) {
        return fail(error, STATUS_INPUT, "no section %s: run %s", name, producer);
    }
    if ((*section)->type != type) {
        return fail(error, STATUS_INPUT, "%s: type %s, need %s as %s makes it", name,
                    element_type_name((*section)->type), element_type_name(type), producer);
    }
    if (cols > 0 && (*section)->cols != cols) {
        return fail(error, STATUS_INPUT, "%s: %jd columns, need %jd", name, (*section)->cols, cols);
    }
    return STATUS_OK;
}

enum status stream_add(struct stream *stream, struct section *section, struct error *error)
{
    struct section *slot = find(stream, section->name);
    /* Allocate all slots at once, as untouched zero pages: sections never move when others are added. */
    if (stream->sections == NULL) {
        stream->sections = calloc(STREAM_SECTION_LIMIT, sizeof *stream->sections);
        if (stream->sections == NULL) {
            return fail_memory(error, "sections");
        }
    }
    if (slot == NULL && stream->section_count == STREAM_SECTION_LIMIT) {
        return fail(error, STATUS_INPUT, "%s: more than %d sections", section->name, STREAM_SECTION_LIMIT);
    }
    if (slot == NULL) {
        slot = &stream->sections[stream->section_count++];
    } else if (slot->data == section->data) {
        slot->owned = false;
    } else {
        section_give_back(stream, slot, true);
    }
    section_free(slot);
    *slot = *section;
    *section = (struct section){0};
    return STATUS_OK;
}

enum status stream_put(struct stream *stream, const char *name, enum element_type type, int64_t rows,
                       int64_t cols, const char *attributes, void *data, bool owned, struct error *error)
{
    const struct section *old = stream_find(stream, name);
    bool is_here = old != NULL && old->owned && old->data == data;
    struct section section = {.name = strdup(name),
                              .type = type,
                              .rows = rows,
                              .cols = cols,
                              .attributes = strdup(attributes != NULL ? attributes : ""),
                              .data = data,
                              .owned = owned};
    enum status status = section.name == NULL || section.attributes == NULL
                             ? fail_memory(error, name)
                             : section_validate(&section, error);
    if (status == STATUS_OK) {
        status = stream_add(stream, &section, error);
    }
    section.owned = section.owned && !is_here;
    section_free(&section);
    return status;
}

enum status stream_put_named(struct stream *stream, const char *name, enum element_type type, int64_t rows,
                             const struct names *names, void *data, bool owned, struct error *error)
{
    SCRATCH char *attributes = NULL;
    if (asprintf(&attributes, "names=%s", names->list != NULL ? names->list : "") < 0) {
        attributes = NULL;
        free(owned ? data : NULL);
        return fail_memory(error, name);
    }
    return stream_put(stream, name, type, rows, 1, attributes, data, owned, error);
}

void section_give_back(const struct stream *stream, const struct section *section, bool for_good)
{
    uintptr_t from = (uintptr_t)section->data, mapped = (uintptr_t)stream->mapping;
    size_t bytes = (size_t)(section->rows * section->cols) * element_size(section->type);
    if ((for_good || stream->is_file) && !section->owned && from >= mapped &&
        from + bytes <= mapped + stream->mapping_size) {
        memory_give_back(section->data, bytes);
    }
}

void stream_give_back(const struct stream *stream)
{
    for (int64_t i = 0; i < stream->section_count; i++) {
        section_give_back(stream, &stream->sections[i], false);
    }
}

void stream_remove(struct stream *stream, const char *name)
{
    struct section *section = find(stream, name);
    if (section != NULL) {
        section_give_back(stream, section, true);
        section_free(section);
        memmove(section, section + 1,
                (size_t)(stream->sections + --stream->section_count - section) * sizeof *section);
        stream->sections[stream->section_count] = (struct section){0};
    }
}

bool section_attribute(const struct section *section, const char *key, char *value, size_t size)
{
    size_t length;
    const char *found = find_attribute(section->attributes, key, strlen(key), &length);
    if (found == NULL || length >= size) {
        return false;
    }
    memcpy(value, found, length);
    value[length] = '\0';
    return true;
}

/* ---- provenance: the command line of each tool that worked on the stream, as typed into a shell ---- */

/* Write an argument as a shell reads it, at most four bytes for each of its own and three more: as it is,
 * within quotation marks, or with line ends and other control characters as $'...' with escapes. Returns the
 * end. */
static char *put_quoted(char *at, const char *argument)
{
    static const char safe[] = LETTERS "0123456789_@%+=:,./-";
    bool escaped = has_control(argument);
    if (argument[0] != '\0' && argument[strspn(argument, safe)] == '\0') {
        return stpcpy(at, argument);
    }
    at = stpcpy(at, escaped ? "$'" : "'");
    for (const char *c = argument; *c != '\0'; c++) {
        unsigned char byte = (unsigned char)*c;
        if (escaped && (byte < 0x20 || byte == 0x7f)) {
            at += sprintf(at, "\\x%02x", byte);
        } else if (*c == '\'' || (escaped && *c == '\\')) {
            at += sprintf(at, escaped ? "\\%c" : "'\\%c'", *c);
        } else {
            *at++ = *c;
        }
    }
    return stpcpy(at, "'");
}

enum status stream_add_provenance(struct stream *stream, int argc, char *const argv[], struct error *error)
{
    const char *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
    const char *tool = slash != NULL ? slash + 1 : argc > 0 ? argv[0] : "";
    size_t room = 8 * strlen(tool) + sizeof MTS_VERSION + 16;
    for (int i = 1; i < argc; i++) {
        room += 4 * strlen(argv[i]) + 4;
    }
    NEW_SCRATCH(char, text, (int64_t)room, error);
    char *at = put_quoted(stpcpy(put_quoted(text, tool), " " MTS_VERSION " "), tool);
    for (int i = 1; i < argc; i++) {
        at = put_quoted(stpcpy(at, " "), argv[i]);
    }
    return at - text > LINE_LIMIT - 8 /* "# @ " and the newline */
               ? fail(error, STATUS_INPUT, "the command line is longer than %d bytes", LINE_LIMIT)
               : names_add(&stream->provenance, text, error);
}
