#include "solid/nodal_volume.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* A nodal volume for each pair of background node and group of materials. */
struct key {
    int32_t node, group;
    int64_t slot; /* point * (dim + 1) + vertex */
};

static int compare_keys(const void *left, const void *right)
{
    const struct key *a = left, *b = right;
    if (a->node != b->node) {
        return a->node < b->node ? -1 : 1;
    }
    if (a->group != b->group) {
        return a->group < b->group ? -1 : 1;
    }
    return (a->slot > b->slot) - (a->slot < b->slot);
}

/* Number the nodal volumes and list their slots. */
static enum status number_volumes(struct nodal_volumes *volumes, struct key *keys, int64_t slots,
                                  struct error *error)
{
    enum status status;
    qsort(keys, (size_t)slots, sizeof *keys, compare_keys);
    for (int64_t i = 0; i < slots; i++) {
        volumes->count += i == 0 || keys[i].node != keys[i - 1].node || keys[i].group != keys[i - 1].group;
        volumes->of_point[keys[i].slot] = (int32_t)(volumes->count - 1);
        volumes->slot[i] = (int32_t)keys[i].slot;
    }
    TRY(NEW_ARRAY(&volumes->ptr, volumes->count + 1, error));
    for (int64_t i = 0; i < slots; i++) {
        volumes->ptr[volumes->of_point[keys[i].slot] + 1] = i + 1;
    }
done:
    return status;
}

enum status nodal_volumes_build(const struct body_input *input, struct body *body, struct error *error)
{
    enum status status;
    struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    int64_t slots = body->point_count * vertices;
    struct key *keys = NULL;
    TRY(NEW_ARRAY(&keys, slots, error));
    TRY(NEW_ARRAY(&volumes->of_point, slots, error));
    TRY(NEW_ARRAY(&volumes->share, slots, error));
    TRY(NEW_ARRAY(&volumes->slot, slots, error));
    TRY(NEW_ARRAY(&volumes->mean, body->point_count, error));
    TRY(NEW_ARRAY(&volumes->carried, body->point_count, error));
    for (int64_t s = 0; s < slots; s++) {
        int64_t from = body->order[s / vertices] * vertices + s % vertices;
        int32_t material = body->material[s / vertices];
        keys[s] = (struct key){input->hat_node[from], input->group ? input->group[material] : material, s};
        volumes->share[s] = input->hat_value[from] * body->weight[s / vertices];
    }
    TRY(number_volumes(volumes, keys, slots, error));
    TRY(NEW_ARRAY(&volumes->volume, volumes->count, error));
    TRY(NEW_ARRAY(&volumes->ratio, volumes->count, error));
    TRY(NEW_ARRAY(&volumes->pressure, volumes->count, error));
    for (int64_t a = 0; a < volumes->count; a++) {
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
            volumes->volume[a] += volumes->share[volumes->slot[i]];
        }
    }
done:
    free(keys);
    return status;
}

double nodal_volume_modulus(const struct material *material)
{
    return fmin(material_bulk(material), 2.0 * material->shear_modulus);
}

/* Mean over nodal volume a of the values at points; 0 where it has no volume, as all its hat values are 0. */
static inline __attribute__((always_inline)) double
to_volume(const struct nodal_volumes *volumes, int64_t a, int vertices, const double *value, double subtract)
{
    double sum = 0.0;
    for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
        int32_t slot = volumes->slot[i];
        sum += volumes->share[slot] * (value[slot / vertices] - subtract);
    }
    return volumes->volume[a] > 0.0 ? sum / volumes->volume[a] : 0.0;
}

/* sum_a N_a(q) value_a w_q */
static inline __attribute__((always_inline)) double to_point(const struct nodal_volumes *volumes, int64_t q,
                                                             int vertices, const double *value)
{
    double sum = 0.0;
    for (int64_t k = q * vertices; k < (q + 1) * vertices; k++) {
        sum += volumes->share[k] * value[volumes->of_point[k]];
    }
    return sum;
}

static void average_ratios(struct nodal_volumes *volumes, int vertices, const double *J)
{
#pragma omp for schedule(static)
    for (int64_t a = 0; a < volumes->count; a++) { /* of J - 1, which is small */
        volumes->ratio[a] = to_volume(volumes, a, vertices, J, 1.0);
    }
}

/* Jbar, and U'(Jbar) - s (Jbar - 1), which is averaged to the pressures of the nodal volumes. */
static void press_points(struct body *body, int vertices)
{
    struct nodal_volumes *volumes = &body->volumes;
#pragma omp for schedule(static)
    for (int64_t q = 0; q < body->point_count; q++) {
        const struct material *material = &body->materials[body->material[q]];
        double mean = 1.0 + to_point(volumes, q, vertices, volumes->ratio) / body->weight[q];
        volumes->mean[q] = mean;
        volumes->carried[q] =
            material_pressure(material, mean) - nodal_volume_modulus(material) * (mean - 1.0);
    }
}

static void average_pressures(struct nodal_volumes *volumes, int vertices)
{
#pragma omp for schedule(static)
    for (int64_t a = 0; a < volumes->count; a++) {
        volumes->pressure[a] = to_volume(volumes, a, vertices, volumes->carried, 0.0);
    }
}

void nodal_volumes_evaluate(struct body *body)
{
    if (body->dim == 2) {
        average_ratios(&body->volumes, 3, body->J);
        press_points(body, 3);
        average_pressures(&body->volumes, 3);
    } else {
        average_ratios(&body->volumes, 4, body->J);
        press_points(body, 4);
        average_pressures(&body->volumes, 4);
    }
}

double nodal_volume_pressure(const struct body *body, int64_t point)
{
    const struct nodal_volumes *volumes = &body->volumes;
    const struct material *material = &body->materials[body->material[point]];
    return to_point(volumes, point, body->dim + 1, volumes->pressure) / body->weight[point] +
           nodal_volume_modulus(material) * (body->J[point] - 1.0);
}

double nodal_volume_energy(const struct body *body, int64_t point)
{
    const struct material *material = &body->materials[body->material[point]];
    double mean = body->volumes.mean[point], J = body->J[point];
    return material_volume_energy(material, mean) +
           0.5 * nodal_volume_modulus(material) * (J - mean) * (J + mean - 2.0);
}

void nodal_volumes_free(struct nodal_volumes *volumes)
{
    void *arrays[] = {volumes->of_point, volumes->share, volumes->ptr,      volumes->slot,   volumes->volume,
                      volumes->mean,     volumes->ratio, volumes->pressure, volumes->carried};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *volumes = (struct nodal_volumes){0};
}
