/* Vectors of doubles along the neighbours of a point: local coordinates, weights, monomials, the small
 * symmetric systems of the moments, gradients; private to lib/approx. */
#pragma once

#include "approx/mls/mls.h"
#include "base/processor.h"

#include <math.h>
#include <string.h>

/* Rows of scratch. Their stride is at least the number of neighbours and MLS_PADDING. */
enum mls_row {
    ROW_XI,
    ROW_TURNED = ROW_XI + 3, /* A^2 xi */
    ROW_RATIO = ROW_TURNED + 3,
    ROW_WEIGHT,
    ROW_SLOPE,
    ROW_PHI,
    ROW_GRADIENT,
    ROW_ORTHOGONAL = ROW_GRADIENT + 3, /* mls_orthogonal: a matrix in the place of MLS_MAX_BASIS rows */
    MLS_ROWS = ROW_ORTHOGONAL + MLS_MAX_BASIS
};

/* Where all pivots are larger, the condition of this small matrix is good; a support is refused where the
 * reciprocal condition (of the matrix scaled to unit diagonal, from the 1-norm of R) is below the square of
 * this. */
#define MLS_SAFE_PIVOT 1e-5
#define MLS_LEAST_CONDITION (MLS_SAFE_PIVOT * MLS_SAFE_PIVOT)

/* Padding of a row beyond the number of neighbours: for the rows of H, and to whole vectors. */
#define MLS_PADDING 16

/* Evaluate at one point: phi[count] and dphi[count * dim], per unit of x, unless NULL; false if
 * mls_orthogonal() is needed. scratch[MLS_ROWS * stride]. */
bool mls_kernel(const struct mls *mls, const struct mls_support *support, double *scratch, int64_t stride,
                double *phi, double *dphi);

/* The same by orthogonal factorisation, equation (3) of lib/README.md. Any verdict other than MLS_GOOD: there
 * are none. */
enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi);

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
    double regularisation[MLS_MAX_BASIS];            /* diagonal of H */
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

/* x = M^-1 x for LANES right sides at once. The newest unknown enters each sum last, so that the others do
 * not wait for it. */
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

/* One point's neighbours in local scaled coordinates. */
struct mls_point {
    int64_t count, padded; /* padded to a multiple of LANES by neighbours beyond the support */
    int64_t stride;
    double scale; /* s */
    double *row;  /* [MLS_ROWS][stride] */
};

/* Unaligned loads and stores as copies, which compilers turn into single instructions. */
KERNEL_INLINE void load_row(const struct mls_point *point, int row, int64_t j, lanes *v)
{
    memcpy(v, point->row + row * point->stride + j, sizeof *v);
}

KERNEL_INLINE void store_row(const struct mls_point *point, int row, int64_t j, const lanes *v)
{
    memcpy(point->row + row * point->stride + j, v, sizeof *v);
}

/* A^2 xi of neighbour j; A NULL: 1. */
KERNEL_INLINE void turn_difference(const double *A, int dim, int64_t j, struct mls_point *point)
{
    const double *xi = point->row + j;
    double *turned = point->row + ROW_TURNED * point->stride + j, once[3] = {0.0};
    for (int k = 0; k < dim * dim && A != NULL; k++) {
        once[k / dim] += A[k] * xi[k % dim * point->stride];
    }
    for (int a = 0; a < dim; a++) {
        turned[a * point->stride] = A != NULL ? 0.0 : xi[a * point->stride];
        for (int b = 0; b < dim && A != NULL; b++) {
            turned[a * point->stride] += A[a * dim + b] * once[b];
        }
    }
}

/* Differences of coordinates, and radii, in rows; the largest radius. */
KERNEL_INLINE void gather(const struct mls_support *support, int dim, struct mls_point *point)
{
    double *xi = point->row, *turned = point->row + ROW_TURNED * point->stride;
    double *radius = point->row + ROW_RATIO * point->stride;
    double largest = 0.0;
    for (int64_t j = 0; j < support->count; j++) {
        int64_t node = support->neighbours[j];
        for (int a = 0; a < dim; a++) {
            xi[a * point->stride + j] = support->nodes[node * dim + a] - support->x[a];
        }
        struct own_support own = supports_seen(&support->supports, dim, node, support->side);
        turn_difference(own.stretch, dim, j, point);
        radius[j] = own.radius;
        largest = own.radius > largest ? own.radius : largest;
    }
    for (int64_t j = support->count; j < point->padded; j++) {
        for (int a = 0; a < dim; a++) {
            xi[a * point->stride + j] = turned[a * point->stride + j] = 2.0 * largest * support->widen;
        }
        radius[j] = largest;
    }
    point->scale = largest * support->widen;
}

#define WEIGHT_LOOP(formula)                                                                                 \
    for (int64_t j = 0; j < point->padded; j++) {                                                            \
        double relative = 0.0, value, slope_over_r, square = ratio[j] * ratio[j];                            \
        for (int a = 0; a < dim; a++) {                                                                      \
            relative += xi[a * stride + j] * turned[a * stride + j];                                         \
        }                                                                                                    \
        relative *= square;                                                                                  \
        formula(relative < 1.0 ? relative : 1.0, &value, &slope_over_r);                                     \
        weight[j] = relative < 1.0 ? value : 0.0;                                                            \
        slope[j] = relative < 1.0 ? slope_over_r * square : 0.0;                                             \
    }

