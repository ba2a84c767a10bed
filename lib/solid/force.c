/* The force loop: deformation gradients by gathering, stresses, forces by scattering; see body.h. */
#include "solid/stress.h"

#include <math.h>
#include <string.h>

/* A law of ln J knows no volume ratio below zero: where it is the cell's own, such a cell counts as inverted.
 */
static void note_volumes(const struct body *body, struct block *block)
{
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        bool is_log = body->materials[body->material[q]].model == MATERIAL_NEO_HOOKEAN_LOG;
        if (is_log && !body->averaged && body->J[q] <= 0.0 && block->least_jacobian > 0.0) {
            block->least_jacobian = body->J[q];
            block->worst_point = q;
        }
    }
}

/* Stresses of a block of cells, and what they put on the means. */
static void stress_cell_block(struct body *body, int64_t b)
{
    block_stress P, T;
    if (body->blocks[b].neo_hookean) {
        body->kernels->cell_neo_hookean(body, b, P, T);
    } else {
        stress_cells(body, &body->blocks[b], P, T);
        note_volumes(body, &body->blocks[b]);
    }
    body->kernels->cell_forces(body, b, (const double(*)[PAIRS_MAX_ROWS])P,
                               (const double(*)[PAIRS_MAX_ROWS])T);
}

/* Stresses of a block of points, and their forces on its nodes. */
static void stress_point_block(struct body *body, int64_t b, double *scratch)
{
    block_stress P;
    if (body->blocks[b].neo_hookean) {
        body->kernels->neo_hookean(body, b, P);
    } else {
        stress_points(body, &body->blocks[b], P);
    }
    for (int64_t i = body->blocks[b].point_count; i % PAIRS_GROUP != 0; i++) {
        for (int k = 0; k < body->dim * body->dim; k++) {
            P[k][i] = 0.0;
        }
    }
    body->kernels->scatter(body, b, (const double(*)[PAIRS_MAX_ROWS])P, scratch);
}

static void stress_block(struct body *body, int64_t b, double *scratch)
{
    if (body->conforming) {
        stress_cell_block(body, b);
    } else {
        stress_point_block(body, b, scratch);
    }
}

/* Mean and variance of J over a hat: taken of J - 1, which is small. */
static void average_volume(const struct body *body, int64_t a, double *mean, double *variance)
{
    const struct volume_hats *hats = &body->hats;
    double sum = 0.0, squares = 0.0;
    for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
        double difference = body->J[hats->point[i]] - 1.0, part = hats->share[i] * difference;
        sum += part;
        squares += part * difference;
    }
    *mean = 1.0 + sum;
    *variance = squares > sum * sum ? squares - sum * sum : 0.0;
}

/* Share s of the pointwise law in a hat. */
static double share_of(const struct body *body, const struct material *material)
{
    return body->pointwise_share > material->least_share ? body->pointwise_share : material->least_share;
}

/* Pressure of a hat, from the derivative of its energy: U'(theta) + kappa (s + 2 c v) (J - theta). */
static void set_pressure(struct body *body, int64_t a)
{
    struct volume_hats *hats = &body->hats;
    const struct material *material = &body->materials[hats->material[a]];
    double mean, variance;
    average_volume(body, a, &mean, &variance);
    hats->theta[a] = mean;
    double bulk = material_bulk(material);
    hats->slope[a] = bulk * (share_of(body, material) + 2.0 * body->share_growth * variance);
    hats->pressure[a] = material_pressure(material, mean) - hats->slope[a] * mean;
}

/* Nodes are worked on in stretches of so many. */
enum { NODES_AT_ONCE = 256 };

static int64_t stretch_end(const struct body *body, int64_t first)
{
    return first + NODES_AT_ONCE < body->node_count ? first + NODES_AT_ONCE : body->node_count;
}

/* The means that conforming cells look at, and what they put on them: loops that threads share. */
static void gather_means(const struct body *body, struct means *means, double *scratch)
{
#pragma omp for schedule(static)
    for (int64_t b = 0; b < means->pairs.block_count; b++) {
        body->kernels->gather_means(means, b, body->u, scratch);
    }
}

static void scatter_means(const struct body *body, struct means *means, double *scratch)
{
#pragma omp for schedule(static)
    for (int64_t b = 0; b < means->pairs.block_count; b++) {
        body->kernels->scatter_means(means, b, scratch);
    }
}

