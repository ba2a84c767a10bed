/* Which places are within reach of a node, so that measured values do not act across gaps and slits.
 *
 * A place belongs to the node nearest to it. It is within reach of another node when the straight segment
 * between the two nodes stays within the cells (see reach.h), or when a way along edges of the cells is at
 * most twice as long as that segment: around mild folds of the boundary, but not from one lip of a slit to
 * the other. */
#pragma once

#include "approx/reach.h"
#include "base/queue.h"

enum way_verdict { WAY_UNKNOWN, WAY_GOOD, WAY_NONE };

struct ways {
    struct reach reach; /* its cells only */
    struct reach_work work;
    int64_t place_count;
    int32_t *node;    /* place_count: to which each place belongs; -1 where no node is in a cell */
    uint8_t *verdict; /* place_count, of enum way_verdict: on the ways from `from` */
    int32_t from;     /* -1: none yet */
    double searched;  /* ways from there are known up to this length, m; negative: none */
    double *length;   /* node_count: their lengths, infinite beyond */
    struct queue queue;
};

/* place[place_count * stride], the first dim of each row, in units of `unit` m. The cells must outlive this.
 * Errors: STATUS_INPUT for cells that share a face with more than one other; STATUS_SYSTEM (memory). */
MUST_CHECK enum status ways_build(const struct cells *cells, int64_t place_count, int64_t stride,
                                  const double *place, double unit, struct ways *ways, struct error *error);
void ways_free(struct ways *ways);

/* Ask about another node; the same as before: nothing is forgotten. */
void ways_begin(struct ways *ways, int32_t from);

MUST_CHECK enum status ways_reach(struct ways *ways, int64_t place, bool *reached, struct error *error);
