/* The search for folds of a displacement field; see folds.h. */
#include "solid/folds/folds.h"

#include "base/chunks.h"
#include "base/round_off.h"
#include "base/vector.h"
#include "solid/contact/contact.h"

#include <stdlib.h>
#include <string.h>

static const double full_turn = 6.28318530717958648;

enum { ITEMS_FOR_THREAD = 2000 }; /* see chunks_of */

static const double turned_share = 0.1;     /* see is_turned_over; twice as much: folds_list_flat */
static const double uncertain_share = 0.25; /* see most_angle */

/* Deformed position of a node, dim components. */
static const double *fold_position(const struct folds *folds, int32_t node)
{
    return folds->y + (int64_t)node * folds->input.cells.dim;
}

/* Set the two facets of a fold, `other` -1 where there is none, and its place, the middle of the first facet
 * at rest. */
static void name_facets(const struct fold_input *input, int64_t facet, int64_t other, struct fold *fold)
{
    fold->facet[0] = facet;
    fold->facet[1] = other;
    vector_middle(input->cells.dim, input->cells.x, input->cells.dim, input->facet + facet * input->cells.dim,
                  fold->place);
}

/* Combine the folds of consecutive shares: the first fold of the kind that comes first, and the number of
 * that kind. */
static struct fold combine(int64_t count, const struct fold *found)
{
    struct fold fold = found[0];
    for (int64_t i = 1; i < count; i++) {
        if (found[i].kind == fold.kind) {
            fold.count += found[i].count;
        } else if (fold.kind == FOLD_NONE || (found[i].kind != FOLD_NONE && found[i].kind < fold.kind)) {
            fold = found[i];
        }
    }
    return fold;
}

/* Search the cells, rings, boxes or facets [begin, end). */
typedef struct fold search_range(const struct folds *folds, int64_t begin, int64_t end);

/* Search [0, count), shared among the threads of all processes. */
static struct fold search(const struct folds *folds, int64_t count, search_range *of_range)
{
    const struct ranks *ranks = folds->input.ranks;
    int64_t first = count * ranks_rank(ranks) / ranks_count(ranks);
    int64_t last = count * (ranks_rank(ranks) + 1) / ranks_count(ranks);
    struct chunks chunks = chunks_of(last - first, ITEMS_FOR_THREAD);
    struct fold found[CHUNKS_MOST];
#pragma omp parallel for schedule(static, 1) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        int64_t begin = first + chunks_begin(&chunks, c), end = first + chunks_begin(&chunks, c + 1);
        found[c] = of_range(folds, begin, end);
    }
    folds->found[ranks_rank(ranks)] = combine(chunks.count, found);
    ranks_gather(ranks, folds->found, sizeof *found, NULL);
    return combine(ranks_count(ranks), folds->found);
}

/* Whether the cell is pressed flat against an obstacle: all its nodes are prescribed or in contact, and at
 * least one is stopped. */
static bool is_flattened(const struct folds *folds, const int32_t *node)
{
    bool all = true, any = false;
    for (int k = 0; k <= folds->input.cells.dim; k++) {
        all = all && (folds->is_held[node[k]] || folds->stopped[node[k]]);
        any = any || folds->stopped[node[k]];
    }
    return all && any;
}

/* simplex_determinant of a cell. */
static double cell_size(const struct folds *folds, const int32_t *node)
{
    int dim = folds->input.cells.dim;
    return simplex_determinant(dim, fold_position(folds, node[0]), fold_position(folds, node[1]),
                               fold_position(folds, node[2]), fold_position(folds, node[dim]));
}

/* The least height of a cell divided by its longest edge, at positions y. */
static double flatness(int dim, const double *y, const int32_t *node)
{
    const double *corner[4];
    double longest2 = 0.0, largest2 = 0.0, whole = dim == 2 ? 1.0 : 2.0; /* see simplex_determinant */
    for (int k = 0; k <= dim; k++) {
        int32_t side[3] = {0, 0, 0};
        double area[3];
        for (int i = 0; i < dim; i++) {
            side[i] = node[(k + 1 + i) % (dim + 1)];
        }
        corner[k] = y + (int64_t)node[k] * dim;
        face_area_vector(dim, y, side, area);
        largest2 = fmax(largest2, vector_dot(dim, area, area));
        for (int m = k + 1; m <= dim; m++) {
            longest2 = fmax(longest2, vector_distance2(dim, corner[k], y + (int64_t)node[m] * dim));
        }
    }
    return fabs(simplex_determinant(dim, corner[0], corner[1], corner[2], corner[dim])) /
           (whole * sqrt(longest2 * largest2));
}

