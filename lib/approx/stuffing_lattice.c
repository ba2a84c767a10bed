#include "approx/stuffing_private.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Edges that a point owns: 3D: along the axes, and of corners those to the centres of eight cubes. */
enum { OWN_AXES = 3, OWN_CORNER = 11, NEIGHBOURS_MOST = 14 };
/* A cut within so much of an edge's length moves the point: Labelle and Shewchuk 2007, section 3. */
static const double near_long = 0.24999, near_short = 0.41189;
static const double near_plane = 0.35;
static const int64_t most_points = (int64_t)1 << 28;

struct lattice_index lattice_index(const struct lattice *lattice, int64_t point)
{
    struct lattice_index index = {.centre = point >= lattice->corners};
    point -= index.centre ? lattice->corners : 0;
    index.at[0] = point % lattice->count[0];
    index.at[1] = point / lattice->count[0] % lattice->count[1];
    index.at[2] = point / lattice->count[0] / lattice->count[1];
    return index;
}

int64_t lattice_point(const struct lattice *lattice, const struct lattice_index *index)
{
    return (index->at[2] * lattice->count[1] + index->at[1]) * lattice->count[0] + index->at[0] +
           (index->centre ? lattice->corners : 0);
}

int64_t lattice_edge(const struct lattice *lattice, int64_t p, int64_t q, int64_t *first, int *order)
{
    struct lattice_index a = lattice_index(lattice, p), b = lattice_index(lattice, q);
    if (lattice->dim == 2) {
        int64_t low = p < q ? p : q;
        const struct lattice_index *lower = p < q ? &a : &b, *upper = p < q ? &b : &a;
        *first = low;
        *order = 0;
        if (a.at[1] == b.at[1]) {
            return OWN_AXES * low;
        }
        bool right = upper->at[0] == lower->at[0] + (lower->at[1] & 1);
        return OWN_AXES * low + (right ? 1 : 2);
    }
    if (a.centre == b.centre) {
        int64_t low = p < q ? p : q;
        int axis = a.at[0] != b.at[0] ? 0 : a.at[1] != b.at[1] ? 1 : 2;
        *first = low;
        *order = 0;
        return (a.centre ? lattice->corners * OWN_CORNER + (low - lattice->corners) * OWN_AXES
                         : low * OWN_CORNER) +
               axis;
    }
    const struct lattice_index *corner = a.centre ? &b : &a, *centre = a.centre ? &a : &b;
    int64_t octant = 0, sum = 0;
    for (int d = 0; d < 3; d++) {
        octant += (centre->at[d] - corner->at[d] + 1) << d;
        sum += centre->at[d] + corner->at[d];
    }
    *first = a.centre ? q : p;
    *order = 1 + (int)(sum & 1);
    return *first * OWN_CORNER + OWN_AXES + octant;
}

/* Neighbours of a point within the lattice. */
static int neighbours(const struct lattice *lattice, int64_t p, int64_t neighbour[NEIGHBOURS_MOST])
{
    struct lattice_index index = lattice_index(lattice, p);
    int count = 0;
    for (int n = 0; n < (lattice->dim == 2 ? 6 : NEIGHBOURS_MOST); n++) {
        struct lattice_index next = index;
        bool within = true;
        if (lattice->dim == 2) {
            int64_t shift = index.at[1] & 1;
            next.at[0] += n < 2 ? 2 * n - 1 : n % 2 - 1 + shift;
            next.at[1] += n < 2 ? 0 : n < 4 ? 1 : -1;
        } else if (n < 6) {
            next.at[n / 2] += n % 2 ? 1 : -1;
        } else {
            next.centre = !index.centre;
            for (int d = 0; d < 3; d++) {
                next.at[d] += (n - 6) >> d & 1 ? (index.centre ? 1 : -1) : 0;
            }
        }
        for (int d = 0; d < lattice->dim; d++) {
            within = within && next.at[d] >= 0 && next.at[d] < lattice->count[d];
        }
        if (within) {
            neighbour[count++] = lattice_point(lattice, &next);
        }
    }
    return count;
}

/* ---- the points ---- */

static enum status size_lattice(struct lattice *lattice, struct error *error)
{
    int dim = lattice->dim;
    double high[3], points = dim == 3 ? 2 : 1;
    labels_box(lattice->labels, lattice->low, high);
    if (!(lattice->low[0] <= high[0])) {
        return fail(error, STATUS_INPUT, "no voxel has a label: all is outside");
    }
    for (int d = 0; d < 3; d++) {
        lattice->count[d] = 1;
    }
    for (int d = 0; d < dim; d++) {
        double step = dim == 2 && d == 1 ? lattice->spacing * sqrt(0.75) : lattice->spacing;
        /* The lattice stands fast in the world: two points along each axis beyond the labels and their
         * smoothing. */
        double first = floor(lattice->low[d] / step) - 2, last = ceil(high[d] / step) + 3;
        if (dim == 2 && d == 1 && fmod(first, 2) != 0) {
            first -= 1;
        }
        points *= last - first + 1;
        if (!(points < (double)most_points)) {
            return fail(
                error, STATUS_INPUT,
                "spacing %g m: more than %lld lattice points over the labels: larger, or another unit?",
                lattice->spacing, (long long)most_points);
        }
        lattice->low[d] = first * step;
        lattice->count[d] = (int64_t)(last - first) + 1;
    }
    lattice->corners = lattice->count[0] * lattice->count[1] * lattice->count[2];
    lattice->points = dim == 3 ? 2 * lattice->corners : lattice->corners;
    lattice->edges = lattice->corners * (dim == 3 ? OWN_CORNER + OWN_AXES : OWN_AXES);
    return STATUS_OK;
}

