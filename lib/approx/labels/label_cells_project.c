/* Projection onto the nearest interface, and the distance from it. */
#include "approx/labels/label_cells_private.h"
#include "base/dense.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How near to an interface a place on it is, voxels. */
static const double least_step = 1e-3;

/* The shortest step for which the linearised differences of the shares vanish; false if these do not
 * change, or are not less than *residual, which becomes their norm. */
static bool newton_step(const struct labels *labels, int count, const uint16_t label[], const double x[],
                        double *residual, double step[3])
{
    int rows = count - 1, dim = labels->dim;
    double J[3][3] = {{0}}, A[9], g[3], voxel = labels_voxel(labels);
    rows = rows < dim ? rows : dim;
    for (int r = 0; r < rows; r++) {
        g[r] = labels_difference(labels, x, label[0], label[r + 1], J[r]);
    }
    double last = *residual;
    *residual = vector_length(rows, g);
    if (!(*residual < last)) {
        return false;
    }
    for (int r = 0; r < rows; r++) {
        for (int c = 0; c < rows; c++) {
            A[r * rows + c] = vector_dot(dim, J[r], J[c]);
        }
        if (!(A[r * rows + r] * voxel * voxel > 1e-4)) {
            return false;
        }
        A[r * rows + r] *= 1 + 1e-3;
    }
    if (!dense_factorise(rows, A)) {
        return false;
    }
    dense_solve(rows, A, g);
    double length = 0;
    for (int d = 0; d < dim; d++) {
        step[d] = 0;
        for (int r = 0; r < rows; r++) {
            step[d] -= J[r][d] * g[r];
        }
        length += step[d] * step[d];
    }
    length = sqrt(length);
    for (int d = 0; d < dim && length > voxel / 2; d++) {
        step[d] *= voxel / 2 / length;
    }
    return isfinite(length);
}

bool interface_project(const struct labels *labels, int count, const uint16_t label[], double x[])
{
    double y[3] = {0}, length = INFINITY, residual = INFINITY, voxel = labels_voxel(labels);
    struct label_mix mix;
    memcpy(y, x, (size_t)labels->dim * sizeof *x);
    for (int i = 0; i < 20 && length > least_step * voxel; i++) {
        double step[3];
        if (!newton_step(labels, count, label, y, &residual, step)) {
            return false;
        }
        length = 0;
        for (int d = 0; d < labels->dim; d++) {
            y[d] += step[d];
            length = fmax(length, fabs(step[d]));
        }
    }
    labels_mix(labels, y, &mix);
    double share = label_share(&mix, label[0]);
    for (int i = 0; i < mix.count; i++) {
        if (mix.share[i] > share + 0.05) {
            return false;
        }
    }
    memcpy(x, y, (size_t)labels->dim * sizeof *x);
    return length <= least_step * voxel;
}

static bool is_beyond(const struct interface_beyond *beyond, int32_t label)
{
    return beyond->label >= 0 ? label == beyond->label : beyond->keep[label] == beyond->kept;
}

/* Largest distance of a search for an interface, voxels. */
static const double most_voxels = 6.0;

/* The label of the largest share at x among those that are beyond, or are not; -1: none. */
static int32_t largest(const struct label_mix *mix, const struct interface_beyond *beyond, bool is)
{
    int best = -1;
    for (int i = 0; i < mix->count; i++) {
        if (is_beyond(beyond, mix->label[i]) == is && (best < 0 || mix->share[i] > mix->share[best])) {
            best = i;
        }
    }
    return best >= 0 ? mix->label[best] : -1;
}

/* Move place[], beyond, to where that begins on the way from x. */
static void step_back(const struct labels *labels, const struct interface_beyond *beyond, const double x[],
                      double place[3])
{
    double low = 0, high = 1, distance = vector_distance(labels->dim, x, place);
    while ((high - low) * distance > least_step * labels_voxel(labels)) {
        double t = (low + high) / 2, y[3] = {0};
        vector_between(labels->dim, x, place, t, y);
        *(is_beyond(beyond, labels_at(labels, y)) ? &high : &low) = t;
    }
    vector_between(labels->dim, x, place, high, place);
}

/* Turn the way from x to a place on the interface into the direction in which the label beyond gains. False
 * if it does not lie there. */
static bool turn(const struct labels *labels, const struct interface_beyond *beyond, const double x[],
                 double place[3])
{
    struct label_mix mix;
    double gradient[3], end[3] = {0}, distance = vector_distance(labels->dim, x, place);
    labels_mix(labels, place, &mix);
    int32_t there = largest(&mix, beyond, true), here = largest(&mix, beyond, false);
    if (there < 0 || here < 0) {
        return false;
    }
    (void)labels_difference(labels, place, there, here, gradient);
    double length = vector_length(labels->dim, gradient);
    for (int d = 0; d < labels->dim; d++) {
        end[d] = x[d] + distance / length * gradient[d];
    }
    bool lies = length > 0 && is_beyond(beyond, labels_at(labels, end));
    memcpy(place, lies ? end : place, sizeof end);
    return lies;
}

/* Whether the voxel at place[] lies beyond, and the way from x to there reaches beyond before `least`:
 * place[] is moved to where that begins. */
