/* Shortest paths around corners (Dijkstra), and their bends slid along re-entrant edges. */
#include "approx/reach_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bends of one path that are slid, and how often. */
enum { MOST_BENDS = 8, SWEEPS = 3 };
/* Paths over nodes may be so much longer than a radius, in 3D, before their bends are slid. */
static const double most_slack = 1.2;

enum status reach_work_reserve(const struct reach *reach, struct reach_work *work, struct error *error)
{
    enum status status = STATUS_OK;
    if (work->mark == NULL) {
        TRY(NEW_ARRAY(&work->mark, reach->cells.node_count, error));
        TRY(NEW_ARRAY(&work->length, reach->cells.node_count, error));
        TRY(NEW_ARRAY(&work->before, reach->cells.node_count, error));
        TRY(NEW_ARRAY(&work->near_begin, reach->cells.node_count, error));
        TRY(NEW_ARRAY(&work->near_end, reach->cells.node_count, error));
        TRY(NEW_ARRAY(&work->passes, reach->most_opposing, error));
    }
done:
    return status;
}

void reach_work_free(struct reach_work *work)
{
    free(work->own.index);
    free(work->mark);
    free(work->length);
    free(work->before);
    free(work->near_begin);
    free(work->near_end);
    free(work->near.index);
    free(work->passes);
    free(work->corners.index);
    free(work->stack.index);
    free(work->visited.index);
    free(work->image);
    *work = (struct reach_work){0};
}

static enum status add_corner(struct reach_work *work, int32_t node, struct error *error)
{
    enum status status = index_list_reserve(&work->corners, 1, error);
    if (status == STATUS_OK) {
        work->corners.index[work->corners.count++] = node;
    }
    return status;
}

/* Take out the corner of the shortest path; of equals the lowest. */
static int32_t take_nearest(struct reach_work *work)
{
    int32_t *corner = work->corners.index;
    int64_t nearest = 0;
    for (int64_t i = 1; i < work->corners.count; i++) {
        double difference = work->length[corner[i]] - work->length[corner[nearest]];
        nearest = difference < 0.0 || (difference == 0.0 && corner[i] < corner[nearest]) ? i : nearest;
    }
    int32_t taken = corner[nearest];
    corner[nearest] = corner[--work->corners.count];
    return taken;
}

enum status reach_paths(const struct reach *reach, double widen, const int32_t *index, int64_t count,
                        struct reach_work *work, struct error *error)
{
    enum status status = STATUS_OK;
    int dim = reach->cells.dim;
    const double *x = reach->cells.x;
    double limit = dim == 3 ? most_slack * widen : widen;
    work->corners.count = 0;
    for (int64_t i = 0; i < count; i++) {
        int32_t node = index[i];
        bool hidden = reach_is_hidden(work, node);
        work->length[node] = hidden ? INFINITY : reach_distance(dim, work->x, x + (int64_t)node * dim);
        work->before[node] = -1;
        if (!hidden && reach->corner[node] &&
            work->length[node] > REACH_ON_PLANE * reach->grid->radius[node]) {
            TRY(add_corner(work, node, error));
        }
    }
    while (work->corners.count > 0) {
        int32_t corner = take_nearest(work);
        for (int64_t i = reach->view_ptr[corner]; i < reach->view_ptr[corner + 1]; i++) {
            int32_t node = reach->view[i];
            if (!reach_is_hidden(work, node)) {
                continue;
            }
            double length = work->length[corner] +
                            reach_distance(dim, x + (int64_t)corner * dim, x + (int64_t)node * dim);
            if (length < work->length[node] && length < limit * reach->grid->radius[node]) {
                if (reach->corner[node] && !(work->length[node] < INFINITY)) {
                    TRY(add_corner(work, node, error));
                }
                work->length[node] = length;
                work->before[node] = corner;
            }
        }
    }
done:
    return status;
}

/* The point of the edge from a to b over which the way from p to q is shortest: at a if one of them is in
 * line with the edge. */
static void shortest_over_edge(const double *a, const double *b, const double *p, const double *q, double *at)
{
    double u[3], length2 = 0.0, along[2] = {0.0, 0.0}, off[2] = {0.0, 0.0};
    const double *const end[2] = {p, q};
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        length2 += u[i] * u[i];
    }
    for (int e = 0; e < 2; e++) {
        for (int i = 0; i < 3; i++) {
            along[e] += (end[e][i] - a[i]) * u[i] / length2;
        }
        for (int i = 0; i < 3; i++) {
            double d = end[e][i] - a[i] - along[e] * u[i];
            off[e] += d * d;
        }
        off[e] = sqrt(off[e]);
    }
    double sum = off[0] + off[1], least = 1e-9 * sqrt(length2);
    double t = off[0] > least && off[1] > least ? (along[0] * off[1] + along[1] * off[0]) / sum : 0.0;
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    for (int i = 0; i < 3; i++) {
        at[i] = a[i] + t * u[i];
    }
}

/* Slide a bend at a node along the re-entrant edge there that makes the way between its neighbours shortest.
 */
static void slide(const struct reach *reach, const double *before, const double *after, int32_t node,
                  double *bend)
{
    const double *corner = reach->cells.x + (int64_t)node * 3;
    double least = reach_distance(3, before, corner) + reach_distance(3, corner, after);
    memcpy(bend, corner, 3 * sizeof *bend);
    for (int64_t e = reach->edge_ptr[node]; e < reach->edge_ptr[node + 1]; e++) {
        double at[3];
        shortest_over_edge(corner, reach->cells.x + (int64_t)reach->edge[e] * 3, before, after, at);
        double length = reach_distance(3, before, at) + reach_distance(3, at, after);
        if (length < least) {
            least = length;
            memcpy(bend, at, sizeof at);
        }
    }
}

void reach_first_bend(const struct reach *reach, int32_t node, const struct reach_work *work, double *bend,
                      double *length)
{
    int dim = reach->cells.dim, bends = 0;
    int32_t first = work->before[node], at[MOST_BENDS];
    double place[MOST_BENDS + 1][3];
    for (int32_t n = work->before[node]; n >= 0; n = work->before[n], bends++) {
        first = n;
    }
    memcpy(bend, reach->cells.x + (int64_t)first * dim, (size_t)dim * sizeof *bend);
    *length = work->length[node];
    if (dim == 2 || bends > MOST_BENDS) {
        return;
    }
    memcpy(place[bends], reach->cells.x + (int64_t)node * 3, sizeof *place);
    int32_t n = work->before[node];
    for (int b = bends - 1; b >= 0; b--, n = work->before[n]) {
        at[b] = n;
        memcpy(place[b], reach->cells.x + (int64_t)n * 3, sizeof *place);
    }
    for (int sweep = 0; sweep < (bends == 1 ? 1 : SWEEPS); sweep++) {
        for (int b = 0; b < bends; b++) {
            slide(reach, b == 0 ? work->x : place[b - 1], place[b + 1], at[b], place[b]);
        }
    }
    memcpy(bend, place[0], sizeof *place);
    *length = reach_distance(3, work->x, place[0]);
    for (int b = 0; b < bends; b++) {
        *length += reach_distance(3, place[b], place[b + 1]);
    }
}
