/* Preparation of the search for folds, on the body at rest; see folds.h. */
#include "solid/folds/folds.h"

#include "approx/cells/parts.h"
#include "base/keyed.h"
#include "base/memory.h"
#include "base/sets.h"
#include "solid/folds/folds_private.h"

#include <stdlib.h>
#include <string.h>

/* Facets belong to one plane support when the scalar product of their unit normals is at least 1 minus this.
 */
static const double plane_tolerance = 1e-6;

/* A free facet continues its support unless it turns back from it by more than this sine: that of 22.5
 * degrees. */
static const double least_turn = 0.382683;

static int compare_rings(const void *left, const void *right)
{
    return compare_numbers(2, ((const struct fold_ring *)left)->node,
                           ((const struct fold_ring *)right)->node);
}

/* The ring of a node (2D) or of an edge (3D) of a cell, -1 for none. */
static int32_t find_ring(const struct folds *folds, const int32_t *side)
{
    struct fold_ring key = {.node = {-1, -1}};
    sort_nodes(folds->input.dim - 1, side, key.node);
    const struct fold_ring *ring =
        bsearch(&key, folds->rings, (size_t)folds->ring_count, sizeof key, compare_rings);
    return ring != NULL ? (int32_t)(ring - folds->rings) : -1;
}

/* The corners (2D) or edges (3D) of a cell, which rings may go round, with the other corners; in a positive
 * order. */
static const int parts_2d[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
static const int parts_3d[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                   {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};

/* The corners of a cell, those of its part `part` % (3 or 6) first; of the cell `part` / (3 or 6). */
static void part_nodes(const struct fold_input *input, int64_t part, int32_t node[4])
{
    int dim = input->dim, parts = dim == 2 ? 3 : 6;
    const int *order = dim == 2 ? parts_2d[part % parts] : parts_3d[part % parts];
    for (int k = 0; k <= dim; k++) {
        node[k] = input->cell[part / parts * (dim + 1) + order[k]];
    }
}

/* The cells around each ring. */
static enum status list_cells(struct folds *folds, struct error *error)
{
    int corners = folds->input.dim + 1;
    int64_t count = folds->input.cell_count * (corners == 3 ? 3 : 6);
    SCRATCH int32_t *part = NULL;
    int32_t node[4];
    NEW_SCRATCH(int32_t, ring, count, error);
    for (int64_t i = 0; i < count; i++) {
        part_nodes(&folds->input, i, node);
        ring[i] = find_ring(folds, node);
    }
    RETURN_IF_ERROR(lists_by_row(count, 1, ring, folds->ring_count, &folds->ring_ptr, &part, error));
    count = folds->ring_ptr[folds->ring_count];
    RETURN_IF_ERROR(NEW_ARRAY(&folds->ring_cell, count * corners, error));
    for (int64_t i = 0; i < count; i++) {
        part_nodes(&folds->input, part[i], node);
        memcpy(folds->ring_cell + i * corners, node, (size_t)corners * sizeof *node);
    }
    return STATUS_OK;
}

static bool meet(const struct ridge *side, const struct ridge *next)
{
    return compare_numbers(2, side->node, next->node) == 0;
}

static enum status build_rings(struct folds *folds, const struct ridge *sides, struct error *error)
{
    int64_t count = folds->input.facet_count * folds->input.dim;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->rings, count, error));
    for (int64_t i = 0; i < count; i++) {
        if (i == 0 || !meet(&sides[i - 1], &sides[i])) {
            folds->rings[folds->ring_count++] = (struct fold_ring){
                .node = {sides[i].node[0], sides[i].node[1]}, .facet = sides[i].facet, .other = -1};
        } else {
            folds->rings[folds->ring_count - 1].other = sides[i].facet;
        }
    }
    return list_cells(folds, error);
}

/* Whether two facets lie in one plane at rest, turned the same way. */
static bool in_one_plane(const struct fold_input *input, int64_t f, int64_t g)
{
    double a[3], b[3];
    int dim = input->dim;
    face_area_vector(dim, input->x, input->facet + f * dim, a);
    face_area_vector(dim, input->x, input->facet + g * dim, b);
    double size = sqrt(vector_dot(dim, a, a) * vector_dot(dim, b, b));
    return vector_dot(dim, a, b) >= (1.0 - plane_tolerance) * size;
}

