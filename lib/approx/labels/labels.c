#include "approx/labels/labels.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* The labels and weights of the voxels about a point: rows of four along the first axis, those along the
 * second axis first. */
struct stencil {
    int count[3];        /* 4; 1 along an axis of one voxel, of which a row then has four copies */
    uint16_t row[16][4]; /* count[2] * count[1] */
    double weight[3][4], slope[3][4];
};

void labels_to_voxel(const struct labels *labels, const double x[], double voxel[3])
{
    const double world[3] = {x[0], x[1], labels->dim == 3 ? x[2] : labels->across};
    for (int d = 0; d < 3; d++) {
        const double *row = labels->to_voxel[d];
        voxel[d] = row[0] * world[0] + row[1] * world[1] + row[2] * world[2] + row[3];
    }
}

/* The labels of four voxels along the first axis. */
static void read_row(const struct labels *labels, int64_t first, int64_t y, int64_t z, uint16_t row[4])
{
    const int64_t *size = labels->size;
    bool within = y >= 0 && y < size[1] && z >= 0 && z < size[2];
    const uint16_t *line = labels->label + (within ? (z * size[1] + y) * size[0] : 0);
    if (within && first >= 0 && first + 4 <= size[0]) {
        memcpy(row, line + first, 4 * sizeof *row);
        return;
    }
    for (int i = 0; i < 4; i++) {
        int64_t at = size[0] == 1 ? 0 : first + i;
        row[i] = within && at >= 0 && at < size[0] ? line[at] : 0;
    }
}

int32_t labels_nearest(const struct labels *labels, const double x[])
{
    double v[3];
    int64_t at[3];
    labels_to_voxel(labels, x, v);
    for (int d = 0; d < 3; d++) {
        at[d] = labels->size[d] == 1 ? 0 : (int64_t)floor(v[d] + 0.5);
    }
    uint16_t row[4];
    read_row(labels, at[0], at[1], at[2], row);
    return row[0];
}

static void stencil_at(const struct labels *labels, const double x[], struct stencil *stencil)
{
    double voxel[3];
    int64_t first[3] = {0};
    labels_to_voxel(labels, x, voxel);
    for (int d = 0; d < 3; d++) {
        double v = voxel[d];
        double *w = stencil->weight[d], *s = stencil->slope[d];
        if (labels->size[d] == 1) {
            memset(w, 0, 4 * sizeof *w);
            memset(s, 0, 4 * sizeof *s);
            *w = 1;
            stencil->count[d] = 1;
            continue;
        }
        /* Far from the grid all is outside; keep the index within bounds. */
        v = fmin(fmax(v, -4), (double)labels->size[d] + 4);
        double base = floor(v), t = v - base, r = 1 - t;
        first[d] = (int64_t)base - 1;
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
    for (int r = 0; r < stencil->count[1] * stencil->count[2]; r++) {
        read_row(labels, first[0], first[1] + r % stencil->count[1], first[2] + r / stencil->count[1],
                 stencil->row[r]);
    }
}

/* The sum of the numbers of the voxels of a row with this label. */
static inline double sum_of(const uint16_t row[4], uint16_t label, const double number[4])
{
    double sum = 0;
    for (int i = 3; i >= 0; i--) {
        sum += row[i] == label ? number[i] : 0;
    }
    return sum;
}

void labels_mix(const struct labels *labels, const double x[], struct label_mix *mix)
{
    struct stencil stencil;
    double weight[16];
    stencil_at(labels, x, &stencil);
    int rows = stencil.count[1] * stencil.count[2];
    for (int r = 0; r < rows; r++) {
        weight[r] = stencil.weight[2][r / stencil.count[1]] * stencil.weight[1][r % stencil.count[1]];
    }
    mix->count = 0;
    for (int i = 0; i < 4 * rows; i++) {
        uint16_t label = stencil.row[i / 4][i % 4];
        int known = mix->count;
        if (i > 0 && label == stencil.row[(i - 1) / 4][(i - 1) % 4]) { /* as the one before */
            continue;
        }
        while (known > 0 && mix->label[known - 1] != label) {
            known--;
        }
        if (known == 0) {
            double share = 0;
            for (int r = i / 4; r < rows; r++) {
                share += weight[r] * sum_of(stencil.row[r], label, stencil.weight[0]);
            }
            mix->label[mix->count] = label;
            mix->share[mix->count++] = share;
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

int32_t label_largest(const struct label_mix *mix, const bool *keep, bool kept)
{
    int best = -1;
    for (int i = 0; i < mix->count; i++) {
        bool larger = best < 0 || mix->share[i] > mix->share[best] ||
                      (mix->share[i] == mix->share[best] && mix->label[i] < mix->label[best]);
        if ((keep == NULL || keep[mix->label[i]] == kept) && mix->share[i] > 0 && larger) {
            best = i;
        }
    }
    return best >= 0 ? mix->label[best] : -1;
}

int32_t labels_at(const struct labels *labels, const double x[])
{
    struct label_mix mix;
    labels_mix(labels, x, &mix);
    return label_largest(&mix, NULL, false);
}

double labels_difference(const struct labels *labels, const double x[], int32_t a, int32_t b,
                         double gradient[])
{
    struct stencil stencil;
    double value = 0, slope[3] = {0};
    stencil_at(labels, x, &stencil);
    for (int k = 0, r = 0; k < stencil.count[2]; k++) {
        for (int j = 0; j < stencil.count[1]; j++, r++) {
            const uint16_t *row = stencil.row[r];
            const double *w = stencil.weight[0], *s = stencil.slope[0];
            double more = sum_of(row, (uint16_t)a, w) - sum_of(row, (uint16_t)b, w);
            double steeper = sum_of(row, (uint16_t)a, s) - sum_of(row, (uint16_t)b, s);
            value += more * stencil.weight[1][j] * stencil.weight[2][k];
            slope[0] += steeper * stencil.weight[1][j] * stencil.weight[2][k];
            slope[1] += more * stencil.slope[1][j] * stencil.weight[2][k];
            slope[2] += more * stencil.weight[1][j] * stencil.slope[2][k];
        }
    }
    for (int d = 0; d < labels->dim; d++) {
        gradient[d] = 0;
        for (int e = 0; e < 3; e++) {
            gradient[d] += slope[e] * labels->to_voxel[e][d];
        }
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
            double x = inverse[d][0] * v[0] + inverse[d][1] * v[1] + inverse[d][2] * v[2];
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
        const double column[3] = {inverse[0][e], inverse[1][e], inverse[2][e]};
        double length = vector_length(3, column);
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
