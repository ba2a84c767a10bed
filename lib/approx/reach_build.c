/* Preparation of a body for queries of reach: facets, re-entrant corners, and which nodes see which. */
#include "approx/reach_private.h"

#include "approx/parts.h"
#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

enum status pair_list_reserve(struct pair_list *pairs, int64_t more, struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&pairs->row, pairs->count + more, &pairs->row_capacity, error));
    return GROW_ARRAY(&pairs->value, pairs->count + more, &pairs->capacity, error);
}

enum status pair_list_append(struct pair_list *pairs, const struct pair_list *more, struct error *error)
{
    RETURN_IF_ERROR(pair_list_reserve(pairs, more->count, error));
    for (int64_t i = 0; i < more->count; i++) {
        pair_list_add(pairs, more->row[i], more->value[i]);
    }
    return STATUS_OK;
}

enum status pair_list_file(const struct pair_list *pairs, int64_t rows, int64_t **ptr, int32_t **idx,
                           struct error *error)
{
    RETURN_IF_ERROR(lists_by_row(pairs->count, 1, pairs->row, rows, ptr, idx, error));
    for (int64_t i = 0; i < pairs->count; i++) {
        (*idx)[i] = pairs->value[(*idx)[i]];
    }
    return STATUS_OK;
}

void pair_list_free(struct pair_list *pairs)
{
    FREE_ALL(pairs->row, pairs->value);
}

/* The dual of the edges from the first vertex, within the facet. */
static void set_dual(const struct reach *reach, struct reach_facet *facet)
{
    int dim = reach->cells.dim;
    double edge[2][3] = {{0.0}};
    const double *first = reach->cells.x + (int64_t)facet->node[0] * dim;
    for (int k = 0; k < dim - 1; k++) {
        vector_subtract(dim, reach->cells.x + (int64_t)facet->node[k + 1] * dim, first, edge[k]);
    }
    double first2 = vector_dot(dim, edge[0], edge[0]), product = vector_dot(dim, edge[0], edge[1]);
    double second2 = dim == 2 ? 1.0 : vector_dot(dim, edge[1], edge[1]);
    double determinant = first2 * second2 - product * product;
    for (int a = 0; a < dim; a++) {
        facet->dual[0][a] = (second2 * edge[0][a] - product * edge[1][a]) / determinant;
        facet->dual[1][a] = (first2 * edge[1][a] - product * edge[0][a]) / determinant;
    }
    facet->from[0] = vector_dot(dim, facet->dual[0], first);
    facet->from[1] = vector_dot(dim, facet->dual[1], first);
}

static enum status set_facets(const struct faces *faces, struct reach *reach, struct error *error)
{
    int dim = reach->cells.dim;
    RETURN_IF_ERROR(NEW_ARRAY(&reach->facet, faces->count, error));
    reach->facet_count = faces->count;
    for (int64_t f = 0; f < faces->count; f++) {
        struct reach_facet *facet = &reach->facet[f];
        double area[3] = {0.0, 0.0, 0.0};
        memcpy(facet->node, faces->node + f * dim, (size_t)dim * sizeof *facet->node);
        facet->cell = faces->cell[2 * f];
        face_area_vector(dim, reach->cells.x, facet->node, area);
        double size = vector_length(3, area);
        for (int a = 0; a < dim; a++) {
            facet->normal[a] = area[a] / size;
        }
        facet->offset = vector_dot(dim, facet->normal, reach->cells.x + (int64_t)facet->node[0] * dim);
        vector_middle(dim, reach->cells.x, dim, facet->node, facet->middle);
        for (int k = 0; k < dim; k++) {
            const double *vertex = reach->cells.x + (int64_t)facet->node[k] * dim;
            facet->radius = fmax(facet->radius, vector_distance(dim, facet->middle, vertex) * (1.0 + 1e-6));
        }
        set_dual(reach, facet);
    }
    return STATUS_OK;
}

static bool is_of_facet(int dim, const struct reach_facet *facet, int32_t node)
{
    return facet->node[0] == node || facet->node[1] == node || (dim == 3 && facet->node[2] == node);
}

/* The shadows: of nodes whose supports reach a facet and that are beyond it, or on it without being its own.
 */
