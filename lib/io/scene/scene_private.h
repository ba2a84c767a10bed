/* The kinds of sections of a scene, and the values of one section, read as its keys are declared; private to
 * lib/io. Messages are
 * `FILE:LINE: [kind NAME]: key: what: remedy`. */
#pragma once

#include "base/status.h"
#include "io/scene/scene.h"

#include <stdbool.h>

struct ini_entry {
    const char *key;
    char *value; /* not empty, without blanks at its ends; readers may modify it */
    int64_t line;
};

/* `[kind NAME]` or `[kind]`, without interpretation. */
struct ini_section {
    const char *kind;
    const char *name; /* "" if the header has none */
    int64_t line;
    struct ini_entry *entries; /* keys differ */
    int64_t entry_count;
};

/* The entry of that key, or NULL. */
const struct ini_entry *ini_find(const struct ini_section *section, const char *key);

/* Cut the blanks off the end of a text. */
void ini_trim(char *text);

/* The section under interpretation. */
struct place {
    const struct ini_section *section;
    struct scene *scene; /* owns texts and lists */
    struct error *error;
};

/* Types of values of keys, and the C types in which they are stored. */
enum value_type {
    VALUE_NUMBER, /* double; those that follow are bounded: */
    VALUE_POSITIVE,
    VALUE_NOT_NEGATIVE,
    VALUE_SHARE,  /* within (0, 1) */
    VALUE_DIM,    /* int: 2 or 3 */
    VALUE_COUNT,  /* int64_t: within [1, most] */
    VALUE_CHOICE, /* an enum: the index of one of the words */
    VALUE_YES,    /* bool: no or yes, or the two words */
    VALUE_VECTOR, /* double[3], of which dim are given */
    VALUE_NAMES,  /* struct name_list: a comma list of different names */
    VALUE_TABLE,  /* const char *: a file of lengths, relative to the scene's folder unless absolute */
    VALUE_UNIT,   /* double: the unit of such a file in m; one is an error without the other */
    VALUE_CURVE,  /* struct scene_curve */
    VALUE_PRONY,  /* struct scene_prony: a comma list of `g tau` */
    VALUE_TEXT    /* const char * */
};

struct scene_key {
    const char *name;
    enum value_type type;
    size_t at;           /* offset of the value in the item or, of a section without items, in the scene */
    const char *missing; /* the remedy if the key is missing; NULL: it is optional */
    const char *const *words; /* NULL-terminated */
    int64_t most;
    size_t free; /* VALUE_VECTOR: offset of bool[3], set for components that are `free`; 0: none may be */
    const char *with[2];                  /* it is allowed only with one of these keys; NULL: any */
    const char *not_static, *not_dynamic; /* why it is not allowed in such scenes; NULL: it is */
};

/* Read the value of a key into *item, which is unchanged if the key is absent. */
MUST_CHECK enum status place_read(const struct place *place, const struct scene_key *key, int dim,
                                  void *item);

/* Read the numbers of a key of a material law that the section has: at most key->count, within its range. */
MUST_CHECK enum status place_numbers(const struct place *place, const struct law_key *key, double *values,
                                     int *given);

/* An error if a file of lengths is named without their unit. */
MUST_CHECK enum status place_check_units(const struct place *place, const struct scene_key *keys);

/* fail() with STATUS_INPUT at a key's line, or with key NULL at the section's. */
enum status place_fail(const struct place *place, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Whether the section has the key. */
bool place_has(const struct place *place, const char *key);

/* STATUS_INPUT unless the key is present; `what` is the remedy. */
MUST_CHECK enum status place_require(const struct place *place, const char *key, const char *what);

/* STATUS_INPUT if the key is present; `why` follows the message "not allowed: ". */
MUST_CHECK enum status place_forbid(const struct place *place, const char *key, const char *why);

/* The same of all keys of a NULL-terminated list. */
MUST_CHECK enum status place_forbid_all(const struct place *place, const char *const keys[], const char *why);

/* Print a text, which the scene owns. */
MUST_CHECK enum status place_print(const struct place *place, char **text, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* ---- scene_kinds.c ---- */

/* A kind of section, and the array of the scene that its sections extend, if any. */
struct scene_kind {
    const char *name;
    const struct scene_key *keys; /* all admitted keys; the last one has no name */
    /* Check of the keys together, after all have been read; NULL: none. */
    enum status (*check)(const struct place *place, struct scene *scene);
    bool has_items;
    size_t items, count; /* offsets in struct scene of the array and its count */
    size_t item_size;    /* items begin with a struct scene_label */
};

/* ---- scene_material.c ---- */

/* Append the keys of all laws to keys[count], up to `most`: each once. */
void scene_material_list_keys(const char **keys, int count, int most);

/* The check of a material: of its law, whose keys it reads, and of its moduli. */
MUST_CHECK enum status scene_material_check(const struct place *place, struct scene *scene);

/* The kind of the section; STATUS_INPUT for an unknown kind or key. */
MUST_CHECK enum status scene_kind_find(const struct place *place, const struct scene_kind **kind);
