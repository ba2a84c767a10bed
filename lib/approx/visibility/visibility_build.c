/* Preparation of a body for visibility queries: facets, re-entrant corners, and the nodes visible from each
 * node. */
#include "approx/visibility/visibility_private.h"

#include "approx/cells/parts.h"
#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"
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
static void set_dual(const struct visibility *visibility, struct visibility_facet *facet)
{
    int dim = visibility->cells.dim;
    double edge[2][3] = {{0.0}};
    const double *first = visibility->cells.x + (int64_t)facet->node[0] * dim;
    for (int k = 0; k < dim - 1; k++) {
        vector_subtract(dim, visibility->cells.x + (int64_t)facet->node[k + 1] * dim, first, edge[k]);
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

static enum status set_facets(const struct faces *faces, struct visibility *visibility, struct error *error)
{
    int dim = visibility->cells.dim;
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->facet, faces->count, error));
    visibility->facet_count = faces->count;
    for (int64_t f = 0; f < faces->count; f++) {
        struct visibility_facet *facet = &visibility->facet[f];
        double area[3] = {0.0, 0.0, 0.0};
        memcpy(facet->node, faces->node + f * dim, (size_t)dim * sizeof *facet->node);
        facet->cell = faces->cell[2 * f];
        face_area_vector(dim, visibility->cells.x, facet->node, area);
        double size = vector_length(3, area);
        for (int a = 0; a < dim; a++) {
            facet->normal[a] = area[a] / size;
        }
        facet->offset = vector_dot(dim, facet->normal, visibility->cells.x + (int64_t)facet->node[0] * dim);
        vector_middle(dim, visibility->cells.x, dim, facet->node, facet->middle);
        for (int k = 0; k < dim; k++) {
            const double *vertex = visibility->cells.x + (int64_t)facet->node[k] * dim;
            facet->radius = fmax(facet->radius, vector_distance(dim, facet->middle, vertex) * (1.0 + 1e-6));
        }
        set_dual(visibility, facet);
    }
    return STATUS_OK;
}

static bool is_of_facet(int dim, const struct visibility_facet *facet, int32_t node)
{
    return facet->node[0] == node || facet->node[1] == node || (dim == 3 && facet->node[2] == node);
}

/* Whether a node and a facet are of two bodies. */
static bool are_apart(const struct visibility *visibility, const struct visibility_facet *facet, int32_t node)
{
    const int32_t *part = visibility->part;
    return part != NULL && part[node] >= 0 && part[facet->node[0]] >= 0 && part[node] != part[facet->node[0]];
}

/* List the shadows: of nodes of its body whose supports reach a facet and that are beyond it, or on it but
 * not nodes of it. */
static enum status list_shadows(struct visibility *visibility, struct error *error)
{
    FREED_BY(index_list_free) struct index_list near = {0};
    int dim = visibility->cells.dim;
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->shadowed, visibility->cells.node_count, error));
    for (int64_t f = 0; f < visibility->facet_count; f++) {
        const struct visibility_facet *facet = &visibility->facet[f];
        struct box box = box_of_nodes(dim, visibility->cells.x, facet->node, dim);
        near.count = 0;
        RETURN_IF_ERROR(point_grid_query_box(visibility->grid, box.low, box.high, 1.0, &near, error));
        RETURN_IF_ERROR(GROW_ARRAY(&visibility->shadow, visibility->shadow_count + near.count,
                                   &visibility->shadow_capacity, error));
        for (int64_t i = 0; i < near.count; i++) {
            int32_t node = near.index[i];
            if (are_apart(visibility, facet, node)) {
                continue;
            }
            const double *x = visibility->cells.x + (int64_t)node * dim;
            double height = visibility_height_above(dim, facet, x),
                   tolerance = COARSE_ROUND_OFF * visibility->grid->radius[node];
            if (height > tolerance || (height >= -tolerance && !is_of_facet(dim, facet, node) &&
                                       vector_distance(dim, facet->middle, x) <= facet->radius)) {
                visibility->shadow[visibility->shadow_count++] = (struct visibility_shadow){(int32_t)f, node};
                visibility->shadowed[node] = true;
            }
        }
    }
    return STATUS_OK;
}

