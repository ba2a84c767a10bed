#include "io/scene/scene_ini.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { FILE_LIMIT = 64 << 10, HEADER_LIMIT = 49, LINE_LIMIT = 198 };

struct reading {
    struct ini_file *file;
    struct owned *words;
    int64_t line; /* number of the current line, from 1 */
    struct error *error;
};

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

static enum status fail_line(struct reading *reading, const char *what)
{
    return fail(reading->error, STATUS_INPUT, "%s:%lld: %s", reading->file->path, (long long)reading->line,
                what);
}

/* The length of a line without comment and trailing blanks. */
static size_t content_length(const char *line, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if ((line[i] == '#' || line[i] == ';') && (i == 0 || is_blank(line[i - 1]))) {
            length = i;
        }
    }
    return ini_trimmed(line, length);
}

/* *word: a copy of a text, owned by the caller's list. */
static enum status keep(struct reading *reading, const char *text, size_t length, char **word)
{
    *word = strndup(text, length);
    return owned_add(reading->words, *word, reading->file->path, reading->error);
}

static bool is_word(const char *text, size_t length)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return length > 0 && strspn(text, allowed) >= length;
}

/* Append the section of a header line `[kind NAME]`. */
static enum status add_section(struct reading *reading, const char *header, size_t length)
{
    const char *kind = header + 1;
    const char *end = header + length - 1;
    if (*end != ']' || length > HEADER_LIMIT + 2) {
        return fail_line(reading, "section header is not [kind] or [kind NAME], within 49 bytes");
    }
    size_t kind_length = strcspn(kind, " \t]");
    const char *name = kind + kind_length + strspn(kind + kind_length, " \t");
    size_t name_length = (size_t)(end - name);
    if (!is_word(kind, kind_length) || (name_length > 0 && !is_word(name, name_length))) {
        return fail_line(reading,
                         "section header is not [kind] or [kind NAME] of letters, digits, '_', '.', '-'");
    }
    struct ini_file *file = reading->file;
    RETURN_IF_ERROR(RESIZE_ARRAY(&file->sections, file->section_count + 1, reading->error));
    struct ini_section *section = &file->sections[file->section_count++];
    *section = (struct ini_section){.line = reading->line};
    RETURN_IF_ERROR(keep(reading, kind, kind_length, &section->kind));
    RETURN_IF_ERROR(keep(reading, name, name_length, &section->name));
    for (const struct ini_section *other = file->sections; other < section; other++) {
        if (strcmp(other->kind, section->kind) == 0 && strcmp(other->name, section->name) == 0) {
            return fail(reading->error, STATUS_INPUT, "%s:%lld: [%.*s]: already in line %lld: join the two",
                        file->path, (long long)reading->line, (int)length - 2, kind, (long long)other->line);
        }
    }
    return STATUS_OK;
}

/* Append an entry to the last section. */
static enum status add_entry(struct reading *reading, const char *text, size_t length, const char *value,
                             size_t value_length)
{
    struct ini_section *section = &reading->file->sections[reading->file->section_count - 1];
    char what[64] = "has no value", *key;
    RETURN_IF_ERROR(keep(reading, text, length, &key));
    const struct ini_entry *other = ini_find(section, key);
    if (other != NULL) {
        snprintf(what, sizeof what, "already in line %lld", (long long)other->line);
    }
    if (other != NULL || value_length == 0) {
        return fail(reading->error, STATUS_INPUT, "%s:%lld: [%s%s%s]: %s: %s", reading->file->path,
                    (long long)reading->line, section->kind, *section->name ? " " : "", section->name, key,
                    what);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&section->entries, section->entry_count + 1, reading->error));
    struct ini_entry *entry = &section->entries[section->entry_count++];
    *entry = (struct ini_entry){.key = key, .line = reading->line};
    return keep(reading, value, value_length, &entry->value);
}

/* Read a line without the blanks at its ends and without comment. */
static enum status read_line(struct reading *reading, const char *line, size_t length)
{
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
    const char *equals = memchr(line, '=', length);
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
    const char *value = equals + 1 + strspn(equals + 1, " \t"), *end = line + length;
    return add_entry(reading, line, key_length, value, value < end ? (size_t)(end - value) : 0);
}

enum status ini_read(const char *path, struct owned *words, struct ini_file *file, struct error *error)
{
    FREED_BY(textfile_free) struct textfile text = {0};
    struct reading reading = {.file = file, .words = words, .line = 1, .error = error};
    *file = (struct ini_file){.path = path};
    RETURN_IF_ERROR(textfile_read(path, FILE_LIMIT, &text, error));
    file->checksum = (uint32_t)crc32(0, (const unsigned char *)text.text, (unsigned)text.size);
    for (const char *at = text.text; *at != '\0'; reading.line++) {
        const char *line = at + strspn(at, " \t"), *end = strchr(at, '\n');
        RETURN_IF_ERROR(read_line(&reading, line, content_length(line, (size_t)(end - line))));
        at = end + 1;
    }
    return STATUS_OK;
}

void ini_free(struct ini_file *file)
{
    for (int64_t s = 0; s < file->section_count; s++) {
        free(file->sections[s].entries);
    }
    free(file->sections);
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
