/* Looking for folds of a displacement field; see folds.h. */
#include "solid/folds_private.h"

#include "base/chunks.h"

#include <stdlib.h>
#include <string.h>

static const double full_turn = 6.28318530717958648;

/* Positions below this share of the largest coordinate are round-off. */
static const double round_off = 1e-12;

enum { ITEMS_FOR_THREAD = 2000 }; /* see chunks_of */

static const struct fold none = {.kind = FOLD_NONE, .cell = -1, .facet = {-1, -1}};

/* See folds_find_beyond, are_deep. */
static const double beyond_body = 1e-3, beyond_facet = 0.05;
static const double turned_share = 0.1; /* see is_turned_over */
static const double held_share = 0.5;   /* see are_deep; contact_most_depth */

static const double *at(const struct folds *folds, int32_t node)
{
    return folds->y + (int64_t)node * folds->input.dim;
}

void fold_name_facets(const struct fold_input *input, int64_t facet, int64_t other, struct fold *fold)
{
    fold->facet[0] = facet;
    fold->facet[1] = other;
    vector_middle(input->dim, input->x, input->dim, input->facet + facet * input->dim, fold->place);
}

/* What there is in shares in turn: the gravest kind, its first one, and how many there are. */
static struct fold put_together(int64_t count, const struct fold *found)
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

/* A look at cells, rings or boxes, from `begin` to before `end`. */
typedef struct fold look_at(const struct folds *folds, int64_t begin, int64_t end, const bool *stopped);

/* The look at so many of them, by all threads of all processes. */
static struct fold look(const struct folds *folds, int64_t count, look_at *at_items, const bool *stopped)
{
    const struct ranks *ranks = folds->input.ranks;
    int64_t first = count * ranks_rank(ranks) / ranks_count(ranks);
    int64_t last = count * (ranks_rank(ranks) + 1) / ranks_count(ranks);
    struct chunks chunks = chunks_of(last - first, ITEMS_FOR_THREAD);
    struct fold found[CHUNKS_MOST];
#pragma omp parallel for schedule(static, 1) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        int64_t begin = first + chunks_begin(&chunks, c), end = first + chunks_begin(&chunks, c + 1);
        found[c] = at_items(folds, begin, end, stopped);
    }
    folds->found[ranks_rank(ranks)] = put_together(chunks.count, found);
    ranks_gather(ranks, folds->found, sizeof *found, NULL);
    return put_together(ranks_count(ranks), folds->found);
}

/* Whether something presses the cell flat: all nodes are held or stopped, not all of them held. */
static bool is_flattened(const struct folds *folds, const int32_t *node, const bool *stopped)
{
    bool all = true, any = false;
    for (int k = 0; k <= folds->input.dim; k++) {
        all = all && (folds->is_held[node[k]] || stopped[node[k]]);
        any = any || stopped[node[k]];
    }
    return all && any;
}

/* The volume of a cell as fold_volume has it. */
static double cell_size(const struct folds *folds, const int32_t *node)
{
    int dim = folds->input.dim;
    return fold_volume(dim, at(folds, node[0]), at(folds, node[1]), at(folds, node[2]),
                       dim == 3 ? at(folds, node[3]) : NULL);
}

/* Whether a cell of that volume < 0 is turned over: its least height is more than a tenth of its longest
 * edge. */
static bool is_turned_over(const struct folds *folds, const int32_t *node, double volume)
{
    int dim = folds->input.dim;
    double longest2 = 0.0, largest2 = 0.0;
    for (int k = 0; k <= dim; k++) {
        int32_t side[3] = {0, 0, 0};
        double area[3];
        for (int i = 0; i < dim; i++) {
            side[i] = node[(k + 1 + i) % (dim + 1)];
        }
        fold_area_vector(dim, folds->y, side, area);
        largest2 = fmax(largest2, vector_dot(dim, area, area));
        for (int m = k + 1; m <= dim; m++) {
            longest2 = fmax(longest2, vector_distance2(dim, at(folds, node[k]), at(folds, node[m])));
        }
    }
    return !(volume * volume <= turned_share * turned_share * longest2 * largest2);
}

/* Whether a cell is between facets that continued each other at rest, and do not face each other now. */
static bool is_in_hollow(const struct folds *folds, int64_t cell)
{
    int32_t r = folds->flat_ring[cell];
    return r >= 0 && fold_facet_cosine(&folds->input, folds->y, folds->rings[r].facet,
                                       folds->rings[r].other) >= FOLD_REVERSING;
}

