/* Names of the labels of an image: a table in a text file. */
#pragma once

#include "base/names.h"
#include "io/image/image.h"

#include <stdbool.h>
#include <stdint.h>

/* The labels first .. last have the name number `name`. */
struct label_range {
    int64_t first, last;
    int32_t name;
};

struct label_table {
    struct names names; /* the first one is "outside" */
    bool *kept;         /* names.count; false: its cells are left out, and it names their walls */
    int32_t range_count;
    struct label_range *range; /* disjoint */
    bool others;               /* a row '*' names all other labels: */
    int32_t name_of_others;    /* as label_range.name */
};

/* Read a table: rows `LABELS NAME` with LABELS a number, a range 3-5, a list 1,3-5 of these, or * for all
 * others but 0. The NAME - makes these labels outside; rows of one name are one region. A third word - leaves
 * the cells out, and names their walls. '#' begins a comment. Errors, as `FILE:LINE: ...`: those of
 * textfile_read; STATUS_INPUT for other words, a repeated label, a name with a comma, quote or colon,
 * 'outside', and a name that is both kept and left out. To be freed also on failure. */
MUST_CHECK enum status label_table_read(const char *path, struct label_table *table, struct error *error);
void label_table_free(struct label_table *table);

/* The number of a name, which is added if it is new. */
MUST_CHECK enum status label_table_name(struct label_table *table, const char *text, bool kept, int32_t *name,
                                        struct error *error);

/* Begin a table by the labels of an image's segments that have voxels, in their order. What a name cannot
 * hold becomes '_', and a number tells it from others; `note` tells so of the first one, else it is "". */
enum { LABEL_TABLE_NOTE = 400 };
MUST_CHECK enum status label_table_segments(struct label_table *table, const struct image *image,
                                            char note[LABEL_TABLE_NOTE], struct error *error);

/* Append a range. STATUS_INPUT if it overlaps another one. */
MUST_CHECK enum status label_table_add(struct label_table *table, const struct label_range *range,
                                       struct error *error);

/* Look up a label: false if no row names it. Without a row, 0 is outside. */
bool label_table_find(const struct label_table *table, int64_t label, int32_t *name);
