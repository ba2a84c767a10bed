/* Steps of building a rigid surface; private to lib/solid. */
#pragma once

#include "base/box.h"
#include "base/vector.h"
#include "solid/rigid/rigid.h"

#include <math.h>

/* Set vertex_normal, edge_normal, turn and the rims from facets and normals. STATUS_INPUT where two facets
 * disagree on the side. */
MUST_CHECK enum status rigid_make_pseudo_normals(struct rigid_surface *surface, struct error *error);

/* An edge of a triangle; it goes from corner k to k + 1. */
struct half_edge {
    int32_t low, high; /* its vertices */
    int32_t opposite;  /* the other vertex of the triangle */
    bool upward;       /* from low to high */
    int64_t slot;      /* facet * 3 + k */
};

/* 3D: edges[facet_count * 3] = the half-edges of a surface, sorted so that those on one edge are
 * consecutive. */
void rigid_list_edges(const struct rigid_surface *surface, struct half_edge *edges);

/* The end of the run of half-edges on one edge that begins at `first`. */
int64_t rigid_edge_end(const struct half_edge *edges, int64_t first, int64_t count);

/* Set branch, branch_count and in_order. */
MUST_CHECK enum status rigid_grow_tree(struct rigid_surface *surface, struct error *error);
