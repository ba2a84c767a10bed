/* The force loop: deformation gradients by gathering, stresses, forces by scattering; see body.h. */
#include "solid/compatibility.h"
#include "solid/kernel.h"

/* Room for the displacements of a block's nodes. */
#define MAX_LOCAL (BODY_MAX_BLOCK_NODES * 4)

/* Volumetric pressure at a point: that of the hats around it, or its own. */
double body_pressure(const struct body *body, int64_t point)
{
    int corners = body->dim + 1;
    double sum = 0.0;
    if (!body->averaged) {
        return material_pressure(&body->materials[body->material[point]], body->J[point]);
    }
    for (int64_t k = point * corners; k < (point + 1) * corners; k++) {
        int32_t hat = body->hats.of_point[k];
        sum += body->hats.value[k] * (body->hats.pressure[hat] + body->hats.slope[hat] * body->J[point]);
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
    double pressure = body_pressure(body, q);
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

static bool is_tied(const struct body *body)
{
    return body->compatibility != NULL && body->compatibility->active;
}

/* The ties of F to the compatible gradient pull at it, too. */
static void subtract_ties(const struct body *body, const struct block *block, block_stress P)
{
    int size = body->dim * body->dim;
    for (int64_t i = 0; i < block->point_count; i++) {
        const double *tie = body->compatibility->stress + (block->first_point + i) * size;
        for (int k = 0; k < size; k++) {
            P[k][i] -= tie[k];
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
    if (is_tied(body)) {
        subtract_ties(body, block, P);
    }
    body->kernels->scatter(body, block, (const double(*)[MAX_BLOCK_POINTS])P, local);
}

/* Mean and variance of J over a hat. */
static void average_volume(struct body *body, int64_t a, double *mean, double *variance)
{
    const struct volume_hats *hats = &body->hats;
    double sum = 0.0, squares = 0.0;
    for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
        sum += hats->share[i] * body->J[hats->point[i]];
    }
    for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
        double difference = body->J[hats->point[i]] - sum;
        squares += hats->share[i] * difference * difference;
    }
    *mean = sum;
    *variance = squares;
}

/* Share s of the pointwise law in a hat. */
static double share_of(const struct body *body, const struct material *material)
{
    return fmax(body->pointwise_share, material->least_share);
}

/* Pressure of a hat, from the derivative of its energy: U'(theta) + kappa (s + 2 c v) (J - theta). */
static void set_pressure(struct body *body, int64_t a)
{
    struct volume_hats *hats = &body->hats;
    const struct material *material = &body->materials[hats->material[a]];
    double mean, variance;
    average_volume(body, a, &mean, &variance);
    hats->theta[a] = mean;
    hats->slope[a] =
        material_bulk(material) * (share_of(body, material) + 2.0 * body->share_growth * variance);
    hats->pressure[a] = material_pressure(material, mean) - hats->slope[a] * mean;
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
    bool tied = is_tied(body), at_once = force != NULL && !body->averaged && !tied;
#pragma omp parallel num_threads(body->threads)
    {
        double local[MAX_LOCAL] __attribute__((aligned(64)));
#pragma omp for schedule(static)
        for (int64_t b = 0; b < body->block_count; b++) {
            body->kernels->gather(body, &body->blocks[b], u, local);
            if (at_once) {
                stress_block(body, &body->blocks[b], local);
            }
        }
        if (body->averaged) {
#pragma omp for schedule(static)
            for (int64_t a = 0; a < body->hats.count; a++) {
                set_pressure(body, a);
            }
        }
        if (tied) {
#pragma omp for schedule(static)
            for (int64_t n = 0; n < body->node_count; n++) {
                compatibility_value(body, n, u);
            }
#pragma omp for schedule(static)
            for (int64_t q = 0; q < body->point_count; q++) {
                compatibility_stress(body, q);
            }
#pragma omp for schedule(static)
            for (int64_t n = 0; n < body->node_count; n++) {
                compatibility_pull(body, n);
            }
        }
        if (force != NULL && !at_once) {
#pragma omp for schedule(static)
            for (int64_t b = 0; b < body->block_count; b++) {
                stress_block(body, &body->blocks[b], local);
            }
        }
        if (force != NULL) {
#pragma omp for schedule(static)
            for (int64_t n = 0; n < body->node_count; n++) {
                sum_node(body, n, force);
                if (tied) {
                    compatibility_add_force(body, n, force + n * body->dim);
                }
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
        energy += body->weight[q] * material_shape_energy(material, F);
        if (!body->averaged) {
            energy += body->weight[q] * material_volume_energy(material, body->J[q]);
        }
    }
    for (int64_t a = 0; body->averaged && a < body->hats.count; a++) {
        const struct material *material = &body->materials[body->hats.material[a]];
        double mean, variance;
        average_volume(body, a, &mean, &variance);
        energy += body->hats.volume[a] * (material_volume_energy(material, mean) +
                                          0.5 * material_bulk(material) * variance *
                                              (share_of(body, material) + body->share_growth * variance));
    }
    return energy + compatibility_energy(body);
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

void body_diagonal(const struct body *body, double *stiffness)
{
    int dim = body->dim;
    memset(stiffness, 0, (size_t)body->node_count * sizeof *stiffness);
    for (int64_t b = 0; b < body->block_count; b++) {
        const struct block *block = &body->blocks[b];
        const int32_t *node = body->block_node + block->first_node;
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            double F[9], C[9], J = body->J[q], I1 = 0.0;
            full_gradient(body, q, F);
            cofactor(F, C);
            for (int k = 0; k < 9; k++) {
                I1 += F[k] * F[k];
            }
            double shear = body->weight[q] * body->shear[q] / cbrt(J * J);
            double tie = is_tied(body) ? 2.0 * body->weight[q] * body->compatibility->coefficient[q] : 0.0;
            double along = body->weight[q] * body->bulk[q] + 5.0 / 9.0 * I1 * shear / (J * J);
            for (int64_t i = body->ptr[q]; i < body->ptr[q + 1]; i++) {
                const double *g = body->dphi + i * dim;
                double g2 = 0.0, y2 = 0.0; /* |grad phi|^2, |J F^-T grad phi|^2 */
                for (int a = 0; a < dim; a++) {
                    double y = 0.0;
                    for (int k = 0; k < dim; k++) {
                        y += C[3 * a + k] * g[k];
                    }
                    g2 += g[a] * g[a];
                    y2 += y * y;
                }
                stiffness[node[body->local[i]]] += fmax(0.0, along * y2 - shear * g2 / 3.0) + tie * g2;
            }
        }
    }
}
