#include "solid/body.h"

#include "base/memory.h"
#include "solid/kernel.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static int64_t points_of_block(int dim)
{
    return dim == 2 ? 64 : 128;
}

/* A point's place on a Morton curve, behind its material model: blocks are of one law and compact. */
struct sort_key {
    uint64_t model, place;
    int64_t point;
};

static int compare_keys(const void *left, const void *right)
{
    const struct sort_key *a = left, *b = right;
    if (a->model != b->model) {
        return a->model < b->model ? -1 : 1;
    }
    if (a->place != b->place) {
        return a->place < b->place ? -1 : 1;
    }
    return (a->point > b->point) - (a->point < b->point);
}

static uint64_t morton(int dim, const double *x, const double *low, double extent)
{
    uint64_t place = 0, cell[3];
    const int bits = 20;
    for (int a = 0; a < dim; a++) {
        cell[a] = (uint64_t)((x[a] - low[a]) / extent * ((1 << bits) - 1));
    }
    for (int b = bits - 1; b >= 0; b--) {
        for (int a = 0; a < dim; a++) {
            place = place << 1 | (cell[a] >> b & 1);
        }
    }
    return place;
}

static enum status order_points(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    struct sort_key *keys = NULL;
    double low[3], high, extent = 1e-300;
    TRY(NEW_ARRAY(&keys, input->point_count, error));
    TRY(NEW_ARRAY(&body->order, input->point_count, error));
    for (int a = 0; a < input->dim; a++) {
        low[a] = INFINITY;
        high = -INFINITY;
        for (int64_t q = 0; q < input->point_count; q++) {
            low[a] = fmin(low[a], input->x[q * input->dim + a]);
            high = fmax(high, input->x[q * input->dim + a]);
        }
        extent = fmax(extent, high - low[a]);
    }
    for (int64_t q = 0; q < input->point_count; q++) {
        keys[q].model = input->materials[input->material[q]].model;
        keys[q].place = morton(input->dim, input->x + q * input->dim, low, extent);
        keys[q].point = q;
    }
    qsort(keys, (size_t)input->point_count, sizeof *keys, compare_keys);
    for (int64_t q = 0; q < input->point_count; q++) {
        body->order[q] = keys[q].point;
    }
done:
    free(keys);
    return status;
}

/* Per-point data and the pairs' gradients, in the body's order. */
static enum status copy_points(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    int dim = input->dim;
    int64_t points = input->point_count;
    TRY(NEW_ARRAY(&body->weight, points + BODY_POINT_PADDING, error));
    TRY(NEW_ARRAY(&body->material, points, error));
    TRY(NEW_ARRAY(&body->shear, points + BODY_POINT_PADDING, error));
    TRY(NEW_ARRAY(&body->bulk, points, error));
    TRY(NEW_ARRAY(&body->ptr, points + 1, error));
    TRY(NEW_ARRAY(&body->F, points * dim * dim + BODY_POINT_PADDING, error));
    TRY(NEW_ARRAY(&body->J, points + BODY_POINT_PADDING, error));
    TRY(NEW_ARRAY(&body->materials, input->material_count, error));
    memcpy(body->materials, input->materials, (size_t)input->material_count * sizeof *body->materials);
    for (int64_t q = 0; q < points; q++) {
        int64_t from = body->order[q], length = input->ptr[from + 1] - input->ptr[from];
        const struct material *material = &input->materials[input->material[from]];
        if (length < 1 || !(input->weight[from] > 0.0)) {
            status = fail(error, STATUS_INPUT, "points.weight: row %lld: no weight or no neighbours",
                          (long long)from);
            goto done;
        }
        body->ptr[q + 1] = body->ptr[q] + length;
        body->weight[q] = input->weight[from];
        body->material[q] = input->material[from];
        body->shear[q] = material->shear_modulus;
        body->bulk[q] = material->bulk_modulus;
    }
    body->pair_count = body->ptr[points];
    TRY(NEW_ARRAY(&body->dphi, body->pair_count * dim + 1, error));
    for (int64_t q = 0; q < points; q++) {
        memcpy(body->dphi + body->ptr[q] * dim, input->dphi + input->ptr[body->order[q]] * dim,
               (size_t)((body->ptr[q + 1] - body->ptr[q]) * dim) * sizeof *body->dphi);
    }
done:
    return status;
}

