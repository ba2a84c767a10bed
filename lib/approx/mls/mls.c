/* Moving least squares by the normal equations, in vectors of the compiler. Sums over the neighbours have the
 * same partial sums for every instruction set, and no multiplication is fused with an addition (set by the
 * Makefile for lib/approx): every processor gives the same bits. Where the normal equations lose digits, as
 * shown by a small pivot or a defect of the linear reproduction, mls_orthogonal() evaluates the point. */
#include "approx/mls/mls.h"

#include "approx/mls/mls_vector.h"
#include "base/memory.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <stdlib.h>

const char *const basis_names[BASIS_COUNT] = {"mls1", "mls2", "mmls2"};
const char *const weight_names[WEIGHT_COUNT] = {"quartic", "regularised"};

struct mls mls_default(int dim)
{
    struct mls mls = {.dim = dim, .basis = BASIS_MODIFIED, .weight = WEIGHT_QUARTIC};
    for (int a = 0, k = 0; a < dim; a++) {
        for (int b = a; b < dim; b++, k++) {
            mls.mu[k] = a == b ? MLS_DEFAULT_MU : MLS_DEFAULT_MU / 2.0;
        }
    }
    return mls;
}

int mls_second_order_count(int dim)
{
    return dim * (dim + 1) / 2;
}

int mls_basis_size(const struct mls *mls)
{
    return 1 + mls->dim + (mls->basis == BASIS_LINEAR ? 0 : mls_second_order_count(mls->dim));
}

void mls_work_free(struct mls_work *work)
{
    free(work->values);
    *work = (struct mls_work){0};
}

/* Store phi_j = w_j p_j.c in ROW_PHI and slope_j p_j.c in ROW_SLOPE. With `gradients`, set the right-hand
 * sides of their coefficients, e_a - (d_a M) c = e_a + sum_j slope_j (A^2 xi)_a p_j.c p_j, one a for each
 * lane. Returns the largest defect of sum phi p = p(0), p linear. */
KERNEL_INLINE double values(int dim, int m, const double *c, bool gradients, const struct mls_point *point,
                            lanes *right)
{
    lanes sum[3][MLS_MAX_BASIS], defect[4];
    memset(sum, 0, sizeof sum);
    memset(defect, 0, sizeof defect);
    for (int64_t j = 0; j < point->padded; j += LANES) {
        lanes xi[3], turned[3], p[MLS_MAX_BASIS], projection, phi, slope;
        load_monomials(dim, m, point, j, xi, p);
        polynomial(dim, m, c, xi, &projection);
        load_row(point, ROW_WEIGHT, j, &phi);
        phi *= projection;
        store_row(point, ROW_PHI, j, &phi);
        for (int k = 0; k <= dim; k++) {
            defect[k] += phi * p[k];
        }
        if (gradients) {
            load_row(point, ROW_SLOPE, j, &slope);
            slope *= projection;
            store_row(point, ROW_SLOPE, j, &slope);
            for (int a = 0; a < dim; a++) {
                load_row(point, ROW_TURNED + a, j, &turned[a]);
            }
            UNROLL
            for (int k = 0; k < m; k++) {
                lanes part = slope * p[k];
                for (int a = 0; a < dim; a++) {
                    sum[a][k] += part * turned[a];
                }
            }
        }
    }
    for (int k = 0; k < m && gradients; k++) {
        right[k] = (lanes){0.0, 0.0, 0.0, 0.0};
        for (int a = 0; a < dim; a++) {
            right[k][a] = lane_sum(&sum[a][k]) + (k == 1 + a ? 1.0 : 0.0);
        }
    }
    double worst = larger_defect(0.0, lane_sum(&defect[0]) - 1.0);
    for (int a = 0; a < dim; a++) {
        worst = larger_defect(worst, lane_sum(&defect[1 + a]));
    }
    return worst;
}