/* Whether a cell that is inverted is turned over: its least height is more than a tenth of its longest edge.
 */
static bool is_turned_over(const struct folds *folds, const int32_t *node)
{
    return !(flatness(folds->input.cells.dim, folds->y, node) <= turned_share);
}

/* Search for cells that are turned over. */
static struct fold search_cells(const struct folds *folds, int64_t begin, int64_t end)
{
    const struct fold_input *input = &folds->input;
    struct fold fold = FOLD_NOTHING;
    int dim = input->cells.dim, corners = dim + 1;
    for (int64_t c = begin; c < end; c++) {
        const int32_t *node = input->cells.node + c * corners;
        bool folded = !(cell_size(folds, node) > 0.0) && is_turned_over(folds, node) && !folds->oriented[c] &&
                      !is_flattened(folds, node);
        if (folded && fold.count++ == 0) {
            fold.kind = FOLD_CELL;
            fold.cell = c;
            vector_middle(dim, input->cells.x, corners, node, fold.place);
        }
    }
    return fold;
}

/* Angle of a cell, at positions y, at the ring given by its first nodes; negative where the cell is inverted.
 */
static double angle_around(int dim, const double *y, const int32_t *node)
{
    double a[3], b[3], axis[3], cosine, sine2;
    const double *corner[4] = {NULL, NULL, NULL, NULL};
    for (int k = 0; k <= dim; k++) {
        corner[k] = y + (int64_t)node[k] * dim;
    }
    vector_subtract(dim, corner[dim - 1], corner[0], a);
    vector_subtract(dim, corner[dim], corner[0], b);
    if (dim == 3) { /* across the edge */
        vector_subtract(dim, corner[1], corner[0], axis);
        double length2 = vector_dot(3, axis, axis), on_a = vector_dot(3, a, axis),
               on_b = vector_dot(3, b, axis);
        for (int i = 0; i < 3; i++) {
            a[i] -= on_a / length2 * axis[i];
            b[i] -= on_b / length2 * axis[i];
        }
    }
    cosine = vector_dot(dim, a, b);
    sine2 = vector_dot(dim, a, a) * vector_dot(dim, b, b) - cosine * cosine;
    double angle = atan2(sqrt(fmax(0.0, sine2)), cosine);
    return simplex_determinant(dim, corner[0], corner[1], corner[2], corner[dim]) > 0.0 ? angle : -angle;
}

/* The sum of angles at ring r above which its facets have passed through each other: a full turn, and a share
 * of what the angles there have changed, but at most a twentieth, within which the field at the nodes is
 * uncertain. Where the body is in contact with itself, a twentieth, since contact acts on averages. */
static double most_angle(const struct folds *folds, int64_t r)
{
    int dim = folds->input.cells.dim;
    const struct fold_ring *ring = &folds->rings[r];
    const bool *in_contact = folds->in_contact;
    double changed = 0.0;
    for (int64_t i = folds->ring_ptr[r]; i < folds->ring_ptr[r + 1]; i++) {
        const int32_t *node = folds->ring_cell + i * (dim + 1);
        changed += fabs(angle_around(dim, folds->y, node) - angle_around(dim, folds->input.cells.x, node));
    }
    bool closed = in_contact[ring->node[0]] && (ring->node[1] < 0 || in_contact[ring->node[1]]);
    return full_turn * (1.0 + 1e-6) +
           (closed ? FOLD_BEYOND_FACET : fmin(FOLD_BEYOND_FACET, uncertain_share * changed));
}

static struct fold search_rings(const struct folds *folds, int64_t begin, int64_t end)
{
    struct fold fold = FOLD_NOTHING;
    int corners = folds->input.cells.dim + 1;
    for (int64_t r = begin; r < end; r++) {
        double sum = 0.0;
        for (int64_t i = folds->ring_ptr[r]; i < folds->ring_ptr[r + 1]; i++) {
            sum += angle_around(folds->input.cells.dim, folds->y, folds->ring_cell + i * corners);
        }
        if (sum > full_turn && sum > most_angle(folds, r) && fold.count++ == 0) {
            name_facets(&folds->input, folds->rings[r].facet, -1, &fold);
        }
    }
    fold.kind = fold.count > 0 ? FOLD_CREASE : FOLD_NONE;
    return fold;
}

