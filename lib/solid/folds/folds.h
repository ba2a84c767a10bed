/* Folds of a body: the piecewise linear map from the reference to the deformed background cells should be
 * one-to-one.
 *
 * It is one-to-one when all cells keep their orientation and the boundary does not cross itself (Meisters and
 * Olech, Duke Math. J. 30, 1963). Both are checked. Of each cell the sign of its volume is checked, which is
 * that of det F of the linear interpolant. It also changes where a facet of the boundary is turned over
 * against the cell behind it. Slivers turn over within the error of the field at the nodes; therefore the
 * depth is measured. Boundary facets that share no node must not cross, nor be pierced by edges. Facets that
 * meet at a node (2D) or an edge (3D) have passed through each other if the angles of the cells around it add
 * up to more than a full turn.
 *
 * The interpolant of a flat cell also turns over where the field only bends: where the boundary bulges, a
 * node just beneath a facet passes through its chord; where it becomes concave, a node of a flat cell between
 * facets that continue each other. Such a cell is no fold if the gradient of the field itself keeps its
 * orientation (approx/field/field.h). */
#pragma once

#include "approx/cells/cells.h"
#include "approx/cells/crossing.h"
#include "base/ranks.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

enum fold_kind {
    FOLD_NONE,
    FOLD_CELL,   /* a cell is turned over: a node is beyond the opposite side by a tenth of the cell's size */
    FOLD_CREASE, /* the facets that meet at a node (2D) or an edge (3D) have passed through each other */
    FOLD_CROSSING, /* two parts of the boundary have passed through each other: by a twentieth of their facets
                    */
    FOLD_WITHIN,   /* a body lies within another; or a cell within a cell that it shares no node with */
    FOLD_EVERTED   /* a body is turned inside out: it passed through itself on the way */
};

struct fold {
    enum fold_kind kind;
    int64_t count;    /* of that kind */
    int64_t cell;     /* FOLD_CELL: the first one; FOLD_WITHIN: the one within; else -1 */
    int64_t facet[2]; /* of other kinds: the input's facets of the first fold, -1: none */
    double place[3];  /* at rest, m: middle of the cell or of the first facet */
};

#define FOLD_NOTHING ((struct fold){.kind = FOLD_NONE, .cell = -1, .facet = {-1, -1}})

/* Depth, by the length of a facet, up to which facets that cross each other are no fold: the field at the
 * nodes is as uncertain. */
#define FOLD_BEYOND_FACET 0.05

struct fold_input {
    struct cells cells; /* at rest, positively oriented */
    int64_t facet_count;
    const int32_t *facet;      /* facet_count * dim: the boundary, oriented outward */
    const bool *held;          /* facet_count: whether the displacement is prescribed there, if only along one
                                  direction */
    const struct ranks *ranks; /* processes that share the search; NULL: one */
};

/* A node (2D) or an edge (3D) of the boundary, where facets meet. */
struct fold_ring {
    int32_t node[2]; /* ascending; in 2D the second is -1 */
    int64_t facet;   /* one of those that meet there */
};

struct folds {
    struct fold_input input; /* the caller's arrays, which must outlive it */
    bool *in_contact; /* node_count, the caller's to set: nodes of facets that a contact keeps from passing
                      through each other, from a share of their size on; those that meet may do so by a
                      twentieth */
    struct fold_ring *rings; /* ring_count, ordered by their nodes */
    int64_t ring_count;
    int64_t *ring_ptr;  /* ring_count + 1: the cells around each, */
    int32_t *ring_cell; /* by their dim + 1 nodes, in a positive order, those of the ring first */
    bool *oriented; /* cell_count: flat cells in which the field keeps its orientation; the caller's to set */
    bool *is_held;  /* node_count: of a prescribed facet */
    double extent;  /* diagonal of the box around the nodes, m */
    int32_t *part;  /* cell_count: the connected body of each cell */
    int32_t *surface; /* facet_count: a node of the connected surface of each facet */
    struct fold
        at_rest; /* FOLD_CREASE, FOLD_CROSSING or FOLD_WITHIN: bodies, or parts of one, interpenetrate at
                    rest. Then the last two kinds are not searched for, nor FOLD_CREASE if it is that */
    /* Of the search. */
    const bool *stopped;     /* see folds_find */
    double *y;               /* node_count * dim: positions */
    double *enclosed;        /* 2 * node_count: volumes within surfaces, by their nodes; at rest, now */
    double largest;          /* of their coordinates, m */
    struct facet_box *boxes; /* facet_count, ascending */
    struct fold *found;      /* of several processes: the folds found by each */
};

/* STATUS_SYSTEM for memory. */
MUST_CHECK enum status folds_build(const struct fold_input *input, struct folds *folds, struct error *error);
void folds_free(struct folds *folds);

/* Look for folds of the displacement field u[node_count * dim] at the nodes: where the map is not one-to-one.
 * Of several kinds the one that comes first in the list of kinds is returned. Nodes that are `stopped`
 * [node_count] are in contact with a surface. A cell between such nodes and prescribed ones is pressed flat
 * against a plate. It may be turned over a little, as conditions hold averages and not nodes, and does not
 * count. */
struct fold folds_find(struct folds *folds, const double *u, const bool *stopped);

/* After folds_find: list the cells that are turned over and were flat at rest, with a height of less than a
 * fifth of the longest edge. In other cells that are turned over, no field that the cells resolve bends
 * enough to explain it. cell[cell_count] receives them, ascending; returns their number. */
int64_t folds_list_flat(const struct folds *folds, int32_t *cell);

/* Look for cells whose middle is within a cell that they share no node with: parts of the body that overlap,
 * also if their boundaries only touch. This costs more than folds_find, so it is used for output states only.
 * *fold is FOLD_NONE or FOLD_WITHIN; none where bodies interpenetrate at rest. STATUS_SYSTEM for memory. */
MUST_CHECK enum status folds_find_overlaps(struct folds *folds, const double *u, struct fold *fold,
                                           struct error *error);

/* Set folds->y to the positions displaced by u: of lib/solid/folds. */
void folds_take_positions(struct folds *folds, const double *u);
