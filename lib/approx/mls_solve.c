#include "approx/mls_solve.h"

#include <math.h>

/* Reciprocal condition (1-norm, of the matrix scaled to unit diagonal) below which a support is refused. */
static const double least_condition_linear = 1e-10;
static const double least_condition_quadratic = 1e-10;
/* With pivots above this the condition is good, as the matrix is small: no estimate is needed. */
static const double safe_pivot = 1e-5;
/* Pivots below this (possible only with H) are left to the orthogonal factorization. */
static const double least_normal_pivot = 1e-9;

void mls_local_layout(struct mls_local *local, double *scratch, int64_t count, int64_t stride)
{
    local->count = count;
    local->stride = stride;
    local->monomials = scratch;
    local->orthogonal = scratch + MLS_MAX_BASIS * stride;
    double *rest = scratch + 2 * MLS_MAX_BASIS * stride;
    local->weight = rest;
    local->slope = rest + stride;
    local->projection = rest + 2 * stride;
    local->row = rest + 3 * stride;
    local->image = rest + 4 * stride;
}

/* L E L^T of the scaled matrix; returns the smallest pivot of the first `leading` columns and of all. */
static void ldlt(int m, int leading, const double *matrix, struct mls_factor *factor, double *least_leading,
                 double *least)
{
    double *lower = factor->lower;
    *least_leading = *least = 1.0;
    for (int k = 0; k < m; k++) {
        for (int l = 0; l <= k; l++) {
            double sum = matrix[k * m + l] * factor->scaling[k] * factor->scaling[l];
            for (int i = 0; i < l; i++) {
                sum -= lower[k * m + i] * lower[l * m + i] * factor->pivot[i];
            }
            if (l < k) {
                lower[k * m + l] = sum / factor->pivot[l];
            } else {
                /* Beyond repair: any positive number keeps the arithmetic finite until the verdict. */
                factor->pivot[k] = sum > 1e-300 ? sum : 1e-300;
                *least = fmin(*least, sum);
                *least_leading = k < leading ? *least : *least_leading;
            }
        }
    }
}

/* Solve with the leading `size` rows and columns of the m x m factor. */
static void substitute(int m, int size, const struct mls_factor *factor, const double *right,
                       double *solution)
{
    const double *lower = factor->lower;
    for (int k = 0; k < size; k++) {
        double sum = right[k] * factor->scaling[k];
        for (int i = 0; i < k; i++) {
            sum -= lower[k * m + i] * solution[i];
        }
        solution[k] = factor->orthogonal ? sum / lower[k * m + k] : sum;
    }
    for (int k = size - 1; k >= 0; k--) {
        double sum = factor->orthogonal ? solution[k] : solution[k] / factor->pivot[k];
        for (int i = k + 1; i < size; i++) {
            sum -= lower[i * m + k] * solution[i];
        }
        solution[k] = factor->orthogonal ? sum / lower[k * m + k] : sum;
    }
    for (int k = 0; k < size; k++) {
        solution[k] *= factor->scaling[k];
    }
}

/* 1 / (|A| |A^-1|) in the 1-norm, of the leading `size` block of the scaled matrix. */
static double reciprocal_condition(int m, int size, const struct mls_local *local,
                                   const struct mls_factor *whole)
{
    struct mls_factor factor;
    double block[MLS_MAX_BASIS * MLS_MAX_BASIS] = {0.0}, least_leading, least;
    double norm = 0.0, inverse_norm = 0.0;
    for (int k = 0; k < size; k++) {
        double sum = 0.0;
        factor.scaling[k] = 1.0;
        for (int l = 0; l < size; l++) {
            block[k * size + l] = local->matrix[k * m + l] * whole->scaling[k] * whole->scaling[l];
            sum += fabs(block[k * size + l]);
        }
        norm = fmax(norm, sum);
    }
    factor.orthogonal = false;
    ldlt(size, 0, block, &factor, &least_leading, &least);
    for (int k = 0; k < size; k++) {
        double unit[MLS_MAX_BASIS] = {0.0}, column[MLS_MAX_BASIS], sum = 0.0;
        unit[k] = 1.0;
        substitute(size, size, &factor, unit, column);
        for (int l = 0; l < size; l++) {
            sum += fabs(column[l]);
        }
        inverse_norm = fmax(inverse_norm, sum);
    }
    return 1.0 / (norm * inverse_norm);
}

