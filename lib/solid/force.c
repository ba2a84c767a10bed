/* The force loop: deformation gradients by gathering, stresses, forces by scattering; see body.h. */
#include "solid/body.h"

#include <math.h>
#include <string.h>

/* Upper bounds of what a block holds: body.c cuts no larger ones. */
#define MAX_BLOCK_POINTS 128
#define MAX_LOCAL (BODY_MAX_BLOCK_NODES * 3)

#define INLINE static inline __attribute__((always_inline))

/* x^(-1/3) for x > 0 by Newton's iteration from a guess by the exponent: vectorises, exact to a few ulp. */
INLINE double inverse_cube_root(double x)
{
    float seed = (float)x;
    uint32_t bits;
    memcpy(&bits, &seed, sizeof bits);
    bits = 0x54a21d2au - bits / 3u;
    memcpy(&seed, &bits, sizeof seed);
    double y = (double)seed;
    for (int i = 0; i < 4; i++) {
        y = y * (4.0 - x * y * y * y) * (1.0 / 3.0);
    }
    return y;
}

/* F = I + sum_j u_j (x) grad phi_j for the points of a block; u_local holds the block's nodes. */
INLINE void gather_gradients(struct body *body, const struct block *block, int dim, const double *u_local)
{
    int64_t stride = body->point_count;
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        double even[9] = {0.0}, odd[9] = {0.0};
        int64_t i = body->ptr[q], end = body->ptr[q + 1];
        /* Two sets of sums: the loop is bound by the latency of the additions. */
        for (; i + 2 <= end; i += 2) {
            const double *u0 = u_local + (int64_t)body->local[i] * dim, *g0 = body->dphi + i * dim;
            const double *u1 = u_local + (int64_t)body->local[i + 1] * dim, *g1 = g0 + dim;
            for (int a = 0; a < dim; a++) {
                for (int b = 0; b < dim; b++) {
                    even[a * dim + b] += u0[a] * g0[b];
                    odd[a * dim + b] += u1[a] * g1[b];
                }
            }
        }
        if (i < end) {
            const double *u0 = u_local + (int64_t)body->local[i] * dim, *g0 = body->dphi + i * dim;
            for (int a = 0; a < dim; a++) {
                for (int b = 0; b < dim; b++) {
                    even[a * dim + b] += u0[a] * g0[b];
                }
            }
        }
        for (int k = 0; k < dim * dim; k++) {
            body->F[k * stride + q] = even[k] + odd[k] + (k % (dim + 1) == 0 ? 1.0 : 0.0);
        }
    }
}

/* J of the points of a block from their F. */
INLINE void determinants(struct body *body, const struct block *block, int dim)
{
    int64_t stride = body->point_count;
    const double *F = body->F;
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        if (dim == 2) {
            body->J[q] = F[q] * F[3 * stride + q] - F[stride + q] * F[2 * stride + q];
        } else {
            double m[9];
            for (int k = 0; k < 9; k++) {
                m[k] = F[k * stride + q];
            }
            body->J[q] = determinant(m);
        }
    }
}

/* Cofactors of F, dim x dim, at point q. */
INLINE void cofactors_at(const double *F, int64_t stride, int64_t q, int dim, double *C)
{
    if (dim == 2) {
        C[0] = F[3 * stride + q];
        C[1] = -F[2 * stride + q];
        C[2] = -F[stride + q];
        C[3] = F[q];
    } else {
        double m[9];
        for (int k = 0; k < 9; k++) {
            m[k] = F[k * stride + q];
        }
        cofactor(m, C);
    }
}

/* Averaged dU/dJ at a point of a body with nodal volumes. */
INLINE double averaged_pressure(const struct body *body, int dim, int64_t q)
{
    const int32_t *hat = body->hats.of_point + q * (dim + 1);
    const double *value = body->hats.value + q * (dim + 1);
    double sum = 0.0;
    for (int k = 0; k <= dim; k++) {
        sum += value[k] * body->hats.pressure[hat[k]];
    }
    return sum;
}

