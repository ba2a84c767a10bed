/* An INI file as sections and entries with their lines, without interpretation; private to lib/io. */
#pragma once

#include "base/memory.h"

#include <stdint.h>

struct ini_entry {
    const char *key;
    char *value; /* not empty, without blanks at its ends; readers may modify it */
    int64_t line;
};

/* `[kind NAME]` or `[kind]`. */
struct ini_section {
    const char *kind;
    const char *name; /* "" if the header has none */
    int64_t line;
    struct ini_entry *entries; /* keys differ */
    int64_t entry_count;
};

struct ini_file {
    const char *path;             /* the caller's */
    uint32_t checksum;            /* CRC-32 of its bytes */
    struct ini_section *sections; /* kind and name together differ */
    int64_t section_count;
};

/* Read an INI file. Its text is added to `words`; this and `path` must outlive it. Errors, as `FILE:LINE:
 * ...`: those of textfile_read; STATUS_INPUT for headers that are not `[kind]` or `[kind NAME]`, keys without
 * value or outside of a section, and repeated sections and keys. To be freed also on failure. */
MUST_CHECK enum status ini_read(const char *path, struct owned *words, struct ini_file *file,
                                struct error *error);

void ini_free(struct ini_file *file);

/* The entry of that key, or NULL. */
const struct ini_entry *ini_find(const struct ini_section *section, const char *key);

/* Cut the blanks off the end of a text. */
void ini_trim(char *text);
