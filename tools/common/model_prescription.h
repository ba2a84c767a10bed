/* What a displacement section of a scene prescribes: at a place, and of an average. */
#ifndef TOOLS_MODEL_PRESCRIPTION_H
#define TOOLS_MODEL_PRESCRIPTION_H

#include "model_conflicts.h"
#include "model_held.h"

#include "approx/scattered_fit.h"
#include "approx/ways.h"
#include "io/table.h"

/* What one displacement section prescribes, and where it goes. */
struct prescription {
    const struct model_input *input;
    const struct scene_displacement *section;
    struct solid_system *system;
    struct nodal_constraints *nodal_constraints; /* of all sections */
    struct held_directions *held;                /* by the sections before */
    bool *shared; /* group_count * dim: sections before hold that component at some of the group's nodes */
    int32_t number, curve;    /* of the section; of its load curve */
    struct table table;       /* SCENE_TABLE */
    struct scattered_fit fit; /* of the table, with the ways to its points */
    bool penalties;           /* adding constraint penalties, not exact rows */
    double modulus, layer;    /* of the constraint penalties: Pa, and the size of the cells there, m */
};

/* What a section asks of one average: the displacement, or its component along the normal. */
struct demand {
    int count;
    double direction[9]; /* count * dim, unit */
    double value[3];     /* count: m */
};

/* Whether the section leaves component i open. */
bool prescription_is_free(const struct scene_displacement *section, int i);

/* How many directions the section prescribes at a place; all of them? */
int prescription_directions(const struct scene_displacement *section, int dim);
bool prescription_is_full(const struct prescription *p);

/* value[dim] = the displacement of the section's table at x, beside that node, m. */
MUST_CHECK enum status prescription_value(const struct prescription *p, int32_t node, const double *x,
                                          double *value, struct error *error);

/* What the section asks of average a. */
MUST_CHECK enum status prescription_demand(const struct prescription *p,
                                           const struct boundary_averages *averages, int64_t a,
                                           struct demand *demand, struct error *error);

#endif
