/* Preparation of the search for folds, on the body at rest; see folds.h. */
#include "solid/folds.h"

#include "base/box.h"
#include "base/memory.h"
#include "solid/folds_private.h"

#include <stdlib.h>
#include <string.h>

/* Facets of one plane support: their normals make a product no less than 1 less this. */
static const double plane_tolerance = 1e-6;

/* A free facet continues its support unless it turns back from it by more than this sine: that of 22.5
 * degrees. */
static const double least_turn = 0.382683;

/* A node (2D) or an edge (3D) of a facet. */
struct side {
    int32_t node[2];
    int64_t facet;
};

static int compare_nodes(const int32_t a[2], const int32_t b[2])
{
    if (a[0] != b[0]) {
        return a[0] < b[0] ? -1 : 1;
    }
    return (a[1] > b[1]) - (a[1] < b[1]);
}

static int compare_sides(const void *left, const void *right)
{
    const struct side *a = left, *b = right;
    int order = compare_nodes(a->node, b->node);
    return order != 0 ? order : (a->facet > b->facet) - (a->facet < b->facet);
}

static int compare_rings(const void *left, const void *right)
{
    return compare_nodes(((const struct fold_ring *)left)->node, ((const struct fold_ring *)right)->node);
}

/* Side k of a facet: in 2D node k, in 3D the edge from corner k to the next. */
static void side_nodes(int dim, const int32_t *facet, int k, int32_t node[2])
{
    int32_t a = facet[k], b = dim == 3 ? facet[(k + 1) % 3] : -1;
    node[0] = dim == 2 || a < b ? a : b;
    node[1] = dim == 2 || a < b ? b : a;
}

static enum status list_sides(const struct fold_input *input, struct side **sides, struct error *error)
{
    enum status status;
    int dim = input->dim;
    TRY(NEW_ARRAY(sides, input->facet_count * dim, error));
    for (int64_t f = 0; f < input->facet_count; f++) {
        for (int k = 0; k < dim; k++) {
            struct side *side = *sides + f * dim + k;
            side_nodes(dim, input->facet + f * dim, k, side->node);
            side->facet = f;
        }
    }
    qsort(*sides, (size_t)(input->facet_count * dim), sizeof **sides, compare_sides);
done:
    return status;
}

/* The ring that a part of a cell is on, -1 for none. */
static int64_t find_ring(const struct folds *folds, int32_t a, int32_t b)
{
    struct fold_ring key = {.node = {a, b}};
    if (folds->input.dim == 3 && b < a) {
        key.node[0] = b;
        key.node[1] = a;
    }
    const struct fold_ring *ring =
        bsearch(&key, folds->rings, (size_t)folds->ring_count, sizeof key, compare_rings);
    return ring != NULL ? ring - folds->rings : -1;
}

