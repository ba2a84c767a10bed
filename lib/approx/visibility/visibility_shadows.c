/* Shadows of facets: the parts of the supports of nodes that a facet of the boundary may hide. The shadow of
 * a facet from a node beyond its plane is the part of the node's support from which the segment to the node
 * passes through the facet. For each shadow the points within it are searched among all points. So the work
 * is proportional to the number of hidden nodes, not to the number of facets that might hide them. */
#include "approx/visibility/visibility_private.h"

#include "base/box.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* A segment passes a facet if it meets its plane within this distance of the facet, in barycentric
 * coordinates. */
static const double beside_facet = 1e-6;

/* How the segment from x to a node passes a facet: not at all; through it, out of the body; or too near the
 * facet's rim or the segment's ends to decide. */
enum passage { PASSES_NOT, PASSES, PASSES_CLOSE };

/* of_x, of_y: heights of x and of the node at y above the facet. own: x lies only in the facet's cell, so
 * that a segment through the facet leaves the body. */
static enum passage passage_of(int dim, const struct visibility_facet *facet, double tolerance,
                               const double *x, double of_x, bool own, const double *y, double of_y)
{
    if (of_y <= tolerance) {
        return of_y < -tolerance ? PASSES_NOT : PASSES_CLOSE; /* the node is on the facet, x elsewhere */
    }
    double t = of_x < 0.0 ? of_x / (of_x - of_y) : 0.0, second = -facet->from[0], third = -facet->from[1];
    for (int a = 0; a < dim; a++) {
        double place = x[a] + t * (y[a] - x[a]);
        second += facet->dual[0][a] * place;
        third += facet->dual[1][a] * place;
    }
    double within = 1.0 - second - third;
    within = second < within ? second : within;
    within = dim == 3 && third < within ? third : within;
    if (within < -beside_facet) {
        return PASSES_NOT;
    }
    return within > beside_facet && (own || of_x < -tolerance) ? PASSES : PASSES_CLOSE;
}

/* A box around a shadow: around the facet and the far end of the pyramid from the node through it, within the
 * node's support. The whole support if the node is on the facet or too near to it. */
static struct box box_of_shadow(const struct visibility *visibility, const struct visibility_facet *facet,
                                int32_t node, bool beyond)
{
    int dim = visibility->cells.dim;
    const double *y = visibility->cells.x + (int64_t)node * dim;
    double radius = visibility->grid->radius[node], ray[3][3] = {{0.0}};
    double cosine = 1.0;
    struct box box = box_of(dim, 0, NULL);
    for (int k = 0; k < dim; k++) {
        double vertex[3];
        /* Beyond the vertices by more than beside_facet. */
        vector_between(dim, facet->middle, visibility->cells.x + (int64_t)facet->node[k] * dim, 1.0 + 1e-5,
                       vertex);
        vector_subtract(dim, vertex, y, ray[k]);
        box_add(&box, 1, vertex);
        double length = vector_length(dim, ray[k]);
        for (int a = 0; a < dim; a++) {
            ray[k][a] /= length;
        }
        for (int i = 0; i < k; i++) {
            double product = vector_dot(dim, ray[i], ray[k]);
            cosine = product < cosine ? product : cosine;
        }
    }
    /* Least distance of the plane through the ends of the unit vectors from their origin, squared. */
    double near2 = (1.0 + (dim - 1) * cosine) / dim;
    bool narrow = beyond && near2 > 0.01;
    for (int k = 0; k < dim && narrow; k++) {
        double end[3];
        for (int a = 0; a < dim; a++) {
            end[a] = y[a] + radius / sqrt(near2) * ray[k][a];
        }
        box_add(&box, 1, end);
    }
    for (int a = 0; a < dim; a++) {
        box.low[a] = narrow ? fmax(box.low[a] - 1e-6 * radius, y[a] - radius) : y[a] - radius;
        box.high[a] = narrow ? fmin(box.high[a] + 1e-6 * radius, y[a] + radius) : y[a] + radius;
    }
    return box;
}

/* The points whose shadows are searched. */
struct shaded {
    struct point_grid grid;
    const int32_t *body_of; /* NULL: all points; else those of this body: */
    int32_t body;
};

/* List the points that a shadow may contain; `near`: scratch. */
static enum status list_points(const struct visibility *visibility, const struct shaded *points,
                               int32_t shadow, struct index_list *near, struct pair_list *pairs,
                               struct error *error)
{
    int dim = visibility->cells.dim;
    int32_t node = visibility->shadow[shadow].node;
    const struct visibility_facet *facet = &visibility->facet[visibility->shadow[shadow].facet];
    const double *y = visibility->cells.x + (int64_t)node * dim;
    double radius = visibility->grid->radius[node], tolerance = COARSE_ROUND_OFF * radius;
    double of_y = visibility_height_above(dim, facet, y);
    struct box box = box_of_shadow(visibility, facet, node, of_y > tolerance);
    const struct point_grid_level *level = &points->grid.level[0];
    near->count = 0;
    RETURN_IF_ERROR(point_grid_list_places(&points->grid, level, box.low, box.high, 1e-6, near, error));
    RETURN_IF_ERROR(pair_list_reserve(pairs, near->count, error));
    for (int64_t i = 0; i < near->count; i++) {
        const double *x = level->place + (int64_t)near->index[i] * (dim + 1);
        int32_t point = level->node[near->index[i]];
        double of_x = visibility_height_above(dim, facet, x);
        if (of_x > tolerance || !(vector_distance2(dim, y, x) < radius * radius) ||
            (points->body_of != NULL && points->body_of[point] != points->body)) {
            continue;
        }
        enum passage passage = passage_of(dim, facet, tolerance, x, of_x, false, y, of_y);
        if (passage != PASSES_NOT) {
            pair_list_add(pairs, point, passage == PASSES ? ~shadow : shadow);
        }
    }
    return STATUS_OK;
}

