/* Kernels over integration points: volume ratios, conforming cells, and the neo-Hookean law; private to
 * lib/solid. */
#ifndef SOLID_KERNEL_POINTS_H
#define SOLID_KERNEL_POINTS_H

#include "solid/compatibility.h"
#include "solid/kernel.h"
#include "solid/kernel_vector.h"

#include <math.h>

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

/* J from F, and the least of the block. */
KERNEL_INLINE void kernel_determinants(struct body *body, struct block *block, int dim)
{
    double J[PAIRS_MAX_ROWS], least = INFINITY;
    int64_t worst = 0;
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        struct lanes_gradient g;
        lanes_load(body, block->first_point + i, dim, &g);
        lanes sum = g.F[0] * g.C[0] + g.F[1] * g.C[1];
        if (dim == 3) {
            sum += g.F[2] * g.C[2];
        }
        STORE(J + i, sum);
    }
    for (int64_t i = 0; i < block->point_count && !isnan(least); i++) {
        if (!(J[i] >= least)) { /* so that NaN counts as the worst */
            least = J[i];
            worst = i;
        }
    }
    memcpy(body->J + block->first_point, J, (size_t)block->point_count * sizeof *J);
    block->least_jacobian = least;
    block->worst_point = block->first_point + worst;
}

/* What the corners of a block's cells look at: component a of corner k in row k dim + a, cells along it. */
typedef double block_corners[12][PAIRS_MAX_ROWS];

KERNEL_INLINE void read_corners(const struct means *means, const struct block *block, int dim,
                                block_corners corners)
{
    const int32_t *of_corner = means->of_corner + block->first_point * (dim + 1);
    for (int64_t i = 0; i < block->point_count; i++) {
        for (int k = 0; k <= dim; k++) {
            const double *value = means->value + of_corner[i * (dim + 1) + k];
            for (int a = 0; a < dim; a++) {
                corners[k * dim + a][i] = value[a * PAIRS_GROUP];
            }
        }
    }
}

KERNEL_INLINE void write_corners(struct means *means, const struct block *block, int dim,
                                 const block_corners corners)
{
    int64_t i = 0, stride = (dim + 1) * PAIRS_STRIDE(dim);
    double *force = means->corner_force + block->first_point * stride;
    for (; dim == 3 && i + 4 <= block->point_count; i += 4) {
        for (int k = 0; k <= dim; k++) {
            quad4 row[4] = {{0.0}};
            for (int a = 0; a < dim; a++) {
                LOAD(row[a], corners[k * dim + a] + i);
            }
            transpose(row);
            for (int r = 0; r < 4; r++) {
                STORE(force + (i + r) * stride + k * PAIRS_STRIDE(dim), row[r]);
            }
        }
    }
    for (; i < block->point_count; i++) {
        for (int k = 0; k <= dim; k++) {
            for (int a = 0; a < dim; a++) {
                force[i * stride + k * PAIRS_STRIDE(dim) + a] = corners[k * dim + a][i];
            }
        }
    }
}

/* Hat gradients of the cells from q on. */
KERNEL_INLINE void load_hats(const struct body *body, int64_t q, int dim, lanes hat[9])
{
    for (int k = 0; k < dim * dim; k++) {
        LOAD(hat[k], body->cells.hat + k * body->point_count + q);
    }
}

/* gradient = sum_k v_k (x) grad N_k for corner values v of the cells i .. of a block. */
KERNEL_INLINE void corner_gradient(const block_corners v, int64_t i, int dim, const lanes hat[9],
                                   lanes gradient[9])
{
    for (int a = 0; a < dim; a++) {
        lanes origin;
        LOAD(origin, v[a] + i);
        for (int b = 0; b < dim; b++) {
            gradient[a * dim + b] = (lanes){0.0};
        }
        for (int k = 1; k <= dim; k++) {
            lanes value;
            LOAD(value, v[k * dim + a] + i);
            value -= origin;
            for (int b = 0; b < dim; b++) {
                gradient[a * dim + b] += value * hat[(k - 1) * dim + b];
            }
        }
    }
}

