#include "solid/body.h"

#include "approx/renumber.h"
#include "base/memory.h"
#include "solid/kernel.h"
#include "solid/nodal_volume.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Points of a block: its part of the operator should take a part of the second cache only. */
static int64_t points_of_block(int dim)
{
    return dim == 2 ? 64 : PAIRS_MAX_ROWS;
}

static enum material_model model_of(const struct body_input *input, int64_t point)
{
    return input->materials[input->material[point]].model;
}

/* Points by law, so that blocks are of one, and along a curve, so that they are compact; nodes along the
 * curve, too. */
static enum status order_all(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    int32_t *model = NULL;
    TRY(NEW_ARRAY(&model, input->point_count, error));
    TRY(NEW_ARRAY(&body->order, input->point_count, error));
    TRY(NEW_ARRAY(&body->node_order, input->node_count, error));
    TRY(NEW_ARRAY(&body->node_place, input->node_count, error));
    for (int64_t q = 0; q < input->point_count; q++) {
        model[q] = (int32_t)model_of(input, q);
    }
    TRY(renumber_morton(input->dim, input->point_count, input->x, model, body->order, error));
    for (int64_t n = 0; n < input->node_count; n++) {
        body->node_order[n] = n;
    }
    if (input->node_x != NULL) {
        TRY(renumber_morton(input->dim, input->node_count, input->node_x, NULL, body->node_order, error));
    }
    for (int64_t n = 0; n < input->node_count; n++) {
        body->node_place[body->node_order[n]] = (int32_t)n;
    }
done:
    free(model);
    return status;
}

/* Per-point data in the body's order. */
static enum status copy_points(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    int dim = input->dim;
    int64_t points = input->point_count;
    TRY(NEW_ARRAY(&body->weight, points + BODY_POINT_PADDING, error));
    TRY(NEW_ARRAY(&body->material, points + BODY_POINT_PADDING, error));
    TRY(NEW_ARRAY(&body->u, body->node_count * PAIRS_STRIDE(dim), error));
    if (body->conforming || body->averaged) {
        TRY(NEW_ARRAY(&body->F, points * dim * dim + BODY_POINT_PADDING, error));
        TRY(NEW_ARRAY(&body->J, points + BODY_POINT_PADDING, error));
    }
    TRY(NEW_ARRAY(&body->materials, input->material_count, error));
    memcpy(body->materials, input->materials, (size_t)input->material_count * sizeof *body->materials);
    TRY(NEW_ARRAY(&body->bulk_modulus, input->material_count, error));
    for (int64_t m = 0; m < input->material_count; m++) {
        body->bulk_modulus[m] = input->materials[m].bulk_modulus;
    }
    for (int64_t q = 0; q < points; q++) {
        int64_t from = body->order[q];
        if (input->ptr[from + 1] <= input->ptr[from] || !(input->weight[from] > 0.0)) {
            status = fail(error, STATUS_INPUT, "points.weight: row %lld: no weight or no neighbours",
                          (long long)from);
            goto done;
        }
        body->weight[q] = input->weight[from];
        body->material[q] = input->material[from];
    }
done:
    return status;
}

/* Cut the ordered points into blocks of one law. */
static enum status cut_blocks(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    int64_t most = points_of_block(body->dim);
    TRY(NEW_ARRAY(&body->blocks, body->point_count / most + MATERIAL_MODEL_COUNT + 1, error));
    for (int64_t q = 0; q < body->point_count;) {
        struct block *block = &body->blocks[body->block_count++];
        enum material_model model = model_of(input, body->order[q]);
        block->first_point = q;
        block->neo_hookean = model == MATERIAL_NEO_HOOKEAN;
        while (q < body->point_count && block->point_count < most &&
               model_of(input, body->order[q]) == model) {
            block->point_count++;
            q++;
        }
    }
done:
    return status;
}

/* The rows of the table of gradients are the points; within a block their order is free. */
static enum status order_rows(const struct body_input *input, struct body *body, int64_t **first_row,
                              struct pairs_rows *rows, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(first_row, body->block_count + 1, error));
    for (int64_t b = 0; b < body->block_count; b++) {
        (*first_row)[b] = body->blocks[b].first_point;
    }
    (*first_row)[body->block_count] = body->point_count;
    *rows = (struct pairs_rows){.node_count = input->node_count,
                                .row_count = input->point_count,
                                .ptr = input->ptr,
                                .idx = input->idx,
                                .row = body->order,
                                .block_count = body->block_count,
                                .first_row = *first_row,
                                .least_sharing = input->dim};
done:
    return status;
}

