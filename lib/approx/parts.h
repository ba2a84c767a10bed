/* Connected parts of a body and of its boundary, and rings around a choice of facets, cells or nodes. */
#pragma once

#include "approx/cells.h"

/* Where facets of a boundary meet: a node, in 3D an edge. */
struct ridge {
    int32_t node[2];         /* ascending; 2D: the second is -1 */
    int32_t facet, opposite; /* the vertex of the facet that is not there */
};

/* ridge[count * dim]: those of the facets node[count * dim], sorted by nodes and then by facets. */
void ridges_list(int dim, int64_t count, const int32_t *node, struct ridge *ridge);

/* The first ridge behind number `first` that has other nodes, or `count`. */
int64_t ridges_end(int64_t count, const struct ridge *ridge, int64_t first);

/* part[cells->count]: the connected body of each cell; cells with a common face are of one body, cells that
 * share no more than an edge or a node are not. Bodies are numbered from 0 by falling volume. */
MUST_CHECK enum status cells_parts(const struct cells *cells, int32_t *part, int32_t *count,
                                   struct error *error);

/* part[boundary->count]: the side of each facet of the boundary. Facets with a common edge (2D: node) are of
 * one side if the outward normals differ by at most `degrees` there; at 180 sides are the connected surfaces.
 * Facets that meet at an edge of more than two facets are not joined there. Sides are numbered from 0 by
 * falling area. */
MUST_CHECK enum status boundary_sides(const double *x, const struct faces *boundary, double degrees,
                                      int32_t *part, int32_t *count, struct error *error);

/* Grow a choice by `rings` rings of neighbours; with `rings` negative shrink it, by those of what is not
 * chosen. Of items, chosen[count]: neighbours have a node in common; of nodes, chosen[node_count]: an item.
 * item[count * corners] indexes node_count nodes. Beyond edge[edge_count], the nodes at the end of the items,
 * nothing is chosen: a choice shrinks there, too. */
MUST_CHECK enum status choice_grow(int64_t count, int corners, const int32_t *item, int64_t node_count,
                                   int64_t edge_count, const int32_t *edge, int rings, bool of_items,
                                   bool *chosen, struct error *error);
