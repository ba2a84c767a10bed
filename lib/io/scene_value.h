/* Typed values of one section of a scene. Inside of lib/io only.
 *
 * Every function looks up `key`, leaves *value alone when the key is absent, and reports a bad value as
 * `FILE:LINE: [kind NAME]: key: what: remedy`. */
#ifndef IO_SCENE_VALUE_H
#define IO_SCENE_VALUE_H

#include "base/status.h"
#include "io/scene.h"
#include "io/scene_ini.h"

#include <stdbool.h>

/* The section under interpretation. */
struct place {
    const struct ini_file *file;
    const struct ini_section *section;
    struct owned *owned; /* of the scene */
    struct error *error;
};

/* Bounds of a number; an open bound is excluded. */
struct range {
    double least, most;
    bool open_least, open_most;
};

extern const struct range range_any, range_positive, range_not_negative, range_open_share;

/* fail() with STATUS_INPUT at a key's line, or with key NULL at the section's. */
enum status place_fail(const struct place *place, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Is the key there? */
bool place_has(const struct place *place, const char *key);

/* An error unless the key is there; `what` is the remedy. */
MUST_CHECK enum status place_require(const struct place *place, const char *key, const char *what);

/* An error if the key is there; `why` follows the message "not allowed: ". */
MUST_CHECK enum status place_forbid(const struct place *place, const char *key, const char *why);

/* The same of all keys of a NULL-terminated list. */
MUST_CHECK enum status place_forbid_all(const struct place *place, const char *const keys[], const char *why);

/* An error unless exactly one of the keys (a NULL-terminated list) is there. */
MUST_CHECK enum status place_require_one(const struct place *place, const char *const keys[]);

/* The error that a key, or with key NULL the section itself, is none of those (a NULL-terminated list). */
enum status place_unknown(const struct place *place, const char *key, const char *what,
                          const char *const allowed[]);

/* An error unless all keys of the section are among `keys` (a NULL-terminated list). */
MUST_CHECK enum status place_only_keys(const struct place *place, const char *const keys[]);

MUST_CHECK enum status place_number(const struct place *place, const char *key, struct range range,
                                    double *value);

MUST_CHECK enum status place_count(const struct place *place, const char *key, int64_t most, int64_t *value);

/* One of a NULL-terminated list of words: its index. */
MUST_CHECK enum status place_choice(const struct place *place, const char *key, const char *const words[],
                                    int *index);

MUST_CHECK enum status place_yes(const struct place *place, const char *key, bool *value);

/* A vector of `dim` numbers; where is_free is not NULL, `free` stands for an absent component. */
MUST_CHECK enum status place_vector(const struct place *place, const char *key, int dim, double values[3],
                                    bool is_free[3]);

/* A comma list of different names. */
MUST_CHECK enum status place_names(const struct place *place, const char *key, struct name_list *list);

/* A file, relative to the scene's folder unless absolute. */
MUST_CHECK enum status place_file(const struct place *place, const char *key, const char **path);

/* A file of lengths: the key and `unit`, whose size in metres is stored; one is an error without the other.
 */
MUST_CHECK enum status place_table(const struct place *place, const char *key, const char **path,
                                   double *metres);

/* The whole text. */
void place_text(const struct place *place, const char *key, const char **value);

/* A text as of printf, which the scene owns. */
MUST_CHECK enum status place_print(const struct place *place, const char **text, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

MUST_CHECK enum status place_curve(const struct place *place, const char *key, struct scene_curve *curve);

#endif
