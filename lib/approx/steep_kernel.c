/* With A the rows sqrt(w_j) p_j, moment matrix M = A^T A, c = M^-1 e_1 and grad w_j = -k_j xi_j, the gradient
 * is
 *
 *   d_a phi_j = -k_j xi_ja p_j.c + w_j p_j.M^-1 (e_a + A^T v_a),  where v_ja = k_j xi_ja p_j.c / sqrt(w_j).
 *
 * sqrt(w_j) |M^-1/2 p_j| <= 1 and |M^-1/2 A^T v_a| <= |v_a|, because the columns of A M^-1/2 are orthonormal.
 * So
 *
 *   |grad phi_j| <= |k_j xi_j p_j.c| + sqrt(w_j) (sqrt(sum_a (M^-1)_aa) + sqrt(sum_ja v_ja^2)),
 *
 * which wants neither gradients nor more moments. It comes to some 2 to 6 times the largest gradient.
 *
 * Points are the lanes of vectors, and walk through the candidates of their group together: nodes beyond a
 * support have no weight. Neither round-off of floats nor H of MMLS matters where M is as well conditioned as
 * is asked here; to be sure the bound is raised by a tenth. */
#include "approx/steep_kernel.h"

#include <math.h>
#include <string.h>

#define LANES STEEP_LANES
typedef float lanes __attribute__((vector_size(4 * LANES)));
typedef int32_t lane_bits __attribute__((vector_size(4 * LANES)));
typedef lanes mls_coefficient;

#include "approx/mls_moments.h"
#include "base/processor.h"

/* Pivots must exceed this times the diagonal entry. */
static const float least_share = 1e-2F;

/* M, or L^T above and 1 / E on the diagonal of M = L E L^T; in each lane its own. */
struct steep_system {
    lanes entry[MLS_MAX_BASIS][MLS_MAX_BASIS];
};

KERNEL_INLINE void square_root(lanes *value)
{
    for (int l = 0; l < LANES; l++) {
        (*value)[l] = sqrtf((*value)[l]);
    }
}

/* xi of the points to candidate i. */
KERNEL_INLINE void towards(int dim, const struct steep_group *group, int64_t i, const lanes *x, lanes *xi)
{
    for (int a = 0; a < dim; a++) {
        xi[a] = group->place[a * group->stride + i] - x[a];
    }
}

/* Weights (quartic spline) and moments; the largest weight. */
KERNEL_INLINE void weigh(int dim, int m, struct steep_group *group, const lanes *x, lanes *moment,
                         lanes *most_weight)
{
    int degree = m > dim + 1 ? 4 : 2;
    const lanes one = (lanes){0} + 1.0F;
    for (int64_t i = 0; i < group->count; i++) {
        lanes xi[3], distance2 = {0}, root, weight, share;
        float ratio = group->ratio[i];
        towards(dim, group, i, x, xi);
        for (int a = 0; a < dim; a++) {
            distance2 += xi[a] * xi[a];
        }
        root = distance2 * ratio;
        lane_bits beyond = root > one;
        root = (lanes)(((lane_bits)root & ~beyond) | ((lane_bits)one & beyond));
        square_root(&root);
        weight = (one - root) * (one - root) * (one - root) * (one + 3.0F * root);
        share = 144.0F * ratio * ratio * (one - root) * distance2 / (one + 3.0F * root);
        memcpy(group->weight + i * LANES, &weight, sizeof weight);
        memcpy(group->share + i * LANES, &share, sizeof share);
        larger(most_weight, &weight);
        add_moments(dim, degree, &weight, xi, moment);
    }
}

/* The factors; not zero in `good` where all pivots are large enough. */
KERNEL_INLINE void factorise(int m, const float *least, struct steep_system *system, lane_bits *good)
{
    lanes(*entry)[MLS_MAX_BASIS] = system->entry;
    lanes diagonal[MLS_MAX_BASIS];
    *good = (lane_bits){0} - 1;
    UNROLL
    for (int k = 0; k < m; k++) {
        diagonal[k] = entry[k][k];
    }
    UNROLL
    for (int k = 0; k < m; k++) {
        lanes pivot = entry[k][k], inverse = 1.0F / pivot;
        *good &= (pivot > least_share * diagonal[k]) & (pivot > least[k]);
        entry[k][k] = inverse;
        UNROLL
        for (int i = k + 1; i < m; i++) {
            lanes factor = entry[k][i] * inverse;
            UNROLL
            for (int l = i; l < m; l++) {
                entry[i][l] -= factor * entry[k][l];
            }
        }
        UNROLL
        for (int i = k + 1; i < m; i++) {
            entry[k][i] *= inverse;
        }
    }
}