/* Both tables of conforming cells must give the same gradients: tried on a field without pattern. */
static enum status check_smoothing(struct body *body, struct error *error)
{
    enum status status;
    int dim = body->dim;
    int64_t size = body->node_count * dim;
    double *u = NULL, *F = NULL;
    uint64_t state = 1;
    TRY(NEW_ARRAY(&u, size, error));
    TRY(NEW_ARRAY(&F, body->point_count * 9, error));
    for (int64_t i = 0; i < size; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        u[i] = (double)(state >> 11) * 0x1p-53;
    }
    (void)body_energy(body, u);
    body_gradient(body, F);
    for (int64_t q = 0; q < body->point_count; q++) {
        for (int a = 0; a < dim; a++) {
            for (int b = 0; b < dim; b++) {
                double sum = a == b ? 1.0 : 0.0, size_of_terms = 1.0;
                for (int64_t i = body->ptr[q]; i < body->ptr[q + 1]; i++) {
                    double term = body->dphi[i * dim + b] * u[(int64_t)body->idx[i] * dim + a];
                    sum += term;
                    size_of_terms += fabs(term);
                }
                if (!(fabs(sum - F[9 * q + 3 * a + b]) <= 1e-5 * size_of_terms)) {
                    status = fail(error, STATUS_INPUT,
                                  "shape.dphi: row %lld: not smoothed from face.phi: run shapefn again",
                                  (long long)q);
                    goto done;
                }
            }
        }
    }
done:
    free(u);
    free(F);
    return status;
}

/* Waiting for each other costs threads some microseconds a step: each must have more to do than that. */
static int worthwhile_threads(const struct body *body)
{
    int64_t by_work = 1 + body->pair_count / 30000;
    int64_t available = omp_get_max_threads();
    return (int)(by_work < available ? by_work : available);
}

enum status body_build(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    struct pairs_input pairs = {.dim = input->dim,
                                .width = input->dim,
                                .value = input->dphi,
                                .passes = input->hat_node != NULL ? 2 : 1};
    int64_t *first_row = NULL;
    *body = (struct body){.dim = input->dim,
                          .node_count = input->node_count,
                          .point_count = input->point_count,
                          .material_count = input->material_count,
                          .ptr = input->ptr,
                          .idx = input->idx,
                          .dphi = input->dphi,
                          .conforming = input->conforming != NULL,
                          .kernels = force_kernels_select(NULL, input->dim),
                          .averaged = input->hat_node != NULL};
    if (body->point_count < 1 || body->point_count > INT32_MAX / (body->dim + 1)) {
        return fail(error, STATUS_INPUT, "points.x: %lld points: none, or too many",
                    (long long)body->point_count);
    }
    TRY(order_all(input, body, error));
    TRY(cut_blocks(input, body, error));
    if (!body->conforming) {
        TRY(order_rows(input, body, &first_row, &pairs.rows, error));
    }
    TRY(copy_points(input, body, error));
    body->pair_count = input->ptr[input->point_count];
    body->threads = worthwhile_threads(body);
    TRY(body_make_bounds(body, error));
    if (body->averaged) {
        TRY(nodal_volumes_build(input, body, error));
    }
    if (!body->conforming) {
        pairs.place = body->node_place;
        TRY(pairs_build(&pairs, &body->gradients, error));
    } else {
        TRY(conforming_build(input->conforming, body, &body->cells, error));
    }
    int threads = body->bound_parts.threads;
    TRY(body_make_scratch(body, threads > body->threads ? threads : body->threads, error));
    if (body->conforming) {
        TRY(check_smoothing(body, error));
    }
done:
    free(first_row);
    if (status != STATUS_OK) {
        body_free(body);
    }
    return status;
}

double body_largest_bulk(const struct body *body)
{
    double largest = 0.0;
    for (int64_t m = 0; m < body->material_count; m++) {
        largest = fmax(largest, body->bulk_modulus[m] / body->materials[m].shear_modulus);
    }
    return largest;
}

void body_limit_bulk(struct body *body, double most)
{
    for (int64_t m = 0; m < body->material_count; m++) {
        struct material *material = &body->materials[m];
        material->bulk_modulus = fmin(body->bulk_modulus[m], most * material->shear_modulus);
    }
}

void body_free(struct body *body)
{
    pairs_free(&body->gradients);
    conforming_free(&body->cells);
    nodal_volumes_free(&body->volumes);
    void *arrays[] = {body->order,      body->weight,     body->materials,   body->material, body->blocks,
                      body->node_order, body->node_place, body->u,           body->F,        body->bound,
                      body->J,          body->scratch,    body->bulk_modulus};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *body = (struct body){0};
}
