#include "approx/labels/labels.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* The place of a point in the grid, and the weights of the voxels about it along each axis. */
struct stencil {
    int64_t first[3];
    int count[3]; /* 4; 1 along an axis of one voxel */
    double weight[3][4], slope[3][4];
};

/* The three world coordinates of a point. */
static void place(const struct labels *labels, const double x[], double world[3])
{
    if (labels->dim == 3) {
        memcpy(world, x, 3 * sizeof *world);
        return;
    }
    world[3 - labels->axis[0] - labels->axis[1]] = labels->across;
    world[labels->axis[0]] = x[0];
    world[labels->axis[1]] = x[1];
}

void labels_to_voxel(const struct labels *labels, const double x[], double voxel[3])
{
    double world[3];
    place(labels, x, world);
    for (int d = 0; d < 3; d++) {
        const double *row = labels->to_voxel[d];
        voxel[d] = row[0] * world[0] + row[1] * world[1] + row[2] * world[2] + row[3];
    }
}

static void stencil_at(const struct labels *labels, const double x[], struct stencil *stencil)
{
    double voxel[3];
    labels_to_voxel(labels, x, voxel);
    for (int d = 0; d < 3; d++) {
        double v = voxel[d];
        double *w = stencil->weight[d], *s = stencil->slope[d];
        if (labels->size[d] == 1) {
            *w = 1;
            *s = 0;
            stencil->first[d] = 0;
            stencil->count[d] = 1;
            continue;
        }
        /* Far from the grid all is outside; keep the index within bounds. */
        v = fmin(fmax(v, -4), (double)labels->size[d] + 4);
        double base = floor(v), t = v - base, r = 1 - t;
        stencil->first[d] = (int64_t)base - 1;
        stencil->count[d] = 4;
        w[0] = r * r * r / 6;
        w[1] = 2.0 / 3 - t * t + t * t * t / 2;
        w[2] = 2.0 / 3 - r * r + r * r * r / 2;
        w[3] = t * t * t / 6;
        s[0] = -r * r / 2;
        s[1] = -2 * t + 1.5 * t * t;
        s[2] = 2 * r - 1.5 * r * r;
        s[3] = t * t / 2;
    }
}

/* The label of a voxel of the stencil. */
static uint16_t voxel(const struct labels *labels, const struct stencil *stencil, int i, int j, int k)
{
    int64_t at[3] = {stencil->first[0] + i, stencil->first[1] + j, stencil->first[2] + k};
    for (int d = 0; d < 3; d++) {
        if (at[d] < 0 || at[d] >= labels->size[d]) {
            return 0;
        }
    }
    return labels->label[(at[2] * labels->size[1] + at[1]) * labels->size[0] + at[0]];
}

void labels_mix(const struct labels *labels, const double x[], struct label_mix *mix)
{
    struct stencil stencil;
    int last = 0;
    stencil_at(labels, x, &stencil);
    mix->count = 0;
    for (int k = 0; k < stencil.count[2]; k++) {
        for (int j = 0; j < stencil.count[1]; j++) {
            double weight = stencil.weight[2][k] * stencil.weight[1][j];
            for (int i = 0; i < stencil.count[0]; i++) {
                uint16_t label = voxel(labels, &stencil, i, j, k);
                if (mix->count == 0 || mix->label[last] != label) {
                    for (last = 0; last < mix->count && mix->label[last] != label; last++) {
                    }
                    if (last == mix->count) {
                        mix->label[last] = label;
                        mix->share[last] = 0;
                        mix->count++;
                    }
                }
                mix->share[last] += weight * stencil.weight[0][i];
            }
        }
    }
}

double label_share(const struct label_mix *mix, int32_t label)
{
    for (int i = 0; i < mix->count; i++) {
        if (mix->label[i] == label) {
            return mix->share[i];
        }
    }
    return 0;
}

int32_t labels_at(const struct labels *labels, const double x[])
{
    struct label_mix mix;
    int best = 0;
    labels_mix(labels, x, &mix);
    for (int i = 1; i < mix.count; i++) {
        if (mix.share[i] > mix.share[best] ||
            (mix.share[i] == mix.share[best] && mix.label[i] < mix.label[best])) {
            best = i;
        }
    }
    return mix.label[best];
}

