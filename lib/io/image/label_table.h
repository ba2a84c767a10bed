/* Names of the labels of an image: a table in a text file. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* A name, of one or more rows of the table. */
struct label_name {
    char *text;
    bool kept; /* false: its cells are left out; it names their walls */
};

/* Numbers first .. last are of name number `name`, -1: outside. */
struct label_range {
    int64_t first, last;
    int32_t name;
};

struct label_table {
    int32_t name_count;
    struct label_name *name;
    int32_t range_count;
    struct label_range *range; /* no number is in two */
    bool others;               /* a row '*' says what all other numbers are: */
    int32_t name_of_others;    /* as label_range.name */
};

/* Read a table: rows `LABELS NAME` with LABELS a number, a range 3-5, a list 1,3-5 of these, or * for all
 * others but 0; a NAME - makes these labels outside; rows of one name are one region. A third word - leaves
 * the cells out, and names their walls. '#' begins a comment. Errors, as `FILE:LINE: ...`: those of
 * textfile_read; STATUS_INPUT for other words, a number that stands twice, a name with a comma, quote or
 * colon, 'outside', and a name that is both kept and left out. To be freed also on failure. */
MUST_CHECK enum status label_table_read(const char *path, struct label_table *table, struct error *error);
void label_table_free(struct label_table *table);

/* Number of the name of that text, added where it is new. */
MUST_CHECK enum status label_table_name(struct label_table *table, const char *text, bool kept, int32_t *name,
                                        struct error *error);

/* Append a range. STATUS_INPUT where one of its numbers is in another. */
MUST_CHECK enum status label_table_add(struct label_table *table, const struct label_range *range,
                                       struct error *error);

/* Look a label up: false where no row names it. 0 is outside, -1, without a row. */
bool label_table_find(const struct label_table *table, int64_t label, int32_t *name);
