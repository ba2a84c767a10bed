/* Conflicting constraints. Where facets of two conditions meet, both prescribe a value at the shared nodes.
 * Only the first one is imposed there (held_directions.h). A different value of the other must not be ignored
 * silently. */
#pragma once

#include "solid/assembly/assembly.h"

struct nodal_constraint {
    int32_t node;
    int32_t condition;   /* its number */
    double direction[3]; /* unit */
    double value;        /* m */
};

struct nodal_constraints {
    int64_t count, room;
    struct nodal_constraint *list;
};

void nodal_constraints_free(struct nodal_constraints *nodal_constraints);

/* STATUS_INPUT if two conditions prescribe values at one node along one direction that differ by more than a
 * tenth of the largest value that either prescribes; the message names them. The first of smaller
 * differences, as between measured values, is reported in `note`, unless that holds another one. The
 * condition with fewer directions takes precedence, else the one that comes first. */
MUST_CHECK enum status nodal_constraints_check(const struct assembly *input,
                                               struct nodal_constraints *nodal_constraints,
                                               struct error *note, struct error *error);
