/* States that are not unique: creased sides, and sides wrapped around corners; see folds.h. */
#include "solid/folds/folds_private.h"

#include <math.h>

/* Cosine of 60 degrees between the normals at rest of facets that meet: above it the side is smooth there,
 * below it there is a corner. */
static const double alike = 0.5;
/* Corners lie on each other by less than this share of the larger facet there. */
static const double corner_share = 0.5;

struct fold folds_find_closed(struct folds *folds, const double *u)
{
    struct fold fold = FOLD_NOTHING;
    const struct fold_input *input = &folds->input;
    folds_take_positions(folds, u);
    for (int64_t i = 0; i < folds->ring_count; i++) {
        int64_t f = folds->rings[i].facet, g = folds->rings[i].other;
        if (g >= 0 && fold_facet_cosine(input, folds->y, f, g) < FOLD_REVERSING &&
            fold_facet_cosine(input, input->x, f, g) > alike && fold.count++ == 0) {
            fold_name_facets(input, f, g, &fold);
        }
    }
    fold.kind = fold.count > 0 ? FOLD_CLOSED : FOLD_NONE;
    return fold;
}

/* Whether the facets that meet there form a convex corner of the body at rest. */
static bool is_corner(const struct fold_input *input, const struct fold_ring *ring)
{
    int dim = input->dim;
    double normal[3], to_other[3], middle[3];
    if (ring->other < 0 || !(fold_facet_cosine(input, input->x, ring->facet, ring->other) < alike)) {
        return false;
    }
    face_area_vector(dim, input->x, input->facet + ring->facet * dim, normal);
    vector_middle(dim, input->x, dim, input->facet + ring->other * dim, middle);
    vector_subtract(dim, middle, input->x + (int64_t)ring->node[0] * dim, to_other);
    return vector_dot(dim, normal, to_other) < 0.0;
}

/* The longest edge of a facet at rest. */
static double facet_width(const struct fold_input *input, int64_t f)
{
    int dim = input->dim;
    const int32_t *node = input->facet + f * dim;
    double width = 0.0;
    for (int k = 0; k < dim; k++) {
        width = fmax(width, vector_distance(dim, input->x + (int64_t)node[k] * dim,
                                            input->x + (int64_t)node[(k + 1) % dim] * dim));
    }
    return width;
}

/* The distance of x from a node (2D) or an edge (3D) of the boundary at rest. */
static double distance_to(const struct fold_input *input, const struct fold_ring *ring, const double *x)
{
    double along[3], offset[3], share = 0.0;
    const double *begin = input->x + (int64_t)ring->node[0] * input->dim;
    vector_subtract(input->dim, x, begin, offset);
    if (input->dim == 3) {
        vector_subtract(3, input->x + (int64_t)ring->node[1] * 3, begin, along);
        share = fmax(0.0, fmin(1.0, vector_dot(3, along, offset) / vector_dot(3, along, along)));
        add_scaled(3, -share, along, offset);
    }
    return vector_length(input->dim, offset);
}

/* Whether a corner lay on one of another body at rest. */
static bool is_met(const struct folds *folds, const struct fold_ring *corner)
{
    const struct fold_input *input = &folds->input;
    double middle[3], width = fmax(facet_width(input, corner->facet), facet_width(input, corner->other));
    vector_middle(input->dim, input->x, input->dim - 1, corner->node, middle);
    for (int64_t i = 0; i < folds->ring_count; i++) {
        const struct fold_ring *ring = &folds->rings[i];
        if (folds->node_part[ring->node[0]] != folds->node_part[corner->node[0]] &&
            distance_to(input, ring, middle) < corner_share * fmax(width, facet_width(input, ring->facet)) &&
            is_corner(input, ring)) {
            return true;
        }
    }
    return false;
}

/* Whether all nodes of a facet are marked. */
static bool are_all(const struct fold_input *input, const bool *marked, int64_t f)
{
    bool all = true;
    for (int k = 0; k < input->dim; k++) {
        all = all && marked[input->facet[f * input->dim + k]];
    }
    return all;
}

struct fold folds_find_wrapped(const struct folds *folds)
{
    struct fold fold = FOLD_NOTHING;
    const struct fold_input *input = &folds->input;
    for (int64_t i = 0; folds->turned != NULL && i < folds->ring_count; i++) {
        int64_t f = folds->rings[i].facet, g = folds->rings[i].other;
        if (g < 0 || !are_all(input, folds->in_contact, f) || !are_all(input, folds->in_contact, g) ||
            !(are_all(input, folds->turned, f) || are_all(input, folds->turned, g)) ||
            !is_corner(input, &folds->rings[i]) || !is_met(folds, &folds->rings[i])) {
            continue;
        }
        if (fold.count++ == 0) {
            bool first = are_all(input, folds->turned, f);
            fold_name_facets(input, first ? f : g, first ? g : f, &fold);
        }
    }
    fold.kind = fold.count > 0 ? FOLD_WRAPPED : FOLD_NONE;
    return fold;
}
