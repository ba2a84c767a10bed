#include "approx/select.h"

#include "approx/cells.h"
#include "approx/point_grid.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

static double dot(int dim, const double *a, const double *b)
{
    double sum = 0;
    for (int k = 0; k < dim; k++) {
        sum += a[k] * b[k];
    }
    return sum;
}

static bool contains(int dim, const struct shape *shape, const double *point)
{
    double from[3];
    double reach = shape->size + shape->slack;
    for (int k = 0; k < dim; k++) {
        from[k] = point[k] - shape->a[k];
    }
    switch (shape->kind) {
    case SHAPE_BOX:
        for (int k = 0; k < dim; k++) {
            if (point[k] < shape->a[k] - shape->slack || point[k] > shape->b[k] + shape->slack) {
                return false;
            }
        }
        return true;
    case SHAPE_BALL:
        return dot(dim, from, from) <= reach * reach;
    default: {
        double height = dot(dim, from, shape->b) / sqrt(dot(dim, shape->b, shape->b));
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
        chosen[i] = dot(dim, normal, direction) >=
                    least * sqrt(dot(dim, normal, normal) * dot(dim, direction, direction));
    }
}

/* ---- distances ---- */

static double clamp(double value)
{
    return fmin(fmax(value, 0), 1);
}

/* Squared distance of `to` to the segment 0, u. */
static double segment_square(int dim, const double *u, const double *to)
{
    double length = dot(dim, u, u);
    double t = length > 0 ? clamp(dot(dim, u, to) / length) : 0;
    double sum = 0;
    for (int k = 0; k < dim; k++) {
        sum += (to[k] - t * u[k]) * (to[k] - t * u[k]);
    }
    return sum;
}

/* Squared distance of `to` to the triangle 0, u, v in space: to its plane if that is met inside, else to its
 * edges. */
static double triangle_square(const double *u, const double *v, const double *to)
{
    double uu = dot(3, u, u);
    double uv = dot(3, u, v);
    double vv = dot(3, v, v);
    double ut = dot(3, u, to);
    double vt = dot(3, v, to);
    double determinant = uu * vv - uv * uv;
    double s = (vv * ut - uv * vt) / determinant;
    double t = (uu * vt - uv * ut) / determinant;
    double sum = 0;
    if (s >= 0 && t >= 0 && s + t <= 1) {
        for (int k = 0; k < 3; k++) {
            double d = to[k] - s * u[k] - t * v[k];
            sum += d * d;
        }
        return sum;
    }
    double w[3], from_u[3];
    for (int k = 0; k < 3; k++) {
        w[k] = v[k] - u[k];
        from_u[k] = to[k] - u[k];
    }
    return fmin(fmin(segment_square(3, u, to), segment_square(3, v, to)), segment_square(3, w, from_u));
}

double piece_distance(const struct pieces *pieces, int64_t piece, const double *point)
{
    int dim = pieces->dim;
    const double *corner = pieces->x + piece * pieces->corners * dim;
    double to[3], u[3], v[3];
    for (int k = 0; k < dim; k++) {
        to[k] = point[k] - corner[k];
        u[k] = pieces->corners > 1 ? corner[dim + k] - corner[k] : 0;
        v[k] = pieces->corners > 2 ? corner[2 * dim + k] - corner[k] : 0;
    }
    return sqrt(pieces->corners > 2 ? triangle_square(u, v, to) : segment_square(dim, u, to));
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
            double square = 0;
            for (int k = 0; k < dim; k++) {
                square += (x[i * dim + k] - c[k]) * (x[i * dim + k] - c[k]);
            }
            farthest = fmax(farthest, sqrt(square));
        }
        radius[p] = (reach + farthest) * (1 + 1e-9);
    }
}

enum status items_near(const struct items *items, const struct pieces *pieces, double reach, bool *chosen,
                       struct error *error)
{
    enum status status;
    struct point_grid grid = {0};
    struct index_list candidates = {0};
    double *centre = NULL;
    double *radius = NULL;
    TRY(NEW_ARRAY(&centre, pieces->count * pieces->dim, error));
    TRY(NEW_ARRAY(&radius, pieces->count, error));
    circumscribe(pieces, reach, centre, radius);
    TRY(point_grid_build(&grid, pieces->dim, pieces->count, centre, radius, error));
    for (int64_t i = 0; i < items->count; i++) {
        double point[3];
        item_centre(items, i, point);
        candidates.count = 0;
        chosen[i] = false;
        TRY(point_grid_query(&grid, point, 1, &candidates, error));
        for (int64_t k = 0; k < candidates.count && !chosen[i]; k++) {
            chosen[i] = piece_distance(pieces, candidates.index[k], point) <= reach;
        }
    }
done:
    point_grid_free(&grid);
    free(candidates.index);
    free(centre);
    free(radius);
    return status;
}
