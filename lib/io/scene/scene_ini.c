#include "io/scene/scene_ini.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <ini.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { FILE_LIMIT = 64 << 10, HEADER_LIMIT = 49 }; /* libinih cuts headers beyond 49 bytes silently */

/* libinih does not report line numbers, empty sections, repetitions and truncation. It gets one cleaned line
 * at a time, so that the line of each entry is known; headers are checked here. */
struct reading {
    struct ini_file *file;
    struct owned *words;
    const char *at; /* the rest of the text */
    int64_t line;   /* number of the line passed last, from 1 */
    enum status status;
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

/* A copy of a word, owned by the caller's list; NULL on failure. */
static char *keep(struct reading *reading, const char *text, size_t length)
{
    char *word = strndup(text, length);
    reading->status = owned_add(reading->words, word, reading->file->path, reading->error);
    return reading->status == STATUS_OK ? word : NULL;
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
    *section = (struct ini_section){.kind = keep(reading, kind, kind_length), .line = reading->line};
    RETURN_IF_ERROR(reading->status);
    section->name = keep(reading, name, name_length);
    RETURN_IF_ERROR(reading->status);
    for (const struct ini_section *other = file->sections; other < section; other++) {
        if (strcmp(other->kind, section->kind) == 0 && strcmp(other->name, section->name) == 0) {
            return fail(reading->error, STATUS_INPUT, "%s:%lld: [%.*s]: already in line %lld: join the two",
                        file->path, (long long)reading->line, (int)length - 2, kind, (long long)other->line);
        }
    }
    return STATUS_OK;
}

/* Check a line of content before libinih parses it. */
static enum status check_line(struct reading *reading, const char *line, size_t length, size_t room)
{
    if (length == 0) {
        return STATUS_OK;
    }
    if (length + 2 > room) {
        return fail(reading->error, STATUS_INPUT, "%s:%lld: longer than %zu bytes without blanks and comment",
                    reading->file->path, (long long)reading->line, room - 2);
    }
    if (line[0] == '[') {
        return add_section(reading, line, length);
    }
    const char *equals = memchr(line, '=', length);
    if (equals == NULL) {
        return fail_line(reading, "neither [kind NAME], nor key = value, nor a comment");
    }
    if (!is_word(line, ini_trimmed(line, (size_t)(equals - line)))) {
        return fail_line(reading, "key before '=' is not one word of letters, digits, '_', '.', '-'");
    }
    return reading->file->section_count > 0 ? STATUS_OK
                                            : fail_line(reading, "stands before the first [section]");
}

/* fgets for libinih: the next line, cleaned. Leading blanks, which would make it a continuation of the last
 * value, are removed. */
static char *next_line(char *buffer, int room, void *user)
{
    struct reading *reading = user;
    if (reading->status != STATUS_OK || *reading->at == '\0') {
        return NULL;
    }
    size_t length = strcspn(reading->at, "\n");
    const char *line = reading->at + strspn(reading->at, " \t");
    const char *end = reading->at + length;
    reading->at = end + 1; /* textfile_read guarantees the newline */
    reading->line++;
    length = content_length(line, line < end ? (size_t)(end - line) : 0);
    reading->status = check_line(reading, line, length, (size_t)room);
    if (reading->status != STATUS_OK) {
        return NULL;
    }
    memcpy(buffer, line, length);
    memcpy(buffer + length, "\n", 2);
    return buffer;
}

/* Append an entry to the last section. */
static enum status add_entry(struct reading *reading, const char *key, const char *value)
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
    struct ini_entry *entry = &section->entries[section->entry_count++];
    *entry = (struct ini_entry){.key = keep(reading, key, strlen(key)), .line = reading->line};
    RETURN_IF_ERROR(reading->status);
    entry->value = keep(reading, value, strlen(value));
    return reading->status;
}

static int take_entry(void *user, const char *section, const char *key, const char *value)
{
    struct reading *reading = user;
    (void)section; /* its kind and name are known from its header already */
    if (reading->status == STATUS_OK) {
        reading->status = add_entry(reading, key, value);
    }
    return reading->status == STATUS_OK;
}

enum status ini_read(const char *path, struct owned *words, struct ini_file *file, struct error *error)
{
    FREED_BY(textfile_free) struct textfile text = {0};
    *file = (struct ini_file){.path = path};
    RETURN_IF_ERROR(textfile_read(path, FILE_LIMIT, &text, error));
    file->checksum = (uint32_t)crc32(0, (const unsigned char *)text.text, (unsigned)text.size);
    struct reading reading = {.file = file, .words = words, .at = text.text, .error = error};
    int result = ini_parse_stream(next_line, &reading, take_entry, &reading);
    if (reading.status == STATUS_OK && result != 0) { /* nothing that passed check_line should fail */
        reading.status = fail(error, STATUS_INPUT, "%s:%d: not an INI line", path, result);
    }
    return reading.status;
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