/* The transpose: v_k = scale P grad N_k. */
KERNEL_INLINE void corner_forces(const lanes P[9], int64_t i, int dim, const lanes hat[9], double scale,
                                 block_corners v)
{
    for (int a = 0; a < dim; a++) {
        lanes all = {0.0};
        for (int k = 1; k <= dim; k++) {
            lanes sum = P[a * dim] * hat[(k - 1) * dim];
            for (int b = 1; b < dim; b++) {
                sum += P[a * dim + b] * hat[(k - 1) * dim + b];
            }
            sum *= scale;
            all -= sum;
            STORE(v[k * dim + a] + i, sum);
        }
        STORE(v[a] + i, all);
    }
}

/* F = I - dim sum_k m_k (x) grad N_k */
KERNEL_INLINE void kernel_cell_gradients(struct body *body, struct block *block, int dim)
{
    block_corners mean;
    block_stress F;
    read_corners(&body->cells.faces, block, dim, mean);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes hat[9], gradient[9];
        load_hats(body, block->first_point + i, dim, hat);
        corner_gradient((const double(*)[PAIRS_MAX_ROWS])mean, i, dim, hat, gradient);
        for (int k = 0; k < dim * dim; k++) {
            lanes entry = (k % (dim + 1) == 0 ? 1.0 : 0.0) - (double)dim * gradient[k];
            STORE(F[k] + i, entry);
        }
    }
    for (int k = 0; k < dim * dim; k++) {
        memcpy(body->F + k * body->point_count + block->first_point, F[k],
               (size_t)block->point_count * sizeof *F[k]);
    }
    kernel_determinants(body, block, dim);
}

/* T = w a (F_h - F), F_h = I + sum_k v_k (x) grad N_k of the node values v: what the ties pull at F with. */
KERNEL_INLINE void tie_stress(struct body *body, const struct block *block, int64_t i, int dim,
                              const block_corners v, const lanes hat[9], double energy[PAIRS_MAX_ROWS],
                              lanes T[9])
{
    int64_t q = block->first_point + i;
    lanes weight, coefficient, F, sum = {0.0};
    LOAD(weight, body->weight + q);
    LOAD(coefficient, body->compatibility->coefficient + q);
    weight *= coefficient;
    corner_gradient(v, i, dim, hat, T);
    for (int k = 0; k < dim * dim; k++) {
        LOAD(F, body->F + k * body->point_count + q);
        T[k] += (k % (dim + 1) == 0 ? 1.0 : 0.0) - F;
        sum += T[k] * T[k];
        T[k] *= weight;
    }
    sum *= 0.5 * weight;
    STORE(energy + i, sum);
}

/* What the corners put on the means of faces, -dim P grad N_k, and where the ties are active on the node
 * values. */
KERNEL_INLINE void kernel_cell_forces(struct body *body, const struct block *block, int dim,
                                      const block_stress P)
{
    bool tied = body->compatibility != NULL && body->compatibility->active;
    block_corners at_faces, at_nodes, pull;
    double energy[PAIRS_MAX_ROWS];
    if (tied) {
        read_corners(&body->compatibility->nodes, block, dim, at_nodes);
    }
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes hat[9], stress[9], tie[9];
        load_hats(body, block->first_point + i, dim, hat);
        for (int k = 0; k < dim * dim; k++) {
            LOAD(stress[k], P[k] + i);
        }
        if (tied) {
            tie_stress(body, block, i, dim, (const double(*)[PAIRS_MAX_ROWS])at_nodes, hat, energy, tie);
            corner_forces(tie, i, dim, hat, 1.0, pull);
            for (int k = 0; k < dim * dim; k++) {
                stress[k] -= tie[k];
            }
        }
        corner_forces(stress, i, dim, hat, -(double)dim, at_faces);
    }
    write_corners(&body->cells.faces, block, dim, (const double(*)[PAIRS_MAX_ROWS])at_faces);
    if (tied) {
        write_corners(&body->compatibility->nodes, block, dim, (const double(*)[PAIRS_MAX_ROWS])pull);
        memcpy(body->compatibility->energy + block->first_point, energy,
               (size_t)block->point_count * sizeof *energy);
    }
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
    double weighted_pressure[PAIRS_MAX_ROWS];
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

#endif
