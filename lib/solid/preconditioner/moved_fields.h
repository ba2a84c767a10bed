/* P Z: what the coarse fields move each node by, with the projection P onto what the conditions admit;
 * private to lib/solid/preconditioner. P changes them near conditions only, where it is kept by nodes and
 * centres. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct preconditioner;

struct moved_fields {
    const struct preconditioner *p;
    int32_t *near; /* node_count: index among the nodes that B G^T reaches, or -1 where P Z = Z */
    int64_t *ptr;  /* near nodes + 1: their entries */
    int64_t *at;   /* for each entry its place in the two lists that follow, centres ascending */
    int32_t *centre;
    float *move; /* dim * (dim + 1) * dim each: by direction, then field and its direction; in large bodies
                    there are many */
};

/* From the preconditioner's conditions, as they are with its present mass. */
MUST_CHECK enum status moved_fields_build(const struct preconditioner *p, struct moved_fields *fields,
                                          struct error *error);
void moved_fields_free(struct moved_fields *fields);
