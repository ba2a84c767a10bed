/* The kernels of the force loop, written once and compiled for several instruction sets; private to
 * lib/solid.
 *
 * Per pair of point and neighbour they do no more than a load of the gradient, a load of the displacement,
 * and the multiplications: the tables decide the speed. Vectors are those of the compiler (vector_size), so
 * that any target compiles; results differ between instruction sets by round-off only (fused
 * multiplications). */
#ifndef SOLID_KERNEL_H
#define SOLID_KERNEL_H

#include "solid/body.h"

#include <math.h>
#include <string.h>

#define KERNEL_INLINE static inline __attribute__((always_inline))

/* The most points of a block; body.c cuts no larger ones. */
#define MAX_BLOCK_POINTS 128

typedef double pair2 __attribute__((vector_size(16)));
typedef double quad4 __attribute__((vector_size(32)));

/* Unaligned loads and stores as copies, which compilers turn into single instructions. */
#define LOAD(vector, from) memcpy(&(vector), (from), sizeof(vector))
#define STORE(to, vector) memcpy((to), &(vector), sizeof(vector))

/* Displacements and forces of a block's nodes stand `LOCAL_STRIDE(dim)` doubles apart: 2, or 3 padded to 4.
 */
#define LOCAL_STRIDE(dim) ((dim) == 2 ? 2 : 4)

/* Weighted first Piola stresses of a block: row k of component k, points along it. */
typedef double block_stress[9][MAX_BLOCK_POINTS];

/* Displacements of the block's nodes. */
KERNEL_INLINE void kernel_localise(const struct body *body, const struct block *block, int dim,
                                   const double *u, double *local)
{
    const int32_t *node = body->block_node + block->first_node;
    for (int64_t i = 0; i < block->node_count; i++) {
        for (int a = 0; a < dim; a++) {
            local[i * LOCAL_STRIDE(dim) + a] = u[(int64_t)node[i] * dim + a];
        }
    }
}

/* (u0, u0, u1, u1) * (g0, g1, g0, g1): the outer product of one pair in 2D. */
KERNEL_INLINE void outer2(const double *u, const double *g, quad4 *sum)
{
    quad4 uu = {u[0], u[0], u[1], u[1]}, gg = {g[0], g[1], g[0], g[1]};
    *sum += uu * gg;
}

KERNEL_INLINE void gradients_2d(struct body *body, const struct block *block, const double *local)
{
    int64_t stride = body->point_count;
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        /* Several sums: the loop is bound by the latency of the additions otherwise. */
        quad4 sum[4] = {{1.0, 0.0, 0.0, 1.0}};
        int64_t i = body->ptr[q], end = body->ptr[q + 1];
        for (; i + 4 <= end; i += 4) {
            for (int lane = 0; lane < 4; lane++) {
                outer2(local + 2 * (int64_t)body->local[i + lane], body->dphi + 2 * (i + lane), &sum[lane]);
            }
        }
        for (; i < end; i++) {
            outer2(local + 2 * (int64_t)body->local[i], body->dphi + 2 * i, &sum[1]);
        }
        sum[0] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
        for (int k = 0; k < 4; k++) {
            body->F[k * stride + q] = sum[0][k];
        }
    }
}

/* Rows of F += u_a (g0, g1, g2, junk). */
KERNEL_INLINE void outer3(const double *u, const double *g, quad4 row[3])
{
    quad4 gg;
    LOAD(gg, g);
    for (int a = 0; a < 3; a++) {
        row[a] += u[a] * gg;
    }
}

