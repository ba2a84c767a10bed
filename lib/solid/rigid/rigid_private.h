/* Steps of building a rigid surface; private to lib/solid. */
#pragma once

#include "approx/cells/parts.h"
#include "base/box.h"
#include "base/vector.h"
#include "solid/rigid/rigid.h"

#include <math.h>

/* Begin to build: vertices and facets alone. */
MUST_CHECK enum status rigid_weld(int dim, int64_t facet_count, const double *corners,
                                  struct rigid_surface *surface, struct error *error);

/* Set vertex_normal, edge_normal, turn and the rims from facets and normals. STATUS_INPUT where two facets
 * disagree on the side. */
MUST_CHECK enum status rigid_make_pseudo_normals(struct rigid_surface *surface, struct error *error);

/* The ridges of a surface, facet_count * dim, to be freed. */
MUST_CHECK enum status rigid_list_ridges(const struct rigid_surface *surface, struct ridge **ridges,
                                         struct error *error);

/* Mark the nodes (3D: and the edge) of a ridge of one facet as rim. */
void rigid_mark_rim(struct rigid_surface *surface, const struct ridge *ridge);

/* facet * dim + k of the ridge: in 3D the edge from corner k to k + 1, in 2D corner k. It is opposite to
 * corner (k + dim - 1) % dim. */
static inline int64_t rigid_ridge_slot(int dim, const struct ridge *ridge)
{
    return (int64_t)ridge->facet * dim + (ridge->corner + 1) % dim;
}

/* Set vertex_normal from the normals of the facets. */
void rigid_weigh_normals(struct rigid_surface *surface);

/* Set branch, branch_count and in_order. */
MUST_CHECK enum status rigid_grow_tree(struct rigid_surface *surface, struct error *error);
