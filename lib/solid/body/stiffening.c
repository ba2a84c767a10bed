#include "solid/body/stiffening.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"
#include "solid/body/body.h"
#include "solid/body/nodal_volume.h"
#include "solid/body/stress.h"
#include "solid/material/law.h"
#include "solid/material/tensor.h"

#include <math.h>
#include <string.h>

static bool may_stiffen(const struct material *material)
{
    return material->model != MATERIAL_NEO_HOOKEAN && material_is_isochoric(material);
}

enum status stiffening_build(struct body *body, struct error *error)
{
    struct stiffening *stiffening = &body->stiffening;
    bool any = false;
    for (int64_t m = 0; m < body->material_count; m++) {
        any = any || may_stiffen(&body->materials[m]);
    }
    if (!any) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&stiffening->of_point, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&stiffening->next, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&stiffening->work, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&stiffening->of_material, 2 * body->material_count, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        stiffening->of_point[q] = 1.0;
    }
    for (int64_t m = 0; m < body->material_count; m++) {
        stiffening->of_material[m] = 1.0;
    }
    return STATUS_OK;
}

void stiffening_free(struct stiffening *stiffening)
{
    FREE_ALL(stiffening->of_point, stiffening->next, stiffening->work, stiffening->of_material);
    *stiffening = (struct stiffening){0};
}

double stiffening_at(const struct body *body, int64_t q)
{
    return body->stiffening.of_point != NULL ? body->stiffening.of_point[q] : 1.0;
}

/* S : E, Pa, of an isochoric law of stress P: as S : C = 0 it is -tr S / 2. */
static double work_of(const double F[9], const double P[9])
{
    double C[9];
    cofactor(F, C);
    return -0.5 * vector_dot(9, C, P) / determinant(F);
}

/* The deviator of the Green-Lagrange strain. */
static void find_deviator(const double F[9], double e[9])
{
    green_lagrange(F, e);
    double third = (e[0] + e[4] + e[8]) / 3.0;
    for (int k = 0; k < 3; k++) {
        e[4 * k] -= third;
    }
}

/* Set the work at rest of a point. Returns that of its law by this one. A strain that is round-off, or one
 * where the law has no stress, has none. */
static double stiffness_of(const struct body *body, int64_t q, double *at_rest)
{
    const struct material *material = &body->materials[body->material[q]];
    double F[9], e[9], P[9], P_rest[9], mu = material->shear_modulus;
    stress_gradient(body, q, F);
    find_deviator(F, e);
    double square = vector_dot(9, e, e);
    *at_rest = 0.0;
    if (!may_stiffen(material) || !(determinant(F) > 0.0) || !(square > COARSE_ROUND_OFF)) {
        return 1.0;
    }
    material_isochoric_stress(material, F, P);
    neo_hookean_stress(mu, F, P_rest);
    double rest = work_of(F, P_rest) * material_rest_energy(material, e) / (mu * square);
    double by_rest = work_of(F, P) / rest;
    if (!(rest > 0.0 && isfinite(by_rest))) {
        return 1.0;
    }
    *at_rest = body->weight[q] * rest;
    return fmax(by_rest, 1.0);
}

/* Set next and work of all points, by all processes. */
static void find_next(struct body *body)
{
    struct stiffening *stiffening = &body->stiffening;
    const struct body_share *share = &body->share;
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t q = share->begin_point; q < share->end_point; q++) {
        stiffening->next[q] = stiffness_of(body, q, &stiffening->work[q]);
    }
    ranks_gather(share->ranks, stiffening->next, sizeof *stiffening->next, share->point_first);
    ranks_gather(share->ranks, stiffening->work, sizeof *stiffening->work, share->point_first);
}

/* The means over the points of each material. */
static void average(struct body *body)
{
    struct stiffening *stiffening = &body->stiffening;
    double *mean = stiffening->of_material, *rest = mean + body->material_count;
    for (int64_t m = 0; m < body->material_count; m++) {
        mean[m] = rest[m] = 0.0;
    }
    for (int64_t q = 0; q < body->point_count; q++) {
        mean[body->material[q]] += stiffening->work[q] * stiffening->of_point[q];
        rest[body->material[q]] += stiffening->work[q];
    }
    for (int64_t m = 0; m < body->material_count; m++) {
        mean[m] = rest[m] > 0.0 ? mean[m] / rest[m] : 1.0;
    }
}

void stiffening_take(struct body *body)
{
    const double *by = body->stiffening.of_material, *left = body->prony.left;
    for (int64_t m = 0; m < body->material_count; m++) {
        body->materials[m].stiffness = (by != NULL ? by[m] : 1.0) * (left != NULL ? left[m] : 1.0);
    }
    smoothed_cells_renew(body);
    nodal_volumes_renew(body);
}

bool body_stiffen(struct body *body, double most)
{
    struct stiffening *stiffening = &body->stiffening;
    double change = 0.0, work = 0.0;
    if (stiffening->of_point == NULL) {
        return false;
    }
    find_next(body);
    for (int64_t q = 0; q < body->point_count; q++) {
        change += stiffening->work[q] * fabs(stiffening->next[q] - stiffening->of_point[q]);
        work += stiffening->work[q] * stiffening->next[q];
    }
    if (!(change > most * work)) {
        return false;
    }
    memcpy(stiffening->of_point, stiffening->next, (size_t)body->point_count * sizeof *stiffening->next);
    average(body);
    stiffening_take(body);
    return true;
}

enum status stiffening_state(struct body *body, const struct state *state, struct error *error)
{
    struct stiffening *stiffening = &body->stiffening;
    const struct state_value values[] = {
        {"of_point", STATE_NUMBERS, stiffening->of_point, body->point_count},
        {"of_material", STATE_NUMBERS, stiffening->of_material, body->material_count}};
    if (stiffening->of_point != NULL) {
        RETURN_IF_ERROR(state_visit(state, "stiffening", values, 2, error));
    }
    if (stiffening->of_point != NULL || body->prony.terms > 0) {
        stiffening_take(body);
    }
    return STATUS_OK;
}