KERNEL_INLINE void gradients_3d(struct body *body, const struct block *block, const double *local)
{
    int64_t stride = body->point_count;
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        quad4 even[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}, odd[3] = {{0.0}, {0.0}, {0.0}};
        int64_t i = body->ptr[q], end = body->ptr[q + 1];
        for (; i + 2 <= end; i += 2) {
            outer3(local + 4 * (int64_t)body->local[i], body->dphi + 3 * i, even);
            outer3(local + 4 * (int64_t)body->local[i + 1], body->dphi + 3 * i + 3, odd);
        }
        if (i < end) {
            outer3(local + 4 * (int64_t)body->local[i], body->dphi + 3 * i, even);
        }
        for (int a = 0; a < 3; a++) {
            even[a] += odd[a];
            for (int b = 0; b < 3; b++) {
                body->F[(3 * a + b) * stride + q] = even[a][b];
            }
        }
    }
}

/* Cofactors of point i of a block whose F stands at F[k * stride]. */
KERNEL_INLINE void kernel_cofactors(const double *F, int64_t stride, int64_t i, int dim, double C[9])
{
    if (dim == 2) {
        C[0] = F[3 * stride + i];
        C[1] = -F[2 * stride + i];
        C[2] = -F[stride + i];
        C[3] = F[i];
    } else {
        double m[9];
        for (int k = 0; k < 9; k++) {
            m[k] = F[k * stride + i];
        }
        cofactor(m, C);
    }
}

KERNEL_INLINE void kernel_determinants(struct body *body, const struct block *block, int dim)
{
    int64_t stride = body->point_count;
    const double *F = body->F + block->first_point;
    double *J = body->J + block->first_point;
#pragma omp simd
    for (int64_t i = 0; i < block->point_count; i++) {
        double C[9];
        kernel_cofactors(F, stride, i, dim, C);
        double sum = 0.0;
        for (int b = 0; b < dim; b++) {
            sum += F[b * stride + i] * C[b];
        }
        J[i] = sum;
    }
}

/* F and J of a block from the displacements u of all nodes; local: scratch. */
KERNEL_INLINE void kernel_gather(struct body *body, const struct block *block, int dim, const double *u,
                                 double *local)
{
    kernel_localise(body, block, dim, u, local);
    if (dim == 2) {
        gradients_2d(body, block, local);
    } else {
        gradients_3d(body, block, local);
    }
    kernel_determinants(body, block, dim);
}

/* x^(-1/3) for x > 0 by Newton's iteration from a guess by the exponent: exact to a few ulp, and it
 * vectorises. */
KERNEL_INLINE double inverse_cube_root(double x)
{
    float seed = (float)x;
    uint32_t bits;
    memcpy(&bits, &seed, sizeof bits);
    bits = 0x54a21d2au - bits / 3u;
    memcpy(&seed, &bits, sizeof seed);
    double y = (double)seed;
    for (int it = 0; it < 4; it++) {
        y = y * (4.0 - x * y * y * y) * (1.0 / 3.0);
    }
    return y;
}

/* Volumetric pressure of each point of a neo-Hookean block, weighted: its own, or that of the hats around it.
 */
KERNEL_INLINE void kernel_pressures(const struct body *body, const struct block *block, int dim,
                                    double *pressure)
{
    const double *J = body->J + block->first_point, *bulk = body->bulk + block->first_point;
    const double *weight = body->weight + block->first_point;
    if (!body->averaged) {
        for (int64_t i = 0; i < block->point_count; i++) {
            pressure[i] = weight[i] * bulk[i] * (J[i] - 1.0);
        }
        return;
    }
    const int32_t *hat = body->hats.of_point + block->first_point * (dim + 1);
    const double *value = body->hats.value + block->first_point * (dim + 1);
    for (int64_t i = 0; i < block->point_count; i++) {
        double level = 0.0, slope = 0.0;
        for (int64_t k = i * (dim + 1); k < (i + 1) * (dim + 1); k++) {
            level += value[k] * body->hats.pressure[hat[k]];
            slope += value[k] * body->hats.slope[hat[k]];
        }
        pressure[i] = weight[i] * (level + slope * J[i]);
    }
}

