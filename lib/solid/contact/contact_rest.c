#include "solid/contact/contact_rest.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* The two ends of a chord of a circle have the same height above each other's tangents. A boundary is
 * resolved if the heights differ by less than this share of them, on average: balls and discs with a dozen
 * facets around are, brains with their folds are not. */
static const double most_rough = 0.2;
/* If heights are below this share of the edges, on average, the facets are flat. */
static const double flat = 1e-3;

/* The facets of a contact, by its points: each stands for a corner of its facet. */
struct facets {
    int dim;
    const struct boundary_averages *points, *averages;
    const double *X;
    int64_t *average; /* points->count: the average at the corner of each point */
    double *hat;      /* points->count * dim: the hat functions of the corners of its facet at each point */
    double *normal;   /* averages->count * dim: unit normal of the boundary at each node, or on its side */
    bool *rim;        /* averages->count: the facets end there, and the normal is that of one side only */
};

static const double *corner_of(const struct facets *facets, int64_t p)
{
    return facets->X + (int64_t)facets->points->node[p] * facets->dim;
}

/* The height of the tangent plane at the corner of point p above a place, m. */
static double height_above(const struct facets *facets, int64_t p, const double *place)
{
    double way[3];
    vector_subtract(facets->dim, corner_of(facets, p), place, way);
    return vector_dot(facets->dim, way, facets->normal + facets->average[p] * facets->dim);
}

/* The weight of Max for the facet of point p at its corner: the sine of the angle between the edges there
 * over their lengths; in 2D one over the length. */
static double facet_weight(const struct facets *facets, int64_t p)
{
    int dim = facets->dim;
    double edge[2][3] = {{0.0}}, across[3];
    for (int k = 1; k < dim; k++) {
        vector_subtract(dim, corner_of(facets, p - p % dim + (p + k) % dim), corner_of(facets, p),
                        edge[k - 1]);
    }
    double size2 = vector_dot(dim, edge[0], edge[0]);
    if (dim == 2) {
        return 1.0 / sqrt(size2);
    }
    vector_cross(edge[0], edge[1], across);
    return vector_length(3, across) / (size2 * vector_dot(3, edge[1], edge[1]));
}

static void facets_free(struct facets *facets)
{
    FREE_ALL(facets->average, facets->hat, facets->normal, facets->rim);
}

static enum status facets_build(int dim, const struct boundary_averages *points,
                                const struct boundary_averages *averages, const double *X,
                                struct facets *facets, struct error *error)
{
    /* Exclusive or of the other corners of the facets: inside, each is a corner of two of them, and they
     * cancel. 2D: whether the facets are one. */
    NEW_SCRATCH(int32_t, once, averages->count, error);
    *facets = (struct facets){.dim = dim, .points = points, .averages = averages, .X = X};
    RETURN_IF_ERROR(NEW_ARRAY(&facets->average, points->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&facets->hat, points->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&facets->normal, averages->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&facets->rim, averages->count, error));
    for (int64_t a = 0; a < averages->count; a++) {
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
            int64_t p = averages->sample_point[s], k = 0;
            while (k < dim - 1 && points->node[p - p % dim + k] != averages->node[a]) {
                k++;
            }
            facets->average[p - p % dim + k] = a;
            facets->hat[p * dim + k] = averages->sample_share[s] * averages->area[a] / points->area[p];
        }
    }
    for (int64_t p = 0; p < points->count; p++) {
        int64_t a = facets->average[p], first = p - p % dim;
        add_scaled(dim, facet_weight(facets, p), points->normal + p * dim, facets->normal + a * dim);
        once[a] ^= dim == 2 ? 1 : points->node[first + (p + 1) % 3] ^ points->node[first + (p + 2) % 3];
    }
    for (int64_t a = 0; a < averages->count; a++) {
        facets->rim[a] = once[a] != 0;
        vector_normalise(dim, facets->normal + a * dim);
    }
    return STATUS_OK;
}

