/* Vectors of doubles along the neighbours of a point: monomials, moments, and the small symmetric systems of
 * the moments; private to lib/approx. */
#pragma once

#include "approx/mls/mls.h"
#include "base/processor.h"

#include <math.h>
#include <string.h>

#define LANES 4
typedef double lanes __attribute__((vector_size(8 * LANES)));

/* Unroll the loops over monomials completely, so that the arrays they index stay in registers. */
#define UNROLL _Pragma("GCC unroll 10")

/* Number of monomials of degree at most 4 in 3D: the distinct entries of the moment matrix of the quadratic
 * basis. */
#define MLS_MOMENTS 35

/* moment_index[k][l]: the moment that is the entry (k, l) of the moment matrix, in the order of
 * add_moments. */
static const uint8_t moment_index_2[6][6] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},
                                             {2, 4, 5, 7, 8, 9},    {3, 6, 7, 10, 11, 12},
                                             {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};
static const uint8_t moment_index_3[10][10] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9},          {1, 4, 5, 6, 10, 11, 12, 13, 14, 15},
    {2, 5, 7, 8, 11, 13, 14, 16, 17, 18},    {3, 6, 8, 9, 12, 14, 15, 17, 18, 19},
    {4, 10, 11, 12, 20, 21, 22, 23, 24, 25}, {5, 11, 13, 14, 21, 23, 24, 26, 27, 28},
    {6, 12, 14, 15, 22, 24, 25, 27, 28, 29}, {7, 13, 16, 17, 23, 26, 27, 30, 31, 32},
    {8, 14, 17, 18, 24, 27, 28, 31, 32, 33}, {9, 15, 18, 19, 25, 28, 29, 32, 33, 34}};

KERNEL_INLINE int moment_index(int dim, int k, int l)
{
    return dim == 2 ? moment_index_2[k][l] : moment_index_3[k][l];
}

/* Number of monomials of degree at most `degree`. */
KERNEL_INLINE int moment_count(int dim, int degree)
{
    static const int count[2][5] = {{1, 3, 6, 10, 15}, {1, 4, 10, 20, 35}};
    return count[dim - 2][degree];
}

/* sum[] += w times each monomial of degree at most `degree` (2 .. 4), graded. */
KERNEL_INLINE void add_moments_2(int degree, const lanes *weight, const lanes *xi, lanes *sum)
{
    lanes w = *weight, x = xi[0], y = xi[1];
    lanes wx = w * x, wy = w * y;
    lanes xx = wx * x, xy = wx * y, yy = wy * y;
    sum[0] += w;
    sum[1] += wx;
    sum[2] += wy;
    sum[3] += xx;
    sum[4] += xy;
    sum[5] += yy;
    if (degree > 2) {
        lanes xxx = xx * x, xxy = xx * y, xyy = xy * y, yyy = yy * y;
        sum[6] += xxx;
        sum[7] += xxy;
        sum[8] += xyy;
        sum[9] += yyy;
        if (degree > 3) {
            sum[10] += xxx * x;
            sum[11] += xxx * y;
            sum[12] += xxy * y;
            sum[13] += xyy * y;
            sum[14] += yyy * y;
        }
    }
}

KERNEL_INLINE void add_moments_3(int degree, const lanes *weight, const lanes *xi, lanes *sum)
{
    lanes w = *weight, x = xi[0], y = xi[1], z = xi[2];
    lanes wx = w * x, wy = w * y, wz = w * z;
    lanes xx = wx * x, xy = wx * y, xz = wx * z, yy = wy * y, yz = wy * z, zz = wz * z;
    sum[0] += w;
    sum[1] += wx;
    sum[2] += wy;
    sum[3] += wz;
    sum[4] += xx;
    sum[5] += xy;
    sum[6] += xz;
    sum[7] += yy;
    sum[8] += yz;
    sum[9] += zz;
    if (degree > 2) {
        lanes xxx = xx * x, xxy = xx * y, xxz = xx * z, xyy = xy * y, xyz = xy * z, xzz = xz * z;
        lanes yyy = yy * y, yyz = yy * z, yzz = yz * z, zzz = zz * z;
        sum[10] += xxx;
        sum[11] += xxy;
        sum[12] += xxz;
        sum[13] += xyy;
        sum[14] += xyz;
        sum[15] += xzz;
        sum[16] += yyy;
        sum[17] += yyz;
        sum[18] += yzz;
        sum[19] += zzz;
        if (degree > 3) {
            sum[20] += xxx * x;
            sum[21] += xxx * y;
            sum[22] += xxx * z;
            sum[23] += xxy * y;
            sum[24] += xxy * z;
            sum[25] += xxz * z;
            sum[26] += xyy * y;
            sum[27] += xyy * z;
            sum[28] += xyz * z;
            sum[29] += xzz * z;
            sum[30] += yyy * y;
            sum[31] += yyy * z;
            sum[32] += yyz * z;
            sum[33] += yzz * z;
            sum[34] += zzz * z;
        }
    }
}

