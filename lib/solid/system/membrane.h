/* A membrane on facets of a body, without bending: St. Venant-Kirchhoff material in plane stress in the plane
 * of each facet, whose corners move with the boundary. In 2D a strip in plane strain along the third axis. */
#pragma once

#include "approx/shape/boundary.h"

struct membrane {
    int dim;
    int64_t facet_count;
    struct boundary_averages corners; /* values at the corners: boundary_corners_build */
    int32_t *corner;                  /* facet_count * dim: the entry of each corner in `corners` */
    double *metric; /* facet_count * (dim - 1)^2: inverse of that of the edges at rest, 1/m2 */
    double *weight; /* facet_count: E thickness area / (1 - nu^2) at rest, J (2D: J/m) */
    double nu;
};

/* thickness, m; E, Pa. STATUS_INPUT if a facet is no face of the boundary. To be freed, also on failure. */
MUST_CHECK enum status membrane_build(const struct face_table *table, const struct facet_set *set,
                                      double thickness, double E, double nu, struct membrane *membrane,
                                      struct error *error);
void membrane_free(struct membrane *membrane);

/* Subtract the internal forces at u from force[node_count * dim]; X: the nodes at rest. Returns the energy, J
 * (2D: J/m). force NULL: only the energy. */
double membrane_pull(const struct membrane *membrane, const double *X, const double *u, double *force);

/* mass[node_count] += a bound of the stiffness at rest at each node, N/m (2D: N/m2). */
void membrane_add_to_bound(const struct membrane *membrane, double *mass);
