/* The force loop: deformation gradients from parameters (apply the operator), stresses, and forces on
 * the parameters (apply its transpose); equation (12) of lib/README.md. */
#include "solid/body/kernel.h"
#include "solid/body/nodal_offset.h"
#include "solid/body/nodal_volume.h"
#include "solid/body/stress.h"

#include <math.h>

/* A material in ln J is undefined for J <= 0. If it uses the volume ratio of the cell itself, a cell with J
 * <= 0 counts as inverted. */
static void note_volumes(const struct body *body, struct block *block)
{
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        bool is_log = material_is_logarithmic(&body->materials[body->material[q]]);
        if (is_log && !body->averaged && body->J[q] <= 0.0 && block->least_jacobian > 0.0) {
            block->least_jacobian = body->J[q];
            block->worst_point = q;
        }
    }
}

/* Stresses of a block of cells, and their forces on the values at edges and vertices. */
static void stress_cell_block(struct body *body, int64_t b)
{
    block_rows P, T;
    if (body->blocks[b].neo_hookean) {
        force_cell_neo_hookean(body, b, P, T);
    } else {
        stress_cells(body, &body->blocks[b], P, T);
        note_volumes(body, &body->blocks[b]);
    }
    force_cell_forces(body, b, P, T);
}

/* Stresses of a block of points. */
static void stress_point_block(struct body *body, int64_t b)
{
    block_rows P;
    if (body->blocks[b].neo_hookean) {
        force_point_neo_hookean(body, b, P);
    } else {
        stress_points(body, &body->blocks[b], P);
    }
    force_point_forces(body, b, (const double(*)[BLOCK_MOST_POINTS])P);
}

/* y = B x for own rows, by all threads of a parallel region. */
static void apply(const struct body *body, const double *x, double *y)
{
    const struct row_ranges *rows = &body->share.values;
#pragma omp for schedule(static)
    for (int64_t i = 0; i < rows->count; i++) {
        force_apply(body->dim, &body->rows.matrix, rows->items[i].begin, rows->items[i].end, x, y);
    }
}

static void apply_transposed(const struct body *body, const double *x, double *y)
{
#pragma omp for schedule(static, 1)
    for (int s = 0; s < body->rows.stripe_count; s++) {
        force_apply_transposed(body->dim, &body->rows, s, x, y);
    }
}

static void sum_parts(struct body *body)
{
    const struct row_ranges *rows = &body->share.sums;
#pragma omp for schedule(static)
    for (int64_t i = 0; i < rows->count; i++) {
        force_sum_parts(body->dim, &body->cells.averages, rows->items[i].begin, rows->items[i].end);
    }
}

/* Process the own blocks. */
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
    const struct row_ranges *placed = &body->share.placed;
#pragma omp for schedule(static)
    for (int64_t i = 0; i < placed->count; i++) {
        for (int64_t n = placed->items[i].begin; n < placed->items[i].end; n++) {
            for (int a = 0; a < dim; a++) {
                body->u[n * stride + a] = u[body->order.nodes[n] * dim + a];
            }
        }
    }
}

static void return_forces(const struct body *body, double *force)
{
    int dim = body->dim, stride = VECTOR_STRIDE(dim);
#pragma omp for schedule(static)
    for (int64_t n = body->share.begin_node; n < body->share.end_node; n++) {
        for (int a = 0; a < dim; a++) {
            force[body->order.nodes[n] * dim + a] = body->force[n * stride + a];
        }
    }
}

/* Set F, J and the volumetric strains of a block. */
static void set_block(struct body *body, int64_t b)
{
    if (body->smoothed) {
        force_cell_gradients(body, b);
    } else {
        force_point_gradients(body, b);
    }
    if (body->averaged) {
        nodal_volumes_change(body, b);
    }
}