int32_t label_largest(const struct label_mix *mix, const bool *keep, bool kept)
{
    int best = -1;
    for (int i = 0; i < mix->count; i++) {
        bool larger = best < 0 || mix->share[i] > mix->share[best] ||
                      (mix->share[i] == mix->share[best] && mix->label[i] < mix->label[best]);
        if (keep[mix->label[i]] == kept && mix->share[i] > 0 && larger) {
            best = i;
        }
    }
    return best >= 0 ? mix->label[best] : -1;
}

double labels_difference(const struct labels *labels, const double x[], int32_t a, int32_t b,
                         double gradient[])
{
    struct stencil stencil;
    double value = 0, slope[3] = {0}, world[3];
    stencil_at(labels, x, &stencil);
    for (int k = 0; k < stencil.count[2]; k++) {
        for (int j = 0; j < stencil.count[1]; j++) {
            for (int i = 0; i < stencil.count[0]; i++) {
                uint16_t label = voxel(labels, &stencil, i, j, k);
                double sign = label == a ? 1 : label == b ? -1 : 0;
                const double *const w[3] = {&stencil.weight[0][i], &stencil.weight[1][j],
                                            &stencil.weight[2][k]};
                const double *const s[3] = {&stencil.slope[0][i], &stencil.slope[1][j], &stencil.slope[2][k]};
                value += sign * *w[0] * *w[1] * *w[2];
                slope[0] += sign * *s[0] * *w[1] * *w[2];
                slope[1] += sign * *w[0] * *s[1] * *w[2];
                slope[2] += sign * *w[0] * *w[1] * *s[2];
            }
        }
    }
    for (int d = 0; d < 3; d++) {
        world[d] = 0;
        for (int e = 0; e < 3; e++) {
            world[d] += slope[e] * labels->to_voxel[e][d];
        }
    }
    for (int d = 0; d < labels->dim; d++) {
        gradient[d] = world[labels->dim == 3 ? d : labels->axis[d]];
    }
    return value;
}

/* Inverse of the linear part of to_voxel. */
static void invert(const struct labels *labels, double inverse[3][3])
{
    (void)matrix_inverse(labels->to_voxel[0], labels->to_voxel[1], labels->to_voxel[2], inverse);
}

void labels_box(const struct labels *labels, double low[], double high[])
{
    int64_t least[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, most[3] = {-1, -1, -1};
    double inverse[3][3];
    const uint16_t *label = labels->label;
    for (int64_t k = 0; k < labels->size[2]; k++) {
        for (int64_t j = 0; j < labels->size[1]; j++) {
            for (int64_t i = 0; i < labels->size[0]; i++) {
                const int64_t at[3] = {i, j, k};
                for (int d = 0; d < 3 && *label != 0; d++) {
                    least[d] = at[d] < least[d] ? at[d] : least[d];
                    most[d] = at[d] > most[d] ? at[d] : most[d];
                }
                label++;
            }
        }
    }
    invert(labels, inverse);
    for (int d = 0; d < labels->dim; d++) {
        low[d] = INFINITY;
        high[d] = -INFINITY;
    }
    for (int corner = 0; corner < 8 && most[0] >= 0; corner++) {
        double v[3];
        for (int d = 0; d < 3; d++) {
            v[d] =
                (corner >> d & 1 ? (double)most[d] + 0.5 : (double)least[d] - 0.5) - labels->to_voxel[d][3];
        }
        for (int d = 0; d < labels->dim; d++) {
            const double *row = inverse[labels->dim == 3 ? d : labels->axis[d]];
            double x = row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
            low[d] = fmin(low[d], x);
            high[d] = fmax(high[d], x);
        }
    }
}

double labels_voxel(const struct labels *labels)
{
    double inverse[3][3], least = INFINITY;
    invert(labels, inverse);
    for (int e = 0; e < 3; e++) {
        double length = hypot(hypot(inverse[0][e], inverse[1][e]), inverse[2][e]);
        if (labels->size[e] > 1) {
            least = fmin(least, length);
        }
    }
    return least;
}

double labels_voxel_volume(const struct labels *labels)
{
    const double(*m)[4] = labels->to_voxel;
    double across = 1;
    for (int d = 0; d < 3; d++) {
        if (labels->dim == 2 && labels->size[d] == 1) { /* areas do not depend on the slice's thickness */
            across = vector_length(3, m[d]);
        }
    }
    return across / fabs(determinant3(m[0], m[1], m[2]));
}
