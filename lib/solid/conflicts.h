/* Where facets of two conditions meet, they share nodes: each prescribes a value there. The one that comes
 * first holds the node (held_directions.h), so that another value would be left out silently. */
#pragma once

#include "solid/assembly.h"

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

MUST_CHECK enum status nodal_constraints_add(struct nodal_constraints *nodal_constraints,
                                             const struct nodal_constraint *nodal_constraint,
                                             struct error *error);
void nodal_constraints_free(struct nodal_constraints *nodal_constraints);

/* Two conditions that prescribe values of one node along one direction, further apart than a tenth of the
 * largest value that either prescribes, are an error that names them. Of those that are nearer, as measured
 * values at a rim may be, the first is reported in `note`, which is empty when all agree. The condition with
 * fewer directions takes precedence, or else the one that comes first. */
MUST_CHECK enum status nodal_constraints_check(const struct assembly *input,
                                               struct nodal_constraints *nodal_constraints,
                                               struct error *note, struct error *error);
