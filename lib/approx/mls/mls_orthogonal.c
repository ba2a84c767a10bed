/* Moving least squares by orthogonal (QR) factorisation of the weighted monomials, for points whose moment
 * matrix may be ill-conditioned. It loses half as many digits as the normal equations. */
#include "approx/mls/mls_orthogonal.h"

#include "approx/mls/mls_vector.h"
#include "base/dense.h"

/* sqrt(W) P D^-1 over sqrt(H) D^-1 = Q R, D = sqrt(diag M); Q is in ROW_ORTHOGONAL. */
struct mls_factor {
    double scaling[MLS_MAX_BASIS];               /* 1 / D */
    double lower[MLS_MAX_BASIS * MLS_MAX_BASIS]; /* R^T */
};

/* Solve with the leading `size` rows and columns of the m x m factor. */
static void solve(int m, int size, const struct mls_factor *factor, const double *right, double *solution)
{
    const double *lower = factor->lower;
    for (int k = 0; k < size; k++) {
        double sum = right[k] * factor->scaling[k];
        for (int i = 0; i < k; i++) {
            sum -= lower[k * m + i] * solution[i];
        }
        solution[k] = sum / lower[k * m + k];
    }
    for (int k = size - 1; k >= 0; k--) {
        double sum = solution[k];
        for (int i = k + 1; i < size; i++) {
            sum -= lower[i * m + k] * solution[i];
        }
        solution[k] = sum / lower[k * m + k];
    }
    for (int k = 0; k < size; k++) {
        solution[k] *= factor->scaling[k];
    }
}

/* 1 / (|A| |A^-1|) in the 1-norm, of the leading `size` block of the moment matrix, scaled; 0 where that is
 * not positive definite. */
static double reciprocal_condition(int size, const struct mls_system *system, const double *scaling)
{
    double block[MLS_MAX_BASIS * MLS_MAX_BASIS], norm[2] = {0.0, 0.0};
    for (int k = 0; k < size * size; k++) {
        block[k] = system->matrix[k / size][k % size] * scaling[k / size] * scaling[k % size];
    }
    for (int inverse = 0; inverse < 2; inverse++) {
        if (inverse == 1) {
            if (!dense_factorise(size, block)) {
                return 0.0;
            }
            dense_invert(size, block);
        }
        for (int k = 0; k < size; k++) {
            double sum = 0.0;
            for (int l = 0; l < size; l++) {
                sum += fabs(block[k * size + l]);
            }
            norm[inverse] = fmax(norm[inverse], sum);
        }
    }
    return 1.0 / (norm[0] * norm[1]);
}

/* Check the condition of the linear block of the moment matrix, and unless `modified` that of the whole
 * matrix (with MMLS H bounds it, and the reproduction is checked afterwards). Sets `scaling`. */
static bool is_conditioned(int m, int dim, bool modified, const struct mls_system *system, double *scaling)
{
    for (int k = 0; k < m; k++) {
        double diagonal = system->matrix[k][k];
        if (!(diagonal > 1e-280) || !isfinite(diagonal)) {
            return false;
        }
        scaling[k] = 1.0 / sqrt(diagonal);
    }
    return reciprocal_condition(dim + 1, system, scaling) >= MLS_LEAST_CONDITION &&
           (modified || reciprocal_condition(m, system, scaling) >= MLS_LEAST_CONDITION);
}

static double *row_of(const struct mls_point *point, int row)
{
    return point->row + row * point->stride;
}

