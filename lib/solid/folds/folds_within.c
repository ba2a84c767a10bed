/* The search for a body within another one, whose boundaries do not cross. */
#include "solid/folds/folds_private.h"

#include "approx/cells/parts.h"
#include "approx/cells/quality.h"
#include "approx/points/point_grid.h"
#include "base/memory.h"
#include "base/round_off.h"

#include <stdlib.h>

/* Least barycentric coordinate below which a point is on a face of a cell. */
static const double on_face = 1e-6;

enum status folds_find_bodies(struct folds *folds, struct error *error)
{
    const struct fold_input *input = &folds->input;
    struct cells cells = {input->dim, input->node_count, input->x, input->cell_count, input->cell};
    int32_t count;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->part, input->cell_count, error));
    RETURN_IF_ERROR(cells_parts(&cells, folds->part, &count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->bodies, count, error));
    folds->body_count = count;
    for (int64_t c = input->cell_count; c-- > 0;) {
        folds->bodies[folds->part[c]].cell.item = c;
    }
    return STATUS_OK;
}

static void find_middle(const struct folds *folds, const double *x, int64_t cell, double *middle)
{
    int dim = folds->input.dim, corners = dim + 1;
    vector_middle(dim, x, corners, folds->input.cell + cell * corners, middle);
}

/* Name the first cell that is within another one. */
static void name_cell(const struct folds *folds, int64_t cell, struct fold *fold)
{
    fold->kind = FOLD_WITHIN;
    fold->cell = cell;
    find_middle(folds, folds->input.x, cell, fold->place);
}

/* Whether a cell contains a point, barycentric coordinates being larger than `least`. */
static bool contains(const struct folds *folds, int64_t cell, const double *point, double least)
{
    int dim = folds->input.dim, corners = dim + 1;
    const double *vertex[4] = {NULL, NULL, NULL, NULL};
    for (int k = 0; k < corners; k++) {
        vertex[k] = folds->y + (int64_t)folds->input.cell[cell * corners + k] * dim;
    }
    double whole = simplex_determinant(dim, vertex[0], vertex[1], vertex[2], vertex[3]);
    for (int k = 0; k < corners; k++) {
        const double *kept = vertex[k];
        vertex[k] = point;
        double part = simplex_determinant(dim, vertex[0], vertex[1], vertex[2], vertex[3]);
        vertex[k] = kept;
        if (!(part / whole > least)) {
            return false;
        }
    }
    return true;
}

/* The box around a cell. */
static struct box box_around(const struct folds *folds, int64_t cell)
{
    int dim = folds->input.dim;
    return box_of_nodes(dim, folds->y, folds->input.cell + cell * (dim + 1), dim + 1);
}

/* The first body whose middle has a first coordinate of at least this. */
static int64_t first_body_from(const struct folds *folds, double least)
{
    int64_t first = 0;
    for (int64_t last = folds->body_count; first < last;) {
        int64_t middle = first + (last - first) / 2;
        if (folds->bodies[middle].cell.place < least) {
            first = middle + 1;
        } else {
            last = middle;
        }
    }
    return first;
}

void folds_find_within(struct folds *folds, struct fold *fold)
{
    int64_t count = folds->body_count;
    if (count < 2) {
        return;
    }
    for (int64_t b = 0; b < count; b++) {
        struct fold_body *body = &folds->bodies[b];
        find_middle(folds, folds->y, body->cell.item, body->middle);
        body->cell.place = body->middle[0];
    }
    qsort(folds->bodies, (size_t)count, sizeof *folds->bodies, compare_placed);
    for (int64_t c = 0; c < folds->input.cell_count; c++) {
        struct box box = box_around(folds, c);
        for (int64_t b = first_body_from(folds, box.low[0]);
             b < count && folds->bodies[b].cell.place <= box.high[0]; b++) {
            const struct fold_body *body = &folds->bodies[b];
            if (folds->part[c] != folds->part[body->cell.item] && contains(folds, c, body->middle, on_face) &&
                fold->count++ == 0) {
                name_cell(folds, body->cell.item, fold);
            }
        }
    }
}

/* Whether two cells have a node together. */
static bool are_neighbours(const struct folds *folds, int64_t c, int64_t other)
{
    int corners = folds->input.dim + 1;
    const int32_t *one = folds->input.cell + c * corners, *two = folds->input.cell + other * corners;
    for (int k = 0; k < corners * corners; k++) {
        if (one[k / corners] == two[k % corners]) {
            return true;
        }
    }
    return false;
}

/* Whether a cell is left out of the search: slivers do not follow the field between their nodes, nor do cells
 * that are inverted a little or because they are flat. */
static bool is_left_out(const struct folds *folds, int64_t cell)
{
    const struct fold_input *input = &folds->input;
    const struct cells cells = {input->dim, input->node_count, input->x, input->cell_count, input->cell};
    const struct cells now = {input->dim, input->node_count, folds->y, input->cell_count, input->cell};
    return cell_quality(&cells, cell) < POOR_QUALITY || cell_volume(&now, cell) <= 0.0;
}

enum status folds_look_for_overlaps(struct folds *folds, bool of_bodies, struct fold *fold,
                                    struct error *error)
{
    int dim = folds->input.dim;
    int64_t count = folds->input.cell_count;
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(index_list_free) struct index_list near = {0};
    NEW_SCRATCH(double, middle, count * dim, error);
    NEW_SCRATCH(double, radius, count, error);
    for (int64_t c = 0; c < count; c++) {
        find_middle(folds, folds->y, c, middle + c * dim);
        radius[c] = ROUND_OFF * folds->extent;
    }
    RETURN_IF_ERROR(point_grid_build(&grid, dim, count, middle, radius, error));
    for (int64_t c = 0; c < count; c++) {
        struct box box = box_around(folds, c);
        near.count = 0;
        RETURN_IF_ERROR(point_grid_query_box(&grid, box.low, box.high, 1.0, &near, error));
        for (int64_t i = 0; i < near.count; i++) {
            int32_t other = near.index[i];
            bool apart =
                folds->part[other] != folds->part[c] || (!of_bodies && !are_neighbours(folds, c, other));
            if (apart && contains(folds, c, middle + (int64_t)other * dim, FOLD_BEYOND_FACET) &&
                !is_left_out(folds, c) && !is_left_out(folds, other) && fold->count++ == 0) {
                name_cell(folds, other, fold);
            }
        }
    }
    return STATUS_OK;
}

enum status folds_find_overlaps(struct folds *folds, const double *u, struct fold *fold, struct error *error)
{
    *fold = FOLD_NOTHING;
    folds_take_positions(folds, u);
    return folds->at_rest.kind == FOLD_NONE ? folds_look_for_overlaps(folds, false, fold, error) : STATUS_OK;
}
