/* The force loop: deformation gradients from parameters (apply the operator), stresses, and forces on
 * the parameters (apply its transpose); equation (12) of lib/README.md. */
#include "base/memory.h"
#include "solid/merged_cells.h"
#include "solid/nodal_volume.h"
#include "solid/stress.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
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

/* Stresses of a block of cells, and their forces on the face averages and node values. */
static void stress_cell_block(struct body *body, int64_t b)
{
    block_rows P, T;
    if (body->blocks[b].neo_hookean) {
        body->kernels->cell_neo_hookean(body, b, P, T);
    } else {
        stress_cells(body, &body->blocks[b], P, T);
        note_volumes(body, &body->blocks[b]);
    }
    if (body->cells.group != NULL) {
        merged_cells_stresses(body, &body->blocks[b], P, T);
    }
    body->kernels->cell_forces(body, b, (const double(*)[BLOCK_MOST_POINTS])P,
                               (const double(*)[BLOCK_MOST_POINTS])T);
}

/* Stresses of a block of points. */
static void stress_point_block(struct body *body, int64_t b)
{
    block_rows P;
    if (body->blocks[b].neo_hookean) {
        body->kernels->neo_hookean(body, b, P);
    } else {
        stress_points(body, &body->blocks[b], P);
    }
    body->kernels->point_forces(body, b, (const double(*)[BLOCK_MOST_POINTS])P);
}

void body_visit(const struct body *body, int64_t first, int64_t last, body_visitor *visit, void *context)
{
    for (int64_t b = first; b < last; b++) {
        const struct block *block = &body->blocks[b];
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            double F[9];
            stress_matrix(body->dim, body->F + q, body->point_count, F);
            visit(body, q, F, body->J[q], context);
        }
    }
}

/* What threads share: loops over rows, blocks and nodes. */
static void apply(const struct body *body, const double *x, double *y)
{
    const struct stretches *rows = &body->share.values;
#pragma omp for schedule(static)
    for (int64_t i = 0; i < rows->count; i++) {
        body->kernels->apply(&body->rows.matrix, rows->items[i].begin, rows->items[i].end, x, y);
    }
}

static void apply_transposed(const struct body *body, const double *x, double *y)
{
#pragma omp for schedule(static, 1)
    for (int s = 0; s < body->rows.stripe_count; s++) {
        body->kernels->apply_transposed(&body->rows, s, x, y);
    }
}

static void sum_corners(struct body *body)
{
    const struct stretches *rows = &body->share.sums;
#pragma omp for schedule(static)
    for (int64_t i = 0; i < rows->count; i++) {
        body->kernels->sum_corners(&body->cells.averages, rows->items[i].begin, rows->items[i].end);
    }
}

static void for_blocks(struct body *body, void (*work)(struct body *body, int64_t block))
{
#pragma omp for schedule(static)
    for (int64_t b = body->share.begin_block; b < body->share.end_block; b++) {
        work(body, b);
    }
}

static void place_nodes(struct body *body, const double *u)
{
    int dim = body->dim, stride = VECTOR_STRIDE(dim);
#pragma omp for schedule(static)
    for (int64_t n = 0; n < body->node_count; n++) {
        for (int a = 0; a < dim; a++) {
            body->u[n * stride + a] = u[body->node_order[n] * dim + a];
        }
    }
}

static void return_forces(const struct body *body, double *force)
{
    int dim = body->dim, stride = VECTOR_STRIDE(dim);
#pragma omp for schedule(static)
    for (int64_t n = body->share.begin_node; n < body->share.end_node; n++) {
        for (int a = 0; a < dim; a++) {
            force[body->node_order[n] * dim + a] = body->force[n * stride + a];
        }
    }
}

/* The displacements, F, J and pressures. */
static void set_state(struct body *body, const double *u)
{
    place_nodes(body, u);
    if (body->smoothed) {
        apply(body, body->u, body->cells.averages.value);
        for_blocks(body, body->kernels->cell_gradients);
    } else {
        apply(body, body->u, body->derivative);
        for_blocks(body, body->kernels->point_gradients);
    }
    if (body->averaged) {
        nodal_volumes_evaluate(body);
    }
}

/* Internal forces on own nodes at u. */
static void evaluate(struct body *body, const double *u, double *force)
{
    struct body_share *share = &body->share;
    struct field_averages *averages = &body->cells.averages;
    int stride = VECTOR_STRIDE(body->dim);
#pragma omp parallel num_threads(body->threads)
    {
        set_state(body, u);
        if (body->smoothed) {
            for_blocks(body, stress_cell_block);
            body_share_exchange(share, &share->corners, stride, averages->corner_force);
            sum_corners(body);
            body_share_exchange(share, &share->rows, stride, averages->force);
            apply_transposed(body, averages->force, body->force);
        } else {
            for_blocks(body, stress_point_block);
            body_share_exchange(share, &share->rows, stride, body->derivative);
            apply_transposed(body, body->derivative, body->force);
        }
        body_share_gather(share, body->blocks, sizeof *body->blocks, share->block_first);
        return_forces(body, force);
    }
}

struct deformation body_own_force(struct body *body, const double *u, double *force)
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

struct deformation body_force(struct body *body, const double *u, double *force)
{
    struct deformation deformation = body_own_force(body, u, force);
    body_gather(body, force);
    return deformation;
}

void body_gather(struct body *body, double *vector)
{
    const struct body_share *share = &body->share;
    const int64_t *node = body->node_order;
    double *by_place = body->force; /* scratch here */
    size_t size = (size_t)body->dim * sizeof *vector;
    if (share->ranks == NULL) {
        return;
    }
    for (int64_t p = share->begin_node; p < share->end_node; p++) {
        memcpy(by_place + p * body->dim, vector + node[p] * body->dim, size);
    }
    ranks_gather(share->ranks, by_place, size, share->node_first);
    for (int64_t p = 0; p < body->node_count; p++) {
        memcpy(vector + node[p] * body->dim, by_place + p * body->dim, size);
    }
}

double body_volume(const struct body *body)
{
    double volume = 0.0;
    for (int64_t q = 0; q < body->point_count; q++) {
        volume += body->weight[q];
    }
    return volume;
}

/* Energy of a point, added to *energy. */
static void add_energy(const struct body *body, int64_t q, const double F[9], double J, void *energy)
{
    const struct material *material = &body->materials[body->material[q]];
    double sum = material_shape_energy(material, F);
    if (body->smoothed) {
        sum += stress_smoothing_energy(body, q, F);
    }
    sum += body->averaged ? nodal_volume_energy(body, q) : material_volume_energy(material, J);
    *(double *)energy += body->weight[q] * sum;
}

double body_energy(struct body *body, const double *u)
{
    double energy = 0.0;
#pragma omp parallel num_threads(body->threads)
    set_state(body, u);
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t b = body->share.begin_block; b < body->share.end_block; b++) {
        body->blocks[b].energy = 0.0;
        body_visit(body, b, b + 1, add_energy, &body->blocks[b].energy);
    }
    ranks_gather(body->share.ranks, body->blocks, sizeof *body->blocks, body->share.block_first);
    for (int64_t b = 0; b < body->block_count; b++) {
        energy += body->blocks[b].energy;
    }
    return energy;
}
