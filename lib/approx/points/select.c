#include "approx/points/select.h"

#include "approx/points/point_grid.h"
#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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

/* ---- hanging nodes ---- */

/* A node lies on a facet if it is as near to it as this share of the facet's longest edge, and not as near to
 * a corner: files may give six digits of coordinates. */
static const double on_facet = 1e-4;

enum { JOINED = 1, APART = 2 };

/* The nodes of a boundary. */
struct search {
    const struct cells *cells;
    const struct faces *boundary;
    struct point_grid grid; /* of all nodes */
    struct index_list near;
    int64_t *face_ptr; /* the boundary faces at each node */
    int32_t *face_idx;
    bool *named; /* each boundary face */
};

static void search_free(struct search *search)
{
    point_grid_free(&search->grid);
    index_list_free(&search->near);
    FREE_ALL(search->face_ptr, search->face_idx, search->named);
}

/* Whether all nodes but one of a face are among corner[count]. */
static bool borders(int dim, const int32_t *face, int count, const int32_t *corner)
{
    int common = 0;
    for (int k = 0; k < dim; k++) {
        for (int l = 0; l < count; l++) {
            common += face[k] == corner[l];
        }
    }
    return common >= dim - 1;
}

/* Whether a node is on an edge of the facet, within `near`, that is an edge of a named facet as well: at the
 * rim of a slit's face, where the surface beyond may have no name. */
static bool is_on_rim(const struct search *search, int64_t facet, int32_t node, double near)
{
    int dim = search->cells->dim;
    const int32_t *corner = search->boundary->node + facet * dim;
    for (int k = 0; k < 3 && dim == 3; k++) {
        const int32_t edge[2] = {corner[k], corner[(k + 1) % 3]};
        const double *end[2] = {search->cells->x + (int64_t)edge[0] * 3,
                                search->cells->x + (int64_t)edge[1] * 3};
        bool rim = false;
        for (int64_t i = search->face_ptr[edge[0]]; i < search->face_ptr[edge[0] + 1]; i++) {
            int32_t other = search->face_idx[i];
            rim = rim ||
                  (search->named[other] && borders(3, search->boundary->node + (int64_t)other * 3, 2, edge));
        }
        if (rim && simplex_distance2(3, 1, end, search->cells->x + (int64_t)node * 3) <= near * near) {
            return true;
        }
    }
    return false;
}

/* Whether a node is on a named facet. */
static bool is_named(const struct search *search, int32_t node)
{
    bool any = false;
    for (int64_t i = search->face_ptr[node]; i < search->face_ptr[node + 1]; i++) {
        any = any || search->named[search->face_idx[i]];
    }
    return any;
}

/* Whether a facet is a face of a slit, and the node on another one. */
static bool is_lip(const struct search *search, int64_t facet, int32_t node, double near)
{
    return is_named(search, node) && (search->named[facet] || is_on_rim(search, facet, node, near));
}

/* Whether a node is near the facet as a corner of its cell, or of a facet beside it: of a flat one. */
static bool is_beside(const struct search *search, int64_t facet, int32_t node)
{
    int dim = search->cells->dim;
    const int32_t *corner = search->boundary->node + facet * dim;
    const int32_t *cell = search->cells->node + (int64_t)search->boundary->cell[2 * facet] * (dim + 1);
    for (int k = 0; k <= dim; k++) {
        if (cell[k] == node) {
            return true;
        }
    }
    for (int64_t i = search->face_ptr[node]; dim == 3 && i < search->face_ptr[node + 1]; i++) {
        if (borders(dim, search->boundary->node + (int64_t)search->face_idx[i] * dim, dim, corner)) {
            return true;
        }
    }
    return false;
}