/* *together: whether the cells at a node are connected by faces at the node. */
static enum status hangs_together(const struct visibility *visibility, int32_t node,
                                  struct visibility_work *work, bool *together, struct error *error)
{
    const double *x = visibility->cells.x + (int64_t)node * visibility->cells.dim;
    enum status status = visibility_walk(visibility, x, visibility->star + visibility->star_ptr[node], 1, -1,
                                         work, together, error);
    int64_t met = 0;
    for (int64_t i = 0; status == STATUS_OK && i < work->visited.count; i++) {
        const int32_t *v =
            visibility->cells.node + (int64_t)work->visited.index[i] * (visibility->cells.dim + 1);
        for (int k = 0; k <= visibility->cells.dim; k++) {
            met += v[k] == node;
        }
    }
    *together = met == visibility->star_ptr[node + 1] - visibility->star_ptr[node];
    return status;
}

/* Whether the interior angle between two facets is larger than 180 degrees; it is 360 if they coincide. */
static bool is_reentrant(const struct visibility *visibility, const struct ridge *first,
                         const struct ridge *second)
{
    int dim = visibility->cells.dim;
    const double *ridge = visibility->cells.x + (int64_t)first->node[0] * dim;
    const double *ends[2] = {visibility->cells.x + (int64_t)first->opposite * dim,
                             visibility->cells.x + (int64_t)second->opposite * dim};
    double height = visibility_height_above(dim, &visibility->facet[first->facet], ends[1]);
    double tolerance = COARSE_ROUND_OFF * visibility->grid->radius[first->node[0]], u[2][3],
           along[2][2] = {{0.0}};
    double edge[3] = {0.0, 0.0, 0.0}, product = 0.0;
    if (fabs(height) > tolerance) {
        return height > 0.0;
    }
    /* In one plane: on the same side of the ridge? */
    for (int a = 0; a < dim; a++) {
        u[0][a] = ends[0][a] - ridge[a];
        u[1][a] = ends[1][a] - ridge[a];
        edge[a] = dim == 3 ? visibility->cells.x[(int64_t)first->node[1] * 3 + a] - ridge[a] : 0.0;
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

/* Find the corners: nodes of re-entrant ridges. Where more than two facets meet, the body only touches
 * itself. */
static enum status find_corners(const struct faces *faces, struct visibility *visibility,
                                struct visibility_work *work, struct error *error)
{
    FREED_BY(pair_list_free) struct pair_list edges = {0};
    int dim = visibility->cells.dim;
    int64_t count = faces->count * dim;
    NEW_SCRATCH(struct ridge, ridges, count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->corner, visibility->cells.node_count, error));
    ridges_list(dim, faces->count, faces->node, ridges);
    for (int64_t i = 0, end; i < count; i = end) {
        end = ridges_end(count, ridges, i);
        int32_t a = ridges[i].node[0], b = ridges[i].node[1];
        if (end - i != 2 || !is_reentrant(visibility, &ridges[i], &ridges[i + 1])) {
            continue;
        }
        visibility->corner[a] = true;
        if (b >= 0) {
            visibility->corner[b] = true;
            RETURN_IF_ERROR(pair_list_reserve(&edges, 2, error));
            pair_list_add(&edges, a, b);
            pair_list_add(&edges, b, a);
        }
    }
    for (int64_t n = 0; n < visibility->cells.node_count; n++) {
        if (visibility->corner[n]) {
            RETURN_IF_ERROR(hangs_together(visibility, (int32_t)n, work, &visibility->corner[n], error));
        }
    }
    return pair_list_file(&edges, visibility->cells.node_count, &visibility->edge_ptr, &visibility->edge,
                          error);
}

/* List the nodes that each node sees, and those hidden from it. */
static enum status file_views(struct visibility *visibility, struct visibility_work *work,
                              struct error *error)
{
    FREED_BY(pair_list_free) struct pair_list seen = {0}, hidden = {0};
    FREED_BY(visibility_shadows_free) struct visibility_shadows shadows = {0};
    FREED_BY(index_list_free) struct index_list near = {0};
    int dim = visibility->cells.dim;
    const struct visibility_places nodes = {.nodes = true};
    RETURN_IF_ERROR(visibility_shadows_build(visibility, visibility->cells.node_count, visibility->cells.x,
                                             NULL, 0, &shadows, error));
    for (int64_t n = 0; n < visibility->cells.node_count; n++) {
        const double *x = visibility->cells.x + n * dim;
        int64_t unused;
        if (!visibility->corner[n] && shadows.ptr[n] == shadows.ptr[n + 1]) {
            continue;
        }
        near.count = 0;
        RETURN_IF_ERROR(point_grid_query(visibility->grid, x, 1.0, &near, error));
        RETURN_IF_ERROR(visibility_begin(visibility, &nodes, n, x, work, error));
        RETURN_IF_ERROR(visibility_mark_shadows(visibility, &shadows, n, work, &unused, error));
        RETURN_IF_ERROR(pair_list_reserve(&seen, near.count, error));
        RETURN_IF_ERROR(pair_list_reserve(&hidden, near.count, error));
        for (int64_t i = 0; i < near.count; i++) {
            if (visibility_is_hidden(work, near.index[i])) {
                pair_list_add(&hidden, (int32_t)n, near.index[i]);
            } else if (visibility->corner[n] && near.index[i] != n) {
                pair_list_add(&seen, near.index[i], (int32_t)n);
            }
        }
    }
    RETURN_IF_ERROR(pair_list_file(&hidden, visibility->cells.node_count, &visibility->hidden_ptr,
                                   &visibility->hidden, error));
    RETURN_IF_ERROR(
        pair_list_file(&seen, visibility->cells.node_count, &visibility->seen_ptr, &visibility->seen, error));
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->seen_length, seen.count, error));
    for (int64_t n = 0; n < visibility->cells.node_count; n++) {
        for (int64_t i = visibility->seen_ptr[n]; i < visibility->seen_ptr[n + 1]; i++) {
            visibility->seen_length[i] = vector_distance(
                dim, visibility->cells.x + (int64_t)visibility->seen[i] * dim, visibility->cells.x + n * dim);
        }
    }
    return STATUS_OK;
}

