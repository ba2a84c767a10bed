/* Background cells from labels on a grid: isosurface stuffing of several labels. A body-centred cubic lattice
 * (2D: one of equilateral triangles) is laid over the labels. An edge between points of different labels is
 * cut where their shares (approx/labels/labels.h) are equal. A point near a cut is moved onto it; the other
 * cuts bisect their edges, in an order on which neighbouring cells agree. For two labels these are the
 * stencils of Labelle and Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good dihedral angles,
 * ACM Trans. Graph. 26 (2007), 57, with angles between 10.7 and 164.8 degrees. Where three labels meet, nodes
 * are moved onto their common line, and cells are improved by moving nodes. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/labels/labels.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct label_cells_options {
    double spacing; /* of the lattice, m: edge of its cubes (2D: of its triangles) */
    double finest;  /* 3D: edge of the cubes at interfaces, m: the spacing is halved until it is no larger; 0:
                       the same as elsewhere */
    const bool *fine;          /* labels->count: those with fine interfaces; NULL: all */
    const struct cells *sized; /* 3D: cells over the body, with sizes at their nodes */
    const double *size; /* sized->node_count: wanted length of edges, m, positive, linear within cells; cubes
                           are halved where it is smaller than theirs; NULL: nowhere */
    const bool *keep;   /* labels->count: cells of this label are wanted; not label 0 */
    bool largest; /* keep only the largest of several connected bodies: voxels of others become outside */
    /* Called at the beginning of each step, and at the end with NULL; NULL: not. */
    void (*begin)(const char *step);
};

/* Bounds of the angles of cells, degrees, which label_cells_make meets if it can. */
#define LABEL_CELLS_LEAST_ANGLE 8.0
#define LABEL_CELLS_MOST_ANGLE 165.0

/* Wanted largest distance of the nodes of interfaces from them, voxels. Nodes may be farther away where
 * labels leave less room than the lattice needs. */
#define LABEL_CELLS_MOST_ASTRAY 0.6

struct label_cells {
    int dim;
    int64_t node_count;
    double *x; /* node_count * dim, m; every node belongs to a cell */
    int64_t cell_count;
    int32_t *cell;  /* cell_count * (dim + 1), positively oriented */
    int32_t *label; /* cell_count */
    int64_t facet_count;
    int32_t *facet;      /* facet_count * dim: the boundary, oriented outward */
    int32_t *side;       /* facet_count * 2: the label within, and the one beyond that is not kept */
    int64_t pinched;     /* nodes at which two bodies shared only a node or an edge; they are cut apart */
    int64_t hinges;      /* nodes at which parts of one body share only a node or an edge */
    int64_t specks;      /* bodies around a single point of the lattice, which are left out, */
    double speck_volume; /* and their volume, m3 */
    int64_t astray;      /* nodes of interfaces farther from them than LABEL_CELLS_MOST_ASTRAY voxels */
    double farthest;     /* largest distance of such a node, m */
    double unsized;      /* share of the body's cubes outside of the cells with sizes */
};

/* Make the cells. STATUS_INPUT if there is no voxel of a label to keep, or no cell at this spacing; if the
 * finest lattice would have more than 2^26 points everywhere; if sizes need more than seven halvings, or none
 * lies in the body. */
MUST_CHECK enum status label_cells_make(const struct labels *labels,
                                        const struct label_cells_options *options, struct label_cells *mesh,
                                        struct error *error);
void label_cells_free(struct label_cells *mesh);

/* A view of the cells. */
static inline struct cells label_cells_view(const struct label_cells *mesh)
{
    return (struct cells){mesh->dim, mesh->node_count, mesh->x, mesh->cell_count, mesh->cell};
}

/* lost[labels->count]: number of voxels of each label that neither lie in a cell of this label nor touch such
 * a voxel: parts too thin for the lattice, and sharp edges. For labels that are not kept, and the outside:
 * voxels that neither lie outside of the cells nor touch such a voxel: gaps and cavities that were filled. */
MUST_CHECK enum status label_cells_lost(const struct labels *labels, const bool *keep,
                                        const struct label_cells *mesh, int64_t *lost, struct error *error);
