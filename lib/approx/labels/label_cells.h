/* Background cells from labels on a grid: isosurface stuffing of several labels.
 *
 * A body-centred cubic lattice (2D: one of equilateral triangles) is laid over the labels. An edge between
 * points of different labels is cut where their shares (approx/labels/labels.h) are equal. A point that a cut
 * lies near is moved onto it; the other cuts bisect their edges, in an order that neighbouring cells agree
 * on. For two labels these are the stencils of Labelle and Shewchuk, Isosurface stuffing: fast tetrahedral
 * meshes with good dihedral angles, ACM Trans. Graph. 26 (2007), 57, whose angles lie between 10.7 and 164.8
 * degrees. Where three labels meet, nodes are moved onto their common line and cells are improved by moving
 * nodes; the bounds of struct label_cells tell what holds. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/labels/labels.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct label_cells_options {
    double spacing; /* of the lattice, m: edge of its cubes (2D: of its triangles) */
    double finest;  /* 3D: edge of the cubes at interfaces, m: the spacing is halved until it is no larger; 0:
                       as elsewhere */
    const bool *fine;          /* labels->count: at interfaces of these labels; NULL: at all */
    const struct cells *sized; /* 3D: cells over the body, at whose nodes */
    const double *size;   /* sized->node_count: the wanted length of edges, m, positive, linear within cells;
                             where   it asks for smaller cubes than `spacing` these are halved; NULL: nowhere */
    const bool *keep;     /* labels->count: cells of this label are wanted; never of label 0 */
    const int32_t *whole; /* labels->count: the label whose part each is: the volume of a whole is kept; NULL:
                             of each label */
    bool largest;         /* of several connected bodies only the largest */
};

/* Angles of cells, degrees: label_cells_make keeps within them where it can. */
#define LABEL_CELLS_LEAST_ANGLE 8.0
#define LABEL_CELLS_MOST_ANGLE 165.0

/* Voxels that the nodes of interfaces may be off their interface: where labels leave less room than the
 * lattice needs, some are farther. */
#define LABEL_CELLS_MOST_ASTRAY 0.6

struct label_cells {
    int dim;
    int64_t node_count;
    double *x; /* node_count * dim, m; every node belongs to a cell */
    int64_t cell_count;
    int32_t *cell;  /* cell_count * (dim + 1), positively oriented */
    int32_t *label; /* cell_count */
    int64_t facet_count;
    int32_t *facet;  /* facet_count * dim: the boundary, oriented outward */
    int32_t *side;   /* facet_count * 2: the label within, and the one beyond that is not kept */
    int64_t pinched; /* nodes at which two bodies shared no more than a node or an edge: they are cut apart */
    int64_t hinges;  /* nodes at which parts of one body share no more than a node or an edge */
    int64_t specks;  /* bodies about a single point of the lattice: they are left out, */
    double speck_volume; /* m3 */
    int64_t
        astray; /* nodes of interfaces farther than LABEL_CELLS_MOST_ASTRAY voxels from where labels meet */
    double unsized;  /* the share of the body's cubes that lies beyond the cells of the sizes */
    double farthest; /* largest of these distances of all nodes, m */
};

/* Make the cells. STATUS_INPUT: no voxel of a label that is kept, a spacing, or sizes, for which the lattice
 * would have more than 2^26 points all over at its finest, sizes that ask for more than seven halvings of it,
 * sizes that all lie elsewhere, or no cell at that spacing. */
MUST_CHECK enum status label_cells_make(const struct labels *labels,
                                        const struct label_cells_options *options, struct label_cells *mesh,
                                        struct error *error);
void label_cells_free(struct label_cells *mesh);

/* A view of the cells. */
static inline struct cells label_cells_view(const struct label_cells *mesh)
{
    return (struct cells){mesh->dim, mesh->node_count, mesh->x, mesh->cell_count, mesh->cell};
}

/* lost[labels->count]: voxels of each label that neither lie in a cell of it nor touch one that does: parts
 * too thin for the lattice, and sharp edges. Of labels that are not kept, the outside with them, voxels that
 * neither lie outside of the cells nor touch one that does: gaps and cavities that are filled. */
MUST_CHECK enum status label_cells_lost(const struct labels *labels, const bool *keep,
                                        const struct label_cells *mesh, int64_t *lost, struct error *error);

/* Bodies that voxels of the labels which are kept connect by faces. */
struct label_cells_apart {
    int64_t count;    /* missing connections: the number of bodies less that of the voxels */
    int64_t voxel[2]; /* of the first one: two that touch, halfway between the bodies */
};

/* part[mesh->cell_count], part_count: the bodies, by cells_parts. */
MUST_CHECK enum status label_cells_find_apart(const struct labels *labels, const bool *keep,
                                              const struct label_cells *mesh, const int32_t *part,
                                              int32_t part_count, struct label_cells_apart *apart,
                                              struct error *error);

/* Least and largest dihedral angle (2D: angle) of a simplex with corners x[dim + 1], degrees; 0 and 180 for
 * one without volume or inverted. */
void simplex_angles(int dim, const double *const x[], double angles[2]);
