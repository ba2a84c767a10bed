/* The part of a body that this process computes, where several compute it together (base/ranks.h): intervals
 * of its points and of its nodes in the body's order. This order follows a Morton curve, so that the parts
 * are compact. A single process computes all.
 *
 * An evaluation takes the displacements of all nodes. It computes the rows of the operator that own points or
 * cells need, the stresses there, and, with the rows of the transposed operator, the forces on own nodes.
 * In between, processes exchange rows at their borders: those with own nodes in them that others have
 * computed. With smoothed cells a row has forces from all cells around it; the process of the first of these
 * cells sums them. */
#pragma once

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
    struct row_ranges values; /* rows of the operator that are computed here, */
    struct row_ranges placed; /* and the nodes in them, in the body's order */
    struct row_ranges sums;   /* smoothed cells: rows whose forces are summed here */
    struct halo strains;      /* of points: for nodal volumes */
    struct halo pressures;    /* of nodal volumes: those beside own ones, and at own points */
    struct halo parts;        /* of smoothed cells: parts of the forces on rows that are summed here */
    struct halo rows;         /* forces on rows, for own nodes */
};

/* Distribute the blocks of a body, which are known, and its nodes over the processes. */
MUST_CHECK enum status body_share_cut(const struct body_input *input, struct body *body, struct error *error);

/* Distribute the nodal volumes, and list the strains that they need. body_share_pressures, once A is known,
 * lists what the pressures need.
 */
MUST_CHECK enum status body_share_volumes(struct body *body, struct error *error);
MUST_CHECK enum status body_share_pressures(struct body *body, struct error *error);

/* wanted[rows of the operator]: those that own points or cells need. Needs of_use of smoothed cells. */
MUST_CHECK enum status body_share_values(const struct body *body, bool **wanted, struct error *error);

/* The halos of rows, when operator and transpose are there; wanted[rows]: those that own nodes are in. */
MUST_CHECK enum status body_share_rows(struct body *body, const bool *wanted, struct error *error);

/* The process that sums the forces on a row of smoothed cells. */
int body_share_owner(const struct body *body, int64_t row);

/* The nodes whose displacements own rows need, once row_operator_finish has been called. */
MUST_CHECK enum status body_share_nodes(struct body *body, struct error *error);

void body_share_free(struct body_share *share);

/* ranks_gather and halo_exchange inside a parallel region, to be called by all its threads. */
void body_share_gather(const struct body_share *share, void *items, size_t size, const int64_t *first);
void body_share_exchange(const struct body_share *share, struct halo *halo, int width, double *x);

/* Collect the nodal pressures of all processes at the last evaluation; and the state of all points. */
void body_share_collect_pressures(struct body *body);
void body_share_collect(struct body *body);
