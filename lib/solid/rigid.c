/* Building rigid surfaces: vertices, normals, rims and bins; see rigid.h. */
#include "solid/rigid.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Corners closer than this, relative to the extent, are one vertex. */
static const double merge_tolerance = 1e-9;

/* Triangles whose area is less than this part of their longest edge squared have no normal. */
static const double least_slenderness = 1e-12;

/* At a smooth vertex every facet's normal makes at least this product with the mean: its facets turn by less
 * than 45 degrees there (a little less, so that round-off does not decide on chamfers). */
static const double smooth_cosine = 0.9239;

static enum status measure(struct rigid_surface *surface, const double *corners, double *low, double *high,
                           struct error *error)
{
    int dim = surface->dim;
    double sum = 0.0;
    for (int a = 0; a < dim; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (int64_t c = 0; c < surface->facet_count * dim; c++) {
            if (!isfinite(corners[c * dim + a])) {
                return fail(error, STATUS_INPUT, "rigid surface: facet %lld: coordinate is not finite",
                            (long long)(c / dim + 1));
            }
            low[a] = fmin(low[a], corners[c * dim + a]);
            high[a] = fmax(high[a], corners[c * dim + a]);
        }
        sum += (high[a] - low[a]) * (high[a] - low[a]);
    }
    surface->extent = sqrt(sum);
    return STATUS_OK;
}

/* A corner by its place along a direction in which few distinct corners coincide. */
struct placed_corner {
    double place;
    int64_t corner;
};

static int compare_placed(const void *left, const void *right)
{
    const struct placed_corner *a = left, *b = right;
    if (a->place != b->place) {
        return a->place < b->place ? -1 : 1;
    }
    return (a->corner > b->corner) - (a->corner < b->corner);
}

static double distance2(int dim, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < dim; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sum;
}

/* same[corner]: the first corner, along the direction, of those that coincide with it. */
static enum status find_coincident(const struct rigid_surface *surface, const double *corners, int64_t *same,
                                   struct error *error)
{
    enum status status;
    static const double direction[3] = {0.5377, 0.6180, 0.5734};
    int dim = surface->dim;
    int64_t count = surface->facet_count * dim;
    double near = merge_tolerance * surface->extent;
    struct placed_corner *placed = NULL;
    TRY(NEW_ARRAY(&placed, count, error));
    for (int64_t c = 0; c < count; c++) {
        placed[c].corner = c;
        for (int a = 0; a < dim; a++) {
            placed[c].place += direction[a] * corners[c * dim + a];
        }
    }
    qsort(placed, (size_t)count, sizeof *placed, compare_placed);
    for (int64_t i = 0; i < count; i++) {
        int64_t c = placed[i].corner;
        same[c] = c;
        for (int64_t k = i - 1; k >= 0 && placed[i].place - placed[k].place <= near; k--) {
            int64_t other = same[placed[k].corner];
            if (distance2(dim, corners + c * dim, corners + other * dim) <= near * near) {
                same[c] = other;
                break;
            }
        }
    }
done:
    free(placed);
    return status;
}

/* Vertices in the order of their first corner, and the facets' indices into them. */
static enum status number_vertices(struct rigid_surface *surface, const double *corners, struct error *error)
{
    enum status status;
    int dim = surface->dim;
    int64_t count = surface->facet_count * dim;
    int64_t *same = NULL;
    int32_t *number = NULL; /* of the vertex of each first corner, + 1 */
    TRY(NEW_ARRAY(&same, count, error));
    TRY(NEW_ARRAY(&number, count, error));
    TRY(NEW_ARRAY(&surface->vertex, count * dim, error));
    TRY(NEW_ARRAY(&surface->facet, count, error));
    TRY(find_coincident(surface, corners, same, error));
    for (int64_t c = 0; c < count; c++) {
        if (number[same[c]] == 0) {
            memcpy(surface->vertex + surface->vertex_count * dim, corners + c * dim,
                   (size_t)dim * sizeof *corners);
            number[same[c]] = (int32_t)++surface->vertex_count;
        }
        surface->facet[c] = number[same[c]] - 1;
    }
done:
    free(same);
    free(number);
    return status;
}

/* Make v unit; a zero vector stays zero. */
static void normalise(int dim, double *v)
{
    double sum = 0.0;
    for (int a = 0; a < dim; a++) {
        sum += v[a] * v[a];
    }
    for (int a = 0; a < dim && sum > 0.0; a++) {
        v[a] /= sqrt(sum);
    }
}

