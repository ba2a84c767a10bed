/* A membrane on facets of a body, without bending: St. Venant-Kirchhoff material in plane stress in the plane
 * of each facet, whose corners move with the boundary. In 2D a strip in plane strain along the third axis.
 * Where rows of the conditions prescribe a corner's node, the corner has their averages: the tension of a
 * membrane that ends there acts on the rows, not on a point of the body. */
#pragma once

#include "approx/shape/boundary.h"
#include "solid/constraint/constraint.h"

struct membrane_law {
    double thickness, youngs_modulus, poisson_ratio; /* m, Pa */
    double prestress; /* second Piola-Kirchhoff stress in all directions of the plane at rest, Pa */
    int32_t curve;    /* by whose value it is multiplied */
};

struct membrane {
    int dim;
    int64_t facet_count;
    struct boundary_averages corners;   /* values at the corners: boundary_corners_build */
    int32_t *corner;                    /* facet_count * dim: the entry of each corner in `corners` */
    const struct constraint_rows *rows; /* the caller's; must outlive this */
    int64_t *held; /* corners.count * dim: rows that prescribe the corner, -1 after the last */
    double *along; /* corners.count * dim^2: vector b_k of each, with b_k . a_j = (j == k) for directions a */
    double *metric; /* facet_count * (dim - 1)^2: inverse of that of the edges at rest, 1/m2 */
    double *weight; /* facet_count: E thickness area / (1 - nu^2) at rest, J (2D: J/m) */
    double nu;
    double tension; /* the prestress by E / (1 - nu^2) */
    int32_t curve;  /* of the tension */
};

/* rows: those of conditions on facets and nodes. STATUS_INPUT if a facet is no face of the
 * boundary. To be freed, also on failure. */
MUST_CHECK enum status membrane_build(const struct face_table *table, const struct facet_set *set,
                                      const struct constraint_rows *rows, const struct membrane_law *law,
                                      struct membrane *membrane, struct error *error);
void membrane_free(struct membrane *membrane);

/* Subtract the internal forces at u from force[node_count * dim]; X: the nodes at rest; factor: that of the
 * prestress. Returns the energy, J (2D: J/m), linear in the factor. force NULL: only the energy. */
double membrane_pull(const struct membrane *membrane, const double *X, double factor, const double *u,
                     double *force);

/* mass[node_count] += a bound of the stiffness at rest at each node, under the whole prestress, N/m (2D:
 * N/m2). */
void membrane_add_to_bound(const struct membrane *membrane, double *mass);
