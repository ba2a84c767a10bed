/* Preparation of the search for folds, on the body at rest; see folds.h. */
#include "solid/folds/folds.h"

#include "approx/cells/parts.h"
#include "base/keyed.h"
#include "base/memory.h"
#include "solid/folds/folds_private.h"

#include <stdlib.h>
#include <string.h>

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

static enum status build_rings(struct folds *folds, struct error *error)
{
    const struct fold_input *input = &folds->input;
    int64_t count = input->facet_count * input->dim;
    NEW_SCRATCH(struct ridge, sides, count, error);
    ridges_list(input->dim, input->facet_count, input->facet, sides);
    RETURN_IF_ERROR(NEW_ARRAY(&folds->rings, count, error));
    for (int64_t i = 0; i < count; i = ridges_end(count, sides, i)) {
        folds->rings[folds->ring_count++] =
            (struct fold_ring){.node = {sides[i].node[0], sides[i].node[1]}, .facet = sides[i].facet};
    }
    return list_cells(folds, error);
}

static enum status mark_held(struct folds *folds, struct error *error)
{
    const struct fold_input *input = &folds->input;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->is_held, input->node_count, error));
    for (int64_t i = 0; i < input->facet_count * input->dim; i++) {
        folds->is_held[input->facet[i]] |= input->held[i / input->dim];
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
    RETURN_IF_ERROR(NEW_ARRAY(&folds->oriented, input->cell_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->boxes, input->facet_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->found, ranks_count(input->ranks), error));
    RETURN_IF_ERROR(build_rings(folds, error));
    RETURN_IF_ERROR(mark_held(folds, error));
    RETURN_IF_ERROR(folds_find_surfaces(folds, error));
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
    FREE_ALL(folds->rings, folds->ring_ptr, folds->ring_cell, folds->oriented, folds->is_held, folds->part,
             folds->bodies, folds->surface, folds->enclosed, folds->y, folds->boxes, folds->found);
    *folds = (struct folds){0};
}
