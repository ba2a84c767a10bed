/* The steps of mesh_build; private to lib/io. */
#pragma once

#include "base/status.h"
#include "io/mesh/msh.h"

#include <stdint.h>

/* A mesh of simplices in metres that is being made: its arrays are those of the stream (lib/README.md). */
struct mesh {
    struct msh *msh;    /* receives notes */
    double unit;        /* of the file's lengths, m */
    const char *wanted; /* list of regions, or NULL: all */
    struct error *error;
    int dim; /* 2 or 3 */
    int64_t node_count;
    double *x; /* node_count x dim, m; every node belongs to a cell */
    int64_t cell_count;
    int32_t *cells;       /* cell_count x (dim + 1), positively oriented */
    int32_t *cell_region; /* cell_count: index into regions */
    int64_t facet_count;
    int32_t *facets;    /* facet_count x dim, each the face of exactly one cell, oriented outward */
    int32_t *facet_set; /* facet_count: index into facet_sets; ascending */
    int64_t *set_ptr;   /* node_sets.count + 1 */
    int32_t *set_idx;   /* nodes, ascending within each set */
    struct names regions, facet_sets, node_sets;

    int32_t *region_of; /* msh->element_count: the region of each kept cell, -1 for other elements */
    int32_t *node_of;   /* msh->node_count: node of the mesh, or -1 */
    int64_t *origin;    /* cell_count: the element of which each cell is a part */
    int64_t face_count, boundary_count;
    struct keyed *face; /* face_count, sorted: cell * (dim + 1) + the node of the cell that is not on it */
    int64_t *group_ptr; /* msh->group_count + 1: elements by group, in the order of the file */
    int32_t *group_idx;
    int32_t *face_stamp;  /* face_count: 1 + the last group that contains it */
    int32_t *node_stamp;  /* node_count: the same */
    int64_t set_capacity; /* of set_idx */
};

/* Append a note, printed. */
#define mesh_add_note(mesh, ...) names_print(&(mesh)->msh->notes, (mesh)->error, __VA_ARGS__)

/* The dimension of an element, and the number of its corners: no other nodes are used. */
int mesh_element_dim(const struct mesh *mesh, int64_t element);
int mesh_corners(const struct mesh *mesh, int64_t element);

/* The simplices of an element, as nodes of the mesh or -1; returns their number. A quadrangle in the plane
 * that is not convex is split along its inner diagonal. */
#define MSH_MOST_SIMPLICES 6
int mesh_simplices(const struct mesh *mesh, int64_t element, int32_t simplices[MSH_MOST_SIMPLICES][4]);

/* Set the dimension, that of the highest elements: 3, or 2 if they lie in a plane z = const. Name the
 * regions, and set mesh->region_of. */
MUST_CHECK enum status mesh_find_dim(struct mesh *mesh);
MUST_CHECK enum status mesh_pick_regions(struct mesh *mesh);

/* Make facets and node sets from the elements of lower dimension. */
MUST_CHECK enum status mesh_build_facets(struct mesh *mesh);
