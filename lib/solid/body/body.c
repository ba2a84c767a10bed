#include "solid/body/body.h"

#include "approx/cells/cells.h"
#include "base/memory.h"
#include "solid/body/kernel.h"
#include "solid/body/merged_cells.h"
#include "solid/body/nodal_volume.h"
#include "solid/material/law.h"

#include <math.h>
#include <omp.h>
#include <string.h>

/* Points of a block: its part of the operator should fit into a part of the second-level cache. */
static int64_t points_of_block(int dim)
{
    return dim == 2 ? 64 : BLOCK_MOST_POINTS;
}

/* The law of a point, which with active stress or viscosity counts as another one: its kernel is another, or
 * that of any law. */
static int model_of(const struct body_input *input, int64_t point)
{
    const struct material *material = &input->materials[input->material[point]];
    int variant = (fabs(material->active) > 0.0 ? 1 : 0) + (material->prony_terms > 0 ? 2 : 0);
    return material->model + variant * law_count;
}

/* Order the points by material law, so that each block has one law, and within a law along a Morton curve, so
 * that blocks are compact; order the nodes along the curve, too. */
static enum status order_all(const struct body_input *input, struct body *body, struct error *error)
{
    NEW_SCRATCH(int32_t, model, input->point_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&body->order.points, input->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->order.nodes, body->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->order.places, body->node_count, error));
    for (int64_t q = 0; q < input->point_count; q++) {
        model[q] = model_of(input, q);
    }
    RETURN_IF_ERROR(
        renumber_morton(body->dim, input->point_count, input->x, model, body->order.points, error));
    if (body->smoothed) {
        RETURN_IF_ERROR(merged_cells_build(input, body, error));
    }
    RETURN_IF_ERROR(
        renumber_morton(body->dim, body->node_count, input->cells.x, NULL, body->order.nodes, error));
    for (int64_t n = 0; n < body->node_count; n++) {
        body->order.places[body->order.nodes[n]] = (int32_t)n;
    }
    return STATUS_OK;
}

/* Per-point data in the body's order. */
static enum status copy_points(const struct body_input *input, struct body *body, struct error *error)
{
    int dim = body->dim;
    int64_t points = input->point_count;
    RETURN_IF_ERROR(NEW_ARRAY(&body->weight, points + BODY_POINT_PADDING, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->material, points + BODY_POINT_PADDING, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->u, body->node_count * VECTOR_STRIDE(dim), error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->force, body->node_count * VECTOR_STRIDE(dim), error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->F, points * dim * dim + BODY_POINT_PADDING, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->J, points + BODY_POINT_PADDING, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->materials, input->material_count, error));
    memcpy(body->materials, input->materials, (size_t)input->material_count * sizeof *body->materials);
    for (int64_t m = 0; m < input->material_count; m++) {
        body->materials[m].stiffness = 1.0;
    }
    for (int64_t q = 0; q < points; q++) {
        int64_t from = body->order.points[q];
        bool alone = !body->smoothed && input->lists->ptr[from + 1] <= input->lists->ptr[from];
        if (alone || !(input->weight[from] > 0.0)) {
            return fail(error, STATUS_INPUT, "points.weight: row %lld: no weight or no neighbours",
                        (long long)from);
        }
        body->weight[q] = input->weight[from];
        body->material[q] = input->material[from];
    }
    RETURN_IF_ERROR(stiffening_build(body, error));
    return prony_build(body, error);
}