enum mls_verdict mls_factorise(int m, int dim, bool modified, struct mls_local *local,
                               struct mls_factor *factor)
{
    factor->orthogonal = false;
    for (int k = 0; k < m; k++) {
        double diagonal = local->matrix[k * m + k];
        if (!(diagonal > 1e-280) || !isfinite(diagonal)) {
            return MLS_ILL_CONDITIONED;
        }
        factor->scaling[k] = 1.0 / sqrt(diagonal);
    }
    double least_linear, least;
    ldlt(m, dim + 1, local->matrix, factor, &least_linear, &least);
    if (!(least_linear > safe_pivot) &&
        !(reciprocal_condition(m, dim + 1, local, factor) >= least_condition_linear)) {
        return MLS_ILL_CONDITIONED;
    }
    if (!modified && !(least > safe_pivot) &&
        !(reciprocal_condition(m, m, local, factor) >= least_condition_quadratic)) {
        return MLS_ILL_CONDITIONED;
    }
    if (!(least > least_normal_pivot)) {
        mls_orthogonalise(m, local, factor);
    }
    return MLS_GOOD;
}

/* Gram-Schmidt, each column orthogonalised twice, of the scaled rows sqrt(w_j) p_j and sqrt(h_k) e_k. */
void mls_orthogonalise(int m, struct mls_local *local, struct mls_factor *factor)
{
    int64_t rows = local->count + m;
    factor->orthogonal = true;
    for (int k = 0; k < m; k++) {
        double *column = local->orthogonal + k * local->stride;
        const double *pk = local->monomials + k * local->stride;
        for (int64_t j = 0; j < local->count; j++) {
            column[j] = sqrt(local->weight[j]) * pk[j] * factor->scaling[k];
        }
        for (int l = 0; l < m; l++) {
            column[local->count + l] = l == k ? sqrt(local->regularisation[k]) * factor->scaling[k] : 0.0;
        }
        double *r = factor->lower + k * m; /* column k of R, stored as row k of R^T */
        for (int l = 0; l < m; l++) {
            r[l] = 0.0;
        }
        for (int pass = 0; pass < 2; pass++) {
            for (int l = 0; l < k; l++) {
                const double *other = local->orthogonal + l * local->stride;
                double dot = 0.0;
                for (int64_t j = 0; j < rows; j++) {
                    dot += other[j] * column[j];
                }
                r[l] += dot;
                for (int64_t j = 0; j < rows; j++) {
                    column[j] -= dot * other[j];
                }
            }
        }
        double norm2 = 0.0;
        for (int64_t j = 0; j < rows; j++) {
            norm2 += column[j] * column[j];
        }
        r[k] = sqrt(fmax(norm2, 1e-300));
        for (int64_t j = 0; j < rows; j++) {
            column[j] /= r[k];
        }
    }
}

void mls_solve(int m, const struct mls_factor *factor, const struct mls_local *local, const double *right,
               double *solution)
{
    double residual[MLS_MAX_BASIS] = {0.0}, correction[MLS_MAX_BASIS];
    substitute(m, m, factor, right, solution);
    for (int k = 0; k < m; k++) {
        double sum = right[k];
        for (int l = 0; l < m; l++) {
            sum -= local->matrix[k * m + l] * solution[l];
        }
        residual[k] = sum;
    }
    substitute(m, m, factor, residual, correction);
    for (int k = 0; k < m; k++) {
        solution[k] += correction[k];
    }
}

void mls_orthogonal_values(int m, const struct mls_factor *factor, struct mls_local *local, double *c,
                           double *phi)
{
    double unit[MLS_MAX_BASIS] = {1.0}, y[MLS_MAX_BASIS];
    for (int k = 0; k < m; k++) { /* R^T y = D^-1 e_1 */
        double sum = unit[k] * factor->scaling[k];
        for (int i = 0; i < k; i++) {
            sum -= factor->lower[k * m + i] * y[i];
        }
        y[k] = sum / factor->lower[k * m + k];
    }
    mls_solve(m, factor, local, unit, c);
    for (int64_t j = 0; j < local->count; j++) {
        double sum = 0.0;
        for (int k = 0; k < m; k++) {
            sum += local->orthogonal[k * local->stride + j] * y[k];
        }
        double root = sqrt(local->weight[j]);
        phi[j] = root * sum;
        local->projection[j] = root > 1e-150 ? sum / root : 0.0;
    }
}

void mls_restore_linear(int m, int dim, const struct mls_factor *factor, const struct mls_local *local,
                        const double *target, double *values, int value_stride)
{
    double defect[MLS_MAX_BASIS], correction[MLS_MAX_BASIS];
    for (int k = 0; k <= dim; k++) {
        const double *pk = local->monomials + k * local->stride;
        defect[k] = target[k];
        for (int64_t j = 0; j < local->count; j++) {
            defect[k] -= values[j * value_stride] * pk[j];
        }
    }
    substitute(m, dim + 1, factor, defect, correction);
    for (int64_t j = 0; j < local->count; j++) {
        double sum = 0.0;
        for (int k = 0; k <= dim; k++) {
            sum += local->monomials[k * local->stride + j] * correction[k];
        }
        values[j * value_stride] += local->weight[j] * sum;
    }
}
