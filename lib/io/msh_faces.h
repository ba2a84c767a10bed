/* The faces (edges in 2D) of a mesh of simplices, to be found by their nodes. */
#ifndef IO_MSH_FACES_H
#define IO_MSH_FACES_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct msh_face {
    int32_t rest[2]; /* its nodes but the lowest, ascending; in 2D the second is -1 */
    int32_t cell;
    int8_t opposite; /* which node of the cell is not on it */
    bool odd;        /* the outward order of the nodes is an odd permutation of the ascending one */
};

struct msh_faces {
    int dim;
    const int32_t *cells;  /* the caller's, cell_count x (dim + 1), positively oriented */
    int64_t *ptr;          /* node_count + 1: faces by their lowest node */
    struct msh_face *face; /* cell_count x (dim + 1); those of the same nodes stand side by side */
};

/* Where a mesh is no mesh: two cells on the same side of a face, or three cells on one. */
struct msh_overlap {
    int32_t cell[2]; /* -1 when there is none */
};

MUST_CHECK enum status msh_faces_make(struct msh_faces *faces, int dim, int64_t node_count,
                                      int64_t cell_count, const int32_t cells[], struct msh_overlap *overlap,
                                      struct error *error);
void msh_faces_free(struct msh_faces *faces);

/* Index of the first face with these `dim` nodes, in any order; *count receives how many cells share it. */
int64_t msh_faces_find(const struct msh_faces *faces, const int32_t node[], int *count);

/* The nodes of a face, oriented outward from its cell: in 2D the cell is on the left from first to second
 * node, in 3D the right-hand normal points out. */
void msh_face_nodes(const struct msh_faces *faces, int64_t face, int32_t node[]);

#endif