static bool is_resolved(const struct facets *facets)
{
    int dim = facets->dim;
    double rough = 0.0, sum = 0.0, length = 0.0;
    for (int64_t p = 0; p < facets->points->count; p++) {
        int64_t next = p - p % dim + (p + 1) % dim;
        double here = height_above(facets, p, corner_of(facets, next));
        double there = height_above(facets, next, corner_of(facets, p));
        if (!facets->rim[facets->average[p]] && !facets->rim[facets->average[next]]) {
            rough += fabs(here - there);
            sum += fabs(here) + fabs(there);
            length += 2.0 * vector_distance(dim, corner_of(facets, p), corner_of(facets, next));
        }
    }
    return rough <= most_rough * sum || sum <= flat * length;
}

enum status contact_rest_resolved(int dim, const struct boundary_averages *points,
                                  const struct boundary_averages *averages, const double *X, bool *resolved,
                                  struct error *error)
{
    FREED_BY(facets_free) struct facets facets = {0};
    RETURN_IF_ERROR(facets_build(dim, points, averages, X, &facets, error));
    *resolved = is_resolved(&facets);
    return STATUS_OK;
}

/* The share of heights above a point, of this mean, that is due to curvature. A curved boundary turns about
 * equally at all corners of a facet: the share is 1. An edge between plane sides turns at some corners only:
 * it is 0. In between, twice the least height counts (the limiter MC of van Leer 1977). */
static double share_of_curve(double least, double most, double mean)
{
    double limit = 2.0 * (mean > 0.0 ? fmax(least, 0.0) : fmin(most, 0.0));
    return fabs(limit) < fabs(mean) ? limit / mean : 1.0;
}

/* rest[dim] += the way from point p to the boundary, by the corners of its facet but for those on a rim,
 * where the boundary is taken to continue as at the others. */
static void raise_point(const struct facets *facets, int64_t p, double *rest)
{
    int dim = facets->dim, count = 0;
    const double *hat = facets->hat + p * dim;
    double height[3] = {0.0}, least = INFINITY, most = -INFINITY, mean = 0.0;
    for (int64_t k = 0, corner = p - p % dim; k < dim; k++, corner++) {
        if (!facets->rim[facets->average[corner]]) {
            height[k] = height_above(facets, corner, facets->points->position + p * dim);
            least = fmin(least, height[k]);
            most = fmax(most, height[k]);
            mean += hat[k] * height[k];
            count++;
        }
    }
    double share = count > 0 ? 0.5 * dim / count * share_of_curve(least, most, mean) : 0.0;
    for (int64_t k = 0, corner = p - p % dim; k < dim; k++, corner++) {
        add_scaled(dim, share * hat[k] * height[k], facets->normal + facets->average[corner] * dim, rest);
    }
}

enum status contact_rest_heights(int dim, const struct boundary_averages *points,
                                 const struct boundary_averages *averages, const double *X, double *height,
                                 struct error *error)
{
    FREED_BY(facets_free) struct facets facets = {0};
    RETURN_IF_ERROR(facets_build(dim, points, averages, X, &facets, error));
    bool resolved = is_resolved(&facets);
    for (int64_t p = 0; p < points->count && resolved; p++) {
        double way[3] = {0.0};
        raise_point(&facets, p, way);
        height[p] = vector_dot(dim, way, points->normal + p * dim);
    }
    return STATUS_OK;
}

/* Raise each average to the plane through its node. */
static void raise_averages(struct contact *contact, const double *X)
{
    const struct boundary_averages *points = contact->points;
    int dim = contact->dim;
    for (int64_t p = 0; p < contact->count; p++) {
        double way[3], *x = contact->rest + p * dim;
        vector_subtract(dim, X + (int64_t)points->node[p] * dim, x, way);
        add_scaled(dim, vector_dot(dim, way, points->normal + p * dim), points->normal + p * dim, x);
    }
}

enum status contact_rest_place(struct contact *contact, const double *X, struct error *error)
{
    for (int64_t p = 0; p < contact->count; p++) {
        struct average average = average_of_boundary(contact->points, p);
        average_take(&average, contact->dim, X, contact->rest + p * contact->dim);
    }
    if (contact->averages == NULL) {
        raise_averages(contact, X);
        return STATUS_OK;
    }
    FREED_BY(facets_free) struct facets facets = {0};
    RETURN_IF_ERROR(facets_build(contact->dim, contact->points, contact->averages, X, &facets, error));
    for (int64_t p = 0; p < contact->count; p++) {
        raise_point(&facets, p, contact->rest + p * contact->dim);
    }
    return STATUS_OK;
}