/* Weighted first Piola stress of a block of neo-Hookean points: P[k][point of block]. */
INLINE void neo_hookean_block(const struct body *body, const struct block *block, int dim, bool averaged,
                              double (*P)[MAX_BLOCK_POINTS])
{
    int64_t stride = body->point_count;
    double pressure[MAX_BLOCK_POINTS];
    for (int64_t i = 0; i < block->point_count; i++) {
        int64_t q = block->first_point + i;
        double own = body->bulk[q] * (body->J[q] - 1.0);
        pressure[i] = !averaged ? own
                                : body->pointwise_share * own +
                                      (1.0 - body->pointwise_share) * averaged_pressure(body, dim, q);
    }
    for (int64_t i = 0; i < block->point_count; i++) {
        int64_t q = block->first_point + i;
        double C[9], J = body->J[q], I1 = dim == 2 ? 1.0 : 0.0;
        for (int k = 0; k < dim * dim; k++) {
            I1 += body->F[k * stride + q] * body->F[k * stride + q];
        }
        cofactors_at(body->F, stride, q, dim, C);
        double root = inverse_cube_root(J);
        double scale = body->weight[q] * body->shear[q] * root * root;
        double along = body->weight[q] * pressure[i] - scale * I1 / (3.0 * J);
        for (int k = 0; k < dim * dim; k++) {
            P[k][i] = scale * body->F[k * stride + q] + along * C[k];
        }
    }
}

/* F at a point, 3 x 3. */
static void full_gradient(const struct body *body, int64_t q, double F[9])
{
    int dim = body->dim;
    memset(F, 0, 9 * sizeof *F);
    F[8] = 1.0;
    for (int a = 0; a < dim; a++) {
        for (int b = 0; b < dim; b++) {
            F[3 * a + b] = body->F[(a * dim + b) * body->point_count + q];
        }
    }
}

/* P at a point of the body, 3 x 3, any material. */
static void full_stress(const struct body *body, int64_t q, double P[9])
{
    double F[9], C[9];
    const struct material *material = &body->materials[body->material[q]];
    full_gradient(body, q, F);
    material_shape_stress(material, F, P);
    cofactor(F, C);
    double pressure = body->pointwise_share * material_pressure(material, body->J[q]);
    if (body->averaged) {
        pressure += (1.0 - body->pointwise_share) * averaged_pressure(body, body->dim, q);
    }
    for (int k = 0; k < 9; k++) {
        P[k] += pressure * C[k];
    }
}

static void general_block(const struct body *body, const struct block *block, double (*P)[MAX_BLOCK_POINTS])
{
    int dim = body->dim;
    for (int64_t i = 0; i < block->point_count; i++) {
        double full[9];
        full_stress(body, block->first_point + i, full);
        for (int k = 0; k < dim * dim; k++) {
            P[k][i] = body->weight[block->first_point + i] * full[3 * (k / dim) + k % dim];
        }
    }
}

/* Forces of a block on its nodes: f_j = sum_q P_q grad phi_j. */
INLINE void scatter_forces(struct body *body, const struct block *block, int dim,
                           double (*P)[MAX_BLOCK_POINTS])
{
    double *force = body->block_force + block->first_node * dim;
    memset(force, 0, (size_t)(block->node_count * dim) * sizeof *force);
    for (int64_t p = 0; p < block->point_count; p++) {
        int64_t q = block->first_point + p;
        double stress[9];
        for (int k = 0; k < dim * dim; k++) {
            stress[k] = P[k][p];
        }
        for (int64_t i = body->ptr[q]; i < body->ptr[q + 1]; i++) {
            const double *g = body->dphi + i * dim;
            double *f = force + (int64_t)body->local[i] * dim;
            for (int a = 0; a < dim; a++) {
                double sum = stress[a * dim] * g[0];
                for (int b = 1; b < dim; b++) {
                    sum += stress[a * dim + b] * g[b];
                }
                f[a] += sum;
            }
        }
    }
}

INLINE void gather_block(struct body *body, const struct block *block, int dim, const double *u,
                         double *u_local)
{
    const int32_t *node = body->block_node + block->first_node;
    for (int64_t i = 0; i < block->node_count; i++) {
        for (int a = 0; a < dim; a++) {
            u_local[i * dim + a] = u[(int64_t)node[i] * dim + a];
        }
    }
    gather_gradients(body, block, dim, u_local);
    determinants(body, block, dim);
}