static enum status list_shadows(struct reach *reach, struct error *error)
{
    FREED_BY(index_list_free) struct index_list near = {0};
    int dim = reach->cells.dim;
    RETURN_IF_ERROR(NEW_ARRAY(&reach->shadowed, reach->cells.node_count, error));
    for (int64_t f = 0; f < reach->facet_count; f++) {
        const struct reach_facet *facet = &reach->facet[f];
        struct box box = box_of_nodes(dim, reach->cells.x, facet->node, dim);
        near.count = 0;
        RETURN_IF_ERROR(point_grid_query_box(reach->grid, box.low, box.high, 1.0, &near, error));
        RETURN_IF_ERROR(
            GROW_ARRAY(&reach->shadow, reach->shadow_count + near.count, &reach->shadow_capacity, error));
        for (int64_t i = 0; i < near.count; i++) {
            int32_t node = near.index[i];
            const double *x = reach->cells.x + (int64_t)node * dim;
            double height = reach_height_above(dim, facet, x),
                   tolerance = REACH_ON_PLANE * reach->grid->radius[node];
            if (height > tolerance || (height >= -tolerance && !is_of_facet(dim, facet, node) &&
                                       vector_distance(dim, facet->middle, x) <= facet->radius)) {
                reach->shadow[reach->shadow_count++] = (struct reach_shadow){(int32_t)f, node};
                reach->shadowed[node] = true;
            }
        }
    }
    return STATUS_OK;
}

/* Whether the cells at a node hang together by faces at it. */
static enum status hangs_together(const struct reach *reach, int32_t node, struct reach_work *work,
                                  bool *together, struct error *error)
{
    const double *x = reach->cells.x + (int64_t)node * reach->cells.dim;
    enum status status =
        reach_walk(reach, x, reach->star + reach->star_ptr[node], 1, -1, work, together, error);
    int64_t met = 0;
    for (int64_t i = 0; status == STATUS_OK && i < work->visited.count; i++) {
        const int32_t *v = reach->cells.node + (int64_t)work->visited.index[i] * (reach->cells.dim + 1);
        for (int k = 0; k <= reach->cells.dim; k++) {
            met += v[k] == node;
        }
    }
    *together = met == reach->star_ptr[node + 1] - reach->star_ptr[node];
    return status;
}

/* Whether the body's angle between two facets is larger than a straight one: up to a full turn, where they
 * lie on each other. */
static bool is_reentrant(const struct reach *reach, const struct ridge *first, const struct ridge *second)
{
    int dim = reach->cells.dim;
    const double *ridge = reach->cells.x + (int64_t)first->node[0] * dim;
    const double *ends[2] = {reach->cells.x + (int64_t)first->opposite * dim,
                             reach->cells.x + (int64_t)second->opposite * dim};
    double height = reach_height_above(dim, &reach->facet[first->facet], ends[1]);
    double tolerance = REACH_ON_PLANE * reach->grid->radius[first->node[0]], u[2][3], along[2][2] = {{0.0}};
    double edge[3] = {0.0, 0.0, 0.0}, product = 0.0;
    if (fabs(height) > tolerance) {
        return height > 0.0;
    }
    /* In one plane: on the same side of the ridge? */
    for (int a = 0; a < dim; a++) {
        u[0][a] = ends[0][a] - ridge[a];
        u[1][a] = ends[1][a] - ridge[a];
        edge[a] = dim == 3 ? reach->cells.x[(int64_t)first->node[1] * 3 + a] - ridge[a] : 0.0;
        product += u[0][a] * u[1][a];
        along[0][0] += u[0][a] * edge[a];
        along[1][0] += u[1][a] * edge[a];
        along[0][1] += edge[a] * edge[a];
    }
    if (dim == 3) {
        product -= along[0][0] * along[1][0] / along[0][1];
    }
    return product > 0.0;
}

/* Corners: nodes of re-entrant ridges. Where more than two facets meet the body only touches itself. */
static enum status find_corners(const struct faces *faces, struct reach *reach, struct reach_work *work,
                                struct error *error)
{
    FREED_BY(pair_list_free) struct pair_list edges = {0};
    SCRATCH struct ridge *ridges = NULL;
    int dim = reach->cells.dim;
    int64_t count = faces->count * dim;
    RETURN_IF_ERROR(NEW_ARRAY(&ridges, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&reach->corner, reach->cells.node_count, error));
    ridges_list(dim, faces->count, faces->node, ridges);
    for (int64_t i = 0, end; i < count; i = end) {
        end = ridges_end(count, ridges, i);
        int32_t a = ridges[i].node[0], b = ridges[i].node[1];
        if (end - i != 2 || !is_reentrant(reach, &ridges[i], &ridges[i + 1])) {
            continue;
        }
        reach->corner[a] = true;
        if (b >= 0) {
            reach->corner[b] = true;
            RETURN_IF_ERROR(pair_list_reserve(&edges, 2, error));
            pair_list_add(&edges, a, b);
            pair_list_add(&edges, b, a);
        }
    }
    for (int64_t n = 0; n < reach->cells.node_count; n++) {
        if (reach->corner[n]) {
            RETURN_IF_ERROR(hangs_together(reach, (int32_t)n, work, &reach->corner[n], error));
        }
    }
    return pair_list_file(&edges, reach->cells.node_count, &reach->edge_ptr, &reach->edge, error);
}

