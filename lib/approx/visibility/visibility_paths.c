/* Shortest paths around corners, with bends that slide along re-entrant edges. */
#include "approx/visibility/visibility_private.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Most bends of one path that slide along their re-entrant edges, and number of sweeps over them. */
enum { MOST_BENDS = 8, SWEEPS = 3 };
/* In 3D paths over nodes may be longer than a radius by this factor, before their bends slide. */
static const double most_slack = 1.2;

enum status visibility_work_reserve(const struct visibility *visibility, struct visibility_work *work,
                                    struct error *error)
{
    if (work->mark == NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&work->mark, visibility->cells.node_count, error));
        RETURN_IF_ERROR(NEW_ARRAY(&work->length, visibility->cells.node_count, error));
        RETURN_IF_ERROR(NEW_ARRAY(&work->before, visibility->cells.node_count, error));
        for (int64_t n = 0; n < visibility->cells.node_count; n++) {
            work->length[n] = INFINITY;
        }
    }
    return STATUS_OK;
}

void visibility_work_free(struct visibility_work *work)
{
    FREE_ALL(work->own.index, work->mark, work->length, work->before, work->hidden.index, work->reached.index,
             work->stack.index, work->visited.index, work->image);
    *work = (struct visibility_work){0};
}

/* Shorten the path to a hidden node by way of the corners from which it is visible, if their path lengths are
 * known. */
static bool shorten(const struct visibility *visibility, int32_t node, double limit,
                    struct visibility_work *work)
{
    double least = fmin(work->length[node], limit);
    bool shorter = false;
    for (int64_t i = visibility->seen_ptr[node]; i < visibility->seen_ptr[node + 1]; i++) {
        double length = work->length[visibility->seen[i]] + visibility->seen_length[i];
        if (length < least) {
            least = work->length[node] = length;
            work->before[node] = visibility->seen[i];
            shorter = true;
        }
    }
    return shorter;
}

enum status visibility_paths(const struct visibility *visibility, double widen, const int32_t *index,
                             int64_t count, struct visibility_work *work, struct error *error)
{
    int dim = visibility->cells.dim;
    double limit = dim == 3 ? most_slack * widen : widen;
    for (int64_t i = 0; i < work->reached.count; i++) {
        work->length[work->reached.index[i]] = INFINITY;
    }
    work->hidden.count = work->reached.count = 0;
    RETURN_IF_ERROR(index_list_reserve(&work->hidden, count, error));
    RETURN_IF_ERROR(index_list_reserve(&work->reached, count, error));
    for (int64_t i = 0; i < count; i++) {
        int32_t node = index[i];
        if (visibility_is_hidden(work, node)) {
            work->hidden.index[work->hidden.count++] = node;
            work->length[node] = INFINITY;
        } else if (visibility->corner[node]) {
            double length = vector_distance(dim, work->from, visibility->cells.x + (int64_t)node * dim);
            /* A path continues from a corner only to nodes visible from it. */
            work->length[node] =
                length > COARSE_ROUND_OFF * visibility->grid->radius[node] ? length : INFINITY;
        } else {
            continue;
        }
        work->before[node] = -1;
        work->reached.index[work->reached.count++] = node;
    }
    /* Each pass completes paths with at least one bend more. */
    for (bool shorter = true; shorter;) {
        shorter = false;
        for (int64_t i = 0; i < work->hidden.count; i++) {
            int32_t node = work->hidden.index[i];
            bool now = shorten(visibility, node, limit * visibility->grid->radius[node], work);
            shorter = shorter || (now && visibility->corner[node]);
        }
    }
    return STATUS_OK;
}

/* The length of the shortest path from p to q across the edge from a to b, by unrolling it into a plane.
 * *passes: where it crosses the edge, 0 to 1; 0 if p or q is on the line of the edge. */
static double shortest_over_edge(const double *a, const double *b, const double *p, const double *q,
                                 double *passes)
{
    double length2 = 0.0, pu = 0.0, qu = 0.0, pp = 0.0, qq = 0.0;
    for (int i = 0; i < 3; i++) {
        double u = b[i] - a[i], from_p = p[i] - a[i], from_q = q[i] - a[i];
        length2 += u * u;
        pu += from_p * u;
        qu += from_q * u;
        pp += from_p * from_p;
        qq += from_q * from_q;
    }
    /* Squared distances from the line, and places along it in lengths of the edge. */
    double off_p2 = pp - pu * pu / length2, off_q2 = qq - qu * qu / length2, least = 1e-12 * length2;
    double along_p = pu / length2, along_q = qu / length2, t = 0.0;
    *passes = 0.0;
    if (along_p <= 0.0 && along_q <= 0.0) {
        return INFINITY;
    }
    double off_p = sqrt(fmax(off_p2, 0.0)), off_q = sqrt(fmax(off_q2, 0.0));
    if (off_p2 > least && off_q2 > least) {
        t = (along_p * off_q + along_q * off_p) / (off_p + off_q);
        t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    }
    *passes = t;
    if (!(t > 0.0)) {
        return INFINITY;
    }
    return sqrt(off_p * off_p + (along_p - t) * (along_p - t) * length2) +
           sqrt(off_q * off_q + (along_q - t) * (along_q - t) * length2);
}

/* Slide a bend at a node along the re-entrant edge at the node that makes the path between its neighbours
 * shortest. */
static void slide(const struct visibility *visibility, const double *before, const double *after,
                  int32_t node, double *bend)
{
    const double *corner = visibility->cells.x + (int64_t)node * 3;
    double least = vector_distance(3, before, corner) + vector_distance(3, corner, after);
    memcpy(bend, corner, 3 * sizeof *bend);
    for (int64_t e = visibility->edge_ptr[node]; e < visibility->edge_ptr[node + 1]; e++) {
        double passes;
        const double *other = visibility->cells.x + (int64_t)visibility->edge[e] * 3;
        double length = shortest_over_edge(corner, other, before, after, &passes);
        if (length < least && passes > 0.0) {
            least = length;
            vector_between(3, corner, other, passes, bend);
        }
    }
}

void visibility_first_bend(const struct visibility *visibility, int32_t node,
                           const struct visibility_work *work, double *bend, double *length)
{
    int dim = visibility->cells.dim, bends = 0;
    int32_t first = work->before[node], at[MOST_BENDS];
    double place[MOST_BENDS + 1][3];
    for (int32_t n = work->before[node]; n >= 0; n = work->before[n], bends++) {
        first = n;
    }
    memcpy(bend, visibility->cells.x + (int64_t)first * dim, (size_t)dim * sizeof *bend);
    *length = work->length[node];
    if (dim == 2 || bends > MOST_BENDS) {
        return;
    }
    memcpy(place[bends], visibility->cells.x + (int64_t)node * 3, sizeof *place);
    int32_t n = work->before[node];
    for (int b = bends - 1; b >= 0; b--, n = work->before[n]) {
        at[b] = n;
        memcpy(place[b], visibility->cells.x + (int64_t)n * 3, sizeof *place);
    }
    for (int sweep = 0; sweep < (bends == 1 ? 1 : SWEEPS); sweep++) {
        for (int b = 0; b < bends; b++) {
            slide(visibility, b == 0 ? work->from : place[b - 1], place[b + 1], at[b], place[b]);
        }
    }
    memcpy(bend, place[0], sizeof *place);
    *length = vector_distance(3, work->from, place[0]);
    for (int b = 0; b < bends; b++) {
        *length += vector_distance(3, place[b], place[b + 1]);
    }
}
