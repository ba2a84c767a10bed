/* MLS at points whose moment matrix may be ill-conditioned: the normal equations with refinement where the
 * condition admits them, else an orthogonal (QR) factorisation. */
#include "approx/mls_solve.h"

#include "approx/weight.h"

#include <math.h>

/* Local coordinates, weights and monomials of the neighbours. */
static inline __attribute__((always_inline)) void
gather(const struct mls *mls, const struct mls_support *support, int dim, int m, struct mls_local *local)
{
    double scale = 0.0;
    for (int64_t j = 0; j < support->count; j++) {
        scale = fmax(scale, support->radius[support->neighbours[j]]);
    }
    scale *= support->widen;
    local->scale = scale;
    for (int64_t j = 0; j < support->count; j++) {
        int64_t node = support->neighbours[j];
        double radius = support->radius[node] * support->widen;
        double xi[3];
        double distance2 = 0.0;
        for (int a = 0; a < dim; a++) {
            double difference = support->nodes[node * dim + a] - support->x[a];
            xi[a] = difference / scale;
            if (support->image != NULL) {
                difference = support->image[j * dim + a];
            }
            local->image[a * local->stride + j] = difference / scale;
            distance2 += difference * difference;
        }
        double relative = distance2 / (radius * radius);
        double weight = 0.0, slope_over_r = 0.0;
        if (relative < 1.0) {
            weight_evaluate(mls->weight, relative, &weight, &slope_over_r);
        }
        local->weight[j] = weight;
        /* d w / d x_a = w'(r)/r (x - x_j)_a / R^2 = -slope[j] xi_a, in units of 1/s; around a corner the
         * distance grows against the first leg of the path, which leads to the image */
        local->slope[j] = slope_over_r * (scale / radius) * (scale / radius);
        double *p = local->monomials + j;
        p[0] = 1.0;
        int k = 1 + dim;
        for (int a = 0; a < dim; a++) {
            p[(1 + a) * local->stride] = xi[a];
            for (int b = a; m > 1 + dim && b < dim; b++) {
                p[k++ * local->stride] = xi[a] * xi[b];
            }
        }
    }
}

/* Upper triangle of the moment matrix sum_j w p p^T, mirrored. */
static inline __attribute__((always_inline)) void assemble(int m, struct mls_local *local)
{
    for (int k = 0; k < m; k++) {
        const double *pk = local->monomials + k * local->stride;
        for (int64_t j = 0; j < local->count; j++) {
            local->row[j] = local->weight[j] * pk[j];
        }
        for (int l = k; l < m; l++) {
            const double *pl = local->monomials + l * local->stride;
            double sum[4] = {0.0, 0.0, 0.0, 0.0};
            int64_t j = 0;
            for (; j + 4 <= local->count; j += 4) {
                for (int lane = 0; lane < 4; lane++) {
                    sum[lane] += local->row[j + lane] * pl[j + lane];
                }
            }
            for (; j < local->count; j++) {
                sum[0] += local->row[j] * pl[j];
            }
            local->matrix[k * m + l] = local->matrix[l * m + k] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
        }
    }
}

/* The diagonal of H in scaled coordinates. */
static void regularise(const struct mls *mls, int dim, int m, struct mls_local *local)
{
    double s4 = local->scale * local->scale * local->scale * local->scale;
    for (int k = 0; k < m; k++) {
        local->regularisation[k] = 0.0;
        if (k > dim && mls->basis == BASIS_MODIFIED) {
            double mu = mls->mu[k - 1 - dim];
            local->regularisation[k] = mls->mu_absolute ? mu / s4 : mu;
        }
        local->matrix[k * m + k] += local->regularisation[k];
    }
}

/* phi_j = w_j p_j.c; keeps p_j.c in local->projection. */
static inline __attribute__((always_inline)) void values(int m, struct mls_local *local, const double *c,
                                                         double *phi)
{
    for (int64_t j = 0; j < local->count; j++) {
        double sum = 0.0;
        for (int k = 0; k < m; k++) {
            sum += local->monomials[k * local->stride + j] * c[k];
        }
        local->projection[j] = sum;
        phi[j] = local->weight[j] * sum;
    }
}

/* Right-hand side of the gradient's coefficients: e_a - (d_a M) c, with d_a M = sum_j d_a w_j p_j p_j^T. */
static inline __attribute__((always_inline)) void
gradient_right_side(int m, int a, const struct mls_local *local, double *right)
{
    const double *image = local->image + a * local->stride;
    for (int64_t j = 0; j < local->count; j++) {
        local->row[j] = local->slope[j] * image[j] * local->projection[j];
    }
    for (int k = 0; k < m; k++) {
        const double *pk = local->monomials + k * local->stride;
        double sum = k == 1 + a ? 1.0 : 0.0;
        for (int64_t j = 0; j < local->count; j++) {
            sum += local->row[j] * pk[j];
        }
        right[k] = sum;
    }
}