/* Turned cells, or else inverted ones. */
static struct fold look_at_cells(const struct folds *folds, int64_t begin, int64_t end, const bool *stopped)
{
    const struct fold_input *input = &folds->input;
    struct fold fold = none;
    int dim = input->dim, corners = dim + 1;
    for (int64_t c = begin; c < end; c++) {
        const int32_t *node = input->cell + c * corners;
        double volume = cell_size(folds, node);
        if (volume > 0.0 || is_flattened(folds, node, stopped)) {
            continue;
        }
        enum fold_kind kind =
            is_turned_over(folds, node, volume) && !is_in_hollow(folds, c) ? FOLD_CELL : FOLD_FLAT;
        if (fold.kind == FOLD_NONE || (fold.kind == FOLD_FLAT && kind == FOLD_CELL)) {
            fold = (struct fold){.kind = kind, .cell = c, .facet = {-1, -1}};
            vector_middle(dim, input->x, corners, node, fold.place);
        }
        fold.count += kind == fold.kind;
    }
    return fold;
}

/* Angle that a cell takes around the ring that its first nodes are; negative where it is inverted. */
static double angle_around(const struct folds *folds, const int32_t *node)
{
    int dim = folds->input.dim;
    double a[3], b[3], axis[3], cosine, sine2;
    const double *origin = at(folds, node[0]);
    vector_subtract(dim, at(folds, node[dim - 1]), origin, a);
    vector_subtract(dim, at(folds, node[dim]), origin, b);
    if (dim == 3) { /* across the edge */
        vector_subtract(dim, at(folds, node[1]), origin, axis);
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
    return cell_size(folds, node) > 0.0 ? angle : -angle;
}

/* The angle above which what meets at a ring has passed through itself. Where parts of the body press on each
 * other by averages, facets may do so by a twentieth of their length. */
static double most_angle(const struct folds *folds, const struct fold_ring *ring)
{
    const bool *touched = folds->touched;
    bool touches = touched != NULL && touched[ring->node[0]] && (ring->node[1] < 0 || touched[ring->node[1]]);
    return full_turn * (1.0 + 1e-6) + (touches ? beyond_facet : 0.0);
}

static struct fold look_at_rings(const struct folds *folds, int64_t begin, int64_t end, const bool *stopped)
{
    struct fold fold = none;
    int corners = folds->input.dim + 1;
    (void)stopped;
    for (int64_t r = begin; r < end; r++) {
        double sum = 0.0;
        for (int64_t i = folds->ring_ptr[r]; i < folds->ring_ptr[r + 1]; i++) {
            sum += angle_around(folds, folds->ring_cell + i * corners);
        }
        if (sum > most_angle(folds, &folds->rings[r]) && fold.count++ == 0) {
            fold_name_facets(&folds->input, folds->rings[r].facet, -1, &fold);
        }
    }
    fold.kind = fold.count > 0 ? FOLD_CREASE : FOLD_NONE;
    return fold;
}

/* Whether the segment p q goes through facet f, at neither's border. */
static bool pierces(const struct folds *folds, int32_t p, int32_t q, int64_t f)
{
    int dim = folds->input.dim;
    const int32_t *node = folds->input.facet + f * dim;
    const double *x = at(folds, p), *y = at(folds, q), *a = at(folds, node[0]), *b = at(folds, node[1]);
    const double *c = dim == 3 ? at(folds, node[2]) : NULL;
    double before = dim == 2 ? fold_volume(2, a, b, x, NULL) : fold_volume(3, a, b, c, x);
    double after = dim == 2 ? fold_volume(2, a, b, y, NULL) : fold_volume(3, a, b, c, y);
    double side[3];
    double size = vector_distance(dim, x, y) + vector_distance(dim, x, a) + vector_distance(dim, a, b);
    double least = round_off * folds->largest * (dim == 2 ? size : size * size);
    if (!(fmin(before, after) < -least && fmax(before, after) > least)) {
        return false;
    }
    if (dim == 2) {
        side[0] = fold_volume(2, x, y, a, NULL);
        side[1] = -fold_volume(2, x, y, b, NULL);
        side[2] = side[0];
    } else {
        side[0] = fold_volume(3, x, y, a, b);
        side[1] = fold_volume(3, x, y, b, c);
        side[2] = fold_volume(3, x, y, c, a);
    }
    return (side[0] > least && side[1] > least && side[2] > least) ||
           (side[0] < -least && side[1] < -least && side[2] < -least);
}

/* Whether an edge of facet f (2D: the facet) that has no node of facet g goes through g. */
static bool goes_through(const struct folds *folds, int64_t f, int64_t g)
{
    int dim = folds->input.dim;
    const int32_t *edge = folds->input.facet + f * dim, *node = folds->input.facet + g * dim;
    for (int k = 0; k < (dim == 2 ? 1 : 3); k++) {
        int32_t p = edge[k], q = edge[(k + 1) % dim];
        bool apart = true;
        for (int i = 0; i < dim; i++) {
            apart = apart && node[i] != p && node[i] != q;
        }
        if (apart && pierces(folds, p, q, g)) {
            return true;
        }
    }
    return false;
}

/* How far facet g reaches behind the plane of facet f; *width receives the length of f (3D: root of twice the
 * area). */
static double reach_behind(const struct folds *folds, int64_t f, int64_t g, double *width)
{
    int dim = folds->input.dim;
    double area[3], way[3], deepest = 0.0;
    const int32_t *node = folds->input.facet + f * dim;
    fold_area_vector(dim, folds->y, node, area);
    double size = vector_length(dim, area);
    for (int k = 0; k < dim; k++) {
        vector_subtract(dim, at(folds, folds->input.facet[g * dim + k]), at(folds, node[0]), way);
        deepest = fmax(deepest, -vector_dot(dim, area, way) / size);
    }
    *width = dim == 2 ? size : sqrt(size);
    return deepest;
}

/* 3D: the least way along which one of the facets can be moved off the other, across two of their edges. */
static double apart_across_edges(const struct folds *folds, int64_t f, int64_t g)
{
    const int32_t *one = folds->input.facet + f * 3, *other = folds->input.facet + g * 3;
    double least = INFINITY, side[3], other_side[3], axis[3];
    for (int k = 0; k < 9; k++) {
        vector_subtract(3, at(folds, one[(k / 3 + 1) % 3]), at(folds, one[k / 3]), side);
        vector_subtract(3, at(folds, other[(k % 3 + 1) % 3]), at(folds, other[k % 3]), other_side);
        vector_cross(side, other_side, axis);
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        double size2 = vector_dot(3, axis, axis);
        for (int i = 0; i < 6; i++) {
            double place = vector_dot(3, axis, at(folds, i < 3 ? one[i] : other[i - 3]));
            low[i / 3] = fmin(low[i / 3], place);
            high[i / 3] = fmax(high[i / 3], place);
        }
        if (size2 > round_off * vector_dot(3, side, side) * vector_dot(3, other_side, other_side)) {
            least = fmin(least, fmin(high[0] - low[1], high[1] - low[0]) / sqrt(size2));
        }
    }
    return least;
}

/* Whether a part of the body stands against a node of the facet. */
static bool is_touched(const struct folds *folds, int64_t f)
{
    bool touched = false;
    for (int k = 0; k < folds->input.dim && folds->touched != NULL; k++) {
        touched = touched || folds->touched[folds->input.facet[f * folds->input.dim + k]];
    }
    return touched;
}

/* Whether two facets that meet are through each other by more than a twentieth of the smaller one: so far
 * must one of them be moved to set them apart. Less is no more than what a field at the nodes is uncertain
 * by, as conditions and contacts hold averages: a node on a support is beyond its plane by round-off and
 * more. Where parts of the body press on each other the corner of one may sink into the chord of the other:
 * the contact acts at points, a fifth of a facet away from its ends, and by less than half of the larger
 * facet is still held. */
static bool are_deep(const struct folds *folds, int64_t f, int64_t g)
{
    double width[2];
    double depth = fmin(reach_behind(folds, f, g, &width[0]), reach_behind(folds, g, f, &width[1]));
    depth = folds->input.dim == 3 ? fmin(depth, apart_across_edges(folds, f, g)) : depth;
    if (is_touched(folds, f) && is_touched(folds, g)) {
        return depth > held_share * fmax(width[0], width[1]);
    }
    return depth > beyond_facet * fmin(width[0], width[1]);
}

/* Whether two boxes meet along the other axes than the first. */
static bool boxes_meet(const struct box *one, const struct box *other)
{
    bool meet = true;
    for (int i = 1; i < one->dim; i++) {
        meet = meet && one->low[i] <= other->high[i] && other->low[i] <= one->high[i];
    }
    return meet;
}

static void sort_boxes(struct folds *folds)
{
    int dim = folds->input.dim;
    for (int64_t f = 0; f < folds->input.facet_count; f++) {
        struct box box = box_of_nodes(dim, folds->y, folds->input.facet + f * dim, dim);
        folds->boxes[f] = (struct fold_box){{box.low[0], f}, box};
    }
    qsort(folds->boxes, (size_t)folds->input.facet_count, sizeof *folds->boxes, compare_placed);
}

/* Facets that go through each other. */
static struct fold look_at_boxes(const struct folds *folds, int64_t begin, int64_t end, const bool *stopped)
{
    struct fold fold = none;
    int64_t count = folds->input.facet_count;
    const struct fold_box *boxes = folds->boxes;
    (void)stopped;
    for (int64_t i = begin; i < end; i++) {
        int64_t f = boxes[i].facet.item;
        for (int64_t k = i + 1; k < count && boxes[k].facet.place <= boxes[i].box.high[0]; k++) {
            int64_t g = boxes[k].facet.item;
            if (!boxes_meet(&boxes[i].box, &boxes[k].box) ||
                !(goes_through(folds, f, g) || goes_through(folds, g, f)) || !are_deep(folds, f, g)) {
                continue;
            }
            if (fold.count++ == 0) {
                fold_name_facets(&folds->input, f < g ? f : g, f < g ? g : f, &fold);
            }
        }
    }
    fold.kind = fold.count > 0 ? FOLD_CROSSING : FOLD_NONE;
    return fold;
}

/* Sliding facets that show their backs. */
static struct fold look_at_sliding(const struct folds *folds, int64_t begin, int64_t end, const bool *stopped)
{
    const struct fold_input *input = &folds->input;
    struct fold fold = none;
    int dim = input->dim;
    (void)stopped;
    for (int64_t f = begin; f < end; f++) {
        double now[3], rest[3];
        if (!input->slides[f]) {
            continue;
        }
        fold_area_vector(dim, folds->y, input->facet + f * dim, now);
        fold_area_vector(dim, input->x, input->facet + f * dim, rest);
        if (fold_cosine(dim, now, rest) < FOLD_REVERSING && fold.count++ == 0) {
            fold_name_facets(&folds->input, f, -1, &fold);
        }
    }
    fold.kind = fold.count > 0 ? FOLD_REVERSED : FOLD_NONE;
    return fold;
}

void folds_fill_planes(struct folds *folds, const double *y)
{
    int dim = folds->input.dim;
    memset(folds->plane, 0, (size_t)folds->input.facet_count * 7 * sizeof *folds->plane);
    for (int64_t f = 0; f < folds->input.facet_count; f++) {
        double area[3], *plane = folds->plane + folds->support[f] * 7;
        if (folds->support[f] < 0) {
            continue;
        }
        fold_area_vector(dim, y, folds->input.facet + f * dim, area);
        for (int i = 0; i < dim; i++) {
            plane[i] += area[i];
            for (int k = 0; k < dim; k++) {
                plane[3 + i] += y[(int64_t)folds->input.facet[f * dim + k] * dim + i];
            }
        }
        plane[6] += dim;
    }
}

double folds_rim_beyond(const struct folds *folds, const struct fold_rim *rim, const double *y, double *reach)
{
    int dim = folds->input.dim;
    const double *plane = folds->plane + folds->support[rim->support_facet] * 7;
    const double *node = y + (int64_t)rim->node * dim;
    double depth = 0.0;
    for (int i = 0; i < dim; i++) {
        depth += plane[i] * (node[i] - plane[3 + i] / plane[6]);
    }
    *reach = vector_distance(dim, y + (int64_t)rim->on_rim * dim, node);
    return depth / vector_length(dim, plane);
}

void folds_take_positions(struct folds *folds, const double *u)
{
    folds->largest = 0.0;
    for (int64_t i = 0; i < folds->input.node_count * folds->input.dim; i++) {
        folds->y[i] = folds->input.x[i] + u[i];
        folds->largest = fmax(folds->largest, fabs(folds->y[i]));
    }
}

struct fold folds_find(struct folds *folds, const double *u, const bool *stopped)
{
    folds_take_positions(folds, u);
    if (folds->input.slides != NULL) {
        struct fold sliding = look(folds, folds->input.facet_count, look_at_sliding, stopped);
        if (sliding.kind != FOLD_NONE) {
            return sliding;
        }
    }
    struct fold cells = look(folds, folds->input.cell_count, look_at_cells, stopped);
    if (cells.kind == FOLD_CELL) {
        return cells;
    }
    struct fold fold = look(folds, folds->ring_count, look_at_rings, stopped);
    if (fold.kind == FOLD_NONE && folds->at_rest.kind == FOLD_NONE) {
        sort_boxes(folds);
        fold = look(folds, folds->input.facet_count, look_at_boxes, stopped);
        if (fold.kind == FOLD_NONE) {
            folds_find_within(folds, &fold);
        }
    }
    return fold.kind != FOLD_NONE ? fold : cells;
}

struct fold folds_find_beyond(struct folds *folds, const double *u, const bool *stopped)
{
    struct fold fold = none;
    folds_take_positions(folds, u);
    folds_fill_planes(folds, folds->y);
    for (int64_t r = 0; r < folds->rim_count; r++) {
        const struct fold_rim *rim = &folds->rims[r];
        double reach, depth = folds_rim_beyond(folds, rim, folds->y, &reach);
        if (!stopped[rim->node] && depth > fmax(beyond_body * folds->extent, beyond_facet * reach) &&
            fold.count++ == 0) {
            fold_name_facets(&folds->input, rim->facet, rim->support_facet, &fold);
        }
    }
    fold.kind = fold.count > 0 ? FOLD_SUPPORT : FOLD_NONE;
    return fold;
}