/* Held facets that meet in one plane are one support, numbered by its first facet. */
static enum status find_supports(struct folds *folds, const struct ridge *sides, struct error *error)
{
    const struct fold_input *input = &folds->input;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->support, input->facet_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->is_held, input->node_count, error));
    for (int64_t f = 0; f < input->facet_count; f++) {
        folds->support[f] = input->held[f] ? (int32_t)f : -1;
        for (int k = 0; k < input->dim && input->held[f]; k++) {
            folds->is_held[input->facet[f * input->dim + k]] = true;
        }
    }
    for (int64_t i = 1; i < input->facet_count * input->dim; i++) {
        int64_t f = sides[i - 1].facet, g = sides[i].facet;
        if (meet(&sides[i - 1], &sides[i]) && input->held[f] && input->held[g] && in_one_plane(input, f, g)) {
            set_join(folds->support, (int32_t)f, (int32_t)g);
        }
    }
    for (int64_t f = 0; f < input->facet_count; f++) {
        if (input->held[f]) {
            folds->support[f] = set_first(folds->support, (int32_t)f);
        }
    }
    return STATUS_OK;
}

/* Add the rim between a free facet, by its side, and a support, which meet in a node or an edge. */
static void add_rim(struct folds *folds, const struct ridge *side, int64_t support_facet)
{
    double reach;
    struct fold_rim rim = {.facet = side->facet,
                           .support_facet = support_facet,
                           .node = side->opposite,
                           .on_rim = side->node[0]};
    if (folds_rim_beyond(folds, &rim, folds->input.x, &reach) < -least_turn * reach) {
        folds->rims[folds->rim_count++] = rim;
    }
}

static enum status find_rims(struct folds *folds, const struct ridge *sides, struct error *error)
{
    const struct fold_input *input = &folds->input;
    int64_t count = input->facet_count * input->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->rims, 2 * count, error));
    folds_fill_planes(folds, input->x);
    for (int64_t i = 1; i < count; i++) {
        int64_t f = sides[i - 1].facet, g = sides[i].facet;
        if (meet(&sides[i - 1], &sides[i]) && input->held[f] != input->held[g]) {
            add_rim(folds, &sides[input->held[f] ? i : i - 1], input->held[f] ? f : g);
        }
    }
    return STATUS_OK;
}

static bool interpenetrates(const struct fold *fold)
{
    return fold->kind == FOLD_CREASE || fold->kind == FOLD_CROSSING || fold->kind == FOLD_WITHIN;
}

enum status folds_build(const struct fold_input *input, struct folds *folds, struct error *error)
{
    int64_t size = input->node_count * input->dim;
    *folds = (struct folds){.input = *input};
    struct box box = box_of(input->dim, input->node_count, input->x);
    folds->extent = box_diagonal(&box);
    RETURN_IF_ERROR(NEW_ARRAY(&folds->y, size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->upright, input->cell_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->boxes, input->facet_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->plane, input->facet_count * 7, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->found, ranks_count(input->ranks), error));
    NEW_SCRATCH(struct ridge, sides, input->facet_count * input->dim, error);
    ridges_list(input->dim, input->facet_count, input->facet, sides);
    RETURN_IF_ERROR(build_rings(folds, sides, error));
    RETURN_IF_ERROR(find_supports(folds, sides, error));
    RETURN_IF_ERROR(find_rims(folds, sides, error));
    NEW_SCRATCH(double, u, size, error);
    NEW_SCRATCH(bool, stopped, input->node_count, error);
    RETURN_IF_ERROR(folds_find_bodies(folds, error));
    struct fold at_rest = folds_find(folds, u, stopped);
    if (!interpenetrates(&at_rest) && folds->body_count > 1) {
        at_rest = FOLD_NOTHING;
        RETURN_IF_ERROR(folds_look_for_overlaps(folds, true, &at_rest, error));
    }
    if (interpenetrates(&at_rest)) {
        folds->at_rest = at_rest;
    }
    return STATUS_OK;
}

void folds_free(struct folds *folds)
{
    FREE_ALL(folds->rings, folds->ring_ptr, folds->ring_cell, folds->rims, folds->upright, folds->support,
             folds->is_held, folds->part, folds->node_part, folds->bodies, folds->y, folds->boxes,
             folds->plane, folds->found);
    *folds = (struct folds){0};
}
