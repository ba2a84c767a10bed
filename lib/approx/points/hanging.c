#include "approx/points/hanging.h"

#include "approx/points/point_grid.h"
#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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

/* Whether a facet is a face of a slit, and the node on another one. */
static bool is_lip(const struct search *search, int64_t facet, int32_t node, double near)
{
    bool other = false;
    for (int64_t i = search->face_ptr[node]; i < search->face_ptr[node + 1]; i++) {
        other = other || search->named[search->face_idx[i]];
    }
    return other && (search->named[facet] || is_on_rim(search, facet, node, near));
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

enum status cells_find_hanging(const struct cells *cells, int64_t named_count, const int32_t *named,
                               struct hanging_nodes *joined, struct hanging_nodes *apart, struct error *error)
{
    int dim = cells->dim;
    FREED_BY(faces_free) struct faces boundary = {0};
    FREED_BY(search_free) struct search search = {.cells = cells, .boundary = &boundary};
    struct box box = box_of(dim, cells->node_count, cells->x);
    *joined = *apart = (struct hanging_nodes){0};
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
    for (int64_t n = 0; n < cells->node_count; n++) {
        struct hanging_nodes *of = (mark[n] & JOINED) != 0 ? joined : apart;
        if (mark[n] != 0 && of->count++ == 0) {
            memcpy(of->place, cells->x + n * dim, (size_t)dim * sizeof *of->place);
        }
    }
    return STATUS_OK;
}
