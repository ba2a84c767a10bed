#include "io/scene/scene_ini.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { FILE_LIMIT = 64 << 10 };

struct reading {
    struct ini_file *file;
    struct owned *words;
    int64_t line; /* number of the line at hand, from 1 */
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

/* *word: a copy, owned by the caller's list. */
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
    if (*end != ']') {
        return fail_line(reading, "section header is not [kind] or [kind NAME]");
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
    char *words[2];
    *section = (struct ini_section){.line = reading->line};
    RETURN_IF_ERROR(keep(reading, kind, kind_length, &words[0]));
    RETURN_IF_ERROR(keep(reading, name, name_length, &words[1]));
    section->kind = words[0];
    section->name = words[1];
    for (const struct ini_section *other = file->sections; other < section; other++) {
        if (strcmp(other->kind, section->kind) == 0 && strcmp(other->name, section->name) == 0) {
            return fail(reading->error, STATUS_INPUT, "%s:%lld: [%.*s]: already in line %lld: join the two",
                        file->path, (long long)reading->line, (int)length - 2, kind, (long long)other->line);
        }
    }
    return STATUS_OK;
}

/* Append an entry `key = value` to the last section. */
static enum status add_entry(struct reading *reading, const char *line, size_t length)
{
    struct ini_file *file = reading->file;
    const char *equals = memchr(line, '=', length);
    size_t key_length = equals != NULL ? ini_trimmed(line, (size_t)(equals - line)) : 0;
    char *key, *value;
    if (equals == NULL) {
        return fail_line(reading, "neither [kind NAME], nor key = value, nor a comment");
    }
    if (!is_word(line, key_length)) {
        return fail_line(reading, "key before '=' is not one word of letters, digits, '_', '.', '-'");
    }
    if (file->section_count == 0) {
        return fail_line(reading, "stands before the first [section]");
    }
    const char *text = equals + 1;
    text += strspn(text, " \t");
    RETURN_IF_ERROR(keep(reading, line, key_length, &key));
    RETURN_IF_ERROR(keep(reading, text, text < line + length ? (size_t)(line + length - text) : 0, &value));
    struct ini_section *section = &file->sections[file->section_count - 1];
    const struct ini_entry *other = ini_find(section, key);
    char what[64] = "has no value";
    if (other != NULL) {
        snprintf(what, sizeof what, "already in line %lld", (long long)other->line);
    }
    if (other != NULL || *value == '\0') {
        return fail(reading->error, STATUS_INPUT, "%s:%lld: [%s%s%s]: %s: %s", file->path,
                    (long long)reading->line, section->kind, *section->name ? " " : "", section->name, key,
                    what);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&section->entries, section->entry_count + 1, reading->error));
    section->entries[section->entry_count++] = (struct ini_entry){key, value, reading->line};
    return STATUS_OK;
}

enum status ini_read(const char *path, struct owned *words, struct ini_file *file, struct error *error)
{
    FREED_BY(textfile_free) struct textfile text = {0};
    struct reading reading = {.file = file, .words = words, .error = error};
    *file = (struct ini_file){.path = path};
    RETURN_IF_ERROR(textfile_read(path, FILE_LIMIT, &text, error));
    file->checksum = (uint32_t)crc32(0, (const unsigned char *)text.text, (unsigned)text.size);
    for (const char *at = text.text; *at != '\0'; at = strchr(at, '\n') + 1) {
        const char *line = at + strspn(at, " \t");
        size_t length = content_length(line, strcspn(line, "\n"));
        reading.line++;
        if (length > 0) {
            RETURN_IF_ERROR(line[0] == '[' ? add_section(&reading, line, length)
                                           : add_entry(&reading, line, length));
        }
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
