#include "approx/mls/mls_kernel.h"

#include "approx/mls/mls_vector.h"

/* One point's neighbours in local scaled coordinates. */
struct mls_point {
    int64_t count, padded; /* padded to a multiple of LANES by neighbours beyond the support */
    int64_t stride;
    double scale; /* s */
    double *row;  /* [MLS_KERNEL_ROWS][stride] */
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

KERNEL_INLINE void load_vector(int dim, const struct mls_point *point, int row, int64_t j, lanes *v)
{
    for (int a = 0; a < dim; a++) {
        load_row(point, row + a, j, &v[a]);
    }
}

/* Differences of coordinates, and radii, in rows; the largest radius. */
KERNEL_INLINE void gather(const struct mls_support *support, int dim, struct mls_point *point)
{
    double *xi = point->row, *radius = point->row + ROW_RATIO * point->stride;
    double largest = 0.0;
    for (int64_t j = 0; j < support->count; j++) {
        int64_t node = support->neighbours[j];
        for (int a = 0; a < dim; a++) {
            xi[a * point->stride + j] = support->nodes[node * dim + a] - support->x[a];
        }
        double own = support->radius[node];
        radius[j] = own;
        largest = own > largest ? own : largest;
    }
    for (int64_t j = support->count; j < point->padded; j++) {
        for (int a = 0; a < dim; a++) {
            xi[a * point->stride + j] = 2.0 * largest * support->widen;
        }
        radius[j] = largest;
    }
    point->scale = largest * support->widen;
}

/* The same for the images of the neighbours (see mls_support), which their weights follow. */
KERNEL_INLINE void gather_images(const struct mls_support *support, int dim, struct mls_point *point)
{
    double *image = point->row + ROW_IMAGE * point->stride, inverse = 1.0 / point->scale;
    for (int64_t j = 0; j < support->count; j++) {
        for (int a = 0; a < dim; a++) {
            image[a * point->stride + j] = support->image[j * dim + a] * inverse;
        }
    }
    for (int64_t j = support->count; j < point->padded; j++) {
        for (int a = 0; a < dim; a++) {
            image[a * point->stride + j] = 2.0;
        }
    }
}

#define WEIGHT_LOOP(formula)                                                                                 \
    for (int64_t j = 0; j < point->padded; j++) {                                                            \
        double relative = 0.0, value, slope_over_r, square = ratio[j] * ratio[j];                            \
        for (int a = 0; a < dim; a++) {                                                                      \
            relative += seen[a * stride + j] * seen[a * stride + j];                                         \
        }                                                                                                    \
        relative *= square;                                                                                  \
        formula(relative < 1.0 ? relative : 1.0, &value, &slope_over_r);                                     \
        weight[j] = relative < 1.0 ? value : 0.0;                                                            \
        slope[j] = relative < 1.0 ? slope_over_r * square : 0.0;                                             \
    }

/* Scale the coordinates; set weights, and slopes: grad w = -slope xi / s, with the image in place of xi
 * around corners. */
KERNEL_INLINE void weigh(enum weight_function function, double widen, int dim, bool images,
                         struct mls_point *point)
{
    int64_t stride = point->stride;
    double *restrict xi = point->row, *restrict ratio = point->row + ROW_RATIO * stride;
    double *restrict weight = point->row + ROW_WEIGHT * stride, *restrict slope =
                                                                    point->row + ROW_SLOPE * stride;
    const double *seen = images ? point->row + ROW_IMAGE * stride : xi;
    double inverse = 1.0 / point->scale, relative_scale = point->scale / widen;
    for (int a = 0; a < dim; a++) {
        for (int64_t j = 0; j < point->padded; j++) {
            xi[a * stride + j] *= inverse;
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
    load_vector(dim, point, ROW_XI, j, xi);
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
    if (mls->basis == BASIS_MODIFIED) {
        double unit = mls->mu_absolute ? 1.0 / (scale * scale * scale * scale) : 1.0;
        for (int k = 1 + dim; k < m; k++) {
            system->matrix[k][k] += mls->mu[k - 1 - dim] * unit;
        }
    }
}

KERNEL_INLINE double larger_defect(double worst, double defect)
{
    return fabs(defect) <= worst ? worst : isnan(defect) ? INFINITY : fabs(defect);
}

/* Store phi_j = w_j p_j.c in ROW_PHI and slope_j p_j.c in ROW_SLOPE. With `gradients`, set the right-hand
 * sides of their coefficients, e_a - (d_a M) c = e_a + sum_j slope_j xi_a p_j.c p_j, one a for each lane;
 * with `images`, image_a in place of xi_a. Returns the largest defect of sum phi p = p(0), p linear. */
KERNEL_INLINE double values(int dim, int m, const double *c, bool gradients, bool images,
                            const struct mls_point *point, lanes *right)
{
    lanes sum[3][MLS_MAX_BASIS], defect[4];
    memset(sum, 0, sizeof sum);
    memset(defect, 0, sizeof defect);
    for (int64_t j = 0; j < point->padded; j += LANES) {
        lanes xi[3], p[MLS_MAX_BASIS], image[3], projection, phi, slope;
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
            load_vector(dim, point, images ? ROW_IMAGE : ROW_XI, j, image);
            UNROLL
            for (int k = 0; k < m; k++) {
                lanes part = slope * p[k];
                for (int a = 0; a < dim; a++) {
                    sum[a][k] += part * image[a];
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

/* Store s d_a phi_j = w_j p_j.g_a - slope_j xi_a p_j.c (image_a in place of xi_a with `images`) in
 * ROW_GRADIENT + a. Returns the largest defect of sum grad phi p = grad p(0), p linear. */
KERNEL_INLINE double gradients(int dim, int m, const lanes *coefficient, bool images,
                               const struct mls_point *point)
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
        lanes xi[3], p[MLS_MAX_BASIS], image[3], weight, slope;
        load_monomials(dim, m, point, j, xi, p);
        load_vector(dim, point, images ? ROW_IMAGE : ROW_XI, j, image);
        load_row(point, ROW_WEIGHT, j, &weight);
        load_row(point, ROW_SLOPE, j, &slope);
        for (int a = 0; a < dim; a++) {
            lanes gradient;
            polynomial(dim, m, g[a], xi, &gradient);
            gradient = weight * gradient - slope * image[a];
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

KERNEL_INLINE bool kernel_evaluate(const struct mls *mls, const struct mls_support *support, int dim, int m,
                                   bool images, double *scratch, int64_t stride, double *phi, double *dphi)
{
    /* With larger pivots the condition of this small matrix is good; no estimate is needed. */
    static const double safe_pivot = 1e-5;
    /* With H pivots may be smaller, but not too small for the normal equations. */
    static const double least_pivot = 1e-9;
    static const double most_defect = 1e-13;
    struct mls_point point = {.count = support->count,
                              .padded = (support->count + LANES - 1) / LANES * LANES,
                              .stride = stride,
                              .row = scratch};
    struct mls_system system;
    double c[MLS_MAX_BASIS];
    lanes right[MLS_MAX_BASIS];
    gather(support, dim, &point);
    if (images) {
        gather_images(support, dim, &point);
    }
    weigh(mls->weight, support->widen, dim, images, &point);
    assemble(dim, m, &point, &system);
    regularise(mls, dim, m, point.scale, &system);
    if (!factorise(dim, m, safe_pivot, mls->basis == BASIS_MODIFIED ? least_pivot : safe_pivot, &system)) {
        return false;
    }
    substitute_unit(m, &system, c);
    if (!(values(dim, m, c, dphi != NULL, images, &point, right) <= most_defect)) {
        return false;
    }
    if (dphi != NULL) {
        substitute(m, &system, right);
        if (!(gradients(dim, m, right, images, &point) <= most_defect)) {
            return false;
        }
        put_gradients(dim, &point, dphi);
    }
    if (phi != NULL) {
        memcpy(phi, point.row + ROW_PHI * stride, (size_t)point.count * sizeof *phi);
    }
    return true;
}

/* The compiler knows the dimension, the number of monomials, and whether there are images. */
#define EVALUATE(dim, m)                                                                                     \
    (support->image == NULL ? kernel_evaluate(mls, support, dim, m, false, scratch, stride, phi, dphi)       \
                            : kernel_evaluate(mls, support, dim, m, true, scratch, stride, phi, dphi))

ALL_SETS bool mls_kernel(const struct mls *mls, const struct mls_support *support, double *scratch,
                         int64_t stride, double *phi, double *dphi)
{
    if (mls->basis == BASIS_LINEAR) {
        return mls->dim == 2 ? EVALUATE(2, 3) : EVALUATE(3, 4);
    }
    return mls->dim == 2 ? EVALUATE(2, 6) : EVALUATE(3, 10);
}
