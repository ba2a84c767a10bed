#include "io/scene_ini.h"

#include "base/memory.h"
#include "io/textfile.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Bytes of a file, of a line without blanks and comment, of a header between its brackets. */
enum { FILE_LIMIT = 64 << 10, LINE_LIMIT = 198, HEADER_LIMIT = 49 };

struct reading {
    struct ini_file *file;
    int64_t line; /* from 1 */
    struct error *error;
};

static enum status fail_line(struct reading *reading, const char *what)
{
    return fail(reading->error, STATUS_INPUT, "%s:%lld: %s", reading->file->path, (long long)reading->line,
                what);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

size_t ini_trimmed(const char *text, size_t length)
{
    while (length > 0 && is_blank(text[length - 1])) {
        length--;
    }
    return length;
}

/* Bytes of the line without comment and without blanks at its end. */
static size_t content_length(const char *line, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if ((line[i] == '#' || line[i] == ';') && (i == 0 || is_blank(line[i - 1]))) {
            length = i;
        }
    }
    return ini_trimmed(line, length);
}

static bool is_word(const char *text, size_t length)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return length > 0 && strspn(text, allowed) >= length;
}

/* Append the section of a header line `[kind NAME]`. */
static enum status add_section(struct reading *reading, char *header, size_t length)
{
    char *kind = header + 1, *end = header + length - 1;
    if (*end != ']' || length > HEADER_LIMIT + 2) {
        return fail_line(reading, "section header is not [kind] or [kind NAME], within 49 bytes");
    }
    size_t kind_length = strcspn(kind, " \t]");
    char *name = kind + kind_length + strspn(kind + kind_length, " \t");
    size_t name_length = (size_t)(end - name);
    if (!is_word(kind, kind_length) || (name_length > 0 && !is_word(name, name_length))) {
        return fail_line(reading,
                         "section header is not [kind] or [kind NAME] of letters, digits, '_', '.', '-'");
    }
    kind[kind_length] = '\0';
    *end = '\0';
    struct ini_file *file = reading->file;
    for (int64_t s = 0; s < file->section_count; s++) {
        const struct ini_section *other = &file->sections[s];
        if (strcmp(other->kind, kind) == 0 && strcmp(other->name, name) == 0) {
            return fail(reading->error, STATUS_INPUT, "%s:%lld: [%s%s%s]: already in line %lld: join the two",
                        file->path, (long long)reading->line, kind, *name ? " " : "", name,
                        (long long)other->line);
        }
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&file->sections, file->section_count + 1, reading->error));
    file->sections[file->section_count++] =
        (struct ini_section){.kind = kind, .name = name, .line = reading->line};
    return STATUS_OK;
}

/* An entry of the section seen last. */
static enum status add_entry(struct reading *reading, const char *key, char *value)
{
    struct ini_section *section = &reading->file->sections[reading->file->section_count - 1];
    const struct ini_entry *other = ini_find(section, key);
    char what[64] = "has no value";
    if (other != NULL) {
        snprintf(what, sizeof what, "already in line %lld", (long long)other->line);
    }
    if (other != NULL || *value == '\0') {
        return fail(reading->error, STATUS_INPUT, "%s:%lld: [%s%s%s]: %s: %s", reading->file->path,
                    (long long)reading->line, section->kind, *section->name ? " " : "", section->name, key,
                    what);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&section->entries, section->entry_count + 1, reading->error));
    section->entries[section->entry_count++] =
        (struct ini_entry){.key = key, .value = value, .line = reading->line};
    return STATUS_OK;
}

/* A line without blanks at its begin; what is behind its content is cut off. */
static enum status read_line(struct reading *reading, char *line, size_t length)
{
    line[length] = '\0';
    if (length == 0) {
        return STATUS_OK;
    }
    if (length > LINE_LIMIT) {
        return fail(reading->error, STATUS_INPUT, "%s:%lld: longer than %d bytes without blanks and comment",
                    reading->file->path, (long long)reading->line, LINE_LIMIT);
    }
    if (line[0] == '[') {
        return add_section(reading, line, length);
    }
    char *equals = strchr(line, '=');
    if (equals == NULL) {
        return fail_line(reading, "neither [kind NAME], nor key = value, nor a comment");
    }
    size_t key_length = ini_trimmed(line, (size_t)(equals - line));
    if (!is_word(line, key_length)) {
        return fail_line(reading, "key before '=' is not one word of letters, digits, '_', '.', '-'");
    }
    if (reading->file->section_count == 0) {
        return fail_line(reading, "stands before the first [section]");
    }
    line[key_length] = '\0';
    return add_entry(reading, line, equals + 1 + strspn(equals + 1, " \t"));
}

enum status ini_read(const char *path, struct ini_file *file, struct error *error)
{
    struct textfile text;
    struct reading reading = {.file = file, .error = error};
    *file = (struct ini_file){.path = path};
    RETURN_IF_ERROR(textfile_read(path, FILE_LIMIT, &text, error));
    file->text = text.text;
    file->checksum = (uint32_t)crc32(0, (const unsigned char *)text.text, (unsigned)text.size);
    for (char *at = file->text, *next; *at != '\0'; at = next) {
        char *end = strchr(at, '\n'),
             *line = at + strspn(at, " \t"); /* textfile_read guarantees the newline */
        next = end + 1;
        reading.line++;
        RETURN_IF_ERROR(read_line(&reading, line, content_length(line, (size_t)(end - line))));
    }
    return STATUS_OK;
}

void ini_free(struct ini_file *file)
{
    for (int64_t s = 0; s < file->section_count; s++) {
        free(file->sections[s].entries);
    }
    free(file->sections);
    free(file->text);
    *file = (struct ini_file){0};
}

const struct ini_entry *ini_find(const struct ini_section *section, const char *key)
{
    for (int64_t e = 0; e < section->entry_count; e++) {
        if (strcmp(section->entries[e].key, key) == 0) {
            return &section->entries[e];
        }
    }
    return NULL;
}
