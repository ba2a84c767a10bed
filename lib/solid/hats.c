#include "solid/hats.h"

#include "base/memory.h"
#include "solid/material.h"

#include <stdlib.h>

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

/* For means over a hat: those of one without volume, as all its values are zero, are 0. */
static double divisor_of(const struct volume_hats *hats, int64_t a)
{
    return hats->volume[a] > 0.0 ? hats->volume[a] : 1.0;
}

/* The law of each hat: that of its points, or of the mean moduli where they differ. */
static enum status choose_hat_laws(struct body *body, struct error *error)
{
    struct volume_hats *hats = &body->hats;
    int corners = body->dim + 1;
    int64_t count = body->material_count, capacity = count;
    for (int64_t a = 0; a < hats->count; a++) {
        int32_t first = body->material[hats->slot[hats->ptr[a]] / corners];
        struct material mean = body->materials[first];
        bool is_mixed = false;
        mean.shear_modulus = mean.bulk_modulus = mean.least_share = 0.0;
        for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
            int32_t number = body->material[hats->slot[i] / corners];
            const struct material *material = &body->materials[number];
            double share = hats->share[hats->slot[i]] / divisor_of(hats, a);
            is_mixed = is_mixed || number != first;
            mean.shear_modulus += share * material->shear_modulus;
            mean.bulk_modulus += share * material->bulk_modulus;
            mean.least_share += share * material->least_share;
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

enum status hats_build(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    struct volume_hats *hats = &body->hats;
    int per_point = body->dim + 1;
    int64_t slots = body->point_count * per_point;
    struct hat_key *keys = NULL;
    TRY(NEW_ARRAY(&keys, slots, error));
    TRY(NEW_ARRAY(&hats->of_point, slots, error));
    TRY(NEW_ARRAY(&hats->share, slots, error));
    TRY(NEW_ARRAY(&hats->slot, slots, error));
    for (int64_t s = 0; s < slots; s++) {
        int64_t from = body->order[s / per_point] * per_point + s % per_point;
        int32_t material = body->material[s / per_point];
        keys[s] =
            (struct hat_key){input->hat_node[from], input->group ? input->group[material] : material, s};
        hats->share[s] = input->hat_value[from] * body->weight[s / per_point];
    }
    qsort(keys, (size_t)slots, sizeof *keys, compare_hats);
    for (int64_t i = 0; i < slots; i++) {
        hats->count += i == 0 || keys[i].node != keys[i - 1].node || keys[i].group != keys[i - 1].group;
        hats->of_point[keys[i].slot] = (int32_t)(hats->count - 1);
        hats->slot[i] = (int32_t)keys[i].slot;
    }
    TRY(NEW_ARRAY(&hats->ptr, hats->count + 1, error));
    for (int64_t i = 0; i < slots; i++) {
        hats->ptr[hats->of_point[keys[i].slot] + 1] = i + 1;
    }
    TRY(NEW_ARRAY(&hats->volume, hats->count, error));
    TRY(NEW_ARRAY(&hats->material, hats->count, error));
    TRY(NEW_ARRAY(&hats->theta, hats->count, error));
    TRY(NEW_ARRAY(&hats->pressure, hats->count, error));
    TRY(NEW_ARRAY(&hats->slope, hats->count, error));
    for (int64_t a = 0; a < hats->count; a++) {
        for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
            hats->volume[a] += hats->share[hats->slot[i]];
        }
    }
    status = choose_hat_laws(body, error);
done:
    free(keys);
    return status;
}

/* Taken of J - 1, which is small. */
static inline __attribute__((always_inline)) void average_hat(const struct body *body, int64_t a, int corners,
                                                              double *mean, double *variance)
{
    const struct volume_hats *hats = &body->hats;
    double sum = 0.0, squares = 0.0;
    for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
        int32_t slot = hats->slot[i];
        double difference = body->J[slot / corners] - 1.0, part = hats->share[slot] * difference;
        sum += part;
        squares += part * difference;
    }
    sum /= divisor_of(hats, a);
    squares /= divisor_of(hats, a);
    *mean = 1.0 + sum;
    *variance = squares > sum * sum ? squares - sum * sum : 0.0;
}

static void average_volume(const struct body *body, int64_t a, double *mean, double *variance)
{
    if (body->dim == 2) {
        average_hat(body, a, 3, mean, variance);
    } else {
        average_hat(body, a, 4, mean, variance);
    }
}

/* Share s of the pointwise law in a hat. */
static double share_of(const struct body *body, const struct material *material)
{
    return body->pointwise_share > material->least_share ? body->pointwise_share : material->least_share;
}

/* Pressure of a hat, from the derivative of its energy: U'(theta) + kappa (s + 2 c v) (J - theta). */
void hats_set_pressure(struct body *body, int64_t a)
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

double hats_energy(const struct body *body)
{
    double energy = 0.0, mean, variance;
    for (int64_t a = 0; a < body->hats.count; a++) {
        const struct material *material = &body->materials[body->hats.material[a]];
        average_volume(body, a, &mean, &variance);
        energy += body->hats.volume[a] * (material_volume_energy(material, mean) +
                                          0.5 * material_bulk(material) * variance *
                                              (share_of(body, material) + body->share_growth * variance));
    }
    return energy;
}

void hats_free(struct volume_hats *hats)
{
    void *arrays[] = {hats->of_point, hats->share, hats->ptr,      hats->slot, hats->volume,
                      hats->material, hats->theta, hats->pressure, hats->slope};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *hats = (struct volume_hats){0};
}
