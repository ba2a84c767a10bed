/* Places that are connected to a node, so that measured values do not act across gaps and slits.
 *
 * A place belongs to the node nearest to it. It is connected to another node when the straight segment
 * between the two nodes stays within the cells (see visibility.h), or when the shortest path along edges of
 * the cells is at most twice as long as that segment. So places around a mild fold of the boundary are
 * connected, the two faces of a slit are not. */
#pragma once

#include "approx/visibility/visibility.h"
#include "base/queue.h"

/* The longest path that connects two places, by their distance. */
#define PATH_MOST_DETOUR 2.0

enum path_verdict { PATH_UNKNOWN, PATH_GOOD, PATH_NONE };

struct edge_paths {
    struct visibility visibility; /* its cells only */
    struct visibility_work work;
    int64_t place_count;
    int32_t *node;    /* place_count: the node to which each place belongs; -1: no node is in a cell */
    uint8_t *verdict; /* place_count, enum path_verdict: whether each place is connected to `from` */
    int32_t from;     /* the node; -1: none yet */
    double searched;  /* shortest paths from it are known up to this length, m; negative: none */
    double *length;   /* node_count: their lengths; infinite: longer */
    struct queue queue;
};

/* place[place_count * stride], the first dim of each row, in units of `unit` m. The cells must outlive this.
 * Errors: STATUS_INPUT for cells that share a face with more than one other; STATUS_SYSTEM (memory). */
MUST_CHECK enum status edge_paths_build(const struct cells *cells, int64_t place_count, int64_t stride,
                                        const double *place, double unit, struct edge_paths *paths,
                                        struct error *error);
void edge_paths_free(struct edge_paths *paths);

/* Set the node `from`; the paths known so far are kept if it is the same as before. */
void edge_paths_begin(struct edge_paths *paths, int32_t from);

MUST_CHECK enum status edge_paths_reach(struct edge_paths *paths, int64_t place, bool *reached,
                                        struct error *error);