static bool begins_beyond(const struct labels *labels, const struct interface_beyond *beyond,
                          const double x[], double least, double place[3])
{
    if (!is_beyond(beyond, labels_nearest(labels, place))) {
        return false;
    }
    vector_between(labels->dim, x, place, fmin(1, least / vector_distance(labels->dim, x, place)), place);
    if (!is_beyond(beyond, labels_at(labels, place))) {
        return false;
    }
    step_back(labels, beyond, x, place);
    return true;
}

/* place[]: the nearest one to x where the label beyond begins, on the ways to the places of a grid about x
 * with the spacing of the voxels, within `reach` and a spacing, m. False if there is none. */
static bool find_nearest(const struct labels *labels, const struct interface_beyond *beyond, const double x[],
                         double reach, double place[3])
{
    int dim = labels->dim;
    double spacing = labels_voxel(labels), least = reach + spacing;
    bool found = false;
    for (int shell = 1; (shell - 1) * spacing <= fmin(reach, least); shell++) {
        int side = 2 * shell + 1, rows = dim == 3 ? side * side : side;
        for (int row = 0; row < rows; row++) {
            int j = row % side - shell, k = dim == 3 ? row / side - shell : 0;
            int step = abs(j) == shell || abs(k) == shell ? 1 : 2 * shell;
            for (int i = -shell; i <= shell; i += step) {
                double y[3] = {x[0] + spacing * i, x[1] + spacing * j, dim == 3 ? x[2] + spacing * k : 0};
                if (begins_beyond(labels, beyond, x, least, y)) {
                    found = true;
                    least = vector_distance(dim, x, y);
                    memcpy(place, y, sizeof y);
                }
            }
        }
    }
    return found;
}

/* Move x to the nearest place where the label beyond begins. False if there is none within `reach`, m. */
static bool search_change(const struct labels *labels, const struct interface_beyond *beyond, double reach,
                          double x[])
{
    double place[3] = {0};
    if (!find_nearest(labels, beyond, x, reach, place)) {
        return false;
    }
    for (int turns = 0; turns < 4 && turn(labels, beyond, x, place); turns++) {
        step_back(labels, beyond, x, place);
    }
    if (!(vector_distance(labels->dim, x, place) <= reach)) {
        return false;
    }
    memcpy(x, place, (size_t)labels->dim * sizeof *x);
    return true;
}

/* Move x onto the surface of the body, where the largest shares of kept and of other labels are equal. If
 * Newton's method fails, it is searched for. False if there is none near. */
static bool project_to_surface(const struct labels *labels, const bool *keep, double reach, double x[])
{
    const struct interface_beyond other = {-1, keep, !keep[labels_at(labels, x)]};
    struct label_mix mix;
    labels_mix(labels, x, &mix);
    int32_t within = label_largest(&mix, keep, true), outside = label_largest(&mix, keep, false);
    const uint16_t pair[2] = {(uint16_t)within, (uint16_t)outside};
    return interface_project(labels, 2, pair, x) || search_change(labels, &other, reach, x);
}

bool node_project(const struct shaping *shaping, int64_t node, double x[])
{
    const struct labels *labels = shaping->labels;
    const struct label_cells_star *star = &shaping->star;
    for (int i = 0; i < star->labels[node]; i++) {
        if (!shaping->keep[star->label[node][i]]) {
            return project_to_surface(labels, shaping->keep, most_voxels * labels_voxel(labels), x);
        }
    }
    if (interface_project(labels, star->labels[node], star->label[node], x)) {
        return true;
    }
    /* Instead of the place where all meet, the nearest interface of two of them. */
    uint16_t pair[2] = {(uint16_t)labels_at(labels, x), 0};
    double best[3] = {0}, least = INFINITY, reach = most_voxels * labels_voxel(labels);
    for (int i = 0; i < star->labels[node]; i++) {
        const struct interface_beyond region = {star->label[node][i], shaping->keep, true};
        double place[3] = {0};
        memcpy(place, x, (size_t)labels->dim * sizeof *place);
        pair[1] = star->label[node][i];
        if (pair[1] != pair[0] &&
            (interface_project(labels, 2, pair, place) ||
             search_change(labels, &region, fmin(reach, least), place)) &&
            vector_distance(labels->dim, place, x) < least) {
            least = vector_distance(labels->dim, place, x);
            memcpy(best, place, sizeof best);
        }
    }
    if (least < INFINITY) {
        memcpy(x, best, (size_t)labels->dim * sizeof *x);
    }
    return least < INFINITY;
}

double interface_distance(const struct labels *labels, const double x[],
                          const struct interface_beyond *beyond)
{
    struct label_mix mix;
    double place[3] = {0};
    int32_t here = labels_at(labels, x);
    if (is_beyond(beyond, here)) {
        return 0;
    }
    labels_mix(labels, x, &mix);
    int32_t there = beyond->label >= 0 ? beyond->label : label_largest(&mix, beyond->keep, beyond->kept);
    const uint16_t pair[2] = {(uint16_t)here, (uint16_t)there};
    memcpy(place, x, (size_t)labels->dim * sizeof *place);
    double least = INFINITY;
    if (there >= 0 && interface_project(labels, 2, pair, place)) {
        least = vector_distance(labels->dim, place, x);
    }
    /* Newton's method need not find the nearest place. */
    memcpy(place, x, (size_t)labels->dim * sizeof *place);
    if (!(least < labels_voxel(labels) / 2) &&
        search_change(labels, beyond, most_voxels * labels_voxel(labels), place)) {
        least = fmin(least, vector_distance(labels->dim, place, x));
    }
    return least;
}
