#include "approx/cells.h"
#include "approx/stuffing_private.h"
#include "base/dense.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Nodes of interfaces are moved as long as the cells at them score at least this, or as before. */
static const double goal = 1.3;
/* Cells that score less are improved; in the end cells beyond the bounds, by nodes up to so many voxels off.
 */
static const double least_score = 1.25, last_score = 1.02, last_slack = 0.55;
/* Nodes that are cut apart move so much of the way to the middle of their own cells, by at most so many
 * voxels. */
static const double separation = 0.25, most_separation = 0.5;
enum { FIT_SWEEPS = 4 };

double stuffing_score(const struct stuffing *stuffing, int64_t cell)
{
    int dim = stuffing->dim;
    const double *x[4];
    double angles[2];
    for (int k = 0; k <= dim; k++) {
        x[k] = stuffing->x + (int64_t)stuffing->cell[cell * (dim + 1) + k] * dim;
    }
    simplex_angles(dim, x, angles);
    if (angles[0] > 0) {
        return fmin(angles[0] / STUFFING_LEAST_ANGLE, (180 - angles[1]) / (180 - STUFFING_MOST_ANGLE));
    }
    /* Inverted: its volume, of the product of its edges at one corner. */
    struct cells cells = {dim, stuffing->node_count, stuffing->x, stuffing->cell_count, stuffing->cell};
    double product = 1;
    for (int k = 1; k <= dim; k++) {
        double square = 0;
        for (int d = 0; d < dim; d++) {
            square += (x[k][d] - x[0][d]) * (x[k][d] - x[0][d]);
        }
        product *= sqrt(square);
    }
    double volume = cell_volume(&cells, cell);
    return volume < 0 ? volume / product : 0;
}

double star_score(const struct stuffing *stuffing, const struct stuffing_star *star, int64_t node)
{
    double least = INFINITY;
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        least = fmin(least, stuffing_score(stuffing, star->cell[i]));
    }
    return least;
}

void star_move(struct stuffing *stuffing, const struct stuffing_star *star, int64_t node,
               const double target[])
{
    int dim = stuffing->dim;
    double *x = stuffing->x + node * dim, before[3] = {0};
    double score = fmin(star_score(stuffing, star, node), goal);
    memcpy(before, x, (size_t)dim * sizeof *x);
    double share = 1;
    for (int halving = 0; halving < 4; halving++, share /= 2) {
        for (int d = 0; d < dim; d++) {
            x[d] = before[d] + share * (target[d] - before[d]);
        }
        if (star_score(stuffing, star, node) >= score) {
            return;
        }
    }
    memcpy(x, before, (size_t)dim * sizeof *x);
}

/* ---- onto the interfaces ---- */

/* The step of least length that makes the linearised differences zero; false where they do not change. */
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
            A[r * rows + c] = 0;
            for (int d = 0; d < dim; d++) {
                A[r * rows + c] += J[r][d] * J[c][d];
            }
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

/* The label of the largest share at a node. */
static uint16_t label_at(const struct labels *labels, const struct stuffing *stuffing, int64_t node)
{
    return (uint16_t)labels_at(labels, stuffing->x + node * stuffing->dim);
}

static bool meets(const struct stuffing_star *star, int64_t node, uint16_t label)
{
    for (int i = 0; i < star->labels[node]; i++) {
        if (star->label[node][i] == label) {
            return true;
        }
    }
    return false;
}

/* Nodes where three labels meet, and others that are off their interface. In a gap between labels that no
 * cell fills, the label there counts as well. */
static void fit(const struct labels *labels, struct stuffing *stuffing, const struct stuffing_star *star)
{
    int dim = labels->dim;
    double voxel = labels_voxel(labels);
    for (int64_t n = 0; n < stuffing->node_count; n++) {
        double target[3] = {0}, distance = 0;
        uint16_t label[STUFFING_MOST_LABELS + 1];
        int count = star->labels[n];
        if (count < 2) {
            continue;
        }
        memcpy(target, stuffing->x + n * dim, (size_t)dim * sizeof *target);
        memcpy(label, star->label[n], sizeof star->label[n]);
        if (!interface_project(labels, count, label, target)) {
            label[count] = label_at(labels, stuffing, n);
            if (meets(star, n, label[count]) || !interface_project(labels, count + 1, label, target)) {
                continue;
            }
        }
        for (int d = 0; d < dim; d++) {
            distance = fmax(distance, fabs(target[d] - stuffing->x[n * dim + d]));
        }
        if (distance > 0.01 * voxel) {
            star_move(stuffing, star, n, target);
        }
    }
}