static void set_points(struct lattice *lattice)
{
    int dim = lattice->dim;
#pragma omp parallel for schedule(static)
    for (int64_t p = 0; p < lattice->points; p++) {
        struct lattice_index index = lattice_index(lattice, p);
        double *x = lattice->x + p * dim;
        for (int d = 0; d < dim; d++) {
            double step = dim == 2 && d == 1 ? lattice->spacing * sqrt(0.75) : lattice->spacing;
            double shift = index.centre || (dim == 2 && d == 0 && (index.at[1] & 1)) ? 0.5 : 0;
            x[d] = lattice->low[d] + step * ((double)index.at[d] + shift);
        }
        lattice->label[p] = (uint16_t)labels_at(lattice->labels, x);
    }
}

/* ---- the cuts ---- */

/* The fraction, from p to q, at which `sign` times (the share of p's label less that of q's) ceases to be
 * positive on the way from `from` to the other end. */
static double change(const struct lattice *lattice, const double *p, const double *q, int32_t a, int32_t b,
                     bool from_p)
{
    double low = 0, high = 1;
    for (int step = 0; step < 16; step++) {
        double t = (low + high) / 2, x[3];
        struct label_mix mix;
        for (int d = 0; d < lattice->dim; d++) {
            x[d] = p[d] + t * (q[d] - p[d]);
        }
        labels_mix(lattice->labels, x, &mix);
        double difference = label_share(&mix, a) - label_share(&mix, b);
        if (from_p ? difference > 0 : difference >= 0) {
            low = t;
        } else {
            high = t;
        }
    }
    return (low + high) / 2;
}

/* Where a third label lies between the two, their shares are equal, 0, over a stretch: its middle. */
static void set_cuts(struct lattice *lattice)
{
    int dim = lattice->dim;
#pragma omp parallel for schedule(dynamic, 256)
    for (int64_t p = 0; p < lattice->points; p++) {
        int64_t neighbour[NEIGHBOURS_MOST];
        int count = neighbours(lattice, p, neighbour);
        for (int n = 0; n < count; n++) {
            int64_t q = neighbour[n], first;
            int32_t a = lattice->label[p], b = lattice->label[q];
            int order;
            if (a == b) {
                continue;
            }
            int64_t edge = lattice_edge(lattice, p, q, &first, &order);
            if (first == p) {
                const double *from = lattice->x + p * dim, *to = lattice->x + q * dim;
                lattice->cut[edge] =
                    (change(lattice, from, to, a, b, true) + change(lattice, from, to, a, b, false)) / 2;
            }
        }
    }
}

enum status lattice_make(const struct labels *labels, double spacing, struct lattice *lattice,
                         struct error *error)
{
    enum status status;
    *lattice = (struct lattice){.labels = labels, .dim = labels->dim, .spacing = spacing};
    TRY(size_lattice(lattice, error));
    TRY(NEW_ARRAY(&lattice->x, lattice->points * lattice->dim, error));
    TRY(NEW_ARRAY(&lattice->label, lattice->points, error));
    TRY(NEW_ARRAY(&lattice->on, lattice->points, error));
    TRY(NEW_ARRAY(&lattice->cut, lattice->edges, error));
    TRY(NEW_ARRAY(&lattice->cut_node, lattice->edges, error));
    set_points(lattice);
    set_cuts(lattice);
done:
    if (status != STATUS_OK) {
        lattice_free(lattice);
    }
    return status;
}

void lattice_free(struct lattice *lattice)
{
    free(lattice->x);
    free(lattice->label);
    free(lattice->on);
    free(lattice->cut);
    free(lattice->cut_node);
    *lattice = (struct lattice){0};
}

/* Move a point onto the nearest of the cuts that lie near it; the edges there are cut no more. */
static void snap(struct lattice *lattice, int64_t p)
{
    int dim = lattice->dim;
    int64_t neighbour[NEIGHBOURS_MOST], edges[NEIGHBOURS_MOST], first;
    int count = neighbours(lattice, p, neighbour), order, best = -1;
    double least = INFINITY, fraction = 0;
    for (int n = 0; n < count; n++) {
        edges[n] = lattice_edge(lattice, p, neighbour[n], &first, &order);
        double cut = lattice->cut[edges[n]];
        double near = dim == 2 ? near_plane : order == 0 ? near_long : near_short;
        double length = dim == 3 && order > 0 ? sqrt(0.75) : 1;
        double t = first == p ? cut : 1 - cut;
        if (cut > 0 && t < near && t * length < least) {
            least = t * length;
            fraction = t;
            best = n;
        }
    }
    if (best >= 0) {
        lattice->on[p] = true;
        for (int d = 0; d < dim; d++) {
            double *x = &lattice->x[p * dim + d];
            *x += fraction * (lattice->x[neighbour[best] * dim + d] - *x);
        }
        for (int n = 0; n < count; n++) {
            lattice->cut[edges[n]] = 0;
        }
    }
}

void lattice_snap(struct lattice *lattice)
{
    for (int64_t p = 0; p < lattice->points; p++) {
        snap(lattice, p);
    }
    for (int64_t e = 0; e < lattice->edges; e++) {
        lattice->cut_node[e] = lattice->cut[e] > 0 ? (int32_t)lattice->cuts++ : -1;
    }
}
