/* Vectors of doubles along the neighbours of a point: monomials, and the small symmetric systems of
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

/* value[m]: the monomials 1, x, y[, z], and of the quadratic basis x^2, xy, ... */
KERNEL_INLINE void monomials(int dim, int m, const lanes *xi, lanes *value)
{
    int k = 1 + dim;
    value[0] = (lanes){1.0, 1.0, 1.0, 1.0};
    for (int a = 0; a < dim; a++) {
        value[1 + a] = xi[a];
        for (int b = a; m > 1 + dim && b < dim; b++) {
            value[k++] = xi[a] * xi[b];
        }
    }
}

/* *value = c . p(xi), p the basis of m monomials, with as few products as possible. */
KERNEL_INLINE void polynomial(int dim, int m, const double *c, const lanes *xi, lanes *value)
{
    lanes sum = {0.0};
    int k = 1 + dim;
    for (int a = 0; a < dim; a++) {
        lanes slope = {c[1 + a], c[1 + a], c[1 + a], c[1 + a]};
        for (int b = a; m > 1 + dim && b < dim; b++) {
            slope += c[k++] * xi[b];
        }
        sum += slope * xi[a];
    }
    *value = c[0] + sum;
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