KERNEL_INLINE bool kernel_evaluate(const struct mls *mls, const struct mls_support *support, int dim, int m,
                                   double *scratch, int64_t stride, double *phi, double *dphi)
{
    /* With H pivots may be smaller, but not too small for the normal equations. */
    static const double least_pivot = 1e-9;
    static const double most_defect = 1e-13;
    struct mls_point point;
    struct mls_system system;
    double c[MLS_MAX_BASIS];
    lanes right[MLS_MAX_BASIS] = {{1.0}};
    begin(mls, support, dim, m, scratch, stride, &point, &system);
    if (!factorise(dim, m, MLS_SAFE_PIVOT, mls->basis == BASIS_MODIFIED ? least_pivot : MLS_SAFE_PIVOT,
                   &system)) {
        return false;
    }
    substitute(m, &system, right);
    for (int l = 0; l < m; l++) {
        c[l] = right[l][0];
    }
    if (!(values(dim, m, c, dphi != NULL, &point, right) <= most_defect)) {
        return false;
    }
    if (dphi != NULL) {
        substitute(m, &system, right);
        if (!(make_gradients(dim, m, right, &point) <= most_defect)) {
            return false;
        }
        put_gradients(dim, &point, dphi);
    }
    if (phi != NULL) {
        memcpy(phi, point.row + ROW_PHI * stride, (size_t)point.count * sizeof *phi);
    }
    return true;
}

/* The compiler knows the dimension and the number of monomials. */
#define EVALUATE(dim, m) kernel_evaluate(mls, support, dim, m, scratch, stride, phi, dphi)

ALL_SETS bool mls_kernel(const struct mls *mls, const struct mls_support *support, double *scratch,
                         int64_t stride, double *phi, double *dphi)
{
    if (mls->basis == BASIS_LINEAR) {
        return mls->dim == 2 ? EVALUATE(2, 3) : EVALUATE(3, 4);
    }
    return mls->dim == 2 ? EVALUATE(2, 6) : EVALUATE(3, 10);
}

/* ---- ill-conditioned moment matrices ---- */

/* Moving least squares by orthogonal (QR) factorisation of the weighted monomials, for points whose moment
 * matrix may be ill-conditioned. It loses half as many digits as the normal equations. */

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
            lanes xi[3], p[MLS_MAX_BASIS], slope, turned;
            load_monomials(dim, m, point, j, xi, p);
            load_row(point, ROW_SLOPE, j, &slope);
            load_row(point, ROW_TURNED + a, j, &turned);
            for (int k = 0; k < m; k++) {
                sum[k] += slope * turned * p[k];
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

/* ---- at a point ---- */

/* Scratch for `count` neighbours, or NULL (memory). */
static double *work_reserve(struct mls_work *work, int64_t count)
{
    if (count > work->capacity) {
        int64_t capacity = (count + count / 2 + 16) / 8 * 8;
        double *values = array_new(capacity + MLS_PADDING, sizeof *values * MLS_ROWS);
        if (values == NULL) {
            return NULL;
        }
        free(work->values);
        work->values = values;
        work->capacity = capacity;
    }
    return work->values;
}

enum status mls_evaluate(const struct mls *mls, const struct mls_support *support, struct mls_work *work,
                         double *phi, double *dphi, enum mls_verdict *verdict, struct error *error)
{
    int m = mls_basis_size(mls);
    *verdict = MLS_TOO_FEW;
    if (support->count < (mls->basis == BASIS_QUADRATIC ? m : mls->dim + 1)) {
        return STATUS_OK;
    }
    double *scratch = work_reserve(work, support->count);
    if (scratch == NULL) {
        return fail_memory(error, "moving least squares");
    }
    int64_t stride = work->capacity + MLS_PADDING;
    *verdict = MLS_GOOD;
    if (!mls_kernel(mls, support, scratch, stride, phi, dphi)) {
        *verdict = mls_orthogonal(mls, support, scratch, stride, phi, dphi);
    }
    return STATUS_OK;
}
