/* Lists of names: of regions, facet sets, node sets; of notes. */
#pragma once

#include "base/status.h"

#include <stdint.h>

/* To be freed. */
struct names {
    int64_t count;
    char **name; /* count */
    char *list;  /* "body,lump", of `length` bytes; NULL or "": none */
    int64_t length;
};

/* Append a copy of a name; a printed one; of each item of a list "body,lump", of which "" has none:
 * names->list is then not NULL. */
MUST_CHECK enum status names_add(struct names *names, const char *name, struct error *error);
MUST_CHECK enum status names_print(struct names *names, struct error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
MUST_CHECK enum status names_split(struct names *names, const char *list, struct error *error);
void names_free(struct names *names);

MUST_CHECK enum status names_remove(struct names *names, int64_t index, struct error *error);

/* Index of `name`, or -1. */
int64_t names_find(const struct names *names, const char *name);

/* The same; STATUS_INPUT where there is no `what` of that name, with a list of those that there are. */
MUST_CHECK enum status names_need(const struct names *names, const char *what, const char *name,
                                  int64_t *index, struct error *error);