/* Gram-Schmidt, each column orthogonalised twice, of the scaled rows sqrt(w_j) p_j and sqrt(h_k) e_k. */
static void orthogonalise(int dim, int m, const struct mls_point *point, const struct mls_system *system,
                          struct mls_factor *factor)
{
    int64_t rows = point->count + m;
    const double *weight = row_of(point, ROW_WEIGHT);
    for (int64_t j = 0; j < point->padded; j += LANES) {
        lanes xi[3], p[MLS_MAX_BASIS];
        load_monomials(dim, m, point, j, xi, p);
        for (int k = 0; k < m; k++) {
            store_row(point, ROW_ORTHOGONAL + k, j, &p[k]);
        }
    }
    for (int k = 0; k < m; k++) {
        double *column = row_of(point, ROW_ORTHOGONAL + k);
        for (int64_t j = 0; j < point->count; j++) {
            column[j] *= sqrt(weight[j]) * factor->scaling[k];
        }
        for (int l = 0; l < m; l++) {
            column[point->count + l] = l == k ? sqrt(system->regularisation[k]) * factor->scaling[k] : 0.0;
        }
        double *r = factor->lower + k * m; /* column k of R, stored as row k of R^T */
        memset(r, 0, (size_t)m * sizeof *r);
        for (int pass = 0; pass < 2; pass++) {
            for (int l = 0; l < k; l++) {
                const double *other = row_of(point, ROW_ORTHOGONAL + l);
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

/* phi_j = w_j p_j . c, c = M^-1 e_1, from Q directly: products with a large c would cancel. Stores it in
 * ROW_PHI, and slope_j p_j . c in ROW_SLOPE. */
static void orthogonal_values(int m, const struct mls_factor *factor, const struct mls_point *point)
{
    double y[MLS_MAX_BASIS];
    for (int k = 0; k < m; k++) { /* R^T y = D^-1 e_1 */
        double sum = k == 0 ? factor->scaling[0] : 0.0;
        for (int i = 0; i < k; i++) {
            sum -= factor->lower[k * m + i] * y[i];
        }
        y[k] = sum / factor->lower[k * m + k];
    }
    for (int64_t j = 0; j < point->count; j++) {
        double sum = 0.0, root = sqrt(row_of(point, ROW_WEIGHT)[j]);
        for (int k = 0; k < m; k++) {
            sum += row_of(point, ROW_ORTHOGONAL + k)[j] * y[k];
        }
        row_of(point, ROW_PHI)[j] = root * sum;
        row_of(point, ROW_SLOPE)[j] *= root > 1e-150 ? sum / root : 0.0;
    }
}

/* Correct the values of a row by w_j p_j . c over the linear monomials, where H is zero, so that
 * sum_j value_j p_k(xi_j), k <= dim, is 1 for k = `one` and else 0, to round-off: linear fields are
 * reproduced also where the quadratic part is ill-conditioned. Returns the largest defect before. */
static double restore(int m, int dim, const struct mls_factor *factor, const struct mls_point *point, int one,
                      double *value)
{
    double defect[4], correction[4], worst = 0.0;
    const double *xi = row_of(point, ROW_XI), *weight = row_of(point, ROW_WEIGHT);
    for (int k = 0; k <= dim; k++) {
        defect[k] = k == one ? 1.0 : 0.0;
        for (int64_t j = 0; j < point->count; j++) {
            defect[k] -= value[j] * (k == 0 ? 1.0 : xi[(k - 1) * point->stride + j]);
        }
        worst = larger_defect(worst, defect[k]);
    }
    solve(m, dim + 1, factor, defect, correction);
    for (int64_t j = 0; j < point->count; j++) {
        double sum = correction[0];
        for (int a = 0; a < dim; a++) {
            sum += xi[a * point->stride + j] * correction[1 + a];
        }
        value[j] += weight[j] * sum;
    }
    return worst;
}

/* The gradients in ROW_GRADIENT, from ROW_SLOPE: their coefficients solve M g_a = e_a - (d_a M) c. */
static void orthogonal_gradients(int dim, int m, const struct mls_factor *factor,
                                 const struct mls_point *point)
{
    lanes coefficient[MLS_MAX_BASIS] = {{0.0}};
    for (int a = 0; a < dim; a++) {
        double right[MLS_MAX_BASIS] = {0.0}, g[MLS_MAX_BASIS];
        lanes sum[MLS_MAX_BASIS] = {{0.0}};
        for (int64_t j = 0; j < point->padded; j += LANES) {
            lanes xi[3], p[MLS_MAX_BASIS], slope;
            load_monomials(dim, m, point, j, xi, p);
            load_row(point, ROW_SLOPE, j, &slope);
            for (int k = 0; k < m; k++) {
                sum[k] += slope * xi[a] * p[k];
            }
        }
        for (int k = 0; k < m; k++) {
            right[k] = lane_sum(&sum[k]) + (k == 1 + a ? 1.0 : 0.0);
        }
        solve(m, m, factor, right, g);
        for (int k = 0; k < m; k++) {
            coefficient[k][a] = g[k];
        }
    }
    (void)gradients(dim, m, coefficient, point);
}

enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi)
{
    int dim = mls->dim, m = mls_basis_size(mls), rows = dphi != NULL ? dim : 0;
    double worst = 0.0;
    struct mls_point point;
    struct mls_system system;
    struct mls_factor factor;
    switch (m) { /* the compiler knows the dimension and the number of monomials */
    case 3:
        begin(mls, support, 2, 3, scratch, stride, &point, &system);
        break;
    case 4:
        begin(mls, support, 3, 4, scratch, stride, &point, &system);
        break;
    case 6:
        begin(mls, support, 2, 6, scratch, stride, &point, &system);
        break;
    default:
        begin(mls, support, 3, 10, scratch, stride, &point, &system);
    }
    if (!is_conditioned(m, dim, mls->basis == BASIS_MODIFIED, &system, factor.scaling)) {
        return MLS_ILL_CONDITIONED;
    }
    orthogonalise(dim, m, &point, &system, &factor);
    orthogonal_values(m, &factor, &point);
    if (dphi != NULL) {
        orthogonal_gradients(dim, m, &factor, &point);
    }
    /* Once to refine them, and once to know what is left. */
    for (int pass = 0; pass < 2; pass++) {
        worst = restore(m, dim, &factor, &point, 0, row_of(&point, ROW_PHI));
        for (int a = 0; a < rows; a++) {
            worst = larger_defect(worst,
                                  restore(m, dim, &factor, &point, 1 + a, row_of(&point, ROW_GRADIENT + a)));
        }
    }
    if (phi != NULL) {
        memcpy(phi, row_of(&point, ROW_PHI), (size_t)point.count * sizeof *phi);
    }
    if (dphi != NULL) {
        put_gradients(dim, &point, dphi);
    }
    return worst <= 1e-10 ? MLS_GOOD : MLS_ILL_CONDITIONED;
}
