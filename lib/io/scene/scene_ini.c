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
    int64_t line; /* number of the line at hand, from 1 */
    struct error *error;
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

void ini_trim(char *text)
{
    size_t length = strlen(text);
    while (length > 0 && is_blank(text[length - 1])) {
        text[--length] = '\0';
    }
}

static enum status fail_line(struct reading *reading, const char *what)
{
    return fail(reading->error, STATUS_INPUT, "%s:%jd: %s", reading->file->path, reading->line, what);
}

static char *content(char *line)
{
    for (size_t i = 0; line[i] != '\0'; i++) {
        if ((line[i] == '#' || line[i] == ';') && (i == 0 || is_blank(line[i - 1]))) {
            line[i] = '\0';
            break;
        }
    }
    ini_trim(line);
    return line + strspn(line, " \t");
}

static bool is_word(const char *text)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return text[0] != '\0' && text[strspn(text, allowed)] == '\0';
}

/* Append the section of a header line `[kind NAME]`. */
static enum status add_section(struct reading *reading, char *header)
{
    struct ini_file *file = reading->file;
    char *end = header + strlen(header) - 1, *kind = header + 1, *name = kind + strcspn(kind, " \t]");
    if (*end != ']') {
        return fail_line(reading, "section header is not [kind] or [kind NAME]");
    }
    *end = '\0';
    while (is_blank(*name)) {
        *name++ = '\0';
    }
    if (!is_word(kind) || (*name != '\0' && !is_word(name))) {
        return fail_line(reading,
                         "section header is not [kind] or [kind NAME] of letters, digits, '_', '.', '-'");
    }
    for (int64_t s = 0; s < file->section_count; s++) {
        const struct ini_section *other = &file->sections[s];
        if (strcmp(other->kind, kind) == 0 && strcmp(other->name, name) == 0) {
            return fail(reading->error, STATUS_INPUT, "%s:%jd: [%s%s%s]: already in line %jd: join the two",
                        file->path, reading->line, kind, *name != '\0' ? " " : "", name, other->line);
        }
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&file->sections, file->section_count + 1, reading->error));
    file->sections[file->section_count++] =
        (struct ini_section){.kind = kind, .name = name, .line = reading->line};
    return STATUS_OK;
}

static enum status add_entry(struct reading *reading, char *key)
{
    struct ini_file *file = reading->file;
    char *value = strchr(key, '='), what[64] = "has no value";
    if (value == NULL) {
        return fail_line(reading, "neither [kind NAME], nor key = value, nor a comment");
    }
    *value++ = '\0';
    ini_trim(key);
    value += strspn(value, " \t");
    if (!is_word(key)) {
        return fail_line(reading, "key before '=' is not one word of letters, digits, '_', '.', '-'");
    }
    if (file->section_count == 0) {
        return fail_line(reading, "stands before the first [section]");
    }
    struct ini_section *section = &file->sections[file->section_count - 1];
    const struct ini_entry *other = ini_find(section, key);
    if (other != NULL) {
        snprintf(what, sizeof what, "already in line %jd", other->line);
    }
    if (other != NULL || *value == '\0') {
        return fail(reading->error, STATUS_INPUT, "%s:%jd: [%s%s%s]: %s: %s", file->path, reading->line,
                    section->kind, *section->name ? " " : "", section->name, key, what);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&section->entries, section->entry_count + 1, reading->error));
    section->entries[section->entry_count++] = (struct ini_entry){key, value, reading->line};
    return STATUS_OK;
}

enum status ini_read(const char *path, struct owned *words, struct ini_file *file, struct error *error)
{
    FREED_BY(textfile_free) struct textfile text = {0};
    struct reading reading = {.file = file, .error = error};
    *file = (struct ini_file){.path = path};
    RETURN_IF_ERROR(textfile_read(path, FILE_LIMIT, &text, error));
    file->checksum = (uint32_t)crc32(0, (const unsigned char *)text.text, (unsigned)text.size);
    char *rest = text.text;
    RETURN_IF_ERROR(owned_add(words, array_take(&text.text), path, error));
    for (char *line; (line = strsep(&rest, "\n")) != NULL;) {
        reading.line++;
        line = content(line);
        if (*line != '\0') {
            RETURN_IF_ERROR(*line == '[' ? add_section(&reading, line) : add_entry(&reading, line));
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