/* y = L^-1 e_k; what stands before k is zero. */
KERNEL_INLINE void forward(int m, int k, const struct steep_system *system, lanes *y)
{
    y[k] = (lanes){0} + 1.0F;
    UNROLL
    for (int i = k + 1; i < m; i++) {
        y[i] = (lanes){0};
        UNROLL
        for (int l = k; l < i; l++) {
            y[i] -= system->entry[l][i] * y[l];
        }
    }
}

/* c = M^-1 e_1. */
KERNEL_INLINE void solve_unit(int m, const struct steep_system *system, lanes *c)
{
    forward(m, 0, system, c);
    UNROLL
    for (int k = m - 1; k >= 0; k--) {
        c[k] *= system->entry[k][k];
        UNROLL
        for (int i = m - 1; i > k; i--) {
            c[k] -= system->entry[k][i] * c[i];
        }
    }
}

/* Sum over a of (M^-1)_aa, the linear monomials. */
KERNEL_INLINE void inverse_trace(int dim, int m, const struct steep_system *system, lanes *trace)
{
    *trace = (lanes){0};
    for (int a = 1; a <= dim; a++) {
        lanes y[MLS_MAX_BASIS];
        forward(m, a, system, y);
        for (int k = a; k < m; k++) {
            *trace += y[k] * y[k] * system->entry[k][k];
        }
    }
}

/* The largest (k_j |xi_j| p_j.c)^2 and the sum of these, each divided by w_j. */
KERNEL_INLINE void slopes(int dim, int m, const struct steep_group *group, const lanes *x, const lanes *c,
                          lanes *most, lanes *sum)
{
    *most = *sum = (lanes){0};
    for (int64_t i = 0; i < group->count; i++) {
        lanes xi[3], projection, weight, share;
        towards(dim, group, i, x, xi);
        polynomial(dim, m, c, xi, &projection);
        memcpy(&weight, group->weight + i * LANES, sizeof weight);
        memcpy(&share, group->share + i * LANES, sizeof share);
        share *= projection * projection;
        weight *= share;
        *sum += share;
        larger(most, &weight);
    }
}

/* Bounds of LANES points x[dim][LANES]; see steep_kernel. */
KERNEL_INLINE void bound_lanes(int dim, int m, struct steep_group *group, const float *place, float *bound)
{
    struct steep_system system;
    lanes moment[MLS_MOMENTS], x[3], c[MLS_MAX_BASIS], most_weight = {0}, trace, most, sum;
    lane_bits good;
    memset(moment, 0, sizeof moment);
    memcpy(x, place, (size_t)dim * sizeof *x);
    weigh(dim, m, group, x, moment, &most_weight);
    for (int k = 0; k < m; k++) {
        for (int l = k; l < m; l++) {
            system.entry[k][l] = moment[moment_index(dim, k, l)];
        }
    }
    factorise(m, group->least_pivot, &system, &good);
    solve_unit(m, &system, c);
    inverse_trace(dim, m, &system, &trace);
    slopes(dim, m, group, x, c, &most, &sum);
    square_root(&most_weight);
    square_root(&trace);
    square_root(&most);
    square_root(&sum);
    most += most_weight * (trace + sum);
    for (int l = 0; l < LANES; l++) {
        bound[l] = good[l] ? most[l] : INFINITY;
    }
}

/* The same for each instruction set; the best is chosen at run time. */

#define KERNEL(set, shape, dim, m, attribute)                                                                \
    attribute static void shape##_##dim##_##set(struct steep_group *group, const float *x, float *bound)     \
    {                                                                                                        \
        bound_lanes(dim, m, group, x, bound);                                                                \
    }

#define KERNEL_SET(set, attribute)                                                                           \
    KERNEL(set, linear, 2, 3, attribute)                                                                     \
    KERNEL(set, linear, 3, 4, attribute)                                                                     \
    KERNEL(set, quadratic, 2, 6, attribute)                                                                  \
    KERNEL(set, quadratic, 3, 10, attribute)                                                                 \
    static const struct steep_kernels set##_kernels = {                                                      \
        #set, {linear_2_##set, linear_3_##set}, {quadratic_2_##set, quadratic_3_##set}};

KERNEL_SET(plain, PLAIN_SET)

#if defined(__x86_64__)
KERNEL_SET(avx2, AVX2_SET)
KERNEL_SET(avx512, AVX512_SET)
#endif

const struct steep_kernels *steep_kernels_named(const char *name)
{
    static const struct steep_kernels *const sets[] = {
#if defined(__x86_64__)
        &avx512_kernels,
        &avx2_kernels,
#endif
        &plain_kernels
    };
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        if (strcmp(sets[i]->name, name) == 0 && processor_has(name)) {
            return sets[i];
        }
    }
    return NULL;
}

const struct steep_kernels *steep_kernels_select(void)
{
    return steep_kernels_named(processor_best_set());
}
