#include "approx/mls/mls_kernel.h"

#include "approx/mls/mls_vector.h"

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
    lanes right[MLS_MAX_BASIS];
    begin(mls, support, dim, m, scratch, stride, &point, &system);
    if (!factorise(dim, m, MLS_SAFE_PIVOT, mls->basis == BASIS_MODIFIED ? least_pivot : MLS_SAFE_PIVOT,
                   &system)) {
        return false;
    }
    substitute_unit(m, &system, c);
    if (!(values(dim, m, c, dphi != NULL, &point, right) <= most_defect)) {
        return false;
    }
    if (dphi != NULL) {
        substitute(m, &system, right);
        if (!(gradients(dim, m, right, &point) <= most_defect)) {
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
