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

void item_centre(const struct items *items, int64_t item, double *centre)
{
    for (int k = 0; k < items->dim; k++) {
        double sum = 0;
        for (int c = 0; c < items->corners; c++) {
            sum += items->x[(int64_t)items->item[item * items->corners + c] * items->dim + k];
        }
        centre[k] = sum / items->corners;
    }
}

void items_in_shape(const struct items *items, const struct shape *shape, bool *chosen)
{
    for (int64_t i = 0; i < items->count; i++) {
        double centre[3];
        item_centre(items, i, centre);
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

double piece_distance(const struct pieces *pieces, int64_t piece, const double *point)
{
    const double *corner[3];
    for (int k = 0; k < pieces->corners; k++) {
        corner[k] = pieces->x + (piece * pieces->corners + k) * pieces->dim;
    }
    return sqrt(simplex_distance2(pieces->dim, pieces->corners - 1, corner, point));
}

/* Balls of radius `reach` and that of each piece around the pieces: those that contain a point are
 * candidates.
 */
static void circumscribe(const struct pieces *pieces, double reach, double *centre, double *radius)
{
    int dim = pieces->dim;
    for (int64_t p = 0; p < pieces->count; p++) {
        const double *x = pieces->x + p * pieces->corners * dim;
        double *c = centre + p * dim;
        double farthest = 0;
        for (int k = 0; k < dim; k++) {
            for (int i = 0; i < pieces->corners; i++) {
                c[k] += x[i * dim + k] / pieces->corners;
            }
        }
        for (int i = 0; i < pieces->corners; i++) {
            farthest = fmax(farthest, vector_distance(dim, x + i * dim, c));
        }
        radius[p] = (reach + farthest) * (1 + 1e-9);
    }
}

enum status items_near(const struct items *items, const struct pieces *pieces, double reach, bool *chosen,
                       struct error *error)
{
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(index_list_free) struct index_list candidates = {0};
    NEW_SCRATCH(double, centre, pieces->count * pieces->dim, error);
    NEW_SCRATCH(double, radius, pieces->count, error);
    circumscribe(pieces, reach, centre, radius);
    RETURN_IF_ERROR(point_grid_build(&grid, pieces->dim, pieces->count, centre, radius, error));
    for (int64_t i = 0; i < items->count; i++) {
        double point[3];
        item_centre(items, i, point);
        candidates.count = 0;
        chosen[i] = false;
        RETURN_IF_ERROR(point_grid_query(&grid, point, 1, &candidates, error));
        for (int64_t k = 0; k < candidates.count && !chosen[i]; k++) {
            chosen[i] = piece_distance(pieces, candidates.index[k], point) <= reach;
        }
    }
    return STATUS_OK;
}
