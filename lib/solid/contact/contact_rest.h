/* Positions at rest of the points of a contact, on the curved boundary whose chords the facets are.
 *
 * A curved boundary is known by its nodes and by the normals there, which the facets around a node give with
 * the weights of Max (1999): exact on circles and spheres, however the facets differ in size. The quadratic
 * boundary with the normals n_a lies above point p of a facet by sum_a N_a(p) (x_a - x_p) . n_a / 2. */
#pragma once

#include "solid/contact/contact.h"

/* *resolved: whether the facets resolve the curvature of the boundary, so that it is known between the nodes.
 * `points` and `averages` are those of the same facets; points->node[p] is corner p % dim of a facet. X:
 * nodes, m. */
MUST_CHECK enum status contact_rest_resolved(int dim, const struct boundary_averages *points,
                                             const struct boundary_averages *averages, const double *X,
                                             bool *resolved, struct error *error);

/* height[points]: by how much the boundary lies above the facets there, along their normals, m; zeros where
 * they do not resolve it. Arguments as above. */
MUST_CHECK enum status contact_rest_heights(int dim, const struct boundary_averages *points,
                                            const struct boundary_averages *averages, const double *X,
                                            double *height, struct error *error);

/* Set contact->rest. Quadrature points are raised from the chords to the boundary. Boundary averages, which
 * lie below their nodes, are raised to the nodes. Both offsets are zero on flat facets. */
MUST_CHECK enum status contact_rest_place(struct contact *contact, const double *X, struct error *error);
