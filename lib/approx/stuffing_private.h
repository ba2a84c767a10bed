/* The steps of stuffing_make, private to lib/approx. */
#ifndef APPROX_STUFFING_PRIVATE_H
#define APPROX_STUFFING_PRIVATE_H

#include "approx/stuffing.h"

/* Points of a lattice, its edges and where they are cut.
 * 3D: corners of cubes, (i, j, k) first index fastest, then their centres in the same order. 2D: rows of
 * points, odd ones shifted by half a spacing. */
struct lattice {
    const struct labels *labels;
    int dim;
    double spacing, low[3];
    int64_t count[3]; /* points along each axis */
    int64_t corners, points;
    double *x;       /* points * dim, m; after lattice_snap some are moved onto interfaces */
    uint16_t *label; /* points */
    bool *on;        /* points: moved onto an interface */
    int64_t edges;
    double *cut;       /* edges: where it is cut, as a fraction from its first end; 0: it is not */
    int32_t *cut_node; /* edges: number of the cut's node, counted from `points`; -1: none */
    int64_t cuts;
};

/* Lay the lattice over the labels, find the label of each point and where edges are cut. */
MUST_CHECK enum status lattice_make(const struct labels *labels, double spacing, struct lattice *lattice,
                                    struct error *error);
void lattice_free(struct lattice *lattice);

/* Move points onto cuts that lie near them, and number the cuts that are left. */
void lattice_snap(struct lattice *lattice);

/* Index of a point on the lattice: i, j, k, and whether it is the centre of a cube. */
struct lattice_index {
    int64_t at[3];
    bool centre;
};
struct lattice_index lattice_index(const struct lattice *lattice, int64_t point);
int64_t lattice_point(const struct lattice *lattice, const struct lattice_index *index);

/* The edge between two neighbours; *first receives the end that its fraction counts from, *order the place of
 * its cut among those of a cell: lower ones bisect first. */
int64_t lattice_edge(const struct lattice *lattice, int64_t p, int64_t q, int64_t *first, int *order);

/* Cut the lattice's cells into cells of one label each; label 0 is left out. */
MUST_CHECK enum status lattice_cells(const struct lattice *lattice, struct stuffing *stuffing,
                                     struct error *error);

/* Keep the cells of labels that are wanted, without those that hang on the rest by a node or an edge only,
 * and find the boundary. */
MUST_CHECK enum status stuffing_keep(const struct stuffing_options *options, struct stuffing *stuffing,
                                     struct error *error);

/* Cells at each node and the labels that meet there. */
enum { STUFFING_MOST_LABELS = 4 };
struct stuffing_star {
    int64_t *ptr;  /* node_count + 1 */
    int32_t *cell; /* ptr[node_count] */
    uint16_t (*label)[STUFFING_MOST_LABELS];
    uint8_t *labels; /* node_count: labels that meet; 1: not on an interface */
};
MUST_CHECK enum status star_make(const struct stuffing *stuffing, struct stuffing_star *star,
                                 struct error *error);
void star_free(struct stuffing_star *star);

/* The poorest score of the cells at a node: the score of a cell is 1 where its angles just keep within the
 * bounds. */
double star_score(const struct stuffing *stuffing, const struct stuffing_star *star, int64_t node);
double stuffing_score(const struct stuffing *stuffing, int64_t cell);

/* Move x onto the interface of the labels, at most four; false where there is none near. */
bool interface_project(const struct labels *labels, int count, const uint16_t label[], double x[]);

/* Improve the cells by moving nodes. */
MUST_CHECK enum status stuffing_improve(const struct labels *labels, const struct stuffing_options *options,
                                        struct stuffing *stuffing, struct error *error);

#endif
