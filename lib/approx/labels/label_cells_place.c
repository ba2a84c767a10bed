/* The place of a node: the nearest one on its interface. */
#include "approx/labels/label_cells_private.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* How near to an interface a place on it is, voxels. */
static const double least_step = 1e-3;

/* Move x onto the interface of the labels: steps along the gradients of the differences of their shares, each
 * of which makes one difference vanish to first order. False if there is none near. */
static bool interface_project(const struct label_body *body, int count, const uint16_t label[], double x[])
{
    const struct labels *labels = body->labels;
    int dim = labels->dim;
    double y[3] = {0}, longest = INFINITY, last = INFINITY;
    struct label_mix mix;
    memcpy(y, x, (size_t)dim * sizeof *x);
    for (int i = 0; i < 20 && longest > least_step * body->voxel; i++) {
        double residual = 0;
        longest = 0;
        for (int r = 1; r < count && r <= dim; r++) {
            double gradient[3], value = labels_difference(labels, y, label[0], label[r], gradient);
            double slope = vector_length(dim, gradient), length = value / slope;
            residual += fabs(value);
            if (!(slope * body->voxel > 0.01 && residual < last)) {
                return false;
            }
            length = fmin(fmax(length, -body->voxel / 2), body->voxel / 2);
            for (int d = 0; d < dim; d++) {
                y[d] -= length * gradient[d] / slope;
            }
            longest = fmax(longest, fabs(length));
        }
        last = residual;
    }
    labels_mix(labels, y, &mix);
    double share = label_share(&mix, label[0]);
    for (int i = 0; i < mix.count; i++) {
        if (mix.share[i] > share + 0.05) {
            return false;
        }
    }
    memcpy(x, y, (size_t)dim * sizeof *x);
    return longest <= least_step * body->voxel;
}

/* The label beyond an interface: one label, or any that is kept, or any that is not. */
struct beyond {
    int32_t label; /* -1: any with keep[] == kept */
    const bool *keep;
    bool kept;
};

static bool is_beyond(const struct beyond *beyond, int32_t label)
{
    return beyond->label >= 0 ? label == beyond->label : beyond->keep[label] == beyond->kept;
}

/* Move y, beyond, to where that begins on the way from x. */
static void step_back(const struct label_body *body, const struct beyond *beyond, const double x[],
                      double y[3])
{
    int dim = body->labels->dim;
    double low = 0, high = 1, length = vector_distance(dim, x, y), end[3];
    memcpy(end, y, sizeof end);
    while ((high - low) * length > least_step * body->voxel) {
        double t = (low + high) / 2;
        vector_between(dim, x, end, t, y);
        *(is_beyond(beyond, labels_at(body->labels, y)) ? &high : &low) = t;
    }
    vector_between(dim, x, end, high, y);
}

/* Search on the ways from x to the places of a grid about it with the spacing of the voxels for one where the
 * label beyond begins, nearer than `least`, m: place[]. Returns its distance, or `least`. */
static double search(const struct label_body *body, const struct beyond *beyond, double least,
                     const double x[], double place[3])
{
    const struct labels *labels = body->labels;
    int dim = labels->dim, side = 1 + 2 * (int)ceil(least / body->voxel);
    for (int i = 0; i < side * side * (dim == 3 ? side : 1); i++) {
        const int at[3] = {i % side, i / side % side, i / side / side};
        double y[3] = {0}, square = 0, nearest = least / body->voxel + 1;
        for (int d = 0; d < dim; d++) {
            int steps = at[d] % 2 ? (at[d] + 1) / 2 : -at[d] / 2; /* 0, 1, -1, 2, -2, ... */
            y[d] = x[d] + body->voxel * steps;
            square += steps * steps;
        }
        if (square == 0 || square > nearest * nearest || !is_beyond(beyond, labels_nearest(labels, y))) {
            continue;
        }
        vector_between(dim, x, y, fmin(1, least / (body->voxel * sqrt(square))), y);
        if (is_beyond(beyond, labels_at(labels, y))) {
            step_back(body, beyond, x, y);
            least = vector_distance(dim, x, y);
            memcpy(place, y, sizeof y);
        }
    }
    return least;
}

/* Move x to the nearest place where the label beyond begins, within `reach`, m, if Newton's method does not
 * find one near. Returns its distance, infinity if there is none. */
static double move_beyond(const struct label_body *body, const struct beyond *beyond,
                          const struct label_mix *mix, double reach, double x[])
{
    const struct labels *labels = body->labels;
    double from[3] = {0}, place[3] = {0}, least = INFINITY;
    int dim = labels->dim;
    int32_t here = label_largest(mix, NULL, false), there = beyond->label;
    there = there < 0 ? label_largest(mix, beyond->keep, beyond->kept) : there;
    const uint16_t pair[2] = {(uint16_t)here, (uint16_t)there};
    memcpy(from, x, (size_t)dim * sizeof *x);
    memcpy(place, x, (size_t)dim * sizeof *x);
    if (there >= 0 && interface_project(body, 2, pair, place)) {
        least = vector_distance(dim, place, x);
    }
    /* Newton's method need not find the nearest place. */
    if (least >= body->voxel / 2) {
        double nearest = fmin(reach, least), found = search(body, beyond, nearest, from, place);
        least = found < nearest ? found : least;
    }
    if (least < INFINITY) {
        memcpy(x, place, (size_t)dim * sizeof *x);
    }
    return least;
}

double node_place(const struct label_body *body, int64_t node, bool meeting, double reach, double x[])
{
    const struct labels *labels = body->labels;
    int count = body->star.labels[node], dim = labels->dim;
    const uint16_t *label = body->star.label[node];
    double best[3] = {0}, least = INFINITY;
    struct label_mix mix;
    memcpy(best, x, (size_t)dim * sizeof *x);
    if (meeting && interface_project(body, count, label, best)) {
        least = vector_distance(dim, best, x);
        memcpy(x, best, (size_t)dim * sizeof *x);
        return least;
    }
    labels_mix(labels, x, &mix);
    int32_t here = label_largest(&mix, NULL, false);
    for (int i = 0; i < count; i++) {
        if (!body->options->keep[label[i]]) {
            const struct beyond other = {-1, body->options->keep, !body->options->keep[here]};
            return move_beyond(body, &other, &mix, reach, x);
        }
    }
    /* The nearest of the interfaces; a gap that cells fill counts where none is near. */
    for (int i = 0; i <= count; i++) {
        const struct beyond other = {i < count ? label[i] : -1, body->options->keep, false};
        double place[3] = {0};
        if (i < count ? label[i] == here
                      : !body->options->keep[here] || least <= LABEL_CELLS_NEAR * body->voxel) {
            continue;
        }
        memcpy(place, x, (size_t)dim * sizeof *x);
        double distance = move_beyond(body, &other, &mix, fmin(reach, least), place);
        if (distance < least) {
            least = distance;
            memcpy(best, place, sizeof best);
        }
    }
    if (least < INFINITY) {
        memcpy(x, best, (size_t)dim * sizeof *x);
    }
    return least;
}
