/* A body of simplices that is divided: edges are split, nodes moved and doubled, cells taken out. */
#pragma once

#include "approx/cells/cells.h"

/* Nodes, cells and facets are appended; those there were keep their places until division_compact. */
struct division {
    int dim;
    int64_t node_count, node_room;
    double *x;       /* node_count * dim, m, at rest */
    double *at;      /* node_count * dim, m: where the blade meets the nodes: deformed, or as x */
    int32_t *parent; /* node_count * 2: the nodes, with lower numbers, of the edge on which a node was put; of
                        a copy twice its original; of an old node itself */
    uint64_t *sets;  /* node_count: a bit for each set of nodes (that of set i is i % 64) */
    int64_t cell_count, cell_room;
    int32_t *node;    /* cell_count * (dim + 1) */
    int32_t *of_cell; /* cell_count: the old cell of which it is a part */
    int64_t facet_count, facet_room;
    int32_t *facet;        /* facet_count * dim: facets of the boundary that belong to groups */
    int32_t *group;        /* facet_count */
    const int32_t *region; /* of the old cells, or NULL; the caller's */
};

/* Begin with a copy of cells and named facets; `at` NULL: as x. To be freed also on failure. */
MUST_CHECK enum status division_begin(const struct cells *cells, const double *at, const int32_t *region,
                                      int64_t facet_count, const int32_t *facet, const int32_t *group,
                                      struct division *body, struct error *error);
void division_free(struct division *body);

/* A view of its cells. */
struct cells division_cells(const struct division *body);

/* An edge to be split: nodes a < b, a new node at a + share (b - a). */
struct split {
    int32_t node[2];
    double share; /* within ]0, 1[ */
};

/* For qsort: ascending nodes. */
int split_compare(const void *left, const void *right);

/* Put a node on each edge split[count], sorted, and divide the cells and facets there: each edge in turn, the
 * longest first, bisects all that have it, so that neighbours agree. Node node_count + i is on edge i. */
MUST_CHECK enum status division_split(struct division *body, int64_t count, const struct split *split,
                                      struct error *error);

/* Append the node at a + share (b - a); a copy of a node is one between it and itself. */
MUST_CHECK enum status division_add_node(struct division *body, int32_t a, int32_t b, double share,
                                         struct error *error);
MUST_CHECK enum status division_add_facet(struct division *body, const int32_t *facet, int32_t group,
                                          struct error *error);

/* Take out the cells that are not kept[cell_count], and the facets and nodes that have no cell any more.
 * Where group >= 0, faces between a cell that is kept and one that is not become facets of that group.
 * kept_as[node count before]: the new number of each node, -1: taken out. */
MUST_CHECK enum status division_take_out(struct division *body, const bool *kept, int32_t group,
                                         int32_t *kept_as, struct error *error);
