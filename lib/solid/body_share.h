/* What of a body this process computes, of several that compute it together (base/ranks.h): stretches of its
 * points and of its nodes, in the body's order, which is along a curve, so that they are compact. One process
 * computes all.
 *
 * An evaluation takes whole displacements, and computes the rows of the operator that own points or cells
 * look at, their stresses, and by the rows of the transposed operator the forces on own nodes, which are
 * gathered. In between a few rows at the borders are exchanged: those that own nodes are in and others have
 * computed. Of smoothed cells a row has forces from all cells around it; it is summed by the process of the
 * first of these. */
#ifndef SOLID_BODY_SHARE_H
#define SOLID_BODY_SHARE_H

#include "base/ranks.h"

struct body;
struct body_input;

struct body_share {
    const struct ranks *ranks; /* NULL: one process */
    int64_t *block_first;      /* of each process, as below: its blocks, */
    int64_t *point_first;      /* the points in them, */
    int64_t *node_first;       /* its nodes in the body's order, */
    int64_t *volume_first;     /* and its nodal volumes */
    int64_t begin_block, end_block, begin_point, end_point, begin_node, end_node; /* of this one */
    struct stretches values; /* rows of the operator that are computed here */
    struct stretches sums;   /* smoothed cells: rows whose forces are summed here */
    struct stretches nodes;  /* own nodes */
    struct halo strains;     /* of points: for nodal volumes */
    struct halo corners;     /* of smoothed cells: forces on rows that are summed here */
    struct halo rows;        /* forces on rows, for own nodes */
};

/* Share out the blocks of a body that are cut, and its nodes. */
MUST_CHECK enum status body_share_cut(const struct body_input *input, struct body *body, struct error *error);

/* Share out the nodal volumes, and list the strains that they need. */
MUST_CHECK enum status body_share_volumes(struct body *body, struct error *error);

/* The process whose node that is; `body` as ranks and halos want it. */
int body_share_owner(const void *body, int64_t node);

/* wanted[rows of the operator]: those that own points or cells look at. Corners of cells are known. */
MUST_CHECK enum status body_share_values(const struct body *body, bool **wanted, struct error *error);

/* The halos of rows, when operator and transpose are there; wanted[rows]: those that own nodes are in. */
MUST_CHECK enum status body_share_rows(struct body *body, const bool *wanted, struct error *error);

/* Is this node, the caller's number, of this process? */
bool body_share_has_node(const struct body *body, int64_t node);

void body_share_free(struct body_share *share);

/* To be called by all threads of a parallel region together: all have all items; and halos. */
void body_share_gather(const struct body_share *share, void *items, size_t size, const int64_t *first);
void body_share_exchange(const struct body_share *share, struct halo *halo, int width, double *x);

/* The state of all points at the last evaluation, here. */
void body_share_collect(struct body *body);

#endif