/* P = mu J^(-2/3) (F - I1/3 F^-T) + p J F^-T, times the weight. */
KERNEL_INLINE void kernel_neo_hookean(const struct body *body, const struct block *block, int dim,
                                      block_stress P)
{
    int64_t stride = body->point_count;
    const double *F = body->F + block->first_point, *J = body->J + block->first_point;
    const double *weight = body->weight + block->first_point, *shear = body->shear + block->first_point;
    double pressure[MAX_BLOCK_POINTS];
    kernel_pressures(body, block, dim, pressure);
#pragma omp simd
    for (int64_t i = 0; i < block->point_count; i++) {
        double C[9], I1 = dim == 2 ? 1.0 : 0.0;
        for (int k = 0; k < dim * dim; k++) {
            I1 += F[k * stride + i] * F[k * stride + i];
        }
        kernel_cofactors(F, stride, i, dim, C);
        double root = inverse_cube_root(J[i]);
        double scale = weight[i] * shear[i] * root * root;
        double along = pressure[i] - scale * I1 * (1.0 / 3.0) * (root * root * root);
        for (int k = 0; k < dim * dim; k++) {
            P[k][i] = scale * F[k * stride + i] + along * C[k];
        }
    }
}

KERNEL_INLINE void scatter_2d(const struct body *body, const struct block *block, const block_stress P,
                              double *force)
{
    for (int64_t p = 0; p < block->point_count; p++) {
        int64_t q = block->first_point + p;
        pair2 column0 = {P[0][p], P[2][p]}, column1 = {P[1][p], P[3][p]};
        for (int64_t i = body->ptr[q]; i < body->ptr[q + 1]; i++) {
            double *f = force + 2 * (int64_t)body->local[i];
            pair2 sum;
            LOAD(sum, f);
            sum += column0 * body->dphi[2 * i] + column1 * body->dphi[2 * i + 1];
            STORE(f, sum);
        }
    }
}

KERNEL_INLINE void scatter_3d(const struct body *body, const struct block *block, const block_stress P,
                              double *force)
{
    for (int64_t p = 0; p < block->point_count; p++) {
        int64_t q = block->first_point + p;
        quad4 column0 = {P[0][p], P[3][p], P[6][p], 0.0}, column1 = {P[1][p], P[4][p], P[7][p], 0.0};
        quad4 column2 = {P[2][p], P[5][p], P[8][p], 0.0};
        for (int64_t i = body->ptr[q]; i < body->ptr[q + 1]; i++) {
            const double *g = body->dphi + 3 * i;
            double *f = force + 4 * (int64_t)body->local[i];
            quad4 sum;
            LOAD(sum, f);
            sum += column0 * g[0] + column1 * g[1] + column2 * g[2];
            STORE(f, sum);
        }
    }
}

/* Forces of a block on its nodes, f_j = sum_q P_q grad phi_j, into block_force; local: scratch. */
KERNEL_INLINE void kernel_scatter(struct body *body, const struct block *block, int dim, const block_stress P,
                                  double *local)
{
    double *force = body->block_force + block->first_node * dim;
    memset(local, 0, (size_t)(block->node_count * LOCAL_STRIDE(dim)) * sizeof *local);
    if (dim == 2) {
        scatter_2d(body, block, P, local);
        memcpy(force, local, (size_t)(block->node_count * 2) * sizeof *force);
        return;
    }
    scatter_3d(body, block, P, local);
    for (int64_t i = 0; i < block->node_count; i++) {
        for (int a = 0; a < 3; a++) {
            force[3 * i + a] = local[4 * i + a];
        }
    }
}

/* One set of compiled kernels. */
struct force_kernels {
    const char *name;
    void (*gather)(struct body *body, const struct block *block, const double *u, double *local);
    void (*neo_hookean)(const struct body *body, const struct block *block, block_stress P);
    void (*scatter)(struct body *body, const struct block *block, const block_stress P, double *local);
};

/* The best set for this processor and dimension. */
const struct force_kernels *force_kernels_select(int dim);

#endif
