/* Cutting the cells of a lattice, private to label_cells_cut.c and label_cells_second.c. */
#pragma once

#include "approx/labels/label_cells_private.h"

/* Pieces of one cell of the lattice: each of its six edges doubles them at most. */
enum { CUTTING_MOST_PIECES = 64 };

/* A second cut: on an edge from a cut to a point of the lattice, within a face whose corners have three
 * labels. Sorted by the ends. */
struct second_cut {
    int32_t cut, point; /* nodes */
    int32_t node;       /* its node; -1: none, as the interface is near the cut */
};

/* The cells of a lattice that are cut. */
struct cutting {
    const struct lattice *lattice;
    struct label_cells *mesh;
    bool *between;                               /* of each cell: whether all its nodes lie on interfaces */
    int64_t cell_room, label_room, between_room; /* allocated */
    int64_t cuts;                                /* number of cuts */
    int64_t node_count; /* nodes of the lattice, of cuts and of second cuts, in this order */
    double *x;          /* node_count * dim, m */
    int32_t *cut_node;  /* lattice->edge_count: the node of each edge's cut */
    int32_t *cut_edge;  /* cuts: the edge of each */
    struct second_cut *second;
    int64_t seconds, second_room;
    bool searching; /* true: second cuts are collected; false: cells are made */
};

/* The pieces of one cell. */
struct cutting_pieces {
    int count, corners;
    int32_t node[CUTTING_MOST_PIECES][4];
};

/* Bisect an edge of all pieces that have it; false where they become too many. */
bool cutting_bisect(struct cutting_pieces *pieces, int32_t p, int32_t q, int32_t middle);

/* Collect the second cuts of the pieces, or make those that were found. All are in faces, at most one in each
 * face, so that neighbours agree. */
MUST_CHECK enum status cutting_again(struct cutting *cutting, struct cutting_pieces *pieces,
                                     struct error *error);

/* Locate the second cuts that were collected, and number them behind the other nodes. */
MUST_CHECK enum status cutting_seconds(struct cutting *cutting, struct error *error);
