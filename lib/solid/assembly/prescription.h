/* The displacements that a condition prescribes at a place or for an average. */
#pragma once

#include "solid/assembly/assembly.h"
#include "solid/constraint/held_directions.h"

#include "approx/field/scattered_fit.h"

/* Conflicting constraints. Where facets of two conditions meet, both prescribe a value at the shared nodes.
 * Only the first one is imposed there (held_directions.h). A different value of the other must not be ignored
 * silently. */
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

/* A condition, and the system that its rows are added to. */
struct prescription {
    const struct assembly *input;
    const struct condition *condition;
    struct solid_system *system;
    struct nodal_constraints *nodal_constraints; /* of all conditions */
    struct held_directions *held;                /* of earlier conditions */
    int32_t number;                              /* of the condition */
    struct scattered_fit fit;                    /* CONDITION_TABLE: to its points */
    double *spacing;                             /* CONDITION_TABLE: of the cells at each node, m */
};

/* The displacements that a condition prescribes for one average: its components, or that along the normal. */
struct demand {
    int count;
    double direction[9]; /* count * dim, unit */
    double value[3];     /* count: m */
};

/* The number of directions that the condition prescribes at a place. */
int prescription_directions(const struct condition *condition, int dim);

/* STATUS_INPUT if two rows of the condition's table have one place and different displacements. */
MUST_CHECK enum status prescription_check_table(const struct prescription *p, struct error *error);

/* The displacements that the condition prescribes for average a; with at_node, at its node along the same
 * directions. */
MUST_CHECK enum status prescription_demand(const struct prescription *p,
                                           const struct boundary_averages *averages, int64_t a, bool at_node,
                                           struct demand *demand, struct error *error);

/* What it prescribes at x, near a node; for a condition along normals the normal there. */
MUST_CHECK enum status prescription_demand_at(const struct prescription *p, int32_t node, const double *x,
                                              const double *normal, struct demand *demand,
                                              struct error *error);

/* Unless there is a note, *note receives one where what a table prescribes is off its row at a node of the
 * condition by more than a hundredth of the largest displacement: by what the fit makes of kinks and short
 * waves. Rows elsewhere are taken for measured ones, whose noise is to average out. */
MUST_CHECK enum status prescription_check_fit(const struct prescription *p, struct error *note,
                                              struct error *error);
