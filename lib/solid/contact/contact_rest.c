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

/* The facets of a contact, described by its points. */
struct facets {
    int dim;
    const struct boundary_averages *points, *averages;
    const double *X;
    double *normal; /* averages->count * dim: unit normal of the boundary at each node, or on its side */
    bool *rim;      /* averages->count: the facets end there, and the normal is that of one side only */
};

static const double *corner_of(const struct facets *facets, int64_t p)
{
    return facets->X + (int64_t)facets->points->node[p] * facets->dim;
}

/* The height of the tangent plane at the node of average a above a place, m. */
static double height_above(const struct facets *facets, int64_t a, const double *place)
{
    double way[3];
    vector_subtract(facets->dim, facets->X + (int64_t)facets->averages->node[a] * facets->dim, place, way);
    return vector_dot(facets->dim, way, facets->normal + a * facets->dim);
}

/* The weight of Max for a facet, whose points begin at `first`, at its corner `at`: the sine of the angle
 * between the edges there over their lengths; in 2D one over the length. */
static double facet_weight(const struct facets *facets, int64_t first, int at)
{
    int dim = facets->dim;
    double edge[2][3] = {{0.0}}, across[3];
    for (int k = 1; k < dim; k++) {
        vector_subtract(dim, corner_of(facets, first + (at + k) % dim), corner_of(facets, first + at),
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
    FREE_ALL(facets->normal, facets->rim);
}

static enum status find_normals(struct facets *facets, struct error *error)
{
    const struct boundary_averages *points = facets->points, *averages = facets->averages;
    int dim = facets->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&facets->normal, averages->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&facets->rim, averages->count, error));
    for (int64_t a = 0; a < averages->count; a++) {
        double *normal = facets->normal + a * dim;
        /* Exclusive or of the other corners of the facets: inside, each is a corner of two of them, and they
         * cancel. 2D: whether the facets are one. */
        int32_t once = 0;
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
            int64_t p = averages->sample_point[s]; /* all points of a facet are samples of its corners */
            if (points->node[p] == averages->node[a]) {
                int64_t first = p - p % dim;
                add_scaled(dim, facet_weight(facets, first, (int)(p % dim)), points->normal + p * dim,
                           normal);
                once ^= dim == 2 ? 1 : points->node[first + (p + 1) % 3] ^ points->node[first + (p + 2) % 3];
            }
        }
        facets->rim[a] = once != 0;
        vector_normalise(dim, normal);
    }
    return STATUS_OK;
}

enum status contact_rest_resolved(int dim, const struct boundary_averages *points,
                                  const struct boundary_averages *averages, const double *X, bool *resolved,
                                  struct error *error)
{
    FREED_BY(facets_free) struct facets facets = {dim, points, averages, X, NULL, NULL};
    double rough = 0.0, sum = 0.0, length = 0.0;
    RETURN_IF_ERROR(find_normals(&facets, error));
    NEW_SCRATCH(int64_t, average, points->count, error); /* of the corner */
    for (int64_t a = 0; a < averages->count; a++) {
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
            int64_t p = averages->sample_point[s];
            average[p] = points->node[p] == averages->node[a] ? a : average[p];
        }
    }
    for (int64_t p = 0; p < points->count; p++) {
        int64_t next = p - p % dim + (p + 1) % dim;
        double here = height_above(&facets, average[p], corner_of(&facets, next));
        double there = height_above(&facets, average[next], corner_of(&facets, p));
        bool known = !facets.rim[average[p]] && !facets.rim[average[next]];
        rough += known ? fabs(here - there) : 0.0;
        sum += known ? fabs(here) + fabs(there) : 0.0;
        length += known ? 2.0 * vector_distance(dim, corner_of(&facets, p), corner_of(&facets, next)) : 0.0;
    }
    *resolved = rough <= most_rough * sum || sum <= flat * length;
    return STATUS_OK;
}

/* Heights of a point's facet corners, except those on a rim, where the boundary is taken to continue as at
 * the other corners. */
struct heights {
    int count;
    double least, most; /* above the point, m */
    double mean;        /* by the corners' hat functions at the point */
};

/* The share of the heights that is due to curvature. A curved boundary turns about equally at all corners of
 * a facet: the share is 1. An edge between plane sides turns at some corners only: it is 0. In between, twice
 * the least height counts (the limiter MC of van Leer 1977). */
static double share_of_curve(const struct heights *heights)
{
    double mean = heights->mean;
    double limit = 2.0 * (mean > 0.0 ? fmax(heights->least, 0.0) : fmin(heights->most, 0.0));
    return fabs(limit) < fabs(mean) ? limit / mean : 1.0;
}

/* The hat function of the node of average a at its sample s. */
static double hat_function(const struct facets *facets, int64_t a, int64_t s)
{
    const struct boundary_averages *averages = facets->averages;
    return averages->sample_share[s] * averages->area[a] / facets->points->area[averages->sample_point[s]];
}

static void measure_heights(const struct facets *facets, struct heights *heights)
{
    const struct boundary_averages *points = facets->points, *averages = facets->averages;
    for (int64_t p = 0; p < points->count; p++) {
        heights[p] = (struct heights){.least = INFINITY, .most = -INFINITY};
    }
    for (int64_t a = 0; a < averages->count; a++) {
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1] && !facets->rim[a]; s++) {
            int64_t p = averages->sample_point[s];
            double height = height_above(facets, a, points->position + p * facets->dim);
            heights[p].count++;
            heights[p].least = fmin(heights[p].least, height);
            heights[p].most = fmax(heights[p].most, height);
            heights[p].mean += hat_function(facets, a, s) * height;
        }
    }
}

/* rest[points * dim] += the way from the facets' points to the boundary. */
static enum status raise_points(int dim, const struct boundary_averages *points,
                                const struct boundary_averages *averages, const double *X, double *rest,
                                struct error *error)
{
    FREED_BY(facets_free) struct facets facets = {dim, points, averages, X, NULL, NULL};
    RETURN_IF_ERROR(find_normals(&facets, error));
    NEW_SCRATCH(struct heights, heights, points->count, error);
    measure_heights(&facets, heights);
    for (int64_t a = 0; a < averages->count; a++) {
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1] && !facets.rim[a]; s++) {
            int64_t p = averages->sample_point[s];
            double height = height_above(&facets, a, points->position + p * dim);
            double share = 0.5 * dim / heights[p].count * share_of_curve(&heights[p]);
            add_scaled(dim, share * hat_function(&facets, a, s) * height, facets.normal + a * dim,
                       rest + p * dim);
        }
    }
    return STATUS_OK;
}

enum status contact_rest_heights(int dim, const struct boundary_averages *points,
                                 const struct boundary_averages *averages, const double *X, double *height,
                                 struct error *error)
{
    bool resolved;
    NEW_SCRATCH(double, way, points->count * dim, error);
    RETURN_IF_ERROR(contact_rest_resolved(dim, points, averages, X, &resolved, error));
    RETURN_IF_ERROR(resolved ? raise_points(dim, points, averages, X, way, error) : STATUS_OK);
    for (int64_t p = 0; p < points->count; p++) {
        height[p] = vector_dot(dim, way + p * dim, points->normal + p * dim);
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
    if (contact->averages != NULL) {
        return raise_points(contact->dim, contact->points, contact->averages, X, contact->rest, error);
    }
    raise_averages(contact, X);
    return STATUS_OK;
}
