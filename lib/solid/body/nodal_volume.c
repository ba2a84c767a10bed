#include "solid/body/nodal_volume.h"

#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* The most of s by the shear modulus. */
static const double points_part = 2.0;
/* mu where it stabilises. */
static double stabilising_shear(const struct material *material)
{
    return material->stiffness * material->shear_modulus;
}

/* epsilon in 2D and 3D: the compliance of bubbles in regular cells. */
static const double stabilisation[] = {1.0 / 5.0, 3.0 / 28.0};

/* Number the nodal volumes, one for each pair of background node and group of materials, and list their
 * slots, point * (dim + 1) + vertex. keys[slots]: the pair of each slot as one number. */
static enum status number_volumes(struct nodal_volumes *volumes, struct placed *keys, int64_t slots,
                                  struct error *error)
{
    qsort(keys, (size_t)slots, sizeof *keys, compare_placed);
    for (int64_t i = 0; i < slots; i++) {
        volumes->count += i == 0 || keys[i].place > keys[i - 1].place;
        volumes->of_point[keys[i].item] = (int32_t)(volumes->count - 1);
        volumes->slot[i] = (int32_t)keys[i].item;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->ptr, volumes->count + 1, error));
    for (int64_t i = 0; i < slots; i++) {
        volumes->ptr[volumes->of_point[keys[i].item] + 1] = i + 1;
    }
    return STATUS_OK;
}

/* share[dim + 1] of point q: its barycentric coordinates times its volume. Nodes at edges give their shares
 * to the other nodes of the cell, if there are any; returns whether they do. */
static bool share_out(const struct body_input *input, const struct body *body, int64_t q, double *share)
{
    int vertices = body->dim + 1;
    int64_t point = body->order.points[q], cell = input->cell[point];
    const int32_t *vertex = input->cells.node + cell * vertices;
    double others = 0.0, coordinate[4];
    bool at_edge = false;
    cell_barycentric(&input->cells, cell, input->x + point * body->dim, coordinate);
    for (int k = 0; k < vertices; k++) {
        bool leaves = input->at_edge != NULL && input->at_edge[vertex[k]];
        others += leaves ? 0.0 : coordinate[k];
        at_edge = at_edge || leaves;
    }
    at_edge = at_edge && others > 0.0;
    for (int k = 0; k < vertices; k++) {
        share[k] = coordinate[k] * body->weight[q];
        if (at_edge) {
            share[k] = input->at_edge[vertex[k]] ? 0.0 : share[k] / others;
        }
    }
    return at_edge;
}

/* s of a point with nodal pressures; 0: without. */
static double part_of_point(const struct body *body, int64_t q)
{
    const struct material *material = &body->materials[body->material[q]];
    return nodal_pressure_modulus(material) > 0.0 ? nodal_volume_modulus(material) : 0.0;
}

/* S_a of the nodal volumes that may have one, which is not 0; -1: none as yet. */
static void sum_moduli(struct body *body)
{
    const struct nodal_volumes *volumes = &body->volumes;
    for (int64_t a = 0; a < volumes->count && volumes->modulus != NULL; a++) {
        double sum = 0.0;
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
            int64_t slot = volumes->slot[i];
            sum += volumes->share[slot] * part_of_point(body, slot / (body->dim + 1));
        }
        volumes->modulus[a] = volumes->modulus[a] == 0.0 ? 0.0 : sum > 0.0 ? sum : -1.0;
    }
}

/* Those that have a point at an edge do. */
static enum status choose_moduli(const bool *at_edge, struct body *body, struct error *error)
{
    struct nodal_volumes *volumes = &body->volumes;
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->direct, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->modulus, volumes->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->mean, volumes->count, error));
    for (int64_t slot = 0; slot < body->point_count * (body->dim + 1); slot++) {
        if (at_edge[slot / (body->dim + 1)]) {
            volumes->modulus[volumes->of_point[slot]] = 1.0;
        }
    }
    sum_moduli(body);
    return STATUS_OK;
}