/* The parts of a cell that rings go round: its corners (2D) or edges (3D), with the other corners. */
enum { MOST_PARTS = 6 };
static const int parts_2d[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
static const int parts_3d[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                   {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};

/* Whether an order of a cell's corners is an even permutation. */
static bool is_even(const int *order, int corners)
{
    bool even = true;
    for (int i = 0; i < corners; i++) {
        for (int k = i + 1; k < corners; k++) {
            even = order[i] > order[k] ? !even : even;
        }
    }
    return even;
}

/* Visit the parts of all cells that are on rings: count them, or, with `fill`, list their nodes. */
static void visit_parts(struct folds *folds, bool fill)
{
    const struct fold_input *input = &folds->input;
    int dim = input->dim, corners = dim + 1;
    for (int64_t c = 0; c < input->cell_count; c++) {
        const int32_t *cell = input->cell + c * corners;
        for (int k = 0; k < (dim == 2 ? 3 : 6); k++) {
            const int *part = dim == 2 ? parts_2d[k] : parts_3d[k];
            int64_t ring = find_ring(folds, cell[part[0]], dim == 2 ? -1 : cell[part[1]]);
            if (ring < 0) {
                continue;
            }
            int64_t at = folds->ring_ptr[ring]++;
            if (fill) {
                folds->ring_turn[at] = is_even(part, corners) ? 1 : -1;
            }
            for (int i = 0; i < corners && fill; i++) {
                folds->ring_cell[at * corners + i] = cell[part[i]];
            }
        }
    }
}

static enum status build_rings(struct folds *folds, const struct side *sides, struct error *error)
{
    enum status status;
    int64_t count = folds->input.facet_count * folds->input.dim, sum = 0;
    TRY(NEW_ARRAY(&folds->rings, count, error));
    for (int64_t i = 0; i < count; i++) {
        if (i == 0 || compare_nodes(sides[i - 1].node, sides[i].node) != 0) {
            struct fold_ring *ring = &folds->rings[folds->ring_count++];
            memcpy(ring->node, sides[i].node, sizeof ring->node);
            ring->facet = sides[i].facet;
        }
    }
    TRY(NEW_ARRAY(&folds->ring_ptr, folds->ring_count + 1, error));
    visit_parts(folds, false);
    for (int64_t r = 0; r <= folds->ring_count; r++) { /* from counts to begins */
        int64_t here = folds->ring_ptr[r];
        folds->ring_ptr[r] = sum;
        sum += here;
    }
    TRY(NEW_ARRAY(&folds->ring_turn, sum, error));
    TRY(NEW_ARRAY(&folds->ring_cell, sum * (folds->input.dim + 1), error));
    visit_parts(folds, true);
    for (int64_t r = folds->ring_count; r > 0; r--) { /* each had moved on to the begin of the next */
        folds->ring_ptr[r] = folds->ring_ptr[r - 1];
    }
    folds->ring_ptr[0] = 0;
done:
    return status;
}

static int64_t support_of(int64_t *support, int64_t f)
{
    while (support[f] != f) {
        support[f] = support[support[f]];
        f = support[f];
    }
    return f;
}

/* Whether two facets lie in one plane at rest, turned the same way. */
static bool in_one_plane(const struct fold_input *input, int64_t f, int64_t g)
{
    double a[3], b[3];
    int dim = input->dim;
    fold_area_vector(dim, input->x, input->facet + f * dim, a);
    fold_area_vector(dim, input->x, input->facet + g * dim, b);
    double size = sqrt(fold_dot(dim, a, a) * fold_dot(dim, b, b));
    return fold_dot(dim, a, b) >= (1.0 - plane_tolerance) * size;
}

/* Held facets that meet in one plane are one support, which is called by its first facet. */
static enum status find_supports(struct folds *folds, const struct side *sides, struct error *error)
{
    enum status status;
    const struct fold_input *input = &folds->input;
    TRY(NEW_ARRAY(&folds->support, input->facet_count, error));
    TRY(NEW_ARRAY(&folds->is_held, input->node_count, error));
    for (int64_t f = 0; f < input->facet_count; f++) {
        folds->support[f] = input->held[f] ? f : -1;
        for (int k = 0; k < input->dim && input->held[f]; k++) {
            folds->is_held[input->facet[f * input->dim + k]] = true;
        }
    }
    for (int64_t i = 1; i < input->facet_count * input->dim; i++) {
        int64_t f = sides[i - 1].facet, g = sides[i].facet;
        if (compare_nodes(sides[i - 1].node, sides[i].node) == 0 && input->held[f] && input->held[g] &&
            in_one_plane(input, f, g)) {
            int64_t a = support_of(folds->support, f), b = support_of(folds->support, g);
            folds->support[a > b ? a : b] = a > b ? b : a;
        }
    }
    for (int64_t f = 0; f < input->facet_count; f++) {
        if (input->held[f]) {
            folds->support[f] = support_of(folds->support, f);
        }
    }
done:
    return status;
}

/* Add the rim between a free facet and a support, which meet in a node or an edge. */
static void add_rim(struct folds *folds, const struct side *side, int64_t facet, int64_t support_facet)
{
    int dim = folds->input.dim;
    double reach;
    struct fold_rim rim = {
        .facet = facet, .support_facet = support_facet, .node = -1, .on_rim = side->node[0]};
    for (int k = 0; k < dim; k++) {
        int32_t node = folds->input.facet[facet * dim + k];
        rim.node = node == side->node[0] || node == side->node[1] ? rim.node : node;
    }
    if (folds_rim_beyond(folds, &rim, folds->input.x, &reach) < -least_turn * reach) {
        folds->rims[folds->rim_count++] = rim;
    }
}

static enum status find_rims(struct folds *folds, const struct side *sides, struct error *error)
{
    enum status status;
    const struct fold_input *input = &folds->input;
    int64_t count = input->facet_count * input->dim;
    TRY(NEW_ARRAY(&folds->rims, 2 * count, error));
    folds_fill_planes(folds, input->x);
    for (int64_t i = 1; i < count; i++) {
        int64_t f = sides[i - 1].facet, g = sides[i].facet;
        if (compare_nodes(sides[i - 1].node, sides[i].node) == 0 && input->held[f] != input->held[g]) {
            add_rim(folds, &sides[i], input->held[f] ? g : f, input->held[f] ? f : g);
        }
    }
done:
    return status;
}

enum status folds_build(const struct fold_input *input, struct folds *folds, struct error *error)
{
    enum status status;
    struct side *sides = NULL;
    double *u = NULL;
    bool *stopped = NULL;
    int64_t size = input->node_count * input->dim;
    *folds = (struct folds){.input = *input};
    struct box box = box_of(input->dim, input->node_count, input->x);
    folds->extent = box_diagonal(&box);
    TRY(NEW_ARRAY(&folds->y, size, error));
    TRY(NEW_ARRAY(&folds->boxes, input->facet_count, error));
    TRY(NEW_ARRAY(&folds->plane, input->facet_count * 7, error));
    TRY(NEW_ARRAY(&folds->found, ranks_count(input->ranks), error));
    TRY(NEW_ARRAY(&folds->in_turn, ranks_count(input->ranks) + 1, error));
    for (int r = 0; r <= ranks_count(input->ranks); r++) {
        folds->in_turn[r] = r;
    }
    TRY(list_sides(input, &sides, error));
    TRY(build_rings(folds, sides, error));
    TRY(find_supports(folds, sides, error));
    TRY(find_rims(folds, sides, error));
    TRY(NEW_ARRAY(&u, size, error));
    TRY(NEW_ARRAY(&stopped, input->node_count, error));
    TRY(folds_find_bodies(folds, error));
    struct fold at_rest = folds_find(folds, u, stopped);
    if (at_rest.kind != FOLD_CROSSING && at_rest.kind != FOLD_WITHIN) {
        at_rest = (struct fold){.cell = -1, .facet = {-1, -1}};
        if (folds->body_count > 1) {
            TRY(folds_look_for_overlaps(folds, true, &at_rest, error));
        }
    }
    if (at_rest.kind == FOLD_CROSSING || at_rest.kind == FOLD_WITHIN) {
        folds->at_rest = at_rest;
    }
done:
    FREE_ALL(sides, u, stopped);
    if (status != STATUS_OK) {
        folds_free(folds);
    }
    return status;
}

void folds_free(struct folds *folds)
{
    FREE_ALL(folds->rings, folds->ring_ptr, folds->ring_cell, folds->ring_turn, folds->rims, folds->support,
             folds->is_held, folds->part, folds->bodies, folds->y, folds->boxes, folds->plane, folds->found,
             folds->in_turn);
    *folds = (struct folds){0};
}
