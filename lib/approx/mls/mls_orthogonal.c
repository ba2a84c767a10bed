/* Moving least squares by orthogonal (QR) factorisation of the weighted monomials, for points whose moment
 * matrix may be ill-conditioned. It loses half as many digits as the normal equations. */
#include "approx/mls/mls_vector.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>

/* sqrt(W) P D^-1 over sqrt(H) D^-1 = Q R, D = sqrt(diag M), as GSL has it: R in the upper triangle. */
struct mls_factor {
    gsl_matrix_view QR;            /* in ROW_ORTHOGONAL */
    double tau[MLS_MAX_BASIS];     /* of Q */
    double scaling[MLS_MAX_BASIS]; /* 1 / D */
};

static double *row_of(const struct mls_point *point, int row)
{
    return point->row + row * point->stride;
}

/* Factorise. False if M has a diagonal entry that is no positive number. */
static bool orthogonalise(int dim, int m, const struct mls_point *point, const struct mls_system *system,
                          struct mls_factor *factor)
{
    double *row = row_of(point, ROW_ORTHOGONAL);
    const double *weight = row_of(point, ROW_WEIGHT);
    gsl_vector_view tau = gsl_vector_view_array(factor->tau, (size_t)m);
    for (int k = 0; k < m; k++) {
        double diagonal = system->matrix[k][k];
        if (!(diagonal > 1e-280) || !isfinite(diagonal)) {
            return false;
        }
        factor->scaling[k] = 1.0 / sqrt(diagonal);
    }
    for (int64_t j = 0; j < point->count; j++) {
        lanes xi[3], p[MLS_MAX_BASIS];
        load_monomials(dim, m, point, j / LANES * LANES, xi, p);
        for (int k = 0; k < m; k++) {
            row[j * m + k] = sqrt(weight[j]) * p[k][j % LANES] * factor->scaling[k];
        }
    }
    for (int k = 0; k < m; k++) {
        for (int l = 0; l < m; l++) {
            row[(point->count + k) * m + l] =
                l == k ? sqrt(system->regularisation[k]) * factor->scaling[k] : 0.0;
        }
    }
    factor->QR = gsl_matrix_view_array(row, (size_t)(point->count + m), (size_t)m);
    gsl_linalg_QR_decomp(&factor->QR.matrix, &tau.vector);
    return true;
}

/* Whether the leading `size` block of the scaled moment matrix R^T R is well conditioned. */
static bool is_conditioned(int size, const struct mls_factor *factor)
{
    double reciprocal, scratch[3 * MLS_MAX_BASIS];
    gsl_matrix_const_view R =
        gsl_matrix_const_submatrix(&factor->QR.matrix, 0, 0, (size_t)size, (size_t)size);
    gsl_vector_view work = gsl_vector_view_array(scratch, (size_t)(3 * size));
    return gsl_linalg_tri_rcond(CblasUpper, &R.matrix, &reciprocal, &work.vector) == GSL_SUCCESS &&
           reciprocal * reciprocal >= MLS_LEAST_CONDITION;
}

/* Solve with the leading `size` rows and columns of R^T, and unless `half` with those of R. */
static void solve_triangles(const struct mls_factor *factor, int size, bool half, double *x)
{
    gsl_matrix_const_view R =
        gsl_matrix_const_submatrix(&factor->QR.matrix, 0, 0, (size_t)size, (size_t)size);
    gsl_vector_view v = gsl_vector_view_array(x, (size_t)size);
    gsl_blas_dtrsv(CblasUpper, CblasTrans, CblasNonUnit, &R.matrix, &v.vector);
    if (!half) {
        gsl_blas_dtrsv(CblasUpper, CblasNoTrans, CblasNonUnit, &R.matrix, &v.vector);
    }
}

/* Solve with the leading `size` rows and columns of the moment matrix. */
static void solve(const struct mls_factor *factor, int size, const double *right, double *solution)
{
    for (int k = 0; k < size; k++) {
        solution[k] = right[k] * factor->scaling[k];
    }
    solve_triangles(factor, size, false, solution);
    for (int k = 0; k < size; k++) {
        solution[k] *= factor->scaling[k];
    }
}

/* phi_j = w_j p_j . c, c = M^-1 e_1, by Q: products with a large c would cancel. Stores it in ROW_PHI, and
 * slope_j p_j . c in ROW_SLOPE. */
static void orthogonal_values(int m, const struct mls_factor *factor, const struct mls_point *point)
{
    double *phi = row_of(point, ROW_PHI);
    gsl_vector_const_view tau = gsl_vector_const_view_array(factor->tau, (size_t)m);
    gsl_vector_view v = gsl_vector_view_array(phi, (size_t)(point->count + m));
    gsl_vector_set_zero(&v.vector);
    phi[0] = factor->scaling[0];
    solve_triangles(factor, m, true, phi);
    gsl_linalg_QR_Qvec(&factor->QR.matrix, &tau.vector, &v.vector);
    for (int64_t j = 0; j < point->count; j++) {
        double root = sqrt(row_of(point, ROW_WEIGHT)[j]);
        row_of(point, ROW_SLOPE)[j] *= root > 1e-150 ? phi[j] / root : 0.0;
        phi[j] *= root;
    }
}

/* Correct the values of a row by w_j p_j . c over the linear monomials, where H is zero, so that
 * sum_j value_j p_k(xi_j), k <= dim, is 1 for k = `one` and else 0, to round-off: linear fields are
 * reproduced also where the quadratic part is ill-conditioned. Returns the largest defect before. */
static double restore(int dim, const struct mls_factor *factor, const struct mls_point *point, int one,
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
    solve(factor, dim + 1, defect, correction);
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
        solve(factor, m, right, g);
        for (int k = 0; k < m; k++) {
            coefficient[k][a] = g[k];
        }
    }
    (void)make_gradients(dim, m, coefficient, point);
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
    /* With MMLS H bounds the condition of the whole matrix, and the reproduction is checked below. */
    if (!orthogonalise(dim, m, &point, &system, &factor) || !is_conditioned(dim + 1, &factor) ||
        (mls->basis != BASIS_MODIFIED && !is_conditioned(m, &factor))) {
        return MLS_ILL_CONDITIONED;
    }
    orthogonal_values(m, &factor, &point);
    if (dphi != NULL) {
        orthogonal_gradients(dim, m, &factor, &point);
    }
    /* Once to refine them, and once to know what is left. */
    for (int pass = 0; pass < 2; pass++) {
        worst = restore(dim, &factor, &point, 0, row_of(&point, ROW_PHI));
        for (int a = 0; a < rows; a++) {
            worst =
                larger_defect(worst, restore(dim, &factor, &point, 1 + a, row_of(&point, ROW_GRADIENT + a)));
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