/* ---- apart ---- */

/* Move nodes that have others at the same place towards the middle of their own cells. */
static void separate(const struct labels *labels, struct stuffing *stuffing, const struct stuffing_star *star,
                     const bool *apart)
{
    int dim = stuffing->dim;
    double most = most_separation * labels_voxel(labels);
    struct cells cells = {dim, stuffing->node_count, stuffing->x, stuffing->cell_count, stuffing->cell};
    for (int64_t n = 0; n < stuffing->node_count; n++) {
        double target[3] = {0};
        int64_t count = star->ptr[n + 1] - star->ptr[n];
        for (int64_t i = star->ptr[n]; i < star->ptr[n + 1] && apart[n]; i++) {
            double middle[3];
            cell_centroid(&cells, star->cell[i], middle);
            for (int d = 0; d < dim; d++) {
                target[d] += middle[d] / (double)count;
            }
        }
        double square = 0;
        for (int d = 0; d < dim; d++) {
            target[d] = separation * (target[d] - stuffing->x[n * dim + d]);
            square += target[d] * target[d];
        }
        for (int d = 0; d < dim; d++) {
            target[d] = stuffing->x[n * dim + d] + target[d] * fmin(1, most / sqrt(square));
        }
        if (apart[n]) {
            star_move(stuffing, star, n, target);
        }
    }
}

/* The least distance, in steps of a tenth of a voxel, at which the label is another one in some direction;
 * infinity where it is the same within three voxels. */
static double search_change(const struct labels *labels, const double x[], int32_t label)
{
    int dim = labels->dim, directions = dim == 2 ? 9 : 27;
    double voxel = labels_voxel(labels);
    for (int step = 1; step <= 30; step++) {
        for (int direction = 0; direction < directions; direction++) {
            static const int power[3] = {1, 3, 9};
            double square = 0, place[3] = {0};
            for (int d = 0; d < dim; d++) {
                place[d] = direction / power[d] % 3 - 1;
                square += place[d] * place[d];
            }
            for (int d = 0; d < dim; d++) {
                place[d] = x[d] + (square > 0 ? 0.1 * step * voxel * place[d] / sqrt(square) : 0);
            }
            if (labels_at(labels, place) != label) {
                return 0.1 * step * voxel;
            }
        }
    }
    return INFINITY;
}

/* How far a node of interfaces is from where the label there gives way to one that meets at it, m. */
static double distance(const struct labels *labels, const struct stuffing *stuffing,
                       const struct stuffing_star *star, int64_t node)
{
    int dim = labels->dim;
    const double *x = stuffing->x + node * dim;
    uint16_t pair[2] = {label_at(labels, stuffing, node), 0};
    double least = INFINITY;
    for (int i = 0; i < star->labels[node]; i++) {
        double place[3] = {0}, square = 0;
        memcpy(place, x, (size_t)dim * sizeof *place);
        pair[1] = star->label[node][i];
        if (pair[1] == pair[0] || !interface_project(labels, 2, pair, place)) {
            continue;
        }
        for (int d = 0; d < dim; d++) {
            square += (place[d] - x[d]) * (place[d] - x[d]);
        }
        least = fmin(least, sqrt(square));
    }
    return least < INFINITY ? least : search_change(labels, x, pair[0]);
}

static void measure(const struct labels *labels, struct stuffing *stuffing, const struct stuffing_star *star)
{
    for (int64_t n = 0; n < stuffing->node_count; n++) {
        double off = star->labels[n] > 1 ? distance(labels, stuffing, star, n) : 0;
        stuffing->astray += off > STUFFING_MOST_ASTRAY * labels_voxel(labels);
        stuffing->farthest = off < INFINITY ? fmax(stuffing->farthest, off) : stuffing->farthest;
    }
}

enum status stuffing_improve(const struct labels *labels, const struct stuffing_options *options,
                             const bool *apart, const double *dropped, struct stuffing *stuffing,
                             struct error *error)
{
    enum status status;
    struct stuffing_star star = {0};
    TRY(star_make(stuffing, &star, error));
    for (int sweep = 0; sweep < FIT_SWEEPS; sweep++) {
        fit(labels, stuffing, &star);
        stuffing_repair(labels, least_score, 0, stuffing, &star);
    }
    separate(labels, stuffing, &star, apart);
    TRY(stuffing_volumes(labels, options->keep, apart, dropped, &star, stuffing, error));
    stuffing_repair(labels, last_score, last_slack * labels_voxel(labels), stuffing, &star);
    measure(labels, stuffing, &star);
done:
    star_free(&star);
    return status;
}
