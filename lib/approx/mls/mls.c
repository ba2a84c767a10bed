/* Moving least squares by the normal equations, in vectors of the compiler. Sums over the neighbours have the
 * same partial sums for every instruction set, and no multiplication is fused with an addition (set by the
 * Makefile for lib/approx): every processor gives the same bits. Where the normal equations lose digits, as
 * shown by a small pivot or a defect of the linear reproduction, mls_orthogonal() evaluates the point. */
#include "approx/mls/mls.h"

#include "approx/mls/mls_vector.h"
#include "base/memory.h"

#include <stdlib.h>

const char *const basis_names[BASIS_COUNT] = {"mls1", "mls2", "mmls2"};
const char *const weight_names[WEIGHT_COUNT] = {"quartic", "regularised"};

struct mls mls_default(int dim)
{
    struct mls mls = {.dim = dim, .basis = BASIS_MODIFIED, .weight = WEIGHT_QUARTIC};
    for (int k = 0; k < MLS_MAX_SECOND; k++) {
        mls.mu[k] = MLS_DEFAULT_MU;
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
 * sides of their coefficients, e_a - (d_a M) c = e_a + sum_j slope_j xi_a p_j.c p_j, one a for each lane.
 * Returns the largest defect of sum phi p = p(0), p linear. */
KERNEL_INLINE double values(int dim, int m, const double *c, bool gradients, const struct mls_point *point,
                            lanes *right)
{
    lanes sum[3][MLS_MAX_BASIS], defect[4];
    memset(sum, 0, sizeof sum);
    memset(defect, 0, sizeof defect);
    for (int64_t j = 0; j < point->padded; j += LANES) {
        lanes xi[3], p[MLS_MAX_BASIS], projection, phi, slope;
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
            UNROLL
            for (int k = 0; k < m; k++) {
                lanes part = slope * p[k];
                for (int a = 0; a < dim; a++) {
                    sum[a][k] += part * xi[a];
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