/* Cut the ordered points into blocks of one law. */
static enum status cut_blocks(struct body *body, struct error *error)
{
    enum status status;
    int64_t most = points_of_block(body->dim);
    TRY(NEW_ARRAY(&body->blocks, body->point_count / most + MATERIAL_MODEL_COUNT + 1, error));
    for (int64_t q = 0; q < body->point_count;) {
        struct block *block = &body->blocks[body->block_count++];
        enum material_model model = body->materials[body->material[q]].model;
        block->first_point = q;
        block->neo_hookean = model == MATERIAL_NEO_HOOKEAN;
        while (q < body->point_count && block->point_count < most &&
               body->materials[body->material[q]].model == model) {
            block->point_count++;
            q++;
        }
    }
done:
    return status;
}

/* The nodes of each block and the pairs' local indices. */
static enum status number_nodes(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    int32_t *local_of = NULL;
    int64_t capacity = 0;
    TRY(NEW_ARRAY(&body->local, body->pair_count, error));
    TRY(NEW_ARRAY(&local_of, body->node_count, error));
    for (int64_t n = 0; n < body->node_count; n++) {
        local_of[n] = -1;
    }
    for (int64_t b = 0; b < body->block_count; b++) {
        struct block *block = &body->blocks[b];
        block->first_node = body->block_node_count;
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            const int32_t *idx = input->idx + input->ptr[body->order[q]];
            for (int64_t i = body->ptr[q]; i < body->ptr[q + 1]; i++) {
                int32_t node = idx[i - body->ptr[q]];
                if (local_of[node] < 0) {
                    if (body->block_node_count == capacity) {
                        capacity = capacity * 2 + 4096;
                        int32_t *grown = array_grow(body->block_node, capacity, sizeof *grown);
                        if (grown == NULL) {
                            status = fail_memory(error, "nodes of blocks");
                            goto done;
                        }
                        body->block_node = grown;
                    }
                    local_of[node] = (int32_t)block->node_count++;
                    body->block_node[body->block_node_count++] = node;
                }
                if (local_of[node] >= BODY_MAX_BLOCK_NODES) {
                    status = fail(error, STATUS_INPUT,
                                  "nbr.idx: a block of points has more than 16384 neighbours: "
                                  "supports are too large");
                    goto done;
                }
                body->local[i] = (uint16_t)local_of[node];
            }
        }
        for (int64_t i = 0; i < block->node_count; i++) {
            local_of[body->block_node[block->first_node + i]] = -1;
        }
        if (block->node_count > body->largest_block_nodes) {
            body->largest_block_nodes = block->node_count;
        }
    }
    TRY(NEW_ARRAY(&body->block_force, body->block_node_count * body->dim, error));
done:
    free(local_of);
    return status;
}

/* For each node the entries of block_force that are its own. */
static enum status number_gather(struct body *body, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&body->gather_ptr, body->node_count + 2, error));
    TRY(NEW_ARRAY(&body->gather, body->block_node_count, error));
    for (int64_t i = 0; i < body->block_node_count; i++) {
        body->gather_ptr[body->block_node[i] + 2]++;
    }
    for (int64_t n = 0; n < body->node_count; n++) {
        body->gather_ptr[n + 2] += body->gather_ptr[n + 1];
    }
    for (int64_t i = 0; i < body->block_node_count; i++) {
        body->gather[body->gather_ptr[body->block_node[i] + 1]++] = (int32_t)i;
    }
done:
    return status;
}

/* One hat for each pair of background node and group: pressures of different groups do not mix. */
struct hat_key {
    int32_t node, group;
    int64_t slot; /* point * (dim + 1) + vertex */
};

static int compare_hats(const void *left, const void *right)
{
    const struct hat_key *a = left, *b = right;
    if (a->node != b->node) {
        return a->node < b->node ? -1 : 1;
    }
    if (a->group != b->group) {
        return a->group < b->group ? -1 : 1;
    }
    return (a->slot > b->slot) - (a->slot < b->slot);
}

/* The law of each hat: that of its points, or of the mean moduli where they differ. */
static enum status choose_hat_laws(struct body *body, struct error *error)
{
    struct volume_hats *hats = &body->hats;
    int64_t count = body->material_count, capacity = count;
    for (int64_t a = 0; a < hats->count; a++) {
        int32_t first = body->material[hats->point[hats->ptr[a]]];
        struct material mean = body->materials[first];
        bool is_mixed = false;
        mean.shear_modulus = mean.bulk_modulus = mean.least_share = 0.0;
        for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
            const struct material *material = &body->materials[body->material[hats->point[i]]];
            is_mixed = is_mixed || body->material[hats->point[i]] != first;
            mean.shear_modulus += hats->share[i] * material->shear_modulus;
            mean.bulk_modulus += hats->share[i] * material->bulk_modulus;
            mean.least_share += hats->share[i] * material->least_share;
        }
        hats->material[a] = first;
        if (!is_mixed) {
            continue;
        }
        if (count == capacity) {
            capacity = 2 * capacity + 64;
            struct material *grown = array_grow(body->materials, capacity, sizeof *grown);
            if (grown == NULL) {
                return fail_memory(error, "materials");
            }
            body->materials = grown;
        }
        hats->material[a] = (int32_t)count;
        body->materials[count++] = mean;
    }
    return STATUS_OK;
}

