/* Crossings of boundary facets; see folds.h. */
#include "solid/folds/folds_private.h"

#include <stdlib.h>

/* Positions below this share of the largest coordinate are round-off. */
static const double round_off = 1e-12;

/* See are_deep; contact_most_depth. */
static const double held_share = 0.5;

/* Whether the segment p q crosses facet f in the interior of both. */
static bool pierces(const struct folds *folds, int32_t p, int32_t q, int64_t f)
{
    int dim = folds->input.dim;
    const int32_t *node = folds->input.facet + f * dim;
    const double *x = fold_position(folds, p), *y = fold_position(folds, q),
                 *a = fold_position(folds, node[0]), *b = fold_position(folds, node[1]);
    const double *c = fold_position(folds, node[dim - 1]); /* 2D: b, not used */
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

/* Whether an edge of facet f (2D: the facet) without a node of facet g crosses g. */
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

/* The depth of facet g behind the plane of facet f; *width receives the length of f (3D: root of twice the
 * area). */
static double reach_behind(const struct folds *folds, int64_t f, int64_t g, double *width)
{
    int dim = folds->input.dim;
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
        if (size2 > round_off * vector_dot(3, side, side) * vector_dot(3, other_side, other_side)) {
            least = fmin(least, fmin(high[0] - low[1], high[1] - low[0]) / sqrt(size2));
        }
    }
    return least;
}

/* Whether a node of the facet is in contact with another part of the body. */
static bool is_in_contact(const struct folds *folds, int64_t f)
{
    bool any = false;
    for (int k = 0; k < folds->input.dim && folds->in_contact != NULL; k++) {
        any = any || folds->in_contact[folds->input.facet[f * folds->input.dim + k]];
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
    depth = folds->input.dim == 3 ? fmin(depth, apart_across_edges(folds, f, g)) : depth;
    bool in_contact = is_in_contact(folds, f) && is_in_contact(folds, g);
    return depth > (in_contact ? held_share : FOLD_BEYOND_FACET) * fmax(width[0], width[1]);
}

/* Whether two boxes overlap along all axes but the first. */
static bool boxes_meet(const struct box *one, const struct box *other)
{
    bool meet = true;
    for (int i = 1; i < one->dim; i++) {
        meet = meet && one->low[i] <= other->high[i] && other->low[i] <= one->high[i];
    }
    return meet;
}

void folds_sort_boxes(struct folds *folds)
{
    int dim = folds->input.dim;
    for (int64_t f = 0; f < folds->input.facet_count; f++) {
        struct box box = box_of_nodes(dim, folds->y, folds->input.facet + f * dim, dim);
        folds->boxes[f] = (struct fold_box){{box.low[0], f}, box};
    }
    qsort(folds->boxes, (size_t)folds->input.facet_count, sizeof *folds->boxes, compare_placed);
}

struct fold folds_search_boxes(const struct folds *folds, int64_t begin, int64_t end)
{
    struct fold fold = FOLD_NOTHING;
    int64_t count = folds->input.facet_count;
    const struct fold_box *boxes = folds->boxes;
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
