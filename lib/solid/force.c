/* The force loop: deformation gradients from parameters (gather: apply the operator), stresses, and forces on
 * the parameters (scatter: apply its transpose); equation (12) of lib/README.md. */
#include "base/memory.h"
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
    body->kernels->cell_forces(body, b, (const double(*)[OPERATOR_MAX_ROWS])P,
                               (const double(*)[OPERATOR_MAX_ROWS])T);
}

/* Stresses of a block of points, and their forces on its nodes. */
static void stress_point_block(struct body *body, int64_t b, struct block_view state, double *scratch)
{
    block_rows P;
    if (body->blocks[b].neo_hookean) {
        body->kernels->neo_hookean(body, b, state, P);
    } else {
        stress_points(body, &body->blocks[b], state, P);
    }
    for (int64_t i = body->blocks[b].point_count; i % OPERATOR_SLICE != 0; i++) {
        for (int k = 0; k < body->dim * body->dim; k++) {
            P[k][i] = 0.0;
        }
    }
    body->kernels->apply_transposed(body, b, (const double(*)[OPERATOR_MAX_ROWS])P, scratch);
}

/* F and J of a block of points are kept where volumes are averaged. */
static void keep_state(struct body *body, const struct block *block, const struct block_state *state)
{
    size_t size = (size_t)block->point_count * sizeof *body->F;
    for (int k = 0; k < body->dim * body->dim; k++) {
        memcpy(body->F + k * body->point_count + block->first_point, state->F[k], size);
    }
    memcpy(body->J + block->first_point, state->J, size);
}

/* F and J of a block at the last evaluation: kept, or gathered anew into `state`. */
static struct block_view state_of(struct body *body, int64_t b, struct block_state *state, double *scratch)
{
    int64_t first = body->blocks[b].first_point;
    if (body->F != NULL) {
        return (struct block_view){body->F + first, body->J + first, body->point_count};
    }
    body->kernels->apply(body, b, state, scratch);
    return (struct block_view){state->F[0], state->J, OPERATOR_MAX_ROWS};
}

/* The calling thread's part of the work arrays. */
static double *scratch_of_thread(const struct body *body)
{
    return body->scratch + omp_get_thread_num() * body->scratch_size;
}

enum status body_make_scratch(struct body *body, int threads, struct error *error)
{
    int64_t own = sparse_operator_scratch(&body->gradients),
            faces = sparse_operator_scratch(&body->cells.faces.op),
            nodes = sparse_operator_scratch(&body->cells.nodes.op);
    free(body->scratch);
    own = own > faces ? own : faces;
    own = own > nodes ? own : nodes;
    body->scratch_size = (own + 7) / 8 * 8; /* whole cache lines */
    return NEW_ARRAY(&body->scratch, threads * body->scratch_size, error);
}

void body_visit(struct body *body, int64_t first, int64_t last, body_visitor *visit, void *context)
{
    double *scratch = scratch_of_thread(body), F[9];
    struct block_state state;
    for (int64_t b = first; b < last; b++) {
        struct block_view view = state_of(body, b, &state, scratch);
        for (int64_t i = 0; i < body->blocks[b].point_count; i++) {
            stress_matrix(body->dim, view.F + i, view.apart, F);
            visit(body, body->blocks[b].first_point + i, F, view.J[i], context);
        }
    }
}

/* What threads share: loops over blocks, accumulation blocks and nodes. */
static void apply_points(struct body *body, double *scratch)
{
#pragma omp for schedule(static)
    for (int64_t b = 0; b < body->block_count; b++) {
        struct block_state state;
        body->kernels->apply(body, b, &state, scratch);
        keep_state(body, &body->blocks[b], &state);
    }
}

/* Stresses and forces of points: with pointwise volume F and J are gathered here, when the block's part of
 * the table comes into the cache. */