static enum status build_hats(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    struct volume_hats *hats = &body->hats;
    int per_point = body->dim + 1;
    int64_t slots = body->point_count * per_point;
    struct hat_key *keys = NULL;
    TRY(NEW_ARRAY(&keys, slots, error));
    TRY(NEW_ARRAY(&hats->of_point, slots, error));
    TRY(NEW_ARRAY(&hats->value, slots, error));
    TRY(NEW_ARRAY(&hats->ptr, slots + 1, error));
    TRY(NEW_ARRAY(&hats->point, slots, error));
    TRY(NEW_ARRAY(&hats->share, slots, error));
    for (int64_t s = 0; s < slots; s++) {
        int64_t from = body->order[s / per_point] * per_point + s % per_point;
        int32_t material = body->material[s / per_point];
        keys[s] =
            (struct hat_key){input->hat_node[from], input->group ? input->group[material] : material, s};
        hats->value[s] = input->hat_value[from];
    }
    qsort(keys, (size_t)slots, sizeof *keys, compare_hats);
    for (int64_t i = 0; i < slots; i++) {
        if (i == 0 || keys[i].node != keys[i - 1].node || keys[i].group != keys[i - 1].group) {
            hats->ptr[hats->count++] = i;
        }
        hats->of_point[keys[i].slot] = (int32_t)(hats->count - 1);
        hats->point[i] = (int32_t)(keys[i].slot / per_point);
        hats->share[i] = hats->value[keys[i].slot] * body->weight[hats->point[i]];
    }
    hats->ptr[hats->count] = slots;
    TRY(NEW_ARRAY(&hats->volume, hats->count, error));
    TRY(NEW_ARRAY(&hats->material, hats->count, error));
    TRY(NEW_ARRAY(&hats->theta, hats->count, error));
    TRY(NEW_ARRAY(&hats->pressure, hats->count, error));
    TRY(NEW_ARRAY(&hats->slope, hats->count, error));
    for (int64_t a = 0; a < hats->count; a++) {
        for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
            hats->volume[a] += hats->share[i];
        }
        for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
            hats->share[i] = hats->volume[a] > 0.0 ? hats->share[i] / hats->volume[a] : 0.0;
        }
    }
    status = choose_hat_laws(body, error);
done:
    free(keys);
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
    *body = (struct body){.dim = input->dim,
                          .node_count = input->node_count,
                          .point_count = input->point_count,
                          .material_count = input->material_count,
                          .kernels = force_kernels_select(input->dim),
                          .averaged = input->hat_node != NULL,
                          .pointwise_share = input->pointwise_share,
                          .share_growth = input->share_growth};
    if (body->point_count < 1 || body->point_count > INT32_MAX / (body->dim + 1)) {
        return fail(error, STATUS_INPUT, "points.x: %lld points: none, or too many",
                    (long long)body->point_count);
    }
    TRY(order_points(input, body, error));
    TRY(copy_points(input, body, error));
    TRY(cut_blocks(body, error));
    TRY(number_nodes(input, body, error));
    TRY(number_gather(body, error));
    body->threads = worthwhile_threads(body);
    if (body->averaged) {
        TRY(build_hats(input, body, error));
    }
done:
    if (status != STATUS_OK) {
        body_free(body);
    }
    return status;
}

void body_free(struct body *body)
{
    void *arrays[] = {body->order,
                      body->weight,
                      body->materials,
                      body->material,
                      body->shear,
                      body->bulk,
                      body->ptr,
                      body->local,
                      body->dphi,
                      body->blocks,
                      body->block_node,
                      body->block_force,
                      body->gather_ptr,
                      body->gather,
                      body->F,
                      body->J,
                      body->hats.ptr,
                      body->hats.point,
                      body->hats.share,
                      body->hats.volume,
                      body->hats.theta,
                      body->hats.value,
                      body->hats.pressure,
                      body->hats.slope,
                      body->hats.material,
                      body->hats.of_point};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *body = (struct body){0};
}
