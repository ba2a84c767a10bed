/* Moving least squares at one point: linear, quadratic, and modified (MMLS) with a regularised quadratic
 * basis.
 *
 * u_h(x) = p(x)^T (P^T W P + H)^-1 P^T W u = sum_j phi_j(x) u_j, where H is zero but for mu on the diagonal
 * entries of the second-order monomials (Joldes et al. 2015; equations (2) to (4) of lib/README.md). All work
 * is done in local coordinates xi = (x_j - x) / s, centred on the point and scaled by the largest support
 * radius s, so that metres, millimetres and a distant origin give the same numbers. An absolute mu (in the
 * units of x) becomes the dimensionless mu / s^4. */
#pragma once

#include "approx/points/supports.h"
#include "base/status.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* Weight functions, on the relative distance r = |A_j (x - x_j)| / R_j within [0, 1): equation (1). */
enum weight_function {
    WEIGHT_QUARTIC,     /* 1 - 6 r^2 + 8 r^3 - 3 r^4 */
    WEIGHT_REGULARISED, /* Most and Bucher 2005, e = 1e-5: almost interpolates */
    WEIGHT_COUNT
};

/* Names for command lines and headers, indexed by weight_function. */
extern const char *const weight_names[WEIGHT_COUNT];

/* The formulas: w(r) and w'(r) / r (finite at r = 0) from the squared relative distance r2 = r^2 < 1. They
 * have no branches, so that loops over them become vector code. */

#define WEIGHT_FORMULA static inline __attribute__((always_inline)) void

/* In factors, so that rounding near r = 1 leaves nothing negative: (1 - r)^3 (1 + 3 r). */
WEIGHT_FORMULA weight_quartic(double r2, double *value, double *slope_over_r)
{
    double r = sqrt(r2);
    double s = 1.0 - r;
    *value = s * s * s * (1.0 + 3.0 * r);
    *slope_over_r = -12.0 * s * s;
}

WEIGHT_FORMULA weight_regularised(double r2, double *value, double *slope_over_r)
{
    const double e = 1e-5;
    const double at_end = 1.0 / ((1.0 + e) * (1.0 + e));
    const double scale = 1.0 / (1.0 / (e * e) - at_end);
    double q = 1.0 / (r2 + e);
    double above = q * q - at_end;
    *value = (above > 0.0 ? above : 0.0) * scale;
    *slope_over_r = -4.0 * q * q * q * scale;
}

enum basis { BASIS_LINEAR, BASIS_QUADRATIC, BASIS_MODIFIED, BASIS_COUNT };

/* "mls1", "mls2", "mmls2". */
extern const char *const basis_names[BASIS_COUNT];

#define MLS_MAX_BASIS 10 /* monomials: 1, x, y[, z], then x^2, xy, y^2 or x^2, xy, xz, y^2, yz, z^2 */
#define MLS_MAX_SECOND 6

struct mls {
    int dim; /* 2 or 3 */
    enum basis basis;
    enum weight_function weight;
    bool mu_absolute;          /* mu belongs to the monomials of x, not of xi, as in the paper */
    double mu[MLS_MAX_SECOND]; /* one for each second-order monomial (3 in 2D, 6 in 3D); MMLS only */
};

/* The project's default: MMLS, quartic spline, dimensionless mu. */
#define MLS_DEFAULT_MU 1e-7
struct mls mls_default(int dim);

/* Number of second-order monomials: 3 or 6. */
int mls_second_order_count(int dim);

/* Number of monomials of the basis. */
int mls_basis_size(const struct mls *mls);

enum mls_verdict {
    MLS_GOOD,
    MLS_TOO_FEW,        /* fewer neighbours than the basis needs (MMLS: than its linear part needs) */
    MLS_ILL_CONDITIONED /* the moment matrix is singular or too close to it */
};

/* Scratch space for one thread, all zero at first; grows on demand. */
struct mls_work {
    double *values;
    int64_t capacity; /* neighbours that `values` serves */
};
void mls_work_free(struct mls_work *work);

/* The neighbours of one point. */
struct mls_support {
    const double *x;          /* the point, dim */
    const double *nodes;      /* all nodes, row-major, dim each */
    struct supports supports; /* of all nodes */
    double widen;             /* factor on the radii at this point, */
    int32_t side;             /* which sees the supports from this side of the interfaces; -1: none */
    const int32_t *neighbours;
    int64_t count;
};

/* Values phi[count] and full gradients dphi[count * dim] (per unit of x) at a point; one of them may be NULL.
 * If the verdict is MLS_GOOD, partition of unity and linear reproduction were checked to 1e-10 (relative to
 * s). The results have the same bits on every processor. Returns STATUS_OK with the verdict, or STATUS_SYSTEM
 * (memory). */
MUST_CHECK enum status mls_evaluate(const struct mls *mls, const struct mls_support *support,
                                    struct mls_work *work, double *phi, double *dphi,
                                    enum mls_verdict *verdict, struct error *error);