/* Append the pairs of all threads to `all`. Their order does not affect the result at a point. */
static enum status list_all(const struct visibility *visibility, const struct shaded *points,
                            struct pair_list *all, struct error *error)
{
    struct first_failure failure = {STATUS_OK};
#pragma omp parallel
    {
        enum status status = STATUS_OK;
        struct error own;
        struct index_list near = {0};
        struct pair_list pairs = {0};
#pragma omp for schedule(dynamic, 256)
        for (int64_t s = 0; s < visibility->shadow_count; s++) {
            status = status == STATUS_OK ? list_points(visibility, points, (int32_t)s, &near, &pairs, &own)
                                         : status;
        }
#pragma omp critical
        status = status == STATUS_OK ? pair_list_append(all, &pairs, &own) : status;
        note_failure(&failure, 0, status, &own, error);
        free(near.index);
        pair_list_free(&pairs);
    }
    return failure.status;
}

enum status visibility_shadows_build(const struct visibility *visibility, int64_t count, const double *x,
                                     const int32_t *body_of, int32_t body, struct visibility_shadows *shadows,
                                     struct error *error)
{
    enum status status;
    struct shaded points = {.body_of = body_of, .body = body};
    struct pair_list pairs = {0};
    double *size = NULL, least = INFINITY;
    *shadows = (struct visibility_shadows){0};
    for (int64_t n = 0; n < visibility->cells.node_count; n++) {
        least = fmin(least, visibility->grid->radius[n]);
    }
    /* Bins of a quarter of the smallest radius, or larger if there were too many. */
    TRY(NEW_ARRAY(&size, count, error));
    for (int64_t p = 0; p < count; p++) {
        size[p] = 0.5 * least;
    }
    if (visibility->shadow_count > 0) {
        TRY(point_grid_build(&points.grid, visibility->cells.dim, count, x, size, error));
        TRY(list_all(visibility, &points, &pairs, error));
    }
    TRY(pair_list_file(&pairs, count, &shadows->ptr, &shadows->shadow, error));
done:
    free(size);
    point_grid_free(&points.grid);
    pair_list_free(&pairs);
    return status;
}

void visibility_shadows_free(struct visibility_shadows *shadows)
{
    FREE_ALL(shadows->ptr, shadows->shadow);
    *shadows = (struct visibility_shadows){0};
}

static int32_t shadow_number(int32_t filed)
{
    return filed < 0 ? ~filed : filed;
}

enum status visibility_mark_shadows(const struct visibility *visibility,
                                    const struct visibility_shadows *shadows, int64_t p,
                                    struct visibility_work *work, int64_t *hidden, struct error *error)
{
    int dim = visibility->cells.dim;
    *hidden = 0;
    for (int64_t i = shadows->ptr[p]; i < shadows->ptr[p + 1]; i++) {
        bool holds = shadows->shadow[i] < 0;
        struct visibility_shadow shadow = visibility->shadow[shadow_number(shadows->shadow[i])];
        if (!holds && work->cell_count == 1 && visibility->facet[shadow.facet].cell == work->cell[0]) {
            const struct visibility_facet *facet = &visibility->facet[shadow.facet];
            const double *y = visibility->cells.x + (int64_t)shadow.node * dim;
            holds = passage_of(dim, facet, COARSE_ROUND_OFF * visibility->grid->radius[shadow.node], work->x,
                               visibility_height_above(dim, facet, work->x), true, y,
                               visibility_height_above(dim, facet, y)) == PASSES;
        }
        if (holds && !visibility_is_hidden(work, shadow.node)) {
            work->mark[shadow.node] = 2 * work->serial + 1;
            ++*hidden;
        }
    }
    /* The other shadows pass too near to decide. */
    for (int64_t i = shadows->ptr[p]; i < shadows->ptr[p + 1]; i++) {
        int32_t node = visibility->shadow[shadow_number(shadows->shadow[i])].node;
        if (work->mark[node] / 2 != work->serial) {
            bool seen;
            RETURN_IF_ERROR(
                visibility_walk(visibility, work->x, work->cell, work->cell_count, node, work, &seen, error));
            work->mark[node] = 2 * work->serial + !seen;
            *hidden += !seen;
        }
    }
    return STATUS_OK;
}
