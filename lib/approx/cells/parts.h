/* Connected parts of a body and of its boundary; rings around a selection of facets, cells or nodes. */
#pragma once

#include "approx/cells/cells.h"

/* Where facets of a boundary meet: a node, in 3D an edge. */
struct ridge {
    int32_t node[2];         /* ascending; 2D: the second is -1 */
    int32_t facet, opposite; /* the facet, and its vertex that is not on the ridge, */
    int8_t corner;           /* and the number of that corner */
    bool upward;             /* the facet goes from the first node to the second; 2D: it ends at the node */
};

/* ridge[count * dim]: the ridges of the facets node[count * dim], sorted by nodes, then by facets. */
void ridges_list(int dim, int64_t count, const int32_t *node, struct ridge *ridge);

/* The index of the first ridge behind `first` that has other nodes, or `count`. */
int64_t ridges_end(int64_t count, const struct ridge *ridge, int64_t first);

/* part[cells->count]: the connected body of each cell. Cells with a common face are connected; cells that
 * share only an edge or a node are not. Bodies are numbered from 0 by decreasing volume. */
MUST_CHECK enum status cells_parts(const struct cells *cells, int32_t *part, int32_t *count,
                                   struct error *error);

/* part[cells->node_count]: the body of each node, by those of the cells, of_cell[cells->count]; -1: of
 * several bodies, or none. */
MUST_CHECK enum status nodes_parts(const struct cells *cells, const int32_t *of_cell, int32_t *part,
                                   struct error *error);

/* part[boundary->count]: the side of each facet of the boundary. Facets with a common edge (2D: node) are on
 * one side if their outward normals differ by at most `degrees`; with 180, sides are the connected surfaces.
 * Facets are not joined at an edge of more than two facets. Sides are numbered from 0 by decreasing area. */
MUST_CHECK enum status boundary_sides(const double *x, const struct faces *boundary, double degrees,
                                      int32_t *part, int32_t *count, struct error *error);

/* Grow a selection by `rings` rings of neighbours; with `rings` negative, shrink it by growing its
 * complement. With `of_items` the selection is of items, chosen[count], and neighbours share a node; else it
 * is of nodes, chosen[node_count], and neighbours share an item. item[count * corners] indexes node_count
 * nodes. edge[edge_count] are the nodes at the border of the items: a selection shrinks from there, too. */
MUST_CHECK enum status choice_grow(int64_t count, int corners, const int32_t *item, int64_t node_count,
                                   int64_t edge_count, const int32_t *edge, int rings, bool of_items,
                                   bool *chosen, struct error *error);
