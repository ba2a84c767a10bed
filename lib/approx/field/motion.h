/* The deformation x = X + u(X) of a body, interpolated from nodal displacements, and its inverse. In a cell
 * the displacement is u(X) = sum_a N_a(X) (u_a + G_a (X - X_a) / 2), with the linear shape functions N_a of
 * its nodes and the gradients G_a there: those of the field if it is known, else those of a quadratic moving
 * least squares fit. It interpolates the nodal values and is continuous across faces. It reproduces a
 * quadratic field of Hessian H if the G_a are its gradients, as sum_a N_a u_a = u + sum_a N_a (X - X_a) H (X
 * - X_a) / 2. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/field/field.h"

struct motion {
    struct cells cells;
    const double *u;  /* node_count * dim, m; the caller's */
    double *gradient; /* node_count * dim * dim: du_i/dx_j, or NULL: linear in each cell */
    int32_t *across;  /* cells_across */
    double *moved;    /* node_count * dim: x + u */
};

/* The field, a displacement, must outlive the motion. The gradients are those of its parameters; without
 * these, of a fit. linear: no gradients, the displacement is piecewise linear. STATUS_VERDICT if the nodes do
 * not admit a fit somewhere, which `linear` does not need; STATUS_INPUT as cells_across. To be freed also on
 * failure. */
MUST_CHECK enum status motion_build(const struct nodal_field *field, bool linear, struct motion *motion,
                                    struct error *error);
void motion_free(struct motion *motion);

/* The number of cells whose moved nodes span no positive volume; *first receives the lowest of them. */
int64_t motion_folded(const struct motion *motion, int64_t *first);

/* moved[dim] = X + u(X) for X[dim] in this cell. */
void motion_place(const struct motion *motion, int64_t cell, const double *X, double *moved);

/* X[dim]: the place that moves to x. The moved nodes of `cell` span a simplex that contains x. Newton's
 * method starts from the inverse of the linear interpolant, and changes to the cell beyond a face if X leaves
 * through it. *residual = |X + u(X) - x| at the end, m. Returns whether it is within the tolerance; if not, X
 * is the place by linear interpolation in this cell. */
bool motion_inverse(const struct motion *motion, int64_t cell, const double *x, double tolerance, double *X,
                    double *residual);
