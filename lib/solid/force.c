/* The force loop: deformation gradients by gathering, stresses, forces by scattering; see body.h. */
#include "solid/kernel.h"

/* Room for the displacements of a block's nodes. */
#define MAX_LOCAL (BODY_MAX_BLOCK_NODES * 4)

/* Averaged dU/dJ at a point of a body with nodal volumes. */
static double averaged_pressure(const struct body *body, int64_t q)
{
    int corners = body->dim + 1;
    double sum = 0.0;
    for (int64_t k = q * corners; k < (q + 1) * corners; k++) {
        sum += body->hats.value[k] * body->hats.pressure[body->hats.of_point[k]];
    }
    return sum;
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
        pressure += (1.0 - body->pointwise_share) * averaged_pressure(body, q);
    }
    for (int k = 0; k < 9; k++) {
        P[k] += pressure * C[k];
    }
}

/* Weighted stresses of a block of any material. */
static void general_block(const struct body *body, const struct block *block, block_stress P)
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

/* Stresses and forces of a block. */
static void stress_block(struct body *body, const struct block *block, double *local)
{
    block_stress P;
    if (block->neo_hookean) {
        body->kernels->neo_hookean(body, block, P);
    } else {
        general_block(body, block, P);
    }
    body->kernels->scatter(body, block, (const double(*)[MAX_BLOCK_POINTS])P, local);
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

/* The force on a node: its blocks' contributions in block order. */
static void sum_node(const struct body *body, int64_t node, double *force)
{
    int dim = body->dim;
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

/* The loops over blocks, hats and nodes. With force == NULL only F, J and the averages. */
static void evaluate(struct body *body, const double *u, double *force)
{
#pragma omp parallel
    {
        double local[MAX_LOCAL] __attribute__((aligned(64)));
#pragma omp for schedule(static)
        for (int64_t b = 0; b < body->block_count; b++) {
            body->kernels->gather(body, &body->blocks[b], u, local);
            if (force != NULL && !body->averaged) {
                stress_block(body, &body->blocks[b], local);
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
                    stress_block(body, &body->blocks[b], local);
                }
            }
        }
        if (force != NULL) {
#pragma omp for schedule(static)
            for (int64_t n = 0; n < body->node_count; n++) {
                sum_node(body, n, force);
            }
        }
    }
}

struct deformation body_force(struct body *body, const double *u, double *force)
{
    struct deformation deformation = {.least_jacobian = INFINITY};
    int64_t worst = 0;
    evaluate(body, u, force);
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
    evaluate(body, u, NULL);
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