/* The depth of facet g behind the plane of facet f; *width receives the length of f (3D: root of twice the
 * area). */
static double reach_behind(const struct folds *folds, int64_t f, int64_t g, double *width)
{
    int dim = folds->input.cells.dim;
    double area[3], offset[3], deepest = 0.0;
    const int32_t *node = folds->input.facet + f * dim;
    face_area_vector(dim, folds->y, node, area);
    double size = vector_length(dim, area);
    for (int k = 0; k < dim; k++) {
        vector_subtract(dim, fold_position(folds, folds->input.facet[g * dim + k]),
                        fold_position(folds, node[0]), offset);
        deepest = fmax(deepest, -vector_dot(dim, area, offset) / size);
    }
    *width = dim == 2 ? size : sqrt(2.0 * size);
    return deepest;
}

/* 3D: the least distance by which one facet can be moved off the other along a normal to two of their edges
 * (separating axes). */
static double apart_across_edges(const struct folds *folds, int64_t f, int64_t g)
{
    const int32_t *one = folds->input.facet + f * 3, *other = folds->input.facet + g * 3;
    double least = INFINITY, side[3], other_side[3], axis[3];
    for (int k = 0; k < 9; k++) {
        vector_subtract(3, fold_position(folds, one[(k / 3 + 1) % 3]), fold_position(folds, one[k / 3]),
                        side);
        vector_subtract(3, fold_position(folds, other[(k % 3 + 1) % 3]), fold_position(folds, other[k % 3]),
                        other_side);
        vector_cross(side, other_side, axis);
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        double size2 = vector_dot(3, axis, axis);
        for (int i = 0; i < 6; i++) {
            double place = vector_dot(3, axis, fold_position(folds, i < 3 ? one[i] : other[i - 3]));
            low[i / 3] = fmin(low[i / 3], place);
            high[i / 3] = fmax(high[i / 3], place);
        }
        if (size2 > ROUND_OFF * vector_dot(3, side, side) * vector_dot(3, other_side, other_side)) {
            least = fmin(least, fmin(high[0] - low[1], high[1] - low[0]) / sqrt(size2));
        }
    }
    return least;
}

/* Whether a node of the facet is in contact with another part of the body. */
static bool is_in_contact(const struct folds *folds, int64_t f)
{
    bool any = false;
    for (int k = 0; k < folds->input.cells.dim; k++) {
        any = any || folds->in_contact[folds->input.facet[f * folds->input.cells.dim + k]];
    }
    return any;
}

/* Whether two facets that cross penetrate each other by more than a twentieth of the larger one: the depth is
 * the distance by which one of them must be moved to separate them. A smaller depth is within the uncertainty
 * of the field at the nodes, as conditions and contacts act on averages: a node beside a long edge of the
 * body may pass through its chord. Where parts of the body are in contact, a corner of one may penetrate the
 * chord of the other, since the contact acts at points a fifth of a facet away from its ends; contact acts up
 * to half of the larger facet. */
static bool are_deep(const struct folds *folds, int64_t f, int64_t g)
{
    double width[2];
    double depth = fmin(reach_behind(folds, f, g, &width[0]), reach_behind(folds, g, f, &width[1]));
    depth = folds->input.cells.dim == 3 ? fmin(depth, apart_across_edges(folds, f, g)) : depth;
    bool in_contact = is_in_contact(folds, f) && is_in_contact(folds, g);
    return depth > (in_contact ? CONTACT_MOST_DEPTH : FOLD_BEYOND_FACET) * fmax(width[0], width[1]);
}