enum status visibility_build_cells(const struct cells *cells, struct visibility *visibility,
                                   struct error *error)
{
    *visibility = (struct visibility){.cells = *cells};
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->across, cells->count * (cells->dim + 1), error));
    RETURN_IF_ERROR(cells_across(cells, visibility->across, error));
    return lists_by_row(cells->count, cells->dim + 1, cells->node, cells->node_count, &visibility->star_ptr,
                        &visibility->star, error);
}

/* Set part[]: cells with a common face are of one body. */
static enum status find_bodies(struct visibility *visibility, struct error *error)
{
    const struct cells *cells = &visibility->cells;
    int corners = cells->dim + 1;
    bool several = false;
    NEW_SCRATCH(int32_t, of_cell, cells->count, error);
    for (int64_t c = 0; c < cells->count; c++) {
        of_cell[c] = (int32_t)c;
    }
    for (int64_t s = 0; s < cells->count * corners; s++) {
        if (visibility->across[s] >= 0) {
            set_join(of_cell, (int32_t)(s / corners), visibility->across[s]);
        }
    }
    for (int64_t c = 0; c < cells->count; c++) {
        of_cell[c] = set_first(of_cell, (int32_t)c);
        several = several || of_cell[c] != of_cell[0];
    }
    if (!several) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->part, cells->node_count, error));
    return nodes_parts(cells, of_cell, visibility->part, error);
}

enum status visibility_build(const struct cells *cells, const struct point_grid *grid,
                             struct visibility *visibility, struct error *error)
{
    FREED_BY(faces_free) struct faces faces = {0};
    FREED_BY(visibility_work_free) struct visibility_work work = {0};
    RETURN_IF_ERROR(visibility_build_cells(cells, visibility, error));
    visibility->grid = grid;
    RETURN_IF_ERROR(find_bodies(visibility, error));
    RETURN_IF_ERROR(faces_build(cells, true, &faces, error));
    RETURN_IF_ERROR(set_facets(&faces, visibility, error));
    RETURN_IF_ERROR(list_shadows(visibility, error));
    RETURN_IF_ERROR(find_corners(&faces, visibility, &work, error));
    return file_views(visibility, &work, error);
}