void nodal_volumes_renew(struct body *body)
{
    if (body->averaged) {
        sum_moduli(body);
        nodal_pressures_renew(body);
    }
}

/* Whether nodal pressures act, once the material has relaxed. */
static bool may_have_pressure(const struct material *material)
{
    struct material relaxed = *material;
    relaxed.stiffness = material_long_term(material);
    return nodal_pressure_modulus(&relaxed) > 0.0;
}

enum status nodal_volumes_build(const struct body_input *input, struct body *body, struct error *error)
{
    struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    int64_t slots = body->point_count * vertices;
    SCRATCH bool *at_edge = NULL; /* points of cells with a node at an edge and others */
    NEW_SCRATCH(struct placed, keys, slots, error);
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->of_point, slots, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->share, slots, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->slot, slots, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->change, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&at_edge, body->point_count, error));
    for (int64_t s = 0; s < slots; s++) {
        int64_t q = s / vertices, cell = input->cell[body->order.points[q]];
        int64_t node = input->cells.node[cell * vertices + s % vertices];
        int32_t material = body->material[q];
        int32_t group = input->group != NULL ? input->group[material] : material;
        keys[s] = (struct placed){(double)(node * body->material_count + group), s};
    }
    for (int64_t q = 0; q < body->point_count; q++) {
        if (may_have_pressure(&body->materials[body->material[q]])) {
            at_edge[q] = share_out(input, body, q, volumes->share + q * vertices);
        }
    }
    RETURN_IF_ERROR(number_volumes(volumes, keys, slots, error));
    if (input->at_edge != NULL) {
        RETURN_IF_ERROR(choose_moduli(at_edge, body, error));
    }
    RETURN_IF_ERROR(body_share_volumes(body, error));
    RETURN_IF_ERROR(nodal_pressures_build(body, error));
    for (int64_t m = 0; m < body->material_count && volumes->slope == NULL; m++) {
        if (material_is_logarithmic(&body->materials[m])) {
            RETURN_IF_ERROR(NEW_ARRAY(&volumes->slope, volumes->count, error));
        }
    }
    RETURN_IF_ERROR(NEW_ARRAY(&volumes->content, volumes->count, error));
    return NEW_ARRAY(&volumes->pressure, volumes->count, error);
}

double nodal_volume_part(double modulus, double shear)
{
    return fmin(modulus, points_part * shear);
}

double nodal_volume_modulus(const struct material *material)
{
    return nodal_volume_part(material_bulk(material), stabilising_shear(material));
}

double nodal_pressure_modulus(const struct material *material)
{
    return material_bulk(material) - nodal_volume_modulus(material);
}

double nodal_pressure_compliance(const struct material *material, int dim)
{
    return stabilisation[dim - 2] / ((dim + 2) * stabilising_shear(material));
}

static bool is_logarithmic(const struct body *body, int64_t point)
{
    return material_is_logarithmic(&body->materials[body->material[point]]);
}

/* b and y' of a nodal volume in ln J, from its change of volume in `content`. */
static void take_logarithm(const struct body *body, int64_t a)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    double volume = 0.0, change = volumes->content[a];
    volumes->slope[a] = 1.0;
    if (!is_logarithmic(body, volumes->slot[volumes->ptr[a]] / vertices) || change == 0.0) {
        return;
    }
    for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
        volume += volumes->share[volumes->slot[i]];
    }
    volumes->content[a] = volume * log1p(change / volume);
    volumes->slope[a] = volume / (volume + change);
}

/* b and y' */
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
            sum += volumes->share[slot] * volumes->change[slot / vertices];
        }
        volumes->content[a] = sum;
        if (volumes->slope != NULL) {
            take_logarithm(body, a);
        }
    }
}