static void force_points(struct body *body, double *scratch)
{
    struct sparse_operator *op = &body->gradients;
#pragma omp for schedule(static)
    for (int64_t p = 0; p < op->accumulation_count; p++) {
        const struct accumulation_block *accumulation = &op->accumulation[p];
        sparse_operator_clear_forces(op, accumulation);
        for (int64_t b = accumulation->first_block; b < accumulation->first_block + accumulation->block_count;
             b++) {
            struct block_state state;
            struct block_view view = state_of(body, b, &state, scratch);
            stress_point_block(body, b, view, scratch);
        }
    }
}

static void apply_averages(const struct body *body, struct field_averages *averages, double *scratch)
{
#pragma omp for schedule(static)
    for (int64_t b = 0; b < averages->op.block_count; b++) {
        body->kernels->apply_averages(averages, b, body->u, scratch);
    }
}

static void apply_averages_transposed(const struct body *body, struct field_averages *averages,
                                      double *scratch)
{
#pragma omp for schedule(static)
    for (int64_t p = 0; p < averages->op.accumulation_count; p++) {
        const struct accumulation_block *accumulation = &averages->op.accumulation[p];
        sparse_operator_clear_forces(&averages->op, accumulation);
        for (int64_t b = accumulation->first_block; b < accumulation->first_block + accumulation->block_count;
             b++) {
            body->kernels->apply_averages_transposed(averages, b, scratch);
        }
    }
}

static void apply_cells(struct body *body)
{
#pragma omp for schedule(static)
    for (int64_t b = 0; b < body->block_count; b++) {
        body->kernels->cell_gradients(body, b);
    }
}

static void force_cells(struct body *body)
{
#pragma omp for schedule(static)
    for (int64_t b = 0; b < body->block_count; b++) {
        stress_cell_block(body, b);
    }
}

/* Nodes of one unit of work. */
enum { NODES_AT_ONCE = 256 };

static int64_t stretch_end(const struct body *body, int64_t first)
{
    return first + NODES_AT_ONCE < body->node_count ? first + NODES_AT_ONCE : body->node_count;
}

static void place_nodes(struct body *body, const double *u)
{
#pragma omp for schedule(static)
    for (int64_t first = 0; first < body->node_count; first += NODES_AT_ONCE) {
        body->kernels->place(body, first, stretch_end(body, first), u);
    }
}

static void sum_nodes(const struct body *body, double *force)
{
#pragma omp for schedule(static)
    for (int64_t first = 0; first < body->node_count; first += NODES_AT_ONCE) {
        body->kernels->sum(body, first, stretch_end(body, first), force);
    }
}

/* The displacements, and where they are kept F, J and pressures. */
static void set_state(struct body *body, const double *u, double *scratch)
{
    place_nodes(body, u);
    if (body->smoothed) {
        apply_averages(body, &body->cells.faces, scratch);
        apply_averages(body, &body->cells.nodes, scratch);
        apply_cells(body);
    } else if (body->averaged) {
        apply_points(body, scratch);
    }
    if (body->averaged) {
        nodal_volumes_evaluate(body);
    }
}

/* Internal forces at u. */
static void evaluate(struct body *body, const double *u, double *force)
{
#pragma omp parallel num_threads(body->threads)
    {
        double *scratch = scratch_of_thread(body);
        set_state(body, u, scratch);
        if (body->smoothed) {
            force_cells(body);
            apply_averages_transposed(body, &body->cells.faces, scratch);
            apply_averages_transposed(body, &body->cells.nodes, scratch);
        } else {
            force_points(body, scratch);
        }
        sum_nodes(body, force);
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
    {
        double *scratch = scratch_of_thread(body);
        set_state(body, u, scratch);
    }
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t b = 0; b < body->block_count; b++) {
        body->blocks[b].energy = 0.0;
        body_visit(body, b, b + 1, add_energy, &body->blocks[b].energy);
    }
    for (int64_t b = 0; b < body->block_count; b++) {
        energy += body->blocks[b].energy;
    }
    return energy;
}