/* Cut the ordered points into blocks of one law, groups of cells together. */
static enum status cut_blocks(const struct body_input *input, struct body *body, struct error *error)
{
    int64_t most = points_of_block(body->dim);
    RETURN_IF_ERROR(
        NEW_ARRAY(&body->blocks, body->point_count / (most - GROUP_MOST_CELLS) + 4 * law_count + 1, error));
    for (int64_t q = 0; q < body->point_count;) {
        struct block *block = &body->blocks[body->block_count++];
        int model = model_of(input, body->order.points[q]);
        block->first_point = q;
        block->relaxes = model >= 2 * law_count;
        block->neo_hookean = model == MATERIAL_NEO_HOOKEAN ||
                             (body->smoothed && model == MATERIAL_NEO_HOOKEAN + 2 * law_count);
        while (q < body->point_count && model_of(input, body->order.points[q]) == model) {
            int64_t next = body->cells.group != NULL ? body->cells.group_end[q] : q + 1;
            if (next - block->first_point > most) {
                break;
            }
            block->point_count = next - block->first_point;
            q = next;
        }
    }
    return STATUS_OK;
}

/* The table of gradients at points. */
static enum status copy_gradients(const struct body_input *input, struct body *body, struct error *error)
{
    NEW_SCRATCH(int32_t, place, body->point_count, error);
    for (int64_t q = 0; q < body->point_count; q++) {
        place[body->order.points[q]] = (int32_t)q;
    }
    const struct row_table table = {body->dim, input->lists, input->dphi, body->order.points, place};
    RETURN_IF_ERROR(
        NEW_ARRAY(&body->derivative, body->point_count * body->dim * VECTOR_STRIDE(body->dim), error));
    body->pair_count = input->lists->ptr[body->point_count];
    return body_rows_copy(input, 1, &table, body, error);
}

/* Synchronising threads costs some microseconds a step; each must have more work than that. An entry is a
 * gradient, or one value for smoothed cells. */
static int worthwhile_threads(const struct body *body)
{
    int64_t by_work = 1 + body->pair_count / (body->smoothed ? 30000 * body->dim : 30000);
    int64_t available = omp_get_max_threads();
    return (int)(by_work < available ? by_work : available);
}

enum status body_build(const struct body_input *input, struct body *body, struct error *error)
{
    *body = (struct body){.dim = input->cells.dim,
                          .node_count = input->cells.node_count,
                          .point_count = input->point_count,
                          .material_count = input->material_count,
                          .smoothed = input->faces != NULL,
                          .averaged = input->cell != NULL};
    if (body->point_count < 1 || body->point_count > INT32_MAX / (body->dim + 1)) {
        return fail(error, STATUS_INPUT, "points.x: %lld points: none, or too many",
                    (long long)body->point_count);
    }
    RETURN_IF_ERROR(order_all(input, body, error));
    RETURN_IF_ERROR(cut_blocks(input, body, error));
    RETURN_IF_ERROR(body_share_cut(input, body, error));
    RETURN_IF_ERROR(copy_points(input, body, error));
    if (body->averaged) {
        RETURN_IF_ERROR(nodal_volumes_build(input, body, error));
    }
    if (!body->smoothed) {
        RETURN_IF_ERROR(copy_gradients(input, body, error));
    } else {
        body->pair_count =
            input->node_lists->ptr[body->node_count] + input->lists->ptr[face_row_count(input->faces)];
        RETURN_IF_ERROR(smoothed_cells_build(input, body, error));
    }
    body->threads = worthwhile_threads(body);
    RETURN_IF_ERROR(
        row_operator_finish(&body->rows, body->share.begin_node, body->share.end_node, body->threads, error));
    return body_share_nodes(body, error);
}

void body_free(struct body *body)
{
    body_share_free(&body->share);
    row_operator_free(&body->rows);
    smoothed_cells_free(&body->cells);
    nodal_volumes_free(&body->volumes);
    prony_free(&body->prony);
    stiffening_free(&body->stiffening);
    FREE_ALL(body->order.points, body->weight, body->materials, body->material, body->blocks,
             body->order.nodes, body->order.places, body->u, body->F, body->J, body->force, body->derivative);
    *body = (struct body){0};
}

bool body_slackens(const struct body *body)
{
    bool any = false;
    for (int64_t m = 0; m < body->material_count; m++) {
        any = any || material_laws[body->materials[m].model]->slackens;
    }
    return any;
}