/* Set the displacements, F, J and pressures. */
static void set_state(struct body *body, const double *u)
{
    place_nodes(body, u);
    apply(body, body->u, body->smoothed ? body->cells.averages.value : body->derivative);
    prescribed_values_place(body);
    for_blocks(body, set_block);
    if (body->averaged) {
        body_share_exchange(&body->share, &body->share.strains, 1, body->volumes.change);
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
            body_share_exchange(share, &share->parts, body->dim, averages->part_force);
            sum_parts(body);
            nodal_offsets_push_rows(body);
            prescribed_values_take_forces(body);
            body_share_exchange(share, &share->rows, stride, averages->force);
            apply_transposed(body, averages->force, body->force);
            nodal_offsets_push_nodes(body);
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
    prony_prepare(body, false);
    evaluate(body, u, force);
    for (int64_t b = 0; b < body->block_count && !isnan(deformation.least_jacobian); b++) {
        if (!(body->blocks[b].least_jacobian >= deformation.least_jacobian)) { /* NaN counts as the least */
            deformation.least_jacobian = body->blocks[b].least_jacobian;
            worst = body->blocks[b].worst_point;
        }
    }
    deformation.point = body->order.points[worst];
    return deformation;
}

struct deformation body_force(struct body *body, const double *u, double *force)
{
    struct deformation deformation = body_own_force(body, u, force);
    body_gather(body, body->dim, force);
    return deformation;
}

bool body_inverts(struct body *body, const double *u, double *force)
{
    int64_t count = body->cells.prescribed.count;
    body->cells.prescribed.count = 0;
    bool inverts = !(body_force(body, u, force).least_jacobian > 0.0);
    body->cells.prescribed.count = count;
    return inverts;
}

void body_gather(struct body *body, int width, double *vector)
{
    const struct body_share *share = &body->share;
    const int64_t *node = body->order.nodes;
    double *by_place = body->force; /* scratch here */
    if (share->ranks == NULL) {
        return;
    }
    for (int64_t p = share->begin_node; p < share->end_node; p++) {
        for (int a = 0; a < width; a++) {
            by_place[p * width + a] = vector[node[p] * width + a];
        }
    }
    ranks_gather(share->ranks, by_place, (size_t)width * sizeof *vector, share->node_first);
    for (int64_t p = 0; p < body->node_count; p++) {
        for (int a = 0; a < width; a++) {
            vector[node[p] * width + a] = by_place[p * width + a];
        }
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

/* The elastic energy of a point; *dissipated: see prony_energy. */
static double point_energy(const struct body *body, const struct block *block, int64_t q, double *dissipated)
{
    const struct material *material = &body->materials[body->material[q]];
    double F[9], J = body->J[q];
    stress_gradient(body, q, F);
    double W = material_isochoric_energy(material, F), active = stress_active_energy(body, q, F);
    double coupling = stress_coupling_energy(body, q, F, J);
    double volumetric = 0.0, varying = body->smoothed ? stress_variance_energy(body, q, &volumetric) : 0.0;
    if (block->relaxes) {
        double whole = body->weight[q] * (W + coupling) + varying;
        varying = prony_energy(body, q, whole, varying, dissipated);
        W = coupling = 0.0;
    }
    double sum = W + active;
    sum += coupling;
    sum += body->averaged ? nodal_volume_energy(body, q) : material_volume_energy(material, J);
    return body->weight[q] * sum + varying + volumetric;
}

/* The sum of the energies of all blocks, of which each process has its own. */
static double sum_blocks(struct body *body)
{
    double energy = 0.0;
    ranks_gather(body->share.ranks, body->blocks, sizeof *body->blocks, body->share.block_first);
    body->prony.dissipated = 0.0;
    for (int64_t b = 0; b < body->block_count; b++) {
        body->prony.dissipated += body->blocks[b].dissipated;
        energy += body->blocks[b].energy;
    }
    return energy;
}

double body_energy(struct body *body, const double *u)
{
#pragma omp parallel num_threads(body->threads)
    set_state(body, u);
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t b = body->share.begin_block; b < body->share.end_block; b++) {
        struct block *block = &body->blocks[b];
        block->energy = block->dissipated = 0.0;
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            block->energy += point_energy(body, block, q, &block->dissipated);
        }
    }
    return sum_blocks(body) + (body->smoothed ? nodal_offsets_energy(body) : 0.0);
}

double body_active_energy(struct body *body, int32_t curve)
{
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t b = body->share.begin_block; b < body->share.end_block; b++) {
        struct block *block = &body->blocks[b];
        block->energy = 0.0;
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            double F[9];
            if (body->materials[body->material[q]].active_curve == curve) {
                stress_gradient(body, q, F);
                block->energy += body->weight[q] * stress_whole_active_energy(body, q, F);
            }
        }
    }
    return sum_blocks(body);
}
