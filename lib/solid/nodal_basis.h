/* Nodal parameters: parameters that are about the values of the field at the nodes.
 *
 * Shape functions of moving least squares do not interpolate: with parameters u_j the field at node i is
 * (P u)_i = sum_j phi_j(x_i) u_j, equation (5) of lib/README.md. The wider the supports, the nearer P is to
 * singular (least eigenvalues .66, .14, .07, .015 at supports of 1.8 spacings in 2D, and of 1.9, 2, 2.2 in
 * 3D; on regular lattices 0): some patterns of parameters have almost no field and no energy, and a
 * relaxation in the parameters is slow along these. Here the unknowns of the relaxation are v, with u = Q v
 * and Q a sparse approximate left inverse of P (Grote and Huckle 1997): row i of Q has the pattern of row i
 * of P and minimises |q_i P - e_i|^2, subject to keeping linear fields, sum_j q_ij = 1, sum_j q_ij x_j = x_i.
 * Forces on v are Q^T times those on u. The state of equilibrium does not depend on Q. */
#ifndef SOLID_NODAL_BASIS_H
#define SOLID_NODAL_BASIS_H

#include "base/status.h"
#include "base/sparse.h"
#include "solid/constraint.h"

#include <stdint.h>

struct nodal_basis {
    int dim;
    struct sparse matrix, transposed; /* Q, and Q^T; node_count rows each */
};

/* From the values of the shape functions at the nodes, in CSR: ptr[node_count + 1], idx and phi;
 * X[node_count * dim], m. */
MUST_CHECK enum status nodal_basis_build(int dim, int64_t node_count, const double *X, const int64_t *ptr,
                                         const int32_t *idx, const double *phi, struct nodal_basis *basis,
                                         struct error *error);
/* Mean over the nodes of sum_j |q_ij|: how much Q magnifies parameters. About 1 where the field nearly
 * interpolates; large where P is near to singular throughout, and then Q is no good inverse. */
double nodal_basis_magnification(const struct nodal_basis *basis);

void nodal_basis_free(struct nodal_basis *basis);

/* u = Q v, and v = Q^T f; vectors of node_count * dim, not the same. */
void nodal_basis_apply(const struct nodal_basis *basis, const double *v, double *u);
void nodal_basis_apply_transposed(const struct nodal_basis *basis, const double *f, double *v);

/* The rows G as rows on v, G Q, in the same order. */
MUST_CHECK enum status nodal_basis_transform_rows(const struct nodal_basis *basis,
                                                  const struct constraint_rows *rows,
                                                  struct constraint_rows *transformed, struct error *error);

#endif
