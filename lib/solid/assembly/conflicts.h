/* Conflicting constraints. Where facets of two conditions meet, both prescribe a value at the shared nodes.
 * Only the first one is imposed there (held_directions.h), so that a different value of the other would be
 * ignored silently. */
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

MUST_CHECK enum status nodal_constraints_add(struct nodal_constraints *nodal_constraints,
                                             const struct nodal_constraint *nodal_constraint,
                                             struct error *error);
void nodal_constraints_free(struct nodal_constraints *nodal_constraints);

/* Two conditions that prescribe different values at one node along one direction are an error, which names
 * them, if the values differ by more than a tenth of the largest value that either prescribes. Of smaller
 * differences, as between measured values, the first is reported in `note`, which is empty when all agree.
 * The condition with fewer directions takes precedence, or else the one that comes first. */
MUST_CHECK enum status nodal_constraints_check(const struct assembly *input,
                                               struct nodal_constraints *nodal_constraints,
                                               struct error *note, struct error *error);