static void add_scaled(int dim, double factor, const double *v, double *sum)
{
    for (int a = 0; a < dim; a++) {
        sum[a] += factor * v[a];
    }
}

/* Normal, not unit, of facet f; *size2 is the square of its longest edge. */
static void facet_normal(const struct rigid_surface *surface, int64_t f, double *normal, double *size2)
{
    int dim = surface->dim;
    const int32_t *corner = surface->facet + f * dim;
    const double *x0 = surface->vertex + (int64_t)corner[0] * dim;
    const double *x1 = surface->vertex + (int64_t)corner[1] * dim;
    *size2 = distance2(dim, x0, x1);
    if (dim == 2) {
        normal[0] = x1[1] - x0[1];
        normal[1] = x0[0] - x1[0];
    } else {
        const double *x2 = surface->vertex + (int64_t)corner[2] * dim;
        *size2 = fmax(*size2, fmax(distance2(3, x0, x2), distance2(3, x1, x2)));
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            normal[a] = (x1[b] - x0[b]) * (x2[c] - x0[c]) - (x1[c] - x0[c]) * (x2[b] - x0[b]);
        }
    }
}

static enum status make_normals(struct rigid_surface *surface, bool flip, struct error *error)
{
    enum status status;
    int dim = surface->dim;
    TRY(NEW_ARRAY(&surface->normal, surface->facet_count * dim, error));
    for (int64_t f = 0; f < surface->facet_count; f++) {
        double *normal = surface->normal + f * dim, size2, zero[3] = {0.0, 0.0, 0.0};
        facet_normal(surface, f, normal, &size2);
        double least = dim == 2 ? 0.0 : least_slenderness * size2;
        if (!(sqrt(distance2(dim, normal, zero)) > least)) {
            status = fail(error, STATUS_INPUT, "rigid surface: facet %lld has no size: remove it",
                          (long long)(f + 1));
            goto done;
        }
        normalise(dim, normal);
        for (int a = 0; a < dim && flip; a++) {
            normal[a] = -normal[a];
        }
    }
done:
    return status;
}

/* The facets meet, but walk along the place where they do in the same direction. */
static enum status fail_sides(int64_t one, int64_t other, struct error *error)
{
    return fail(error, STATUS_INPUT,
                "rigid surface: facets %lld and %lld meet but disagree on the side: turn one around",
                (long long)(one + 1), (long long)(other + 1));
}

/* 2D: normals and rims at the vertices. */
static enum status join_segments(struct rigid_surface *surface, struct error *error)
{
    enum status status;
    struct meeting {
        int64_t count, last;
        int turn; /* segments that end here less those that begin here */
    } *meetings = NULL;
    TRY(NEW_ARRAY(&meetings, surface->vertex_count, error));
    for (int64_t f = 0; f < surface->facet_count; f++) {
        for (int k = 0; k < 2; k++) {
            int32_t v = surface->facet[2 * f + k];
            add_scaled(2, 1.0, surface->normal + 2 * f, surface->vertex_normal + 2 * (int64_t)v);
            meetings[v].count++;
            meetings[v].turn += k == 0 ? -1 : 1;
            if (meetings[v].count == 2 && meetings[v].turn != 0) {
                status = fail_sides(meetings[v].last, f, error);
                goto done;
            }
            meetings[v].last = f;
        }
    }
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        surface->is_rim[v] = meetings[v].count == 1;
    }
done:
    free(meetings);
    return status;
}

/* An edge of a triangle; it goes from corner k to k + 1. */
struct half_edge {
    int32_t low, high; /* its vertices */
    bool upward;       /* from low to high */
    int64_t slot;      /* facet * 3 + k */
};

static int compare_edges(const void *left, const void *right)
{
    const struct half_edge *a = left, *b = right;
    if (a->low != b->low) {
        return a->low < b->low ? -1 : 1;
    }
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    return (a->slot > b->slot) - (a->slot < b->slot);
}

/* 3D: normals and rims of the `count` half-edges that lie on one edge. */
static enum status join_edge(struct rigid_surface *surface, const struct half_edge *edges, int64_t count,
                             struct error *error)
{
    double normal[3] = {0.0, 0.0, 0.0};
    if (count == 2 && edges[0].upward == edges[1].upward) {
        return fail_sides(edges[0].slot / 3, edges[1].slot / 3, error);
    }
    for (int64_t i = 0; i < count; i++) {
        add_scaled(3, 1.0, surface->normal + edges[i].slot / 3 * 3, normal);
    }
    normalise(3, normal);
    for (int64_t i = 0; i < count; i++) {
        memcpy(surface->edge_normal + edges[i].slot * 3, normal, sizeof normal);
        surface->edge_is_rim[edges[i].slot] = count == 1;
    }
    if (count == 1) {
        surface->is_rim[edges[0].low] = true;
        surface->is_rim[edges[0].high] = true;
    }
    return STATUS_OK;
}

