/* The stiffness of linear elements in a plane body of smoothed cells without contacts, with what conditions
 * add, and its factor.
 *
 * In place of the sparse inverse and the coarse space where solving costs no more than an evaluation. The
 * elements are those of block_row.h, at the last evaluation; conditions are springs of the mean stiffness of
 * the nodes, beside their penalties. In three dimensions linear elements say little of the stiffness, as
 * supports are wide; contacts would call for a new factor at each step. */
#pragma once

#include "base/envelope.h"
#include "base/status.h"

struct solid_system;

struct stiffness_factor {
    double *body; /* factor.size: the matrix, as value[] of the envelope; NULL: none */
    struct envelope factor;
    bool definite; /* the matrix: there is a factor */
};

/* Lay out for a system; none where that does not pay. */
MUST_CHECK enum status stiffness_factor_begin(const struct solid_system *system,
                                              struct stiffness_factor *elements, struct error *error);
void stiffness_factor_free(struct stiffness_factor *elements);

/* Take the stiffness at the last evaluation of the body, which all processes have collected.
 * mass[node_count]: bounds of the stiffness of the nodes, N/m (2D: N/m2). */
MUST_CHECK enum status stiffness_factor_take(const struct solid_system *system, const double *mass,
                                             struct stiffness_factor *elements, struct error *error);

/* Factorise it. */
void stiffness_factor_make(struct stiffness_factor *elements, int dim, const double *mass);

/* y = the inverse times x. */
void stiffness_factor_solve(const struct stiffness_factor *elements, const double *x, double *y);
