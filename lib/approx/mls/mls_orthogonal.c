/* Moving least squares by orthogonal (QR) factorisation of the weighted monomials, for points whose moment
 * matrix may be ill-conditioned. It loses half as many digits as the normal equations. */
#include "approx/mls/mls_orthogonal.h"

#include "approx/mls/weight.h"
#include "base/dense.h"

#include <math.h>

/* Reciprocal condition (1-norm, of the matrix scaled to unit diagonal) below which a support is refused. */
static const double least_condition = 1e-10;

/* One point's data in local scaled coordinates; arrays of `count` entries, `stride` apart. */
struct mls_local {
    int64_t count, stride;
    double scale;       /* s, in units of x */
    double *monomials;  /* [m][stride]: p_k(xi_j) */
    double *orthogonal; /* [m][stride]: scratch of the orthogonal factorization, count + m used */
    double *weight;     /* w_j */
    double *slope;      /* grad w_j = -slope_j image_j / s */
    double *image;      /* [dim][stride]: image of the neighbour (mls_support); xi_j unless around a corner */
    double *projection; /* p_j . c */
    double *row;        /* scratch */
    double matrix[MLS_MAX_BASIS * MLS_MAX_BASIS]; /* moment matrix with H, m x m */
    double regularisation[MLS_MAX_BASIS];         /* diagonal of H */
};

/* sqrt(W) P D^-1 over sqrt(H) D^-1 = Q R, D = sqrt(diag M); Q is in local->orthogonal. */
struct mls_factor {
    double scaling[MLS_MAX_BASIS];               /* 1 / D */
    double lower[MLS_MAX_BASIS * MLS_MAX_BASIS]; /* R^T */
};

/* Local coordinates, weights and monomials of the neighbours. */
static void gather(const struct mls *mls, const struct mls_support *support, int dim, int m,
                   struct mls_local *local)
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
static void assemble(int m, struct mls_local *local)
{
    for (int k = 0; k < m; k++) {
        const double *pk = local->monomials + k * local->stride;
        for (int64_t j = 0; j < local->count; j++) {
            local->row[j] = local->weight[j] * pk[j];
        }
        for (int l = k; l < m; l++) {
            const double *pl = local->monomials + l * local->stride;
            double sum = 0.0;
            for (int64_t j = 0; j < local->count; j++) {
                sum += local->row[j] * pl[j];
            }
            local->matrix[k * m + l] = local->matrix[l * m + k] = sum;
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
static double reciprocal_condition(int m, int size, const struct mls_local *local, const double *scaling)
{
    double block[MLS_MAX_BASIS * MLS_MAX_BASIS], norm[2] = {0.0, 0.0};
    for (int k = 0; k < size * size; k++) {
        block[k] = local->matrix[k / size * m + k % size] * scaling[k / size] * scaling[k % size];
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
static enum mls_verdict judge(int m, int dim, bool modified, const struct mls_local *local, double *scaling)
{
    for (int k = 0; k < m; k++) {
        double diagonal = local->matrix[k * m + k];
        if (!(diagonal > 1e-280) || !isfinite(diagonal)) {
            return MLS_ILL_CONDITIONED;
        }
        scaling[k] = 1.0 / sqrt(diagonal);
    }
    bool good = reciprocal_condition(m, dim + 1, local, scaling) >= least_condition &&
                (modified || reciprocal_condition(m, m, local, scaling) >= least_condition);
    return good ? MLS_GOOD : MLS_ILL_CONDITIONED;
}

/* Gram-Schmidt, each column orthogonalised twice, of the scaled rows sqrt(w_j) p_j and sqrt(h_k) e_k. */
static void orthogonalise(int m, struct mls_local *local, struct mls_factor *factor)
{
    int64_t rows = local->count + m;
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

/* phi_j = w_j p_j . c, c = M^-1 e_1, from Q directly: products with a large c would cancel. Sets
 * local->projection. */
static void orthogonal_values(int m, const struct mls_factor *factor, struct mls_local *local, double *phi)
{
    double y[MLS_MAX_BASIS];
    for (int k = 0; k < m; k++) { /* R^T y = D^-1 e_1 */
        double sum = k == 0 ? factor->scaling[0] : 0.0;
        for (int i = 0; i < k; i++) {
            sum -= factor->lower[k * m + i] * y[i];
        }
        y[k] = sum / factor->lower[k * m + k];
    }
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

/* Correct values[j * value_stride] by w_j p_j . c over the linear monomials, where H is zero, so that
 * sum_j value_j p_k(xi_j) = target[k], k <= dim, to round-off: linear fields are reproduced also where the
 * quadratic part is ill-conditioned. */
static void restore(int m, int dim, const struct mls_factor *factor, const struct mls_local *local,
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

/* Right-hand side of the gradient's coefficients: e_a - (d_a M) c, with d_a M = sum_j d_a w_j p_j p_j^T. */
static void gradient_right_side(int m, int a, const struct mls_local *local, double *right)
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
static void gradient(int m, int dim, int a, const struct mls_local *local, const double *g, double *dphi)
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
    restore(m, dim, factor, local, target, phi, 1);
    target[0] = 0.0;
    for (int a = 0; dphi != NULL && a < dim; a++) {
        target[1 + a] = 1.0 / local->scale;
        restore(m, dim, factor, local, target, dphi + a, dim);
        target[1 + a] = 0.0;
    }
}

enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi)
{
    int dim = mls->dim, m = mls_basis_size(mls);
    double right[MLS_MAX_BASIS], g[MLS_MAX_BASIS];
    struct mls_factor factor;
    struct mls_local local = {.count = support->count,
                              .stride = stride,
                              .monomials = scratch,
                              .orthogonal = scratch + MLS_MAX_BASIS * stride,
                              .weight = scratch + 2 * MLS_MAX_BASIS * stride};
    local.slope = local.weight + stride;
    local.projection = local.slope + stride;
    local.row = local.projection + stride;
    local.image = local.row + stride;
    gather(mls, support, dim, m, &local);
    assemble(m, &local);
    regularise(mls, dim, m, &local);
    enum mls_verdict verdict = judge(m, dim, mls->basis == BASIS_MODIFIED, &local, factor.scaling);
    if (verdict != MLS_GOOD) {
        return verdict;
    }
    orthogonalise(m, &local, &factor);
    orthogonal_values(m, &factor, &local, phi);
    for (int a = 0; dphi != NULL && a < dim; a++) {
        gradient_right_side(m, a, &local, right);
        substitute(m, m, &factor, right, g);
        gradient(m, dim, a, &local, g, dphi);
    }
    restore_linear(m, dim, &factor, &local, phi, dphi);
    return reproduction_defect(dim, &local, phi, dphi) <= 1e-10 ? MLS_GOOD : MLS_ILL_CONDITIONED;
}
