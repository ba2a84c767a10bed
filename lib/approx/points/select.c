#include "approx/points/select.h"

#include "approx/cells/cells.h"
#include "approx/points/point_grid.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

static bool contains(int dim, const struct shape *shape, const double *point)
{
    double from[3];
    double reach = shape->size + shape->slack;
    vector_subtract(dim, point, shape->a, from);
    switch (shape->kind) {
    case SHAPE_BOX:
        for (int k = 0; k < dim; k++) {
            if (point[k] < shape->a[k] - shape->slack || point[k] > shape->b[k] + shape->slack) {
                return false;
            }
        }
        return true;
    case SHAPE_BALL:
        return vector_dot(dim, from, from) <= reach * reach;
    default: {
        double height = vector_dot(dim, from, shape->b) / vector_length(dim, shape->b);
        return shape->kind == SHAPE_HALF ? height >= -shape->slack : fabs(height) <= reach;
    }
    }
}

void items_in_shape(const struct items *items, const struct shape *shape, bool *chosen)
{
    for (int64_t i = 0; i < items->count; i++) {
        double centre[3];
        vector_middle(items->dim, items->x, items->corners, items->item + i * items->corners, centre);
        chosen[i] = shape->kind == SHAPE_PLANE || contains(items->dim, shape, centre);
        for (int c = 0; c < items->corners && shape->kind == SHAPE_PLANE; c++) {
            int32_t node = items->item[i * items->corners + c];
            chosen[i] = chosen[i] && contains(items->dim, shape, items->x + (int64_t)node * items->dim);
        }
    }
}

void items_facing(const struct items *items, const double *direction, double degrees, bool *chosen)
{
    int dim = items->dim;
    double least = cos(degrees * acos(-1) / 180) - 1e-12;
    for (int64_t i = 0; i < items->count; i++) {
        double normal[3];
        face_area_vector(dim, items->x, items->item + i * dim, normal);
        chosen[i] = vector_dot(dim, normal, direction) >=
                    least * sqrt(vector_dot(dim, normal, normal) * vector_dot(dim, direction, direction));
    }
}

/* ---- distances ---- */

static void find_corners(const struct items *items, int64_t item, const double *corner[4])
{
    for (int k = 0; k < items->corners; k++) {
        int64_t at = item * items->corners + k;
        corner[k] = items->x + (items->item != NULL ? items->item[at] : at) * items->dim;
    }
}

/* Balls around the items that hold all points within their reach: those that contain a point are
 * candidates. */
static void enclose(const struct items *items, const double *reach, double *centre, double *radius)
{
    int dim = items->dim;
    for (int64_t p = 0; p < items->count; p++) {
        const double *corner[4];
        double farthest = 0;
        find_corners(items, p, corner);
        for (int i = 0; i < items->corners; i++) {
            add_scaled(dim, 1.0 / items->corners, corner[i], centre + p * dim);
        }
        for (int i = 0; i < items->corners; i++) {
            farthest = fmax(farthest, vector_distance(dim, corner[i], centre + p * dim));
        }
        radius[p] = (reach[p] + farthest) * (1 + 1e-9);
    }
}

enum status items_nearest(const struct items *items, const double *reach, int64_t count, const double *points,
                          int64_t *nearest, struct error *error)
{
    int dim = items->dim;
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(index_list_free) struct index_list near = {0};
    NEW_SCRATCH(double, centre, items->count * dim, error);
    NEW_SCRATCH(double, radius, items->count, error);
    enclose(items, reach, centre, radius);
    RETURN_IF_ERROR(point_grid_build(&grid, dim, items->count, centre, radius, error));
    for (int64_t p = 0; p < count; p++) {
        double least = INFINITY;
        near.count = 0;
        nearest[p] = -1;
        RETURN_IF_ERROR(point_grid_query(&grid, points + p * dim, 1, &near, error));
        for (int64_t i = 0; i < near.count && least > 0; i++) {
            const double *corner[4];
            find_corners(items, near.index[i], corner);
            double distance = sqrt(simplex_distance2(dim, items->corners - 1, corner, points + p * dim));
            if (distance <= reach[near.index[i]] && distance < least) {
                least = distance;
                nearest[p] = near.index[i];
            }
        }
    }
    return STATUS_OK;
}

enum status items_near(const struct items *items, const struct items *others, double reach, bool *chosen,
                       struct error *error)
{
    NEW_SCRATCH(double, centre, items->count * items->dim, error);
    NEW_SCRATCH(double, reaches, others->count, error);
    NEW_SCRATCH(int64_t, nearest, items->count, error);
    for (int64_t p = 0; p < others->count; p++) {
        reaches[p] = reach;
    }
    for (int64_t i = 0; i < items->count; i++) {
        vector_middle(items->dim, items->x, items->corners, items->item + i * items->corners,
                      centre + i * items->dim);
    }
    RETURN_IF_ERROR(items_nearest(others, reaches, items->count, centre, nearest, error));
    for (int64_t i = 0; i < items->count; i++) {
        chosen[i] = nearest[i] >= 0;
    }
    return STATUS_OK;
}