/* What each node sees and does not see of the others. */
static enum status file_views(struct reach *reach, struct reach_work *work, struct error *error)
{
    FREED_BY(pair_list_free) struct pair_list seen = {0}, hidden = {0};
    FREED_BY(reach_shadows_free) struct reach_shadows shadows = {0};
    FREED_BY(index_list_free) struct index_list near = {0};
    int dim = reach->cells.dim;
    const struct reach_places nodes = {.nodes = true};
    RETURN_IF_ERROR(
        reach_shadows_build(reach, reach->cells.node_count, reach->cells.x, NULL, 0, &shadows, error));
    for (int64_t n = 0; n < reach->cells.node_count; n++) {
        const double *x = reach->cells.x + n * dim;
        int64_t unused;
        if (!reach->corner[n] && shadows.ptr[n] == shadows.ptr[n + 1]) {
            continue;
        }
        near.count = 0;
        RETURN_IF_ERROR(point_grid_query(reach->grid, x, 1.0, &near, error));
        RETURN_IF_ERROR(reach_begin(reach, &nodes, n, x, work, error));
        RETURN_IF_ERROR(reach_mark_shadows(reach, &shadows, n, work, &unused, error));
        RETURN_IF_ERROR(pair_list_reserve(&seen, near.count, error));
        RETURN_IF_ERROR(pair_list_reserve(&hidden, near.count, error));
        for (int64_t i = 0; i < near.count; i++) {
            if (reach_is_hidden(work, near.index[i])) {
                pair_list_add(&hidden, (int32_t)n, near.index[i]);
            } else if (reach->corner[n] && near.index[i] != n) {
                pair_list_add(&seen, near.index[i], (int32_t)n);
            }
        }
    }
    RETURN_IF_ERROR(
        pair_list_file(&hidden, reach->cells.node_count, &reach->hidden_ptr, &reach->hidden, error));
    RETURN_IF_ERROR(pair_list_file(&seen, reach->cells.node_count, &reach->seen_ptr, &reach->seen, error));
    RETURN_IF_ERROR(NEW_ARRAY(&reach->seen_length, seen.count, error));
    for (int64_t n = 0; n < reach->cells.node_count; n++) {
        for (int64_t i = reach->seen_ptr[n]; i < reach->seen_ptr[n + 1]; i++) {
            reach->seen_length[i] = vector_distance(dim, reach->cells.x + (int64_t)reach->seen[i] * dim,
                                                    reach->cells.x + n * dim);
        }
    }
    return STATUS_OK;
}

enum status reach_build_cells(const struct cells *cells, struct reach *reach, struct error *error)
{
    *reach = (struct reach){.cells = *cells};
    RETURN_IF_ERROR(NEW_ARRAY(&reach->across, cells->count * (cells->dim + 1), error));
    RETURN_IF_ERROR(cells_across(cells, reach->across, error));
    return lists_by_row(cells->count, cells->dim + 1, cells->node, cells->node_count, &reach->star_ptr,
                        &reach->star, error);
}

enum status reach_build(const struct cells *cells, const struct point_grid *grid, struct reach *reach,
                        struct error *error)
{
    FREED_BY(faces_free) struct faces faces = {0};
    FREED_BY(reach_work_free) struct reach_work work = {0};
    RETURN_IF_ERROR(reach_build_cells(cells, reach, error));
    reach->grid = grid;
    RETURN_IF_ERROR(faces_build(cells, true, &faces, error));
    RETURN_IF_ERROR(set_facets(&faces, reach, error));
    RETURN_IF_ERROR(list_shadows(reach, error));
    RETURN_IF_ERROR(find_corners(&faces, reach, &work, error));
    return file_views(reach, &work, error);
}