void nodal_volumes_change(struct body *body, int64_t b)
{
    const struct block *block = &body->blocks[b];
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        body->volumes.change[q] = body->J[q] - 1.0;
    }
}

/* y of a point */
static double strain(const struct body *body, int64_t point)
{
    double change = body->volumes.change[point];
    return is_logarithmic(body, point) ? log1p(change) : change;
}

/* The strains on which s acts in a body with edges: theta_a Y_a + (1 - theta_a) y_q, summed with N_a(q). */
static void average_strains(struct body *body)
{
    struct nodal_volumes *volumes = &body->volumes;
    struct body_share *share = &body->share;
    int rank = ranks_rank(share->ranks), vertices = body->dim + 1;
#pragma omp for schedule(static)
    for (int64_t a = share->volume_first[rank]; a < share->volume_first[rank + 1]; a++) {
        double sum = 0.0;
        if (!(volumes->modulus[a] > 0.0)) {
            continue;
        }
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
            int64_t slot = volumes->slot[i], q = slot / vertices;
            sum += volumes->share[slot] * part_of_point(body, q) * strain(body, q);
        }
        volumes->mean[a] = sum / volumes->modulus[a];
    }
    body_share_exchange(share, &share->pressures, 1, volumes->mean);
#pragma omp for schedule(static)
    for (int64_t q = share->begin_point; q < share->end_point; q++) {
        double change = 0.0, own = strain(body, q);
        for (int64_t slot = q * vertices; slot < (q + 1) * vertices; slot++) {
            int32_t a = volumes->of_point[slot];
            change += volumes->modulus[a] > 0.0 ? volumes->share[slot] * (volumes->mean[a] - own) : 0.0;
        }
        volumes->direct[q] = own + change / body->weight[q];
    }
}

void nodal_volumes_evaluate(struct body *body)
{
    if (body->dim == 2) {
        sum_content(body, 3);
    } else {
        sum_content(body, 4);
    }
    if (body->volumes.slope != NULL) {
        body_share_exchange(&body->share, &body->share.pressures, 1, body->volumes.slope);
    }
    if (body->volumes.direct != NULL) {
        average_strains(body);
    }
    nodal_pressures_solve(body);
}

/* The pressure of the part s of a point's bulk modulus, by y'. */
static double direct(const struct body *body, int64_t point)
{
    const double *of = body->volumes.direct;
    return nodal_volume_modulus(&body->materials[body->material[point]]) *
           (of != NULL ? of[point] : strain(body, point));
}

double nodal_volume_pressure(const struct body *body, int64_t point)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    double sum = 0.0;
    for (int64_t k = point * vertices; k < (point + 1) * vertices; k++) {
        int32_t a = volumes->of_point[k];
        sum += volumes->share[k] * volumes->pressure[a] * (volumes->slope != NULL ? volumes->slope[a] : 1.0);
    }
    return sum / body->weight[point] +
           direct(body, point) *
               material_volume_slope(&body->materials[body->material[point]], body->J[point]);
}

double nodal_volume_energy(const struct body *body, int64_t point)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    bool by_volume = is_logarithmic(body, point);
    double sum = 0.0, own = strain(body, point);
    for (int64_t k = point * vertices; k < (point + 1) * vertices; k++) {
        int32_t a = volumes->of_point[k];
        sum += volumes->share[k] * volumes->pressure[a] * (by_volume ? -log(volumes->slope[a]) : own);
    }
    return 0.5 * (sum / body->weight[point] + direct(body, point) * own);
}

void nodal_volumes_free(struct nodal_volumes *volumes)
{
    nodal_pressures_free(&volumes->pressures);
    FREE_ALL(volumes->of_point, volumes->share, volumes->ptr, volumes->slot, volumes->change, volumes->slope,
             volumes->content, volumes->pressure, volumes->direct, volumes->modulus, volumes->mean);
    *volumes = (struct nodal_volumes){0};
}
