/* Labels on a regular grid of voxels, and their smoothed indicator functions: the share of a label at a point
 * is the sum of cubic B-splines over its voxels, a smoothing with a standard deviation of .58 voxels. The
 * shares are twice continuously differentiable and sum to 1; the label at a point is the one of the largest
 * share, and the interface of two labels is where their shares are equal. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct label_ball {
    double centre[3], radius; /* dim coordinates, m; radius 0: none */
};

/* The grid. Label 0 is the outside, also beyond the grid; along an axis with one voxel it extends without
 * end. Points have `dim` world coordinates, m: in 2D along the world axes `axis`, at `across` on the third.
 */
struct labels {
    int64_t size[3];
    const uint16_t *label; /* size[2] * size[1] * size[0], first index fastest; less than `count` */
    int32_t count;
    const struct label_ball *ball; /* count: balls that labels which are parts of others are made by, the
                                      later the higher; NULL: none */
    double to_voxel[3][4];         /* (world, m, 1) to voxel index, voxel centres */
    int dim;
    int axis[2];
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

/* The shares at a point. */
void labels_mix(const struct labels *labels, const double x[], struct label_mix *mix);

/* The share of a label in a mix; 0 when it is absent. */
double label_share(const struct label_mix *mix, int32_t label);

/* The label of the largest share at a point, of equal ones the lowest. */
int32_t labels_at(const struct labels *labels, const double x[]);

/* The label of the largest share in a mix among those with keep[label] == kept; -1 where all shares of these
 * are zero. */
int32_t label_largest(const struct label_mix *mix, const bool *keep, bool kept);

/* Share of label a less that of b at a point, and its gradient[dim], 1/m. */
double labels_difference(const struct labels *labels, const double x[], int32_t a, int32_t b,
                         double gradient[]);

/* The labelled world box: of the voxels, faces included, whose label is not 0; low > high when there are
 * none. dim coordinates, m. */
void labels_box(const struct labels *labels, double low[], double high[]);

/* Least extent of a voxel along an axis of the grid with more than one voxel, m. */
double labels_voxel(const struct labels *labels);
