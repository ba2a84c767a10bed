/* A membrane on facets of a body, without bending: St. Venant-Kirchhoff material in plane stress in the plane
 * of each facet. In 2D a strip in plane strain along the third axis. */
#pragma once

#include "approx/shape/boundary.h"
#include "solid/system/corner_values.h"

struct membrane_law {
    double thickness, youngs_modulus, poisson_ratio; /* m, Pa */
    double prestress; /* second Piola-Kirchhoff stress in all directions of the plane at rest, Pa */
    int32_t curve;    /* by whose value it is multiplied */
};

struct membrane {
    int dim;
    int64_t facet_count;
    struct boundary_averages corners; /* values at the corners: boundary_corners_build */
    int32_t *corner;                  /* facet_count * dim: the entry of each corner in `corners` */
    struct corner_values values;      /* their displacements */
    double *place, *on;               /* scratch: place of each corner, m, and force on it */
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