KERNEL_INLINE void add_moments(int dim, int degree, const lanes *weight, const lanes *xi, lanes *sum)
{
    if (dim == 2) {
        add_moments_2(degree, weight, xi, sum);
    } else {
        add_moments_3(degree, weight, xi, sum);
    }
}

/* *value = c . p(xi), p the basis of m monomials. */
KERNEL_INLINE void polynomial(int dim, int m, const double *c, const lanes *xi, lanes *value)
{
    if (m == 3) {
        *value = c[0] + xi[0] * c[1] + xi[1] * c[2];
    } else if (m == 4) {
        *value = c[0] + xi[0] * c[1] + (xi[1] * c[2] + xi[2] * c[3]);
    } else if (dim == 2) {
        *value = c[0] + xi[0] * (c[1] + xi[0] * c[3] + xi[1] * c[4]) + xi[1] * (c[2] + xi[1] * c[5]);
    } else {
        *value = (c[0] + xi[0] * (c[1] + xi[0] * c[4] + (xi[1] * c[5] + xi[2] * c[6]))) +
                 (xi[1] * (c[2] + xi[1] * c[7] + xi[2] * c[8]) + xi[2] * (c[3] + xi[2] * c[9]));
    }
}

KERNEL_INLINE double lane_sum(const lanes *v)
{
    return ((*v)[0] + (*v)[2]) + ((*v)[1] + (*v)[3]);
}

/* The small symmetric system, M = L E L^T. */
struct mls_system {
    double matrix[MLS_MAX_BASIS][MLS_MAX_BASIS + 2]; /* M with H; rows padded to whole vectors */
    double upper[MLS_MAX_BASIS][MLS_MAX_BASIS + 2];  /* L^T */
    double inverse[MLS_MAX_BASIS];                   /* 1 / E */
};

/* Factorise. False unless every pivot, relative to the diagonal entry, exceeds `least_linear` in the linear
 * block and `least` beyond it. */
KERNEL_INLINE bool factorise(int dim, int m, double least_linear, double least, struct mls_system *system)
{
    enum { MOST_VECTORS = (MLS_MAX_BASIS + 3) / 4 };
    const int vectors = (m + 3) / 4;
    lanes row[MLS_MAX_BASIS][MOST_VECTORS];
    bool good = true;
    UNROLL
    for (int k = 0; k < m; k++) {
        memcpy(row[k], system->matrix[k], (size_t)vectors * sizeof(lanes));
    }
    UNROLL
    for (int k = 0; k < m; k++) {
        double diagonal = system->matrix[k][k], pivot = row[k][k / 4][k % 4];
        double inverse = 1.0 / pivot;
        good = good && diagonal > 1e-280 && pivot > (k <= dim ? least_linear : least) * diagonal;
        system->inverse[k] = inverse;
        for (int c = k / 4; c < vectors; c++) {
            lanes upper = row[k][c] * inverse;
            memcpy(&system->upper[k][4 * c], &upper, sizeof upper);
        }
        UNROLL
        for (int i = k + 1; i < m; i++) {
            double factor = system->upper[k][i];
            for (int c = i / 4; c < vectors; c++) {
                row[i][c] -= factor * row[k][c];
            }
        }
    }
    return good && isfinite(system->inverse[m - 1]);
}

/* x = M^-1 e_1. The newest unknown enters each sum last, so that the others do not wait for it. */
KERNEL_INLINE void substitute_unit(int m, const struct mls_system *system, double *x)
{
    x[0] = 1.0;
    UNROLL
    for (int k = 1; k < m; k++) {
        x[k] = 0.0;
        UNROLL
        for (int i = 0; i < k; i++) {
            x[k] -= system->upper[i][k] * x[i];
        }
    }
    UNROLL
    for (int k = m - 1; k >= 0; k--) {
        x[k] *= system->inverse[k];
        UNROLL
        for (int i = m - 1; i > k; i--) {
            x[k] -= system->upper[k][i] * x[i];
        }
    }
}

/* x = M^-1 x for LANES right sides at once. */
KERNEL_INLINE void substitute(int m, const struct mls_system *system, lanes *x)
{
    UNROLL
    for (int k = 1; k < m; k++) {
        UNROLL
        for (int i = 0; i < k; i++) {
            x[k] -= system->upper[i][k] * x[i];
        }
    }
    UNROLL
    for (int k = m - 1; k >= 0; k--) {
        x[k] *= system->inverse[k];
        UNROLL
        for (int i = m - 1; i > k; i--) {
            x[k] -= system->upper[k][i] * x[i];
        }
    }
}