/* The loops over blocks, hats and nodes. With force == NULL only the energies are of use. */
static void evaluate(struct body *body, const double *u, double *force)
{
#pragma omp parallel num_threads(body->threads)
    {
        double scratch[PAIRS_SCRATCH] __attribute__((aligned(64)));
#pragma omp for schedule(static)
        for (int64_t first = 0; first < body->node_count; first += NODES_AT_ONCE) {
            body->kernels->place(body, first, stretch_end(body, first), u);
        }
        if (body->conforming) {
            gather_means(body, &body->cells.faces, scratch);
            gather_means(body, &body->cells.nodes, scratch);
        }
#pragma omp for schedule(static)
        for (int64_t b = 0; b < body->block_count; b++) {
            if (body->conforming) {
                body->kernels->cell_gradients(body, b);
            } else {
                body->kernels->gather(body, b, scratch);
            }
            if (!body->averaged) {
                stress_block(body, b, scratch); /* while its part of the table is in cache */
            }
        }
        if (body->averaged) {
#pragma omp for schedule(static)
            for (int64_t a = 0; a < body->hats.count; a++) {
                set_pressure(body, a);
            }
#pragma omp for schedule(static)
            for (int64_t b = 0; b < body->block_count; b++) {
                stress_block(body, b, scratch);
            }
        }
        if (body->conforming) {
            scatter_means(body, &body->cells.faces, scratch);
            scatter_means(body, &body->cells.nodes, scratch);
        }
        if (force != NULL) {
#pragma omp for schedule(static)
            for (int64_t first = 0; first < body->node_count; first += NODES_AT_ONCE) {
                body->kernels->sum(body, first, stretch_end(body, first), force);
            }
        }
    }
}

struct deformation body_force(struct body *body, const double *u, double *force)
{
    struct deformation deformation = {.least_jacobian = INFINITY};
    int64_t worst = 0;
    evaluate(body, u, force);
    for (int64_t b = 0; b < body->block_count && !isnan(deformation.least_jacobian); b++) {
        if (!(body->blocks[b].least_jacobian >=
              deformation.least_jacobian)) { /* so that NaN counts as the worst */
            deformation.least_jacobian = body->blocks[b].least_jacobian;
            worst = body->blocks[b].worst_point;
        }
    }
    deformation.point = body->order[worst];
    return deformation;
}

double body_volume(const struct body *body)
{
    double volume = 0.0;
    for (int64_t q = 0; q < body->point_count; q++) {
        volume += body->weight[q];
    }
    return volume;
}

double body_energy(struct body *body, const double *u)
{
    double energy = 0.0, F[9];
    evaluate(body, u, NULL);
    for (int64_t q = 0; q < body->point_count; q++) {
        const struct material *material = &body->materials[body->material[q]];
        stress_matrix(body, body->F, q, F);
        energy += body->weight[q] * material_shape_energy(material, F);
        if (body->conforming) {
            struct tie tie = stress_tie(body, q, F);
            energy += 0.5 * body->weight[q] * tie.stiffness * tie.squares;
        }
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
    return energy;
}

/* What a point adds to the bounds: for each neighbour g A g, if positive, and tie |g|^2, g its gradient. */
static inline __attribute__((always_inline)) void add_bounds(const struct body *body, int64_t row, int dim,
                                                             const double A[9], double tie, double *stiffness)
{
    for (int64_t i = body->ptr[row]; i < body->ptr[row + 1]; i++) {
        const double *g = body->dphi + i * dim;
        double bound = 0.0, g2 = 0.0;
        for (int a = 0; a < dim; a++) {
            double half = 0.5 * A[3 * a + a] * g[a];
            for (int b = 0; b < a; b++) {
                half += A[3 * a + b] * g[b];
            }
            bound += 2.0 * half * g[a];
            g2 += g[a] * g[a];
        }
        stiffness[body->idx[i]] += (bound > 0.0 ? bound : 0.0) + tie * g2;
    }
}

void body_diagonal(const struct body *body, double *stiffness)
{
    int dim = body->dim;
    memset(stiffness, 0, (size_t)body->node_count * sizeof *stiffness);
    for (int64_t q = 0; q < body->point_count; q++) {
        double F[9], C[9], A[9], I1 = 0.0;
        stress_matrix(body, body->F, q, F);
        double J = determinant(F);
        if (!(J > 0.0 && isfinite(J))) { /* as at rest: its bounds stay positive until the run is told */
            J = 1.0;
            for (int k = 0; k < 9; k++) {
                F[k] = k % 4 == 0 ? 1.0 : 0.0;
            }
        }
        cofactor(F, C);
        for (int k = 0; k < 9; k++) {
            I1 += F[k] * F[k];
        }
        double shear = body->weight[q] * body->shear[q] / cbrt(J * J);
        double tie = body->conforming ? 2.0 * body->weight[q] * stress_tie(body, q, F).stiffness : 0.0;
        double along = body->weight[q] * body->bulk[q] + 5.0 / 9.0 * I1 * shear / (J * J);
        /* along |J F^-T g|^2 - shear |g|^2 / 3 = g A g */
        for (int k = 0; k < 9; k++) {
            int a = k / 3, b = k % 3;
            A[k] = along * (C[a] * C[b] + C[3 + a] * C[3 + b] + C[6 + a] * C[6 + b]) -
                   (a == b ? shear / 3.0 : 0.0);
        }
        if (dim == 2) {
            add_bounds(body, body->order[q], 2, A, tie, stiffness);
        } else {
            add_bounds(body, body->order[q], 3, A, tie, stiffness);
        }
    }
}