INLINE void stress_block(struct body *body, const struct block *block, int dim)
{
    double P[9][MAX_BLOCK_POINTS];
    if (!block->neo_hookean) {
        general_block(body, block, P);
    } else if (body->averaged) {
        neo_hookean_block(body, block, dim, true, P);
    } else {
        neo_hookean_block(body, block, dim, false, P);
    }
    scatter_forces(body, block, dim, P);
}

/* theta_a and dU/dJ(theta_a) of hats first..last-1. */
static void average_volume(struct body *body, int64_t a)
{
    struct volume_hats *hats = &body->hats;
    double sum = 0.0;
    for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
        sum += hats->share[i] * body->J[hats->point[i]];
    }
    hats->theta[a] = sum;
    hats->pressure[a] = material_pressure(&body->materials[hats->material[a]], sum);
}

INLINE void sum_node(const struct body *body, int dim, int64_t node, double *force)
{
    double sum[3] = {0.0, 0.0, 0.0};
    for (int64_t i = body->gather_ptr[node]; i < body->gather_ptr[node + 1]; i++) {
        const double *part = body->block_force + (int64_t)body->gather[i] * dim;
        for (int a = 0; a < dim; a++) {
            sum[a] += part[a];
        }
    }
    for (int a = 0; a < dim; a++) {
        force[node * dim + a] = sum[a];
    }
}

/* The loops over blocks, hats and nodes, specialised by dimension. With force == NULL only F, J and the
 * averages. */
INLINE void evaluate(struct body *body, int dim, const double *u, double *force)
{
#pragma omp parallel
    {
        double u_local[MAX_LOCAL];
#pragma omp for schedule(static)
        for (int64_t b = 0; b < body->block_count; b++) {
            gather_block(body, &body->blocks[b], dim, u, u_local);
            if (force != NULL && !body->averaged) {
                stress_block(body, &body->blocks[b], dim);
            }
        }
        if (body->averaged) {
#pragma omp for schedule(static)
            for (int64_t a = 0; a < body->hats.count; a++) {
                average_volume(body, a);
            }
            if (force != NULL) {
#pragma omp for schedule(static)
                for (int64_t b = 0; b < body->block_count; b++) {
                    stress_block(body, &body->blocks[b], dim);
                }
            }
        }
        if (force != NULL) {
#pragma omp for schedule(static)
            for (int64_t n = 0; n < body->node_count; n++) {
                sum_node(body, dim, n, force);
            }
        }
    }
}

struct deformation body_force(struct body *body, const double *u, double *force)
{
    struct deformation deformation = {.least_jacobian = INFINITY};
    int64_t worst = 0;
    if (body->dim == 2) {
        evaluate(body, 2, u, force);
    } else {
        evaluate(body, 3, u, force);
    }
    for (int64_t q = 0; q < body->point_count; q++) {
        /* Written so that NaN counts as the worst. */
        if (!(body->J[q] >= deformation.least_jacobian)) {
            deformation.least_jacobian = body->J[q];
            worst = q;
            if (isnan(body->J[q])) {
                break;
            }
        }
    }
    deformation.point = body->order[worst];
    return deformation;
}

double body_energy(struct body *body, const double *u)
{
    double energy = 0.0, F[9];
    if (body->dim == 2) {
        evaluate(body, 2, u, NULL);
    } else {
        evaluate(body, 3, u, NULL);
    }
    for (int64_t q = 0; q < body->point_count; q++) {
        const struct material *material = &body->materials[body->material[q]];
        full_gradient(body, q, F);
        energy += body->weight[q] * (material_shape_energy(material, F) +
                                     body->pointwise_share * material_volume_energy(material, body->J[q]));
    }
    for (int64_t a = 0; body->averaged && a < body->hats.count; a++) {
        energy += (1.0 - body->pointwise_share) * body->hats.volume[a] *
                  material_volume_energy(&body->materials[body->hats.material[a]], body->hats.theta[a]);
    }
    return energy;
}

void body_stress(const struct body *body, double *stress)
{
    for (int64_t q = 0; q < body->point_count; q++) {
        full_stress(body, q, stress + body->order[q] * 9);
    }
}

void body_gradient(const struct body *body, double *gradient)
{
    for (int64_t q = 0; q < body->point_count; q++) {
        full_gradient(body, q, gradient + body->order[q] * 9);
    }
}
