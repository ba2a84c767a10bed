/* Where the facets of a rigid surface meet: normals at vertices and edges, and rims. */
#include "base/memory.h"
#include "solid/rigid/rigid_private.h"

#include <string.h>

enum status rigid_list_ridges(const struct rigid_surface *surface, struct ridge **ridges, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(ridges, surface->facet_count * surface->dim, error));
    ridges_list(surface->dim, surface->facet_count, surface->facet, *ridges);
    return STATUS_OK;
}

void rigid_mark_rim(struct rigid_surface *surface, const struct ridge *ridge)
{
    for (int k = 0; k < surface->dim - 1; k++) {
        surface->is_rim[ridge->node[k]] = true;
    }
    if (surface->dim == 3) {
        surface->edge_is_rim[rigid_ridge_slot(3, ridge)] = true;
    }
}

/* Check the `count` facets that meet at one ridge. A repeated one would have twice the weight in normals, and
 * hide rims. Two that meet must not traverse their edge in the same direction (2D: both begin or end there).
 */
static enum status check_ridge(int dim, const struct ridge *ridge, int64_t count, struct error *error)
{
    for (int64_t i = 1; i < count; i++) {
        for (int64_t k = 0; k < i; k++) {
            if (ridge[k].opposite == ridge[i].opposite && ridge[k].upward == ridge[i].upward) {
                return fail(error, STATUS_INPUT, "rigid surface: facets %d and %d are the same: remove one",
                            ridge[k].facet + 1, ridge[i].facet + 1);
            }
        }
    }
    if ((count == 2 || (dim == 2 && count > 2)) && ridge[0].upward == ridge[1].upward) {
        return fail(error, STATUS_INPUT,
                    "rigid surface: facets %d and %d meet but disagree on the side: turn one around",
                    ridge[0].facet + 1, ridge[1].facet + 1);
    }
    return STATUS_OK;
}

/* Rims, and in 3D the normals at edges. */
static enum status join_ridges(struct rigid_surface *surface, struct error *error)
{
    int dim = surface->dim;
    int64_t count = surface->facet_count * dim;
    SCRATCH struct ridge *ridges = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&surface->edge_normal, dim == 3 ? count * 3 : 0, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->edge_is_rim, dim == 3 ? count : 0, error));
    RETURN_IF_ERROR(rigid_list_ridges(surface, &ridges, error));
    for (int64_t first = 0, end; first < count; first = end) {
        double normal[3] = {0.0, 0.0, 0.0};
        end = ridges_end(count, ridges, first);
        RETURN_IF_ERROR(check_ridge(dim, ridges + first, end - first, error));
        if (end - first == 1) {
            rigid_mark_rim(surface, &ridges[first]);
        }
        for (int64_t i = first; i < end; i++) {
            add_scaled(dim, 1.0, surface->normal + (int64_t)ridges[i].facet * dim, normal);
        }
        vector_normalise(dim, normal);
        for (int64_t i = first; i < end && dim == 3; i++) {
            memcpy(surface->edge_normal + rigid_ridge_slot(3, &ridges[i]) * 3, normal, sizeof normal);
        }
    }
    return STATUS_OK;
}

/* The angle of facet f at its corner k; in 2D all weigh alike. */
static double corner_angle(const struct rigid_surface *surface, int64_t f, int k)
{
    if (surface->dim == 2) {
        return 1.0;
    }
    const int32_t *facet = surface->facet + f * 3;
    const double *x = surface->vertex + (int64_t)facet[k] * 3;
    double one[3], other[3], cross[3];
    vector_subtract(3, surface->vertex + (int64_t)facet[(k + 1) % 3] * 3, x, one);
    vector_subtract(3, surface->vertex + (int64_t)facet[(k + 2) % 3] * 3, x, other);
    vector_cross(one, other, cross);
    return atan2(vector_length(3, cross), vector_dot(3, one, other));
}

void rigid_weigh_normals(struct rigid_surface *surface)
{
    int dim = surface->dim;
    memset(surface->vertex_normal, 0, (size_t)(surface->vertex_count * dim) * sizeof(double));
    for (int64_t c = 0; c < surface->facet_count * dim; c++) {
        add_scaled(dim, corner_angle(surface, c / dim, (int)(c % dim)), surface->normal + c / dim * dim,
                   surface->vertex_normal + (int64_t)surface->facet[c] * dim);
    }
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        vector_normalise(dim, surface->vertex_normal + v * dim);
    }
}

enum status rigid_make_pseudo_normals(struct rigid_surface *surface, struct error *error)
{
    int dim = surface->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&surface->vertex_normal, surface->vertex_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->is_rim, surface->vertex_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->turn, surface->vertex_count, error));
    RETURN_IF_ERROR(join_ridges(surface, error));
    rigid_weigh_normals(surface);
    for (int64_t c = 0; c < surface->facet_count * dim; c++) {
        int64_t vertex = surface->facet[c];
        const double *mean = surface->vertex_normal + vertex * dim;
        const double *normal = surface->normal + c / dim * dim;
        double half = 0.5 * vector_distance(dim, mean, normal);
        surface->turn[vertex] = fmax(surface->turn[vertex], 2.0 * asin(fmin(half, 1.0)));
    }
    return STATUS_OK;
}
