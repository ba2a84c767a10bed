/* What a condition prescribes: at a place, and of an average. */
#pragma once

#include "solid/conflicts.h"
#include "solid/held_directions.h"

#include "approx/scattered_fit.h"
#include "approx/edge_paths.h"

/* One condition, and where it goes. */
struct prescription {
    const struct assembly *input;
    const struct condition *condition;
    struct solid_system *system;
    struct nodal_constraints *nodal_constraints; /* of all conditions */
    struct held_directions *held;                /* by the conditions before */
    bool *shared; /* group_count * dim: conditions before hold that component at some of the group's nodes */
    int32_t number;           /* of the condition */
    struct scattered_fit fit; /* CONDITION_TABLE: of its points, with the ways to them */
    double *spacing;          /* CONDITION_TABLE: of the cells at each node, m */
    bool penalties;           /* adding constraint penalties, not exact rows */
    double modulus, layer;    /* of the constraint penalties: Pa, and the size of the cells there, m */
};

/* What a condition asks of one average: the displacement, or its component along the normal. */
struct demand {
    int count;
    double direction[9]; /* count * dim, unit */
    double value[3];     /* count: m */
};

/* How many directions the condition prescribes at a place; all of them? */
int prescription_directions(const struct condition *condition, int dim);
bool prescription_is_full(const struct prescription *p);

/* STATUS_INPUT where two rows of a condition's table stand at one place with unlike displacements. */
MUST_CHECK enum status prescription_check_table(const struct prescription *p, struct error *error);

/* What the condition asks of average a; or, of the same directions, at its node. */
MUST_CHECK enum status prescription_demand(const struct prescription *p,
                                           const struct boundary_averages *averages, int64_t a, bool at_node,
                                           struct demand *demand, struct error *error);