/* Mark the nodes that hang on a facet. */
static enum status mark_hanging(struct search *search, int64_t facet, int32_t body[], int8_t mark[],
                                struct error *error)
{
    int dim = search->cells->dim;
    const int32_t *node = search->boundary->node + facet * dim;
    const double *corner[3];
    double longest = 0.0;
    for (int k = 0; k < dim; k++) {
        corner[k] = search->cells->x + (int64_t)node[k] * dim;
        for (int l = 0; l < k; l++) {
            longest = fmax(longest, vector_distance2(dim, corner[k], corner[l]));
        }
    }
    double near = on_facet * sqrt(longest);
    struct box box = box_of_nodes(dim, search->cells->x, node, dim);
    for (int a = 0; a < dim; a++) {
        box.low[a] -= near;
        box.high[a] += near;
    }
    search->near.count = 0;
    RETURN_IF_ERROR(point_grid_query_box(&search->grid, box.low, box.high, 1.0, &search->near, error));
    for (int64_t i = 0; i < search->near.count; i++) {
        int32_t n = search->near.index[i];
        const double *x = search->cells->x + (int64_t)n * dim;
        bool out = search->face_ptr[n + 1] == search->face_ptr[n];
        for (int k = 0; k < dim && !out; k++) {
            out = vector_distance2(dim, corner[k], x) <= near * near;
        }
        if (!out && simplex_distance2(dim, dim - 1, corner, x) <= near * near &&
            !is_beside(search, facet, n)) {
            bool one_body = set_first(body, n) == set_first(body, node[0]);
            mark[n] |= one_body && !is_lip(search, facet, n, near) ? JOINED : APART;
        }
    }
    return STATUS_OK;
}

/* Add the nodes behind a node at its place. */
static enum status find_coincident(struct search *search, int32_t node, int32_t body[],
                                   struct hanging_nodes *found, struct error *error)
{
    const double *x = search->cells->x + (int64_t)node * search->cells->dim;
    search->near.count = 0;
    RETURN_IF_ERROR(point_grid_query(&search->grid, x, 1.0, &search->near, error));
    for (int64_t i = 0; i < search->near.count; i++) {
        int32_t other = search->near.index[i];
        bool behind = other > node, one_body = set_first(body, node) == set_first(body, other);
        found->touching.count += behind && !one_body;
        if (behind && one_body && !is_named(search, node) && !is_named(search, other) &&
            found->twice.count++ == 0) {
            memcpy(found->twice.place, x, (size_t)search->cells->dim * sizeof *x);
        }
    }
    return STATUS_OK;
}

enum status cells_find_hanging(const struct cells *cells, int64_t named_count, const int32_t *named,
                               struct hanging_nodes *found, struct error *error)
{
    int dim = cells->dim;
    FREED_BY(faces_free) struct faces boundary = {0};
    FREED_BY(search_free) struct search search = {.cells = cells, .boundary = &boundary};
    struct box box = box_of(dim, cells->node_count, cells->x);
    *found = (struct hanging_nodes){0};
    RETURN_IF_ERROR(faces_build(cells, true, &boundary, error));
    RETURN_IF_ERROR(lists_by_row(boundary.count, dim, boundary.node, cells->node_count, &search.face_ptr,
                                 &search.face_idx, error));
    NEW_SCRATCH(double, radius, cells->node_count, error);
    for (int64_t n = 0; n < cells->node_count; n++) {
        radius[n] = fmax(ROUND_OFF * box_side(&box), 1e-100);
    }
    RETURN_IF_ERROR(point_grid_build(&search.grid, dim, cells->node_count, cells->x, radius, error));
    RETURN_IF_ERROR(NEW_ARRAY(&search.named, boundary.count, error));
    RETURN_IF_ERROR(faces_mark(&boundary, named_count, named, search.named, error));
    NEW_SCRATCH(int32_t, body, cells->node_count, error);
    NEW_SCRATCH(int8_t, mark, cells->node_count, error);
    set_join_cells(cells->node_count, cells->count, dim + 1, cells->node, body);
    for (int64_t f = 0; f < boundary.count; f++) {
        RETURN_IF_ERROR(mark_hanging(&search, f, body, mark, error));
    }
    for (int32_t n = 0; n < cells->node_count; n++) {
        bool joined = (mark[n] & JOINED) != 0;
        if (mark[n] != 0 && (joined ? found->joined.count++ : found->apart.count++) == 0) {
            memcpy(joined ? found->joined.place : found->apart.place, cells->x + (int64_t)n * dim,
                   (size_t)dim * sizeof(double));
        }
        RETURN_IF_ERROR(find_coincident(&search, n, body, found, error));
    }
    return STATUS_OK;
}
