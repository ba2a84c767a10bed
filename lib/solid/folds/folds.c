/* Preparation of the search for folds, on the body at rest, and the search for parts that overlap; see
 * folds.h. */
#include "solid/folds/folds.h"

#include "approx/cells/parts.h"
#include "approx/cells/quality.h"
#include "approx/points/point_grid.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"
#include "base/vector.h"

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
    sort_nodes(folds->input.cells.dim - 1, side, key.node);
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
    int dim = input->cells.dim, parts = dim == 2 ? 3 : 6;
    const int *order = dim == 2 ? parts_2d[part % parts] : parts_3d[part % parts];
    for (int k = 0; k <= dim; k++) {
        node[k] = input->cells.node[part / parts * (dim + 1) + order[k]];
    }
}

/* The cells around each ring. */
static enum status list_cells(struct folds *folds, struct error *error)
{
    int corners = folds->input.cells.dim + 1;
    int64_t count = folds->input.cells.count * (corners == 3 ? 3 : 6);
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
    int64_t count = input->facet_count * input->cells.dim;
    NEW_SCRATCH(struct ridge, sides, count, error);
    ridges_list(input->cells.dim, input->facet_count, input->facet, sides);
    RETURN_IF_ERROR(NEW_ARRAY(&folds->rings, count, error));
    for (int64_t i = 0; i < count; i = ridges_end(count, sides, i)) {
        folds->rings[folds->ring_count++] =
            (struct fold_ring){.node = {sides[i].node[0], sides[i].node[1]}, .facet = sides[i].facet};
    }
    return list_cells(folds, error);
}

/* The surfaces of the boundary, facets that have nodes together. */
static enum status find_surfaces(struct folds *folds, struct error *error)
{
    const struct fold_input *input = &folds->input;
    int dim = input->cells.dim;
    NEW_SCRATCH(int32_t, parent, input->cells.node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&folds->surface, input->facet_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->enclosed, 2 * input->cells.node_count, error));
    set_join_cells(input->cells.node_count, input->facet_count, dim, input->facet, parent);
    for (int64_t f = 0; f < input->facet_count; f++) {
        folds->surface[f] = set_first(parent, input->facet[f * dim]);
    }
    return STATUS_OK;
}

/* Whether two cells have a node together. */
static bool are_neighbours(const struct folds *folds, int64_t c, int64_t other)
{
    int corners = folds->input.cells.dim + 1;
    const int32_t *one = folds->input.cells.node + c * corners,
                  *two = folds->input.cells.node + other * corners;
    for (int k = 0; k < corners * corners; k++) {
        if (one[k / corners] == two[k % corners]) {
            return true;
        }
    }
    return false;
}

/* Whether a cell is left out of the search: slivers do not follow the field between their nodes, nor do cells
 * that are inverted a little or because they are flat. */
static bool is_left_out(const struct folds *folds, const struct cells *now, int64_t cell)
{
    return cell_quality(&folds->input.cells, cell, NULL) < POOR_QUALITY || cell_volume(now, cell) <= 0.0;
}

/* Look for cells whose middle is deep in a cell of another body, or else in any cell that they share no node
 * with. Boundaries that cross at nodes, or lie on each other, are not found as crossings. */
static enum status look_for_overlaps(struct folds *folds, bool of_bodies, struct fold *fold,
                                     struct error *error)
{
    int dim = folds->input.cells.dim;
    int64_t count = folds->input.cells.count;
    struct cells now = folds->input.cells;
    now.x = folds->y;
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(index_list_free) struct index_list near = {0};
    NEW_SCRATCH(double, middle, count * dim, error);
    NEW_SCRATCH(double, radius, count, error);
    for (int64_t c = 0; c < count; c++) {
        cell_centroid(&now, c, middle + c * dim);
        radius[c] = ROUND_OFF * folds->extent;
    }
    RETURN_IF_ERROR(point_grid_build(&grid, dim, count, middle, radius, error));
    for (int64_t c = 0; c < count; c++) {
        struct box box = box_of_nodes(dim, folds->y, folds->input.cells.node + c * (dim + 1), dim + 1);
        near.count = 0;
        RETURN_IF_ERROR(point_grid_query_box(&grid, box.low, box.high, 1.0, &near, error));
        for (int64_t i = 0; i < near.count; i++) {
            int32_t other = near.index[i];
            bool apart =
                folds->part[other] != folds->part[c] || (!of_bodies && !are_neighbours(folds, c, other));
            if (apart && cell_contains(&now, c, middle + (int64_t)other * dim, FOLD_BEYOND_FACET) &&
                !is_left_out(folds, &now, c) && !is_left_out(folds, &now, other) && fold->count++ == 0) {
                fold->kind = FOLD_WITHIN;
                fold->cell = other; /* the first one */
                cell_centroid(&folds->input.cells, other, fold->place);
            }
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
    int64_t size = input->cells.node_count * input->cells.dim;
    int32_t bodies;
    *folds = (struct folds){.input = *input};
    struct box box = box_of(input->cells.dim, input->cells.node_count, input->cells.x);
    folds->extent = box_diagonal(&box);
    RETURN_IF_ERROR(NEW_ARRAY(&folds->y, size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->oriented, input->cells.count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->in_contact, input->cells.node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->boxes, input->facet_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->found, ranks_count(input->ranks), error));
    RETURN_IF_ERROR(build_rings(folds, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->is_held, input->cells.node_count, error));
    for (int64_t i = 0; i < input->facet_count * input->cells.dim; i++) {
        folds->is_held[input->facet[i]] |= input->held[i / input->cells.dim];
    }
    RETURN_IF_ERROR(find_surfaces(folds, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->part, input->cells.count, error));
    RETURN_IF_ERROR(cells_parts(&input->cells, folds->part, &bodies, error));
    NEW_SCRATCH(double, u, size, error);
    NEW_SCRATCH(bool, stopped, input->cells.node_count, error);
    struct fold at_rest = folds_find(folds, u, stopped);
    if (!interpenetrates(&at_rest) && bodies > 1) {
        at_rest = FOLD_NOTHING;
        RETURN_IF_ERROR(look_for_overlaps(folds, true, &at_rest, error));
    }
    if (interpenetrates(&at_rest)) {
        folds->at_rest = at_rest;
    }
    return STATUS_OK;
}

enum status folds_find_overlaps(struct folds *folds, const double *u, struct fold *fold, struct error *error)
{
    *fold = FOLD_NOTHING;
    folds_take_positions(folds, u);
    return folds->at_rest.kind == FOLD_NONE ? look_for_overlaps(folds, false, fold, error) : STATUS_OK;
}

void folds_free(struct folds *folds)
{
    FREE_ALL(folds->rings, folds->ring_ptr, folds->ring_cell, folds->oriented, folds->in_contact,
             folds->is_held, folds->part, folds->surface, folds->enclosed, folds->y, folds->boxes,
             folds->found);
    *folds = (struct folds){0};
}
