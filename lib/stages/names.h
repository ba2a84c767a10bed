/* The names of groups that a section carries: its attribute names=, separated by commas. */
#pragma once

#include "io/stream/stream.h"

struct names {
    char *list; /* "body,lump", as in the section; "" if it has none */
    int64_t count;
    char **name; /* count */
};

/* The names in an attribute of a section, names= or another list such as rows=; to be freed also on
 * failure. */
MUST_CHECK enum status names_of(const struct section *section, const char *key, struct names *names,
                                struct error *error);
void names_free(struct names *names);

/* Index of `name`, or -1. */
int64_t names_find(const struct names *names, const char *name);

/* text[256] = the names, with a blank after each comma, for a message; "none" if there are none. Returns
 * text. */
const char *names_text(const struct names *names, char text[256]);