static enum status join_edges(struct rigid_surface *surface, struct error *error)
{
    enum status status;
    int64_t count = surface->facet_count * 3;
    struct half_edge *edges = NULL;
    TRY(NEW_ARRAY(&edges, count, error));
    TRY(NEW_ARRAY(&surface->edge_normal, count * 3, error));
    TRY(NEW_ARRAY(&surface->edge_is_rim, count, error));
    for (int64_t slot = 0; slot < count; slot++) {
        int32_t from = surface->facet[slot], to = surface->facet[slot / 3 * 3 + (slot + 1) % 3];
        bool upward = from < to;
        edges[slot] = (struct half_edge){upward ? from : to, upward ? to : from, upward, slot};
    }
    qsort(edges, (size_t)count, sizeof *edges, compare_edges);
    for (int64_t first = 0, last; first < count; first = last) {
        for (last = first + 1;
             last < count && edges[last].low == edges[first].low && edges[last].high == edges[first].high;) {
            last++;
        }
        TRY(join_edge(surface, edges + first, last - first, error));
    }
done:
    free(edges);
    return status;
}

/* 3D: the angle of facet f at its corner k. */
static double corner_angle(const struct rigid_surface *surface, int64_t f, int k)
{
    const int32_t *corner = surface->facet + f * 3;
    const double *x = surface->vertex + (int64_t)corner[k] * 3;
    const double *next = surface->vertex + (int64_t)corner[(k + 1) % 3] * 3;
    const double *previous = surface->vertex + (int64_t)corner[(k + 2) % 3] * 3;
    double dot = 0.0, one = distance2(3, x, next), other = distance2(3, x, previous);
    for (int a = 0; a < 3; a++) {
        dot += (next[a] - x[a]) * (previous[a] - x[a]);
    }
    return acos(fmin(fmax(dot / sqrt(one * other), -1.0), 1.0));
}

static enum status join_facets(struct rigid_surface *surface, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&surface->vertex_normal, surface->vertex_count * surface->dim, error));
    TRY(NEW_ARRAY(&surface->is_rim, surface->vertex_count, error));
    TRY(NEW_ARRAY(&surface->is_smooth, surface->vertex_count, error));
    if (surface->dim == 2) {
        TRY(join_segments(surface, error));
    } else {
        TRY(join_edges(surface, error));
        for (int64_t slot = 0; slot < surface->facet_count * 3; slot++) {
            add_scaled(3, corner_angle(surface, slot / 3, (int)(slot % 3)), surface->normal + slot / 3 * 3,
                       surface->vertex_normal + (int64_t)surface->facet[slot] * 3);
        }
    }
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        normalise(surface->dim, surface->vertex_normal + v * surface->dim);
        surface->is_smooth[v] = true;
    }
    for (int64_t c = 0; c < surface->facet_count * surface->dim; c++) {
        int64_t vertex = surface->facet[c];
        const double *mean = surface->vertex_normal + vertex * surface->dim;
        const double *normal = surface->normal + c / surface->dim * surface->dim;
        double cosine = 0.0;
        for (int a = 0; a < surface->dim; a++) {
            cosine += mean[a] * normal[a];
        }
        surface->is_smooth[vertex] = surface->is_smooth[vertex] && cosine >= smooth_cosine;
    }
done:
    return status;
}

/* Box of a facet in bins: first[3] to last[3], both included. */
static void facet_bins(const struct rigid_surface *surface, int64_t f, int64_t first[3], int64_t last[3])
{
    int dim = surface->dim;
    first[2] = last[2] = 0;
    for (int a = 0; a < dim; a++) {
        double low = INFINITY, high = -INFINITY, most = (double)(surface->bins[a] - 1);
        for (int k = 0; k < dim; k++) {
            double x = surface->vertex[(int64_t)surface->facet[f * dim + k] * dim + a];
            low = fmin(low, x);
            high = fmax(high, x);
        }
        first[a] = (int64_t)fmin((low - surface->origin[a]) / surface->bin, most);
        last[a] = (int64_t)fmin((high - surface->origin[a]) / surface->bin, most);
    }
}

