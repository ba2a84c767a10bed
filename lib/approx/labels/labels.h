/* Labels on a regular grid of voxels, and their smoothed indicator functions: the share of a label at a point
 * is the sum of cubic B-splines over its voxels, a smoothing with a standard deviation of .58 voxels. The
 * shares are twice continuously differentiable and sum to 1; the label at a point is the one of the largest
 * share, and the interface of two labels is where their shares are equal. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* The grid. Label 0 is the outside, also beyond the grid; along an axis with one voxel it extends without
 * end. Points have `dim` world coordinates, m: in 2D the first two axes, of the world and of the grid, lie in
 * the slice, which is at `across` on the third axis of the world. */
struct labels {
    int64_t size[3];
    uint16_t *label; /* size[2] * size[1] * size[0], first index fastest; less than `count` */
    int32_t count;
    double to_voxel[3][4]; /* (world, m, 1) to voxel index, voxel centres */
    int dim;
    double across;
};

/* Labels whose share at a point is not zero. */
enum { LABELS_MOST_MIXED = 64 };
struct label_mix {
    int count;
    uint16_t label[LABELS_MOST_MIXED];
    double share[LABELS_MOST_MIXED];
};

/* Voxel index of a point: voxel centres are whole numbers. */
void labels_to_voxel(const struct labels *labels, const double x[], double voxel[3]);

/* The label of the voxel nearest to a point. */
int32_t labels_nearest(const struct labels *labels, const double x[]);

/* The shares at a point. */
void labels_mix(const struct labels *labels, const double x[], struct label_mix *mix);

/* The share of a label in a mix; 0 when it is absent. */
double label_share(const struct label_mix *mix, int32_t label);

/* The label with the largest share at a point; of equal shares the lowest label. */
int32_t labels_at(const struct labels *labels, const double x[]);

/* The label with the largest share in a mix among those with keep[label] == kept (NULL: all); -1 if all these
 * shares are zero. */
int32_t label_largest(const struct label_mix *mix, const bool *keep, bool kept);

/* Share of label a minus that of b at a point, and its gradient[dim], 1/m. */
double labels_difference(const struct labels *labels, const double x[], int32_t a, int32_t b,
                         double gradient[]);

/* The box in world coordinates of the voxels whose label is not 0, with their faces: dim coordinates, m. low
 * > high if there are none. */
void labels_box(const struct labels *labels, double low[], double high[]);

/* Least size of a voxel along the axes of the grid with more than one voxel, m. */
double labels_voxel(const struct labels *labels);

/* Volume of a voxel, m3, or its area in the plane of a slice, m2. */
double labels_voxel_volume(const struct labels *labels);