/* d_a phi_j = d_a w_j (p_j.c) + w_j p_j.g, from scaled to physical coordinates. Call after
 * gradient_right_side, whose row[] it reuses. */
static inline __attribute__((always_inline)) void
gradient(int m, int dim, int a, const struct mls_local *local, const double *g, double *dphi)
{
    for (int64_t j = 0; j < local->count; j++) {
        double sum = 0.0;
        for (int k = 0; k < m; k++) {
            sum += local->monomials[k * local->stride + j] * g[k];
        }
        dphi[j * dim + a] = (local->weight[j] * sum - local->row[j]) / local->scale;
    }
}

/* Largest violation of sum phi = 1, sum phi xi = 0, s sum dphi = 0, sum s dphi xi = I. NaN gives infinity. */
static double reproduction_defect(int dim, const struct mls_local *local, const double *phi,
                                  const double *dphi)
{
    double worst = 0.0;
    for (int k = 0; k <= dim; k++) {
        const double *pk = local->monomials + k * local->stride;
        double sum[4] = {0.0, 0.0, 0.0, 0.0};
        for (int64_t j = 0; j < local->count; j++) {
            sum[0] += phi[j] * pk[j];
            for (int a = 0; dphi != NULL && a < dim; a++) {
                sum[1 + a] += dphi[j * dim + a] * pk[j];
            }
        }
        sum[0] -= k == 0 ? 1.0 : 0.0;
        for (int a = 0; dphi != NULL && a < dim; a++) {
            sum[1 + a] = sum[1 + a] * local->scale - (k == 1 + a ? 1.0 : 0.0);
        }
        for (int i = 0; i <= (dphi != NULL ? dim : 0); i++) {
            double defect = fabs(sum[i]);
            worst = defect <= worst ? worst : (isnan(defect) ? INFINITY : defect);
        }
    }
    return worst;
}

/* One step of refinement of sum phi p = p(0) and sum grad phi p = grad p(0), p linear. */
static void restore_linear(int m, int dim, const struct mls_factor *factor, const struct mls_local *local,
                           double *phi, double *dphi)
{
    double target[4] = {1.0, 0.0, 0.0, 0.0};
    mls_restore_linear(m, dim, factor, local, target, phi, 1);
    target[0] = 0.0;
    for (int a = 0; dphi != NULL && a < dim; a++) {
        target[1 + a] = 1.0 / local->scale;
        mls_restore_linear(m, dim, factor, local, target, dphi + a, dim);
        target[1 + a] = 0.0;
    }
}

static inline __attribute__((always_inline)) enum mls_verdict
evaluate(const struct mls *mls, const struct mls_support *support, int dim, int m, struct mls_local *local,
         double *phi, double *dphi)
{
    double unit[MLS_MAX_BASIS] = {1.0}, c[MLS_MAX_BASIS], right[MLS_MAX_BASIS], g[MLS_MAX_BASIS];
    gather(mls, support, dim, m, local);
    assemble(m, local);
    regularise(mls, dim, m, local);
    struct mls_factor factor;
    enum mls_verdict verdict = mls_factorise(m, dim, mls->basis == BASIS_MODIFIED, local, &factor);
    /* The normal equations serve well-conditioned supports; the orthogonal factorization, which loses half as
     * many digits, the others. */
    for (int attempt = 0; verdict == MLS_GOOD; attempt++) {
        if (factor.orthogonal) {
            mls_orthogonal_values(m, &factor, local, c, phi);
        } else {
            mls_solve(m, &factor, local, unit, c);
            values(m, local, c, phi);
        }
        for (int a = 0; dphi != NULL && a < dim; a++) {
            gradient_right_side(m, a, local, right);
            mls_solve(m, &factor, local, right, g);
            gradient(m, dim, a, local, g, dphi);
        }
        if (factor.orthogonal) {
            restore_linear(m, dim, &factor, local, phi, dphi);
        }
        if (reproduction_defect(dim, local, phi, dphi) <= (factor.orthogonal ? 1e-10 : 1e-13)) {
            break;
        }
        if (factor.orthogonal || attempt > 0) {
            verdict = MLS_ILL_CONDITIONED;
        } else {
            mls_orthogonalise(m, local, &factor);
        }
    }
    return verdict;
}

enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi)
{
    int m = mls_basis_size(mls);
    struct mls_local local;
    mls_local_layout(&local, scratch, support->count, stride);
    if (mls->dim == 2) {
        return m == 3 ? evaluate(mls, support, 2, 3, &local, phi, dphi)
                      : evaluate(mls, support, 2, 6, &local, phi, dphi);
    }
    return m == 4 ? evaluate(mls, support, 3, 4, &local, phi, dphi)
                  : evaluate(mls, support, 3, 10, &local, phi, dphi);
}
