#include "approx/labels/label_cells_private.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

/* A cut moves a point if it is nearer than this share of the edge's length. For edges along the axes and half
 * diagonals of cubes: Labelle and Shewchuk 2007, section 3, for the best bound of the angles. For diagonals
 * of sides, where leaves of two sizes meet, and for triangles: values between these. */
static const double near_axis = 0.24999, near_cube = 0.41189, near_side = 0.3, near_plane = 0.35;

/* Count the edges of cells between points of different labels; store them if the array exists. */
static int64_t collect(const struct lattice *lattice, int64_t *key)
{
    int corners = lattice->dim + 1;
    int64_t count = 0;
    for (int64_t c = 0; c < lattice->cell_count; c++) {
        const int32_t *node = lattice->cell + c * corners;
        for (int k = 0; k < corners; k++) {
            for (int l = k + 1; l < corners; l++) {
                int64_t a = node[k], b = node[l];
                if (lattice->label[a] == lattice->label[b]) {
                    continue;
                }
                if (key != NULL) {
                    key[count] = a < b ? a << 32 | b : b << 32 | a;
                }
                count++;
            }
        }
    }
    return count;
}

static enum status find_edges(struct lattice *lattice, struct error *error)
{
    int64_t count = collect(lattice, NULL);
    NEW_SCRATCH(int64_t, key, count, error);
    collect(lattice, key);
    lattice->edge_count = sort_distinct(count, key);
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->end, 2 * lattice->edge_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->cut, lattice->edge_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->on, lattice->node_count, error));
    for (int64_t e = 0; e < lattice->edge_count; e++) {
        lattice->end[2 * e] = (int32_t)(key[e] >> 32);
        lattice->end[2 * e + 1] = (int32_t)(key[e] & UINT32_MAX);
    }
    return lists_by_row(lattice->edge_count, 2, lattice->end, lattice->node_count, &lattice->edge_ptr,
                        &lattice->edge_idx, error);
}

int64_t lattice_edge(const struct lattice *lattice, int32_t p, int32_t q)
{
    for (int64_t i = lattice->edge_ptr[p]; i < lattice->edge_ptr[p + 1]; i++) {
        int64_t edge = lattice->edge_idx[i];
        if (lattice->cut[edge] > 0 && (lattice->end[2 * edge] == q || lattice->end[2 * edge + 1] == q)) {
            return edge;
        }
    }
    return -1;
}

/* Whether there is no interface between two labels: they are the same, or both are left out. */
static bool same_side(const struct lattice *lattice, int32_t a, int32_t b)
{
    return a == b || (!lattice->keep[a] && !lattice->keep[b]);
}

/* The function whose zero is the interface between two labels: the difference of their shares. Between the
 * body and its outside, it is the difference of the largest shares of labels of the body and of others, so
 * that a thin layer of a third label at the surface does not move the surface. */
static double difference(const struct lattice *lattice, const struct label_mix *mix, int32_t a, int32_t b)
{
    if (lattice->keep[a] != lattice->keep[b]) {
        a = label_largest(mix, lattice->keep, lattice->keep[a]);
        b = label_largest(mix, lattice->keep, lattice->keep[b]);
    }
    return label_share(mix, a) - label_share(mix, b);
}

/* The fraction of an edge at which this difference ceases to be positive (`strictly`), or becomes negative;
 * *after: its value there. */
static double change(const struct lattice *lattice, int64_t edge, bool strictly, double *after)
{
    const int32_t *end = lattice->end + 2 * edge;
    const double *p = lattice->x + (int64_t)end[0] * lattice->dim;
    const double *q = lattice->x + (int64_t)end[1] * lattice->dim;
    double low = 0, high = 1;
    *after = -1;
    for (int step = 0; step < 16; step++) {
        double t = (low + high) / 2, x[3];
        struct label_mix mix;
        vector_between(lattice->dim, p, q, t, x);
        labels_mix(lattice->labels, x, &mix);
        double value = difference(lattice, &mix, lattice->label[end[0]], lattice->label[end[1]]);
        if (strictly ? value > 0 : value >= 0) {
            low = t;
        } else {
            high = t;
            *after = value;
        }
    }
    return (low + high) / 2;
}

