/* Projection onto the nearest interface, and the distance from it. */
#include "approx/labels/label_cells_private.h"
#include "base/dense.h"
#include "base/vector.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* Where a share is below this, the interface is searched for: the share is too flat for Newton's method. */
static const double least_share = 0.1;

/* The shortest step for which the linearised differences of the shares vanish; false if these do not
 * change. */
static bool newton_step(const struct labels *labels, int count, const uint16_t label[], const double x[],
                        double step[3])
{
    int rows = count - 1, dim = labels->dim;
    double J[3][3] = {{0}}, A[9], g[3], voxel = labels_voxel(labels);
    rows = rows < dim ? rows : dim;
    for (int r = 0; r < rows; r++) {
        g[r] = labels_difference(labels, x, label[0], label[r + 1], J[r]);
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
    double y[3] = {0}, length = INFINITY, voxel = labels_voxel(labels);
    struct label_mix mix;
    memcpy(y, x, (size_t)labels->dim * sizeof *x);
    for (int i = 0; i < 20 && length > 1e-3 * voxel; i++) {
        double step[3];
        if (!newton_step(labels, count, label, y, step)) {
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
    return length <= 1e-3 * voxel;
}

static bool is_beyond(const struct interface_beyond *beyond, int32_t label)
{
    return beyond->label >= 0 ? label == beyond->label : beyond->keep[label] == beyond->kept;
}

/* Largest distance of a search for an interface, voxels. */
static const double most_voxels = 6.0;

/* By how much the largest share at x exceeds those of the labels beyond: 0 or less if x lies in one. */
static double margin(const struct labels *labels, const double x[], const struct interface_beyond *beyond)
{
    struct label_mix mix;
    int best = 0;
    double largest = 0;
    labels_mix(labels, x, &mix);
    for (int i = 0; i < mix.count; i++) {
        bool more = mix.share[i] > mix.share[best];
        best = more || (mix.share[i] == mix.share[best] && mix.label[i] < mix.label[best]) ? i : best;
        largest = is_beyond(beyond, mix.label[i]) ? fmax(largest, mix.share[i]) : largest;
    }
    return is_beyond(beyond, mix.label[best]) ? -1 : mix.share[best] - largest;
}

/* A direction of a search, m; the most by which the margin falls in a step along it; and the next step at
 * which there may be a label beyond. */
struct ray {
    double step[3], fall;
    int next;
};

/* The rays from x in steps of a length, m. Along an axis of the voxels a share falls, and another one grows,
 * by at most .75 a voxel, the sum of the positive slopes of the splines. */
static void make_rays(const struct labels *labels, double length, double here, struct ray *ray)
{
    for (int r = 0; r < label_cells_directions(labels->dim); r++) {
        double norm = label_cells_direction(labels->dim, r, ray[r].step), world[3] = {0};
        for (int d = 0; d < labels->dim; d++) {
            ray[r].step[d] *= norm > 0 ? length / norm : 0;
            world[labels->dim == 3 ? d : labels->axis[d]] = ray[r].step[d];
        }
        ray[r].fall = 0;
        for (int e = 0; e < 3; e++) {
            ray[r].fall += 1.5 * fabs(vector_dot(3, labels->to_voxel[e], world));
        }
        ray[r].next = norm > 0 ? (int)fmax(1, here / ray[r].fall) : here > 0 ? INT_MAX : 1;
    }
}

/* The least distance, in steps of a tenth of a voxel, at which there is a label beyond in some direction, and
 * place[]; infinity if there is none within `reach`. */
static double search_beyond(const struct labels *labels, const double x[],
                            const struct interface_beyond *beyond, double reach, double place[3])
{
    int dim = labels->dim;
    double length = 0.1 * labels_voxel(labels);
    int steps = (int)ceil(reach / length - 1e-6);
    struct ray ray[27];
    make_rays(labels, length, margin(labels, x, beyond), ray);
    for (int step = 1; step <= steps; step++) {
        for (int r = 0; r < label_cells_directions(dim); r++) {
            if (ray[r].next > step) {
                continue;
            }
            for (int d = 0; d < dim; d++) {
                place[d] = x[d] + step * ray[r].step[d];
            }
            double there = margin(labels, place, beyond);
            if (there < 0) {
                return step * length;
            }
            ray[r].next = step + (int)fmax(1, there / ray[r].fall);
        }
    }
    return INFINITY;
}

/* Move x to the nearest place, among those of search_beyond, where the label beyond begins. */
static bool search_change(const struct labels *labels, const struct interface_beyond *beyond, double reach,
                          double x[])
{
    double place[3] = {0}, low = 0, high = 1;
    if (!(search_beyond(labels, x, beyond, reach, place) < INFINITY)) {
        return false;
    }
    for (int step = 0; step < 12; step++) {
        double t = (low + high) / 2, y[3] = {0};
        vector_between(labels->dim, x, place, t, y);
        *(is_beyond(beyond, labels_at(labels, y)) ? &high : &low) = t;
    }
    vector_between(labels->dim, x, place, high, x);
    return true;
}

/* Move x onto the surface of the body, where the largest shares of kept and of other labels are equal. Far
 * from it, and if Newton's method fails, it is searched for. False if there is none near. */
static bool project_to_surface(const struct labels *labels, const bool *keep, double reach, double x[])
{
    const struct interface_beyond other = {-1, keep, !keep[labels_at(labels, x)]};
    struct label_mix mix;
    labels_mix(labels, x, &mix);
    int32_t within = label_largest(&mix, keep, true), outside = label_largest(&mix, keep, false);
    const uint16_t pair[2] = {(uint16_t)within, (uint16_t)outside};
    bool near = fmin(label_share(&mix, within), label_share(&mix, outside)) >= least_share;
    return (near && interface_project(labels, 2, pair, x)) || search_change(labels, &other, reach, x);
}

bool node_project(const struct shaping *shaping, int64_t node, double x[])
{
    const struct labels *labels = &shaping->labels;
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

/* Move x onto the rim where a ball cuts the surface of the body, within `reach`, by alternating moves onto
 * the surface and along it onto the ball. */
static bool ball_project(const struct shaping *shaping, const struct label_ball *ball, double x[])
{
    const struct labels *labels = &shaping->labels;
    int dim = labels->dim;
    double voxel = labels_voxel(labels), y[3] = {0}, off = INFINITY;
    memcpy(y, x, (size_t)dim * sizeof *x);
    for (int i = 0; i < 20 && project_to_surface(labels, shaping->keep, shaping->reach, y); i++) {
        double normal[3] = {0}, along[3] = {0}, from[3] = {0};
        struct label_mix mix;
        labels_mix(labels, y, &mix);
        int32_t within = label_largest(&mix, shaping->keep, true);
        int32_t outside = label_largest(&mix, shaping->keep, false);
        vector_subtract(dim, y, ball->centre, from);
        off = vector_length(dim, from) - ball->radius;
        if (fabs(off) <= 1e-3 * voxel || within < 0 || outside < 0) {
            break;
        }
        (void)labels_difference(labels, y, within, outside, normal);
        double share = vector_dot(dim, from, normal) / vector_dot(dim, normal, normal);
        for (int d = 0; d < dim; d++) {
            along[d] = from[d] - share * normal[d];
        }
        double step = off * vector_length(dim, from) / vector_dot(dim, along, along);
        for (int d = 0; d < dim; d++) {
            y[d] -= step * along[d];
        }
        if (!(vector_distance(dim, x, y) <= shaping->reach)) {
            return false;
        }
    }
    if (fabs(off) > 1e-3 * voxel) {
        return false;
    }
    memcpy(x, y, (size_t)dim * sizeof *x);
    return true;
}

bool rim_project(const struct shaping *shaping, const uint16_t rim[3], double x[])
{
    const struct labels *parts = shaping->parts;
    int32_t later = rim[0] > rim[1] ? rim[0] : rim[1];
    if (parts->ball != NULL && parts->ball[later].radius > 0) {
        return ball_project(shaping, &parts->ball[later], x);
    }
    return line_project(parts, shaping->keep, shaping->reach, 3, rim, x);
}

bool line_project(const struct labels *labels, const bool *keep, double reach, int count,
                  const uint16_t label[], double x[])
{
    double y[3] = {0};
    reach = fmax(reach, most_voxels * labels_voxel(labels));
    memcpy(y, x, (size_t)labels->dim * sizeof *x);
    if (interface_project(labels, count, label, x)) {
        return true;
    }
    /* Far away: move to each of the labels in turn, and back onto the surface. */
    bool boundary = false;
    for (int i = 0; i < count; i++) {
        boundary = boundary || !keep[label[i]];
    }
    double moved = INFINITY;
    for (int round = 0; round < 4 && moved > 1e-3 * labels_voxel(labels); round++) {
        double before[3] = {0};
        memcpy(before, y, sizeof before);
        for (int i = 0; i < count; i++) {
            const struct interface_beyond region = {label[i], keep, true};
            if (keep[label[i]] && labels_at(labels, y) != label[i] &&
                !search_change(labels, &region, reach, y)) {
                return false;
            }
        }
        if (boundary && !project_to_surface(labels, keep, reach, y)) {
            return false;
        }
        moved = vector_distance(labels->dim, before, y);
    }
    if (!interface_project(labels, count, label, y)) {
        return false;
    }
    memcpy(x, y, (size_t)labels->dim * sizeof *x);
    return true;
}
