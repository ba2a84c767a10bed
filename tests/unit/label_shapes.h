/* Label images of known shapes, in the middle of a box of about 64 mm. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Voxel (i, j, k) has its centre at first + (i, j, k) * voxel, mm. */
struct label_shape {
    int64_t size[3];
    double first[3], voxel[3];
    int32_t count; /* labels, the outside with them */
    uint16_t *label;
};

enum { SHAPE_BLOBS = 12, SHAPE_PIECES = 50 };

/* Random places, mm, and sizes. */
struct shape_seeds {
    double x[SHAPE_PIECES][3], size[SHAPE_PIECES];
    int label[SHAPE_PIECES];
};

static inline double shape_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 33) / 2147483648.0;
}

static inline struct shape_seeds shape_seeds(uint64_t seed)
{
    struct shape_seeds seeds;
    for (int b = 0; b < SHAPE_PIECES; b++) {
        for (int d = 0; d < 3; d++) {
            seeds.x[b][d] = -17 + 34 * shape_random(&seed);
        }
        seeds.size[b] = 5 + 8 * shape_random(&seed);
        seeds.label[b] = 1 + (int)(3 * shape_random(&seed));
    }
    return seeds;
}

static inline double shape_square(const double a[3], const double b[3])
{
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

/* Regions of three labels: about each place those where its bell is the highest. */
static inline int shape_blobs(const struct shape_seeds *seeds, const double x[3])
{
    double best = 0.4;
    int label = 0;
    for (int b = 0; b < SHAPE_BLOBS; b++) {
        double value = exp(-shape_square(x, seeds->x[b]) / (seeds->size[b] * seeds->size[b]));
        label = value > best ? seeds->label[b] : label;
        best = fmax(value, best);
    }
    return label;
}

/* Regions of three labels in a ball, each where its random waves are the highest: gaps and necks of all
 * widths. */
static inline int shape_waves(const struct shape_seeds *seeds, const double x[3])
{
    double best = 1.2;
    int label = 0;
    for (int l = 1; l <= 3; l++) {
        double value = 0;
        for (int b = 10 * l; b < 10 * l + 10; b++) {
            const double *wave = seeds->x[b];
            value += cos(0.04 * (wave[0] * x[0] + wave[1] * x[1] + wave[2] * x[2]) + seeds->size[b]);
        }
        label = value > best ? l : label;
        best = fmax(value, best);
    }
    return label;
}

/* The piece of an atlas: the nearest place. */
static inline int shape_atlas(const struct shape_seeds *seeds, const double x[3])
{
    int nearest = 0;
    for (int b = 1; b < SHAPE_PIECES; b++) {
        nearest = shape_square(x, seeds->x[b]) < shape_square(x, seeds->x[nearest]) ? b : nearest;
    }
    return 1 + nearest;
}

/* The label at a place, mm; -1: no such shape. */
static inline int shape_label(const char *name, const struct shape_seeds *seeds, const double x[3])
{
    static const double origin[3] = {0, 0, 0};
    double r = sqrt(shape_square(x, origin)), axial = hypot(x[0], x[1]), tilted = x[2] + 0.3 * x[0];
    if (strcmp(name, "sphere") == 0) {
        return r < 24;
    }
    if (strcmp(name, "torus") == 0) {
        return hypot(axial - 17, x[2]) < 8;
    }
    if (strcmp(name, "two") == 0) { /* that touch, in a sphere */
        return r > 24 ? 0 : x[0] + 0.3 * x[1] < 2.2 ? 1 : 2;
    }
    if (strcmp(name, "four") == 0) { /* that meet in a point */
        int upper = x[1] > 0.3 * x[2] ? 1 : 4, lower = x[2] + 0.2 * x[0] > 3 ? 2 : 3;
        return r > 24 ? 0 : x[0] + 0.3 * x[1] < 2.2 ? upper : lower;
    }
    if (strcmp(name, "shell") == 0) { /* two voxels of another label round a ball */
        return r > 24 ? 0 : r > 22 ? 2 : 1;
    }
    if (strcmp(name, "thin") == 0) { /* two voxels of another label amid a cylinder */
        return axial > 22 || fabs(x[2]) > 15 ? 0 : fabs(tilted) < 1 ? 2 : 1;
    }
    if (strcmp(name, "layer") == 0) {
        return axial < 22 && fabs(tilted) < 1;
    }
    if (strcmp(name, "boxes") == 0) { /* two that touch by an edge, and a speck */
        bool low = x[0] < 0 && x[1] < 0 && x[0] > -18 && x[1] > -18;
        bool high = x[0] > 0 && x[1] > 0 && x[0] < 18 && x[1] < 18;
        return fabs(x[2]) < 12 && (low || high);
    }
    if (strcmp(name, "balls") == 0) { /* two, a voxel apart */
        static const double low[3] = {-8.5, -8.5, -8.5}, high[3] = {8.5, 8.5, 8.5};
        return shape_square(x, low) < 14.2 * 14.2 || shape_square(x, high) < 14.2 * 14.2;
    }
    if (strcmp(name, "bar") == 0 || strcmp(name, "wire") == 0) { /* two balls, joined by 2 mm or by 1 mm */
        double half = strcmp(name, "bar") == 0 ? 1 : 0.5, away = fabs(x[0]) - 16;
        return away * away + x[1] * x[1] + x[2] * x[2] < 13 * 13 ||
               (away < 0 && fabs(x[1]) < half && fabs(x[2]) < half);
    }
    if (strcmp(name, "blobs") == 0) {
        return shape_blobs(seeds, x);
    }
    if (strcmp(name, "waves") == 0) {
        return r > 24 ? 0 : shape_waves(seeds, x);
    }
    return strcmp(name, "atlas") != 0 ? -1 : r > 24 ? 0 : shape_atlas(seeds, x);
}

/* Voxels of so many mm. False for an unknown name or without memory. */
static inline bool label_shape_make(const char *name, uint64_t seed, const double voxel[3],
                                    struct label_shape *shape)
{
    struct shape_seeds seeds = shape_seeds(seed);
    *shape = (struct label_shape){0};
    for (int d = 0; d < 3; d++) {
        shape->voxel[d] = voxel[d];
        shape->size[d] = (int64_t)(64 / voxel[d]);
        shape->first[d] = 0.3 - (double)(shape->size[d] - 1) * voxel[d] / 2;
    }
    shape->label = calloc((size_t)(shape->size[0] * shape->size[1] * shape->size[2]), sizeof *shape->label);
    for (int64_t v = 0; shape->label != NULL && v < shape->size[0] * shape->size[1] * shape->size[2]; v++) {
        const int64_t at[3] = {v % shape->size[0], v / shape->size[0] % shape->size[1],
                               v / shape->size[0] / shape->size[1]};
        double x[3];
        for (int d = 0; d < 3; d++) {
            x[d] = shape->first[d] + (double)at[d] * voxel[d];
        }
        int label = shape_label(name, &seeds, x);
        if (label < 0) {
            free(shape->label);
            shape->label = NULL;
            break;
        }
        shape->label[v] = (uint16_t)label;
        shape->count = label + 1 > shape->count ? label + 1 : shape->count;
    }
    return shape->label != NULL;
}