/* Search the boxes [begin, end) and those behind them for facets that cross. */
static struct fold search_boxes(const struct folds *folds, int64_t begin, int64_t end)
{
    struct fold fold = FOLD_NOTHING;
    int dim = folds->input.cells.dim;
    const int32_t *facet = folds->input.facet;
    int64_t count = folds->input.facet_count;
    const struct facet_box *boxes = folds->boxes;
    for (int64_t i = begin; i < end; i++) {
        int64_t f = boxes[i].facet.item;
        for (int64_t k = i + 1; k < count && boxes[k].facet.place <= boxes[i].box.high[0]; k++) {
            int64_t g = boxes[k].facet.item;
            if (!box_meets(&boxes[i].box, &boxes[k].box) ||
                !facets_cross(dim, folds->y, facet + f * dim, facet + g * dim, ROUND_OFF * folds->largest) ||
                !are_deep(folds, f, g)) {
                continue;
            }
            if (fold.count++ == 0) {
                name_facets(&folds->input, f < g ? f : g, f < g ? g : f, &fold);
            }
        }
    }
    fold.kind = fold.count > 0 ? FOLD_CROSSING : FOLD_NONE;
    return fold;
}

/* The part of a facet in the volume that its surface encloses at positions x, times dim. */
static double facet_part(const struct folds *folds, const double *x, int64_t f)
{
    int dim = folds->input.cells.dim;
    const int32_t *node = folds->input.facet + f * dim;
    double middle[3], area[3];
    vector_middle(dim, x, dim, node, middle);
    add_scaled(dim, -1.0, x + (int64_t)folds->surface[f] * dim, middle);
    face_area_vector(dim, x, node, area);
    return vector_dot(dim, middle, area);
}

/* Look for surfaces that enclosed a volume at rest, as the outer ones of bodies do, and enclose less than
 * none: the body is outside of them. No motion without folds leads there, though at the end nothing crosses
 * and no cell is inverted. */
static void find_everted(const struct folds *folds, struct fold *fold)
{
    const struct fold_input *input = &folds->input;
    double *rest = folds->enclosed, *now = folds->enclosed + input->cells.node_count;
    double least = ROUND_OFF * pow(folds->extent, input->cells.dim);
    for (int64_t f = 0; f < input->facet_count; f++) {
        rest[folds->surface[f]] = now[folds->surface[f]] = 0.0;
    }
    for (int64_t f = 0; f < input->facet_count; f++) {
        rest[folds->surface[f]] += facet_part(folds, input->cells.x, f);
        now[folds->surface[f]] += facet_part(folds, folds->y, f);
    }
    for (int64_t f = 0; f < input->facet_count; f++) {
        int32_t s = folds->surface[f];
        if (rest[s] > least && now[s] < 0.0 && fold->count++ == 0) {
            name_facets(input, f, -1, fold);
            fold->kind = FOLD_EVERTED;
        }
    }
}

void folds_take_positions(struct folds *folds, const double *u)
{
    folds->largest = 0.0;
    for (int64_t i = 0; i < folds->input.cells.node_count * folds->input.cells.dim; i++) {
        folds->y[i] = folds->input.cells.x[i] + u[i];
        folds->largest = fmax(folds->largest, fabs(folds->y[i]));
    }
}

int64_t folds_list_flat(const struct folds *folds, int32_t *cell)
{
    const struct fold_input *input = &folds->input;
    int64_t count = 0;
    for (int64_t c = 0; c < input->cells.count; c++) {
        const int32_t *node = input->cells.node + c * (input->cells.dim + 1);
        if (!(cell_size(folds, node) > 0.0) && is_turned_over(folds, node) &&
            flatness(input->cells.dim, input->cells.x, node) < 2.0 * turned_share) {
            cell[count++] = (int32_t)c;
        }
    }
    return count;
}

struct fold folds_find(struct folds *folds, const double *u, const bool *stopped)
{
    folds_take_positions(folds, u);
    folds->stopped = stopped;
    struct fold fold = search(folds, folds->input.cells.count, search_cells);
    if (fold.kind == FOLD_NONE && folds->at_rest.kind != FOLD_CREASE) {
        fold = search(folds, folds->ring_count, search_rings);
    }
    if (fold.kind == FOLD_NONE && folds->at_rest.kind == FOLD_NONE) {
        int64_t count = folds->input.facet_count;
        for (int64_t f = 0; f < count; f++) {
            folds->boxes[f].facet.item = f;
        }
        facet_boxes_sort(folds->input.cells.dim, folds->y, folds->input.facet, count, folds->boxes);
        fold = search(folds, folds->input.facet_count, search_boxes);
        if (fold.kind == FOLD_NONE) {
            find_everted(folds, &fold);
        }
    }
    return fold;
}
