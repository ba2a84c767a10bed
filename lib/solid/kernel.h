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

/* Points are taken LANES at a time; arrays over points are padded by LANES, so that whole vectors may be
 * read. */
#define LANES BODY_POINT_PADDING
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef float lanes_float __attribute__((vector_size(4 * LANES)));
typedef int32_t lanes_int __attribute__((vector_size(4 * LANES)));

/* Deformation gradients of the points from q on, dim x dim, and their cofactors J F^-T. */
struct lanes_gradient {
    lanes F[9], C[9];
};

KERNEL_INLINE void lanes_load(const struct body *body, int64_t q, int dim, struct lanes_gradient *g)
{
    for (int k = 0; k < dim * dim; k++) {
        LOAD(g->F[k], body->F + k * body->point_count + q);
    }
    const lanes *F = g->F;
    lanes *C = g->C;
    if (dim == 2) {
        C[0] = F[3];
        C[1] = -F[2];
        C[2] = -F[1];
        C[3] = F[0];
    } else {
        C[0] = F[4] * F[8] - F[5] * F[7];
        C[1] = F[5] * F[6] - F[3] * F[8];
        C[2] = F[3] * F[7] - F[4] * F[6];
        C[3] = F[2] * F[7] - F[1] * F[8];
        C[4] = F[0] * F[8] - F[2] * F[6];
        C[5] = F[1] * F[6] - F[0] * F[7];
        C[6] = F[1] * F[5] - F[2] * F[4];
        C[7] = F[2] * F[3] - F[0] * F[5];
        C[8] = F[0] * F[4] - F[1] * F[3];
    }
}

KERNEL_INLINE void kernel_determinants(struct body *body, const struct block *block, int dim)
{
    double J[MAX_BLOCK_POINTS];
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        struct lanes_gradient g;
        lanes_load(body, block->first_point + i, dim, &g);
        lanes sum = g.F[0] * g.C[0] + g.F[1] * g.C[1];
        if (dim == 3) {
            sum += g.F[2] * g.C[2];
        }
        STORE(J + i, sum);
    }
    memcpy(body->J + block->first_point, J, (size_t)block->point_count * sizeof *J);
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

/* x^(-1/3) for x > 0 by Newton's iteration from a guess by the exponent: exact to a few ulp. */
KERNEL_INLINE void inverse_cube_root(const lanes *x, lanes *root)
{
    lanes_float seed = __builtin_convertvector(*x, lanes_float);
    lanes_int bits;
    memcpy(&bits, &seed, sizeof bits);
    bits = 0x54a21d2a -
           __builtin_convertvector(__builtin_convertvector(bits, lanes_float) * (1.0f / 3.0f), lanes_int);
    memcpy(&seed, &bits, sizeof seed);
    lanes y = __builtin_convertvector(seed, lanes);
    for (int it = 0; it < 4; it++) {
        y = y * (4.0 - *x * y * y * y) * (1.0 / 3.0);
    }
    *root = y;
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
    double weighted_pressure[MAX_BLOCK_POINTS];
    kernel_pressures(body, block, dim, weighted_pressure);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        struct lanes_gradient g;
        lanes J, weight, shear, pressure, root;
        int64_t q = block->first_point + i;
        lanes_load(body, q, dim, &g);
        LOAD(J, body->J + q);
        LOAD(weight, body->weight + q);
        LOAD(shear, body->shear + q);
        LOAD(pressure, weighted_pressure + i);
        lanes I1 = g.F[0] * g.F[0] + (dim == 2 ? 1.0 : 0.0);
        for (int k = 1; k < dim * dim; k++) {
            I1 += g.F[k] * g.F[k];
        }
        inverse_cube_root(&J, &root);
        lanes scale = weight * shear * root * root;
        lanes along = pressure - scale * I1 * (1.0 / 3.0) * (root * root * root);
        for (int k = 0; k < dim * dim; k++) {
            lanes stress = scale * g.F[k] + along * g.C[k];
            STORE(P[k] + i, stress);
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
