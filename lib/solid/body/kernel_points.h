/* Kernels over integration points: volume ratios and the neo-Hookean law; private to lib/solid. */
#pragma once

#include "solid/body/kernel.h"
#include "solid/body/kernel_vector.h"
#include "solid/body/nodal_volume.h"

#include <math.h>

/* Entries of the matrices of the points at `row` and behind it, their components so far apart. */
KERNEL_INLINE void load_matrix(const double *row, int64_t apart, int dim, lanes F[9])
{
    for (int k = 0; k < dim * dim; k++) {
        LOAD(F[k], row + k * apart);
    }
}

/* Moduli of the points from q on, Pa. */
KERNEL_INLINE void load_moduli(const struct body *body, int64_t q, lanes *shear, lanes *bulk)
{
    for (int i = 0; i < LANES; i++) {
        const struct material *material = &body->materials[body->material[q + i]];
        (*shear)[i] = material->shear_modulus;
        (*bulk)[i] = material->bulk_modulus;
    }
}

/* Cofactor J F^-T; in two dimensions that of the part in the plane. */
KERNEL_INLINE void lanes_cofactor(const lanes F[9], int dim, lanes C[9])
{
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

KERNEL_INLINE void lanes_determinant(const lanes F[9], const lanes C[9], int dim, lanes *J)
{
    *J = F[0] * C[0] + F[1] * C[1];
    if (dim == 3) {
        *J += F[2] * C[2];
    }
}

/* The least determinant of a block. */
KERNEL_INLINE void note_least(struct block *block, const double *determinant)
{
    double least = INFINITY;
    int64_t worst = 0;
    for (int64_t i = 0; i < block->point_count && !isnan(least); i++) {
        if (!(determinant[i] >= least)) { /* so that NaN counts as the worst */
            least = determinant[i];
            worst = i;
        }
    }
    block->least_jacobian = least;
    block->worst_point = block->first_point + worst;
}

/* J from F, and the least of the block. */
KERNEL_INLINE void kernel_determinants(struct body *body, struct block *block, int dim)
{
    double determinant[BLOCK_MOST_POINTS + LANES];
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes F[9], C[9], J;
        load_matrix(body->F + block->first_point + i, body->point_count, dim, F);
        lanes_cofactor(F, dim, C);
        lanes_determinant(F, C, dim, &J);
        STORE(determinant + i, J);
    }
    memcpy(body->J + block->first_point, determinant, (size_t)block->point_count * sizeof *determinant);
    note_least(block, determinant);
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

/* Volumetric pressure of each point of a neo-Hookean block, weighted: by its own law, or by the nodal volumes
 * around it (nodal_volume.h); J: of its points. */
KERNEL_INLINE void kernel_pressures(const struct body *body, const struct block *block, const double *J,
                                    int dim, double *pressure)
{
    const int32_t *material = body->material + block->first_point;
    const double *weight = body->weight + block->first_point;
    if (!body->averaged) {
        for (int64_t i = 0; i < block->point_count; i++) {
            pressure[i] = weight[i] * body->materials[material[i]].bulk_modulus * (J[i] - 1.0);
        }
        return;
    }
    const int32_t *volume = body->volumes.of_point + block->first_point * (dim + 1);
    const double *share = body->volumes.share + block->first_point * (dim + 1);
    const double *direct = body->volumes.direct != NULL ? body->volumes.direct : body->volumes.change;
    direct += block->first_point;
    for (int64_t i = 0; i < block->point_count; i++) {
        double sum = 0.0;
        for (int64_t k = i * (dim + 1); k < (i + 1) * (dim + 1); k++) {
            sum += share[k] * body->volumes.pressure[volume[k]];
        }
        pressure[i] = sum + weight[i] * nodal_volume_modulus(&body->materials[material[i]]) * direct[i];
    }
}

/* The neo-Hookean isochoric energy, and its stress a F + b C, C the cofactor of F; weighted. */
struct lanes_isochoric {
    lanes energy, along_gradient, along_cofactor;
};

/* W = mu/2 (J^(-2/3) I1 - 3), P = mu J^(-2/3) (F - I1/3 F^-T); shear: mu, weighted. */
KERNEL_INLINE void neo_hookean_isochoric(const lanes F[9], const lanes *J, const lanes *shear, int dim,
                                         struct lanes_isochoric *isochoric)
{
    lanes root, I1 = F[0] * F[0] + (dim == 2 ? 1.0 : 0.0);
    for (int k = 1; k < dim * dim; k++) {
        I1 += F[k] * F[k];
    }
    inverse_cube_root(J, &root);
    lanes scale = *shear * root * root;
    isochoric->energy = 0.5 * (scale * I1 - 3.0 * *shear);
    isochoric->along_gradient = scale;
    isochoric->along_cofactor = scale * I1 * (-1.0 / 3.0) * (root * root * root);
}

/* P = mu J^(-2/3) (F - I1/3 F^-T) + p J F^-T, times the weight. */
KERNEL_INLINE void kernel_neo_hookean(const struct body *body, const struct block *block, int dim,
                                      block_rows P)
{
    double weighted_pressure[BLOCK_MOST_POINTS];
    kernel_pressures(body, block, body->J + block->first_point, dim, weighted_pressure);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes F[9], C[9], J, weight, shear, bulk, pressure;
        struct lanes_isochoric isochoric;
        int64_t q = block->first_point + i;
        load_matrix(body->F + q, body->point_count, dim, F);
        lanes_cofactor(F, dim, C);
        LOAD(J, body->J + q);
        LOAD(weight, body->weight + q);
        load_moduli(body, q, &shear, &bulk);
        LOAD(pressure, weighted_pressure + i);
        shear *= weight;
        neo_hookean_isochoric(F, &J, &shear, dim, &isochoric);
        pressure += isochoric.along_cofactor;
        for (int k = 0; k < dim * dim; k++) {
            lanes stress = isochoric.along_gradient * F[k] + pressure * C[k];
            STORE(P[k] + i, stress);
        }
    }
}
