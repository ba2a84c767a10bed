/* Crossings of boundary facets; see folds.h. */
#include "base/round_off.h"
#include "solid/contact/contact.h"
#include "solid/folds/folds_private.h"

#include <stdlib.h>

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
    return depth > (in_contact ? CONTACT_MOST_DEPTH : FOLD_BEYOND_FACET) * fmax(width[0], width[1]);
}

void folds_sort_boxes(struct folds *folds)
{
    int64_t count = folds->input.facet_count;
    for (int64_t f = 0; f < count; f++) {
        folds->boxes[f].facet.item = f;
    }
    facet_boxes_sort(folds->input.dim, folds->y, folds->input.facet, count, folds->boxes);
}

struct fold folds_search_boxes(const struct folds *folds, int64_t begin, int64_t end)
{
    struct fold fold = FOLD_NOTHING;
    int dim = folds->input.dim;
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
                fold_name_facets(&folds->input, f < g ? f : g, f < g ? g : f, &fold);
            }
        }
    }
    fold.kind = fold.count > 0 ? FOLD_CROSSING : FOLD_NONE;
    return fold;
}
