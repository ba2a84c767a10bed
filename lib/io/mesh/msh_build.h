/* The steps of mesh_build, private to lib/io. */
#pragma once

#include "base/keyed.h"
#include "base/status.h"
#include "io/mesh/msh.h"

#include <stdbool.h>
#include <stdint.h>

enum mesh_role { MESH_UNUSED, MESH_MIDSIDE, MESH_CORNER }; /* a corner of any element is a corner */

struct mesh_draft {
    struct mesh *mesh;
    const struct msh *msh;
    const struct mesh_options *options;
    int8_t *role;       /* msh->node_count: what each node is to the elements, an enum mesh_role */
    int32_t *region_of; /* msh->element_count: the region of each cell that is kept, -1 for all else */
    int32_t *node_of;   /* msh->node_count: node of the mesh, or -1 */
    int64_t *origin;    /* mesh->cell_count: the element that each cell is made of */
    struct error *error;
};

/* Append a note (printf-style). */
MUST_CHECK enum status mesh_add_note(struct mesh_draft *draft, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

void mesh_names_free(struct mesh_names *names);

/* Index of the name of that length, or -1. */
int32_t mesh_find_name(const struct mesh_names *names, const char *name, size_t length);

/* Dimension of an element's type, and how many of its nodes count: its corners or all. */
int mesh_element_dim(const struct mesh_draft *draft, int64_t element);
int mesh_used_nodes(const struct mesh_draft *draft, int64_t element);

/* The simplices of an element, of nodes of the mesh or -1; returns how many. Of a quadrangle in the plane
 * whose corners do not go round a convex one, those on the inner diagonal. */
#define MESH_MOST_SIMPLICES 48
int mesh_simplices(const struct mesh_draft *draft, int64_t element,
                   int32_t simplices[MESH_MOST_SIMPLICES][4]);

/* Fill draft->role; an error for elements that the options want split and that cannot be. */
MUST_CHECK enum status mesh_find_roles(struct mesh_draft *draft);

/* Choose the dimension, that of the highest elements, at least 2, where they lie in a plane z = const; name
 * the regions; fill draft->region_of. */
MUST_CHECK enum status mesh_find_dim(struct mesh_draft *draft);
MUST_CHECK enum status mesh_pick_regions(struct mesh_draft *draft);

/* Number the nodes of the cells that are kept, in the order of the file, and take their coordinates; split
 * these cells into simplices, and turn these to be positive. */
MUST_CHECK enum status mesh_build_nodes(struct mesh_draft *draft);
MUST_CHECK enum status mesh_build_cells(struct mesh_draft *draft);

/* Two nodes of the mesh within 1e-12 of its extent are an error if cells connect them, else a note: two
 * bodies that touch. */
MUST_CHECK enum status mesh_check_coincident(struct mesh_draft *draft);

/* Facets and node sets from the elements of lower dimension. */
MUST_CHECK enum status mesh_build_facets(struct mesh_draft *draft);

/* ---- msh_split.c: splitting elements into simplices, so that elements with a common face split it in the
 * same way ---- */

/* Elements of first order that an element is made of: places in its list of nodes. */
struct msh_pieces {
    int type;  /* of each piece */
    int count; /* 0: an element of second order that cannot be split at its midside nodes */
    int8_t node[8][8];
};

/* With `midside`, an element of second order is split at its midside nodes; without, it is the one of first
 * order on its corners. */
const struct msh_pieces *msh_pieces(int type, bool midside);

#define MSH_MOST_SIMPLICES 6

/* Split an element of first order with these nodes in gmsh's order, into simplices of its
 * dimension: simplices[i][0 .. dim]. Returns how many. Their orientation is left open. A quadrangle, and each
 * quadrangular face, is split along the diagonal through its lowest node. With `other`, a quadrangle is split
 * along the other one (that is for meshes of the plane, whose cells share no quadrangles). */
int msh_split(int type, const int32_t node[], bool other, int32_t simplices[MSH_MOST_SIMPLICES][4]);

/* ---- msh_faces.c: the faces (edges in 2D) of a mesh of simplices, to be found by their nodes ---- */

struct msh_faces {
    int dim;
    const int32_t *cells; /* the caller's, cell_count x (dim + 1), positively oriented */
    int64_t count;
    struct keyed *face; /* count, sorted: cell * (dim + 1) + the node of the cell that is not on it */
};

/* Where a mesh is no mesh: two cells on the same side of a face, or three cells on one. */
struct msh_overlap {
    int32_t cell[2]; /* -1 when there is none */
};

MUST_CHECK enum status msh_faces_make(struct msh_faces *faces, int dim, int64_t cell_count,
                                      const int32_t cells[], struct msh_overlap *overlap,
                                      struct error *error);
void msh_faces_free(struct msh_faces *faces);

/* Index of the first face with these `dim` nodes, in any order; *count receives how many cells share it. */
int64_t msh_faces_find(const struct msh_faces *faces, const int32_t node[], int *count);

/* The nodes of a face, oriented outward from its cell: in 2D the cell is on the left from first to second
 * node, in 3D the right-hand normal points out. */
void msh_face_nodes(const struct msh_faces *faces, int64_t face, int32_t node[]);