/* The fraction of an edge at which the interface lies. If a third label lies between the two, both shares are
 * 0 over an interval: its middle. */
static double cut_of(const struct lattice *lattice, int64_t edge)
{
    double after, first = change(lattice, edge, true, &after);
    return after < 0 ? first : (first + change(lattice, edge, false, &after)) / 2;
}

static double near_end(const struct lattice *lattice, int64_t edge)
{
    const int32_t *p = lattice->place + 3 * (int64_t)lattice->end[2 * edge];
    const int32_t *q = lattice->place + 3 * (int64_t)lattice->end[2 * edge + 1];
    int along = (p[0] != q[0]) + (p[1] != q[1]) + (p[2] != q[2]);
    return lattice->dim == 2 ? near_plane : along == 1 ? near_axis : along == 2 ? near_side : near_cube;
}

static double length_of(const struct lattice *lattice, int64_t edge)
{
    const int32_t *end = lattice->end + 2 * edge;
    return vector_distance(lattice->dim, lattice->x + (int64_t)end[1] * lattice->dim,
                           lattice->x + (int64_t)end[0] * lattice->dim);
}

/* A point was moved onto an interface: the edges that end there are no longer cut, except those to a third
 * label whose interface is far away. */
static void take_cuts(struct lattice *lattice, int64_t node, int32_t beyond)
{
    for (int64_t i = lattice->edge_ptr[node]; i < lattice->edge_ptr[node + 1]; i++) {
        int64_t edge = lattice->edge_idx[i];
        const int32_t *end = lattice->end + 2 * edge;
        int32_t label = lattice->label[end[0] == node ? end[1] : end[0]];
        double near = near_end(lattice, edge);
        if (lattice->cut[edge] > 0 && !same_side(lattice, label, beyond)) {
            double cut = cut_of(lattice, edge), t = end[0] == node ? cut : 1 - cut;
            t = t < near ? 0 : fmin(t, 1 - near);
            lattice->cut[edge] = t == 0 ? 0 : end[0] == node ? t : 1 - t;
        } else {
            lattice->cut[edge] = 0;
        }
    }
}

/* Move a point onto the nearest of the cuts that lie near it. */
static void snap(struct lattice *lattice, int64_t node)
{
    int dim = lattice->dim;
    int64_t best = -1;
    double least = INFINITY, fraction = 0;
    for (int64_t i = lattice->edge_ptr[node]; i < lattice->edge_ptr[node + 1]; i++) {
        int64_t edge = lattice->edge_idx[i];
        double cut = lattice->cut[edge], t = lattice->end[2 * edge] == node ? cut : 1 - cut;
        if (cut > 0 && t < near_end(lattice, edge) && t * length_of(lattice, edge) < least) {
            least = t * length_of(lattice, edge);
            fraction = t;
            best = edge;
        }
    }
    if (best < 0) {
        return;
    }
    const int32_t *end = lattice->end + 2 * best;
    const double *other = lattice->x + (int64_t)(end[0] == node ? end[1] : end[0]) * dim;
    lattice->on[node] = true;
    double *own = lattice->x + node * dim;
    vector_between(dim, own, other, fraction, own);
    take_cuts(lattice, node, lattice->label[end[0] == node ? end[1] : end[0]]);
}

enum status lattice_cut(struct lattice *lattice, struct error *error)
{
    RETURN_IF_ERROR(find_edges(lattice, error));
#pragma omp parallel for schedule(dynamic, 256)
    for (int64_t e = 0; e < lattice->edge_count; e++) {
        bool cut =
            !same_side(lattice, lattice->label[lattice->end[2 * e]], lattice->label[lattice->end[2 * e + 1]]);
        lattice->cut[e] = cut ? cut_of(lattice, e) : 0;
    }
    for (int64_t n = 0; n < lattice->node_count; n++) {
        snap(lattice, n);
    }
    return STATUS_OK;
}
