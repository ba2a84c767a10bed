#include "solid/nodal_volume.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* s by the shear modulus. */
static const double points_part = 2.0;
/* epsilon */
static const double stabilisation = 0.125;

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
    TRY(NEW_ARRAY(&volumes->strain, body->point_count, error));
    for (int64_t s = 0; s < slots; s++) {
        int64_t q = s / vertices, from = body->order[q] * vertices + s % vertices;
        int32_t material = body->material[q];
        bool carries = nodal_pressure_modulus(&body->materials[material]) > 0.0;
        keys[s] = (struct key){input->vertex[from], input->group ? input->group[material] : material, s};
        volumes->share[s] = carries ? input->barycentric[from] * body->weight[q] : 0.0;
    }
    TRY(number_volumes(volumes, keys, slots, error));
    TRY(body_share_volumes(body, error));
    TRY(nodal_pressures_build(body, error));
    TRY(NEW_ARRAY(&volumes->content, volumes->pressures.slices * NODAL_PRESSURE_ROWS, error));
    TRY(NEW_ARRAY(&volumes->pressure, volumes->pressures.slices * NODAL_PRESSURE_ROWS, error));
done:
    free(keys);
    return status;
}

double nodal_volume_modulus(const struct material *material)
{
    return fmin(material_bulk(material), points_part * material->shear_modulus);
}

double nodal_pressure_modulus(const struct material *material)
{
    return material_bulk(material) - nodal_volume_modulus(material);
}

double nodal_pressure_compliance(const struct material *material)
{
    return stabilisation / material->shear_modulus;
}

/* b */
static inline __attribute__((always_inline)) void sum_content(struct body *body, int vertices)
{
    struct nodal_volumes *volumes = &body->volumes;
    struct body_share *share = &body->share;
    int rank = ranks_rank(share->ranks);
#pragma omp for schedule(static)
    for (int64_t a = share->volume_first[rank]; a < share->volume_first[rank + 1]; a++) {
        double sum = 0.0;
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
            int32_t slot = volumes->slot[i];
            sum += volumes->share[slot] * volumes->strain[slot / vertices];
        }
        volumes->content[a] = sum;
    }
}

void nodal_volumes_strain(struct body *body, int64_t b)
{
    const struct block *block = &body->blocks[b];
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        body->volumes.strain[q] = material_volume_strain(&body->materials[body->material[q]], body->J[q]);
    }
}

void nodal_volumes_evaluate(struct body *body)
{
    if (body->dim == 2) {
        sum_content(body, 3);
    } else {
        sum_content(body, 4);
    }
    nodal_pressures_solve(body);
}

/* sum_a N_a(q) pi_a */
static double carried(const struct body *body, int64_t point)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    double sum = 0.0;
    for (int64_t k = point * vertices; k < (point + 1) * vertices; k++) {
        sum += volumes->share[k] * volumes->pressure[volumes->of_point[k]];
    }
    return sum / body->weight[point];
}

double nodal_volume_pressure(const struct body *body, int64_t point)
{
    const struct material *material = &body->materials[body->material[point]];
    return (carried(body, point) + nodal_volume_modulus(material) * body->volumes.strain[point]) *
           material_volume_slope(material, body->J[point]);
}

double nodal_volume_energy(const struct body *body, int64_t point)
{
    const struct material *material = &body->materials[body->material[point]];
    double strain = body->volumes.strain[point];
    return 0.5 * (carried(body, point) + nodal_volume_modulus(material) * strain) * strain;
}

void nodal_volumes_free(struct nodal_volumes *volumes)
{
    void *arrays[] = {volumes->of_point, volumes->share,   volumes->ptr,     volumes->slot,
                      volumes->strain,   volumes->content, volumes->pressure};
    nodal_pressures_free(&volumes->pressures);
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *volumes = (struct nodal_volumes){0};
}