/* Whether the facet's plane passes near a bin: large facets do not fill all bins of their box. */
static bool passes_near(const struct rigid_surface *surface, int64_t f, const int64_t at[3])
{
    int dim = surface->dim;
    double height = 0.0;
    const double *x0 = surface->vertex + (int64_t)surface->facet[f * dim] * dim;
    for (int a = 0; a < dim; a++) {
        double centre = surface->origin[a] + ((double)at[a] + 0.5) * surface->bin;
        height += (centre - x0[a]) * surface->normal[f * dim + a];
    }
    return fabs(height) <= 0.9 * surface->bin;
}

/* Visit the bins of every facet: count them in counts[bin], or with `fill` store the facet at counts[bin]++.
 */
static void visit_bins(struct rigid_surface *surface, int64_t *counts, bool fill)
{
    int64_t first[3], last[3], at[3];
    for (int64_t f = 0; f < surface->facet_count; f++) {
        facet_bins(surface, f, first, last);
        for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
            for (at[1] = first[1]; at[1] <= last[1]; at[1]++) {
                for (at[2] = first[2]; at[2] <= last[2]; at[2]++) {
                    if (!passes_near(surface, f, at)) {
                        continue;
                    }
                    int64_t bin = (at[0] * surface->bins[1] + at[1]) * surface->bins[2] + at[2];
                    if (fill) {
                        surface->in_bin[counts[bin]] = (int32_t)f;
                    }
                    counts[bin]++;
                }
            }
        }
    }
}

/* Bins of the facets' mean size, but no more than a few for each facet. */
static void size_bins(struct rigid_surface *surface, const double *low, const double *high)
{
    int dim = surface->dim;
    double mean = 0.0, most = 8.0 * (double)surface->facet_count + 64.0, bins;
    for (int64_t f = 0; f < surface->facet_count; f++) {
        double normal[3], size2;
        facet_normal(surface, f, normal, &size2);
        mean += sqrt(size2) / (double)surface->facet_count;
    }
    surface->bin = mean;
    do {
        bins = 1.0;
        for (int a = 0; a < 3; a++) {
            double along = a < dim ? fmax(1.0, ceil((high[a] - low[a]) / surface->bin)) : 1.0;
            bins *= along;
            surface->bins[a] = along <= most ? (int64_t)along : 1;
            surface->origin[a] = a < dim ? low[a] : 0.0;
        }
        surface->bin *= bins > most ? 1.25 : 1.0;
    } while (bins > most);
}

static enum status make_bins(struct rigid_surface *surface, const double *low, const double *high,
                             struct error *error)
{
    enum status status;
    size_bins(surface, low, high);
    int64_t count = surface->bins[0] * surface->bins[1] * surface->bins[2];
    /* Counted two places on, so that filling leaves the starts where they belong. */
    TRY(NEW_ARRAY(&surface->start, count + 2, error));
    visit_bins(surface, surface->start + 2, false);
    for (int64_t b = 0; b < count; b++) {
        surface->start[b + 2] += surface->start[b + 1];
    }
    TRY(NEW_ARRAY(&surface->in_bin, surface->start[count + 1], error));
    visit_bins(surface, surface->start + 1, true);
done:
    return status;
}

enum status rigid_build(int dim, int64_t facet_count, const double *corners, bool flip,
                        struct rigid_surface *surface, struct error *error)
{
    enum status status;
    double low[3], high[3];
    *surface = (struct rigid_surface){.dim = dim, .facet_count = facet_count};
    if (facet_count < 1 || facet_count > INT32_MAX / 3) {
        return fail(error, STATUS_INPUT, "rigid surface: %lld facets: none, or too many",
                    (long long)facet_count);
    }
    TRY(measure(surface, corners, low, high, error));
    TRY(number_vertices(surface, corners, error));
    TRY(make_normals(surface, flip, error));
    TRY(join_facets(surface, error));
    TRY(make_bins(surface, low, high, error));
done:
    if (status != STATUS_OK) {
        rigid_free(surface);
    }
    return status;
}

void rigid_free(struct rigid_surface *surface)
{
    free(surface->vertex);
    free(surface->facet);
    free(surface->normal);
    free(surface->vertex_normal);
    free(surface->edge_normal);
    free(surface->is_rim);
    free(surface->is_smooth);
    free(surface->edge_is_rim);
    free(surface->start);
    free(surface->in_bin);
    *surface = (struct rigid_surface){0};
}