/* Scale the coordinates; set weights, and slopes: grad w = -slope A^2 xi / s. */
KERNEL_INLINE void weigh(enum weight_function function, double widen, int dim, struct mls_point *point)
{
    int64_t stride = point->stride;
    double *restrict xi = point->row, *restrict turned = point->row + ROW_TURNED * stride;
    double *restrict ratio = point->row + ROW_RATIO * stride;
    double *restrict weight = point->row + ROW_WEIGHT * stride, *restrict slope =
                                                                    point->row + ROW_SLOPE * stride;
    double inverse = 1.0 / point->scale, relative_scale = point->scale / widen;
    for (int a = 0; a < dim; a++) {
        for (int64_t j = 0; j < point->padded; j++) {
            xi[a * stride + j] *= inverse;
            turned[a * stride + j] *= inverse;
        }
    }
    for (int64_t j = 0; j < point->padded; j++) {
        ratio[j] = relative_scale / ratio[j];
    }
    if (function == WEIGHT_REGULARISED) {
        WEIGHT_LOOP(weight_regularised)
    } else {
        WEIGHT_LOOP(weight_quartic)
    }
}

/* The coordinates of LANES neighbours from j on, and their monomials. */
KERNEL_INLINE void load_monomials(int dim, int m, const struct mls_point *point, int64_t j, lanes *xi,
                                  lanes *p)
{
    for (int a = 0; a < dim; a++) {
        load_row(point, ROW_XI + a, j, &xi[a]);
    }
    monomials(dim, m, xi, p);
}

/* The moment matrix. The product of two monomials is formed before the weight is applied, so that equal
 * entries, as of x and y and of 1 and xy, have the same bits. */
KERNEL_INLINE void assemble(int dim, int m, const struct mls_point *point, struct mls_system *system)
{
    lanes sum[MLS_MAX_BASIS][MLS_MAX_BASIS];
    memset(sum, 0, sizeof sum);
    memset(system->matrix, 0, sizeof system->matrix);
    for (int64_t j = 0; j < point->padded; j += LANES) {
        lanes xi[3], weight, p[MLS_MAX_BASIS];
        load_monomials(dim, m, point, j, xi, p);
        load_row(point, ROW_WEIGHT, j, &weight);
        UNROLL
        for (int k = 0; k < m; k++) {
            UNROLL
            for (int l = k; l < m; l++) {
                sum[k][l] += weight * (p[k] * p[l]);
            }
        }
    }
    for (int k = 0; k < m; k++) {
        for (int l = k; l < m; l++) {
            system->matrix[k][l] = system->matrix[l][k] = lane_sum(&sum[k][l]);
        }
    }
}

KERNEL_INLINE void regularise(const struct mls *mls, int dim, int m, double scale, struct mls_system *system)
{
    memset(system->regularisation, 0, sizeof system->regularisation);
    if (mls->basis == BASIS_MODIFIED) {
        double unit = mls->mu_absolute ? 1.0 / (scale * scale * scale * scale) : 1.0;
        for (int k = 1 + dim; k < m; k++) {
            system->regularisation[k] = mls->mu[k - 1 - dim] * unit;
            system->matrix[k][k] += system->regularisation[k];
        }
    }
}

KERNEL_INLINE double larger_defect(double worst, double defect)
{
    return fabs(defect) <= worst ? worst : isnan(defect) ? INFINITY : fabs(defect);
}

/* The neighbours and the moment matrix of a point. */
KERNEL_INLINE void begin(const struct mls *mls, const struct mls_support *support, int dim, int m,
                         double *scratch, int64_t stride, struct mls_point *point, struct mls_system *system)
{
    *point = (struct mls_point){.count = support->count,
                                .padded = (support->count + LANES - 1) / LANES * LANES,
                                .stride = stride,
                                .row = scratch};
    gather(support, dim, point);
    weigh(mls->weight, support->widen, dim, point);
    assemble(dim, m, point, system);
    regularise(mls, dim, m, point->scale, system);
}

/* Store s d_a phi_j = w_j p_j.g_a - slope_j (A^2 xi)_a p_j.c in
 * ROW_GRADIENT + a. Returns the largest defect of sum grad phi p = grad p(0), p linear. */
KERNEL_INLINE double make_gradients(int dim, int m, const lanes *coefficient, const struct mls_point *point)
{
    double g[3][MLS_MAX_BASIS], worst = 0.0;
    lanes defect[3][4];
    memset(defect, 0, sizeof defect);
    for (int k = 0; k < m; k++) {
        for (int a = 0; a < dim; a++) {
            g[a][k] = coefficient[k][a];
        }
    }
    for (int64_t j = 0; j < point->padded; j += LANES) {
        lanes xi[3], p[MLS_MAX_BASIS], weight, slope;
        load_monomials(dim, m, point, j, xi, p);
        load_row(point, ROW_WEIGHT, j, &weight);
        load_row(point, ROW_SLOPE, j, &slope);
        for (int a = 0; a < dim; a++) {
            lanes gradient, turned;
            polynomial(dim, m, g[a], xi, &gradient);
            load_row(point, ROW_TURNED + a, j, &turned);
            gradient = weight * gradient - slope * turned;
            store_row(point, ROW_GRADIENT + a, j, &gradient);
            for (int k = 0; k <= dim; k++) {
                defect[a][k] += gradient * p[k];
            }
        }
    }
    for (int a = 0; a < dim; a++) {
        for (int k = 0; k <= dim; k++) {
            worst = larger_defect(worst, lane_sum(&defect[a][k]) - (k == 1 + a ? 1.0 : 0.0));
        }
    }
    return worst;
}

/* Copy the gradients from rows to dphi[count * dim], per unit of x. */
KERNEL_INLINE void put_gradients(int dim, const struct mls_point *point, double *dphi)
{
    const double *row = point->row + ROW_GRADIENT * point->stride;
    double inverse = 1.0 / point->scale;
    for (int64_t j = 0; j < point->count; j++) {
        for (int a = 0; a < dim; a++) {
            dphi[j * dim + a] = row[a * point->stride + j] * inverse;
        }
    }
}
