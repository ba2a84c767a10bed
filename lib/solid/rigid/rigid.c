/* Building rigid surfaces: vertices and normals; see rigid.h. */
#include "solid/rigid/rigid.h"

#include "approx/cells/cells.h"
#include "base/box.h"
#include "base/eigen.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"
#include "solid/rigid/rigid_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum status check_corners(const struct rigid_surface *surface, const double *corners,
                                 struct error *error)
{
    int64_t per_facet = (int64_t)surface->dim * surface->dim;
    for (int64_t i = 0; i < surface->facet_count * per_facet; i++) {
        if (!isfinite(corners[i])) {
            return fail(error, STATUS_INPUT, "rigid surface: facet %lld: coordinate is not finite",
                        (long long)(i / per_facet + 1));
        }
    }
    return STATUS_OK;
}

/* same[corner]: the first corner, along the direction, of those that coincide with it. */
static enum status find_coincident(const struct rigid_surface *surface, const double *corners, int64_t *same,
                                   struct error *error)
{
    static const double direction[3] = {0.5377, 0.6180, 0.5734};
    int dim = surface->dim;
    int64_t count = surface->facet_count * dim;
    double near = COARSE_ROUND_OFF * surface->extent;
    SCRATCH struct placed *placed = NULL; /* along a direction in which few distinct corners coincide */
    RETURN_IF_ERROR(NEW_ARRAY(&placed, count, error));
    for (int64_t c = 0; c < count; c++) {
        placed[c] = (struct placed){vector_dot(dim, direction, corners + c * dim), c};
    }
    qsort(placed, (size_t)count, sizeof *placed, compare_placed);
    for (int64_t i = 0; i < count; i++) {
        int64_t c = placed[i].item;
        same[c] = c;
        for (int64_t k = i - 1; k >= 0 && placed[i].place - placed[k].place <= near; k--) {
            int64_t other = same[placed[k].item];
            if (vector_distance2(dim, corners + c * dim, corners + other * dim) <= near * near) {
                same[c] = other;
                break;
            }
        }
    }
    return STATUS_OK;
}

/* Vertices in the order of their first corner, and the facets' indices into them. */
static enum status number_vertices(struct rigid_surface *surface, const double *corners, struct error *error)
{
    int dim = surface->dim;
    int64_t count = surface->facet_count * dim;
    SCRATCH int32_t *number = NULL; /* of the vertex of each first corner, + 1 */
    NEW_SCRATCH(int64_t, same, count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&number, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->vertex, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->facet, count, error));
    RETURN_IF_ERROR(find_coincident(surface, corners, same, error));
    for (int64_t c = 0; c < count; c++) {
        if (number[same[c]] == 0) {
            memcpy(surface->vertex + surface->vertex_count * dim, corners + c * dim,
                   (size_t)dim * sizeof *corners);
            number[same[c]] = (int32_t)++surface->vertex_count;
        }
        surface->facet[c] = number[same[c]] - 1;
    }
    return STATUS_OK;
}

static enum status make_normals(struct rigid_surface *surface, bool flip, struct error *error)
{
    int dim = surface->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&surface->normal, surface->facet_count * dim, error));
    for (int64_t f = 0; f < surface->facet_count; f++) {
        const int32_t *corner = surface->facet + f * dim;
        double *normal = surface->normal + f * dim, size2 = 0.0; /* of the longest edge */
        face_area_vector(dim, surface->vertex, corner, normal);
        for (int k = 0; k < dim; k++) {
            size2 = fmax(size2, vector_distance2(dim, surface->vertex + (int64_t)corner[k] * dim,
                                                 surface->vertex + (int64_t)corner[(k + 1) % dim] * dim));
        }
        double least = dim == 2 ? 0.0 : 0.5 * ROUND_OFF * size2;
        if (!(vector_length(dim, normal) > least)) {
            return fail(error, STATUS_INPUT, "rigid surface: facet %lld has no size: remove it",
                        (long long)(f + 1));
        }
        vector_normalise(dim, normal);
        for (int a = 0; a < dim && flip; a++) {
            normal[a] = -normal[a];
        }
    }
    return STATUS_OK;
}

enum status rigid_weld(int dim, int64_t facet_count, const double *corners, struct rigid_surface *surface,
                       struct error *error)
{
    *surface = (struct rigid_surface){.dim = dim, .facet_count = facet_count};
    if (facet_count < 1 || facet_count > INT32_MAX / 3) {
        return fail(error, STATUS_INPUT, "rigid surface: %lld facets: none, or too many",
                    (long long)facet_count);
    }
    RETURN_IF_ERROR(check_corners(surface, corners, error));
    struct box box = box_of(dim, facet_count * dim, corners);
    surface->extent = box_diagonal(&box);
    return number_vertices(surface, corners, error);
}

enum status rigid_build(int dim, int64_t facet_count, const double *corners, bool flip,
                        struct rigid_surface *surface, struct error *error)
{
    RETURN_IF_ERROR(rigid_weld(dim, facet_count, corners, surface, error));
    RETURN_IF_ERROR(make_normals(surface, flip, error));
    RETURN_IF_ERROR(rigid_make_pseudo_normals(surface, error));
    return rigid_grow_tree(surface, error);
}

enum status rigid_of_facets(int dim, const double *x, int64_t facet_count, const int32_t *facet,
                            struct rigid_surface *surface, struct error *error)
{
    NEW_SCRATCH(double, corners, facet_count * dim * dim, error);
    for (int64_t k = 0; k < facet_count * dim; k++) {
        memcpy(corners + k * dim, x + (int64_t)facet[k] * dim, (size_t)dim * sizeof *x);
    }
    return rigid_build(dim, facet_count, corners, false, surface, error);
}

double rigid_width(const struct rigid_surface *surface)
{
    double middle[3] = {0.0}, spread[9] = {0.0}, value[3], V[9];
    int dim = surface->dim;
    for (int64_t i = 0; i < surface->vertex_count * dim; i++) {
        middle[i % dim] += surface->vertex[i] / (double)surface->vertex_count;
    }
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        double off[3];
        vector_subtract(dim, surface->vertex + v * dim, middle, off);
        for (int i = 0; i < dim * dim; i++) {
            spread[i] += off[i / dim] * off[i % dim] / (double)surface->vertex_count;
        }
    }
    eigen_symmetric(dim, spread, value, V);
    qsort(value, (size_t)dim, sizeof *value, compare_double);
    return 2.0 * sqrt(2.0 * fmax(0.0, value[1]));
}

void rigid_free(struct rigid_surface *surface)
{
    FREE_ALL(surface->vertex, surface->facet, surface->normal, surface->vertex_normal, surface->edge_normal,
             surface->is_rim, surface->edge_is_rim, surface->turn, surface->branch, surface->in_order);
    *surface = (struct rigid_surface){0};
}
