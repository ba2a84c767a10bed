#include "solid/body/prony.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "solid/body/stress.h"
#include "solid/material/tensor.h"

#include <math.h>

enum { STRESS = 0, STRAIN = 6, WORK = 12, TERMS = 13, COMPONENTS = 6 };

static const int place[COMPONENTS] = {0, 4, 8, 1, 5, 2}; /* of the components in a matrix */

int prony_row(const struct prony *prony)
{
    return TERMS + COMPONENTS * prony->terms;
}

static struct prony_step step_of(const struct material *material, double dt)
{
    struct prony_step step = {.factor = 1.0};
    for (int k = 0; k < material->prony_terms; k++) {
        double g = material->prony[2 * k], x = dt / material->prony[2 * k + 1];
        step.keep[k] = exp(-x);
        step.add[k] = x > 0.0 ? -g * expm1(-x) / x : g;
        step.factor += step.add[k] - g;
    }
    return step;
}

/* Set the steps of all materials: the first ones to dt. */
static void set_steps(struct body *body, double dt)
{
    for (int64_t m = 0; m < body->material_count; m++) {
        body->prony.steps[m] = step_of(&body->materials[m], dt);
    }
    body->prony.step = dt;
}

void body_step(struct body *body, double dt)
{
    struct prony *prony = &body->prony;
    if (prony->terms > 0 && dt != prony->step) {
        set_steps(body, dt);
    }
    prony->accepted = false;
}

enum status prony_build(struct body *body, struct error *error)
{
    struct prony *prony = &body->prony;
    for (int64_t m = 0; m < body->material_count; m++) {
        int terms = body->materials[m].prony_terms;
        prony->terms = terms > prony->terms ? terms : prony->terms;
    }
    if (prony->terms == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&prony->steps, 2 * body->material_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&prony->history, body->point_count * prony_row(prony), error));
    RETURN_IF_ERROR(NEW_ARRAY(&prony->stress, body->point_count * COMPONENTS, error));
    for (int64_t m = 0; m < body->material_count; m++) {
        prony->steps[body->material_count + m] = step_of(&body->materials[m], 0.0);
    }
    set_steps(body, 0.0);
    return STATUS_OK;
}

void prony_free(struct prony *prony)
{
    FREE_ALL(prony->steps, prony->history, prony->stress);
    *prony = (struct prony){0};
}

static const struct prony_step *present_step(const struct body *body, int64_t q)
{
    const struct prony *prony = &body->prony;
    return prony->steps + body->material[q] + (prony->accepted ? body->material_count : 0);
}

static double *history_of(const struct body *body, int64_t q)
{
    return body->prony.history + q * prony_row(&body->prony);
}

/* S = F^-1 P */
static void second_stress(const double F[9], const double P[9], double S[COMPONENTS])
{
    double C[9], J = determinant(F);
    cofactor(F, C);
    for (int c = 0; c < COMPONENTS; c++) {
        int i = place[c] / 3, j = place[c] % 3;
        S[c] = (C[i] * P[j] + C[3 + i] * P[3 + j] + C[6 + i] * P[6 + j]) / J;
    }
}

/* Component c of term k at the end of the step, at which S is `stress`. */
static inline double term(const struct prony_step *step, const double *history, int k, int c, double stress)
{
    return step->keep[k] * history[TERMS + COMPONENTS * k + c] + step->add[k] * (stress - history[c]);
}

void prony_stress(const struct body *body, int64_t q, const double F[9], double P[9])
{
    const struct material *material = &body->materials[body->material[q]];
    if (material->prony_terms == 0) {
        return;
    }
    const struct prony_step *step = present_step(body, q);
    const double *history = history_of(body, q);
    double *S = body->prony.stress + q * COMPONENTS, rest[9], added[9];
    second_stress(F, P, S);
    for (int c = 0; c < COMPONENTS; c++) {
        double sum = 0.0;
        for (int k = 0; k < material->prony_terms; k++) {
            sum += term(step, history, k, c, 0.0);
        }
        rest[place[c]] = sum;
    }
    rest[3] = rest[1];
    rest[7] = rest[5];
    rest[6] = rest[2];
    multiply(F, rest, added);
    for (int k = 0; k < 9; k++) {
        P[k] = step->factor * P[k] + added[k];
    }
}

/* A : B of symmetric tensors. */
static double contract(const double A[COMPONENTS], const double B[COMPONENTS])
{
    return A[0] * B[0] + A[1] * B[1] + A[2] * B[2] + 2.0 * (A[3] * B[3] + A[4] * B[4] + A[5] * B[5]);
}

double prony_energy(const struct body *body, int64_t q, const double F[9], double W, double *dissipated)
{
    const struct material *material = &body->materials[body->material[q]];
    if (material->prony_terms == 0) {
        return W;
    }
    const struct prony_step *step = present_step(body, q);
    const double *history = history_of(body, q);
    double P[9], S[COMPONENTS], h[COMPONENTS], share = 1.0, stored = 0.0, mu = material->shear_modulus;
    material_isochoric_stress(material, F, P);
    second_stress(F, P, S);
    double compliance = W > COARSE_ROUND_OFF * mu ? W / contract(S, S) : 0.25 / mu;
    for (int k = 0; k < material->prony_terms; k++) {
        double g = material->prony[2 * k];
        for (int c = 0; c < COMPONENTS; c++) {
            h[c] = term(step, history, k, c, S[c]);
        }
        share -= g;
        stored += contract(h, h) / g * compliance;
    }
    *dissipated = history[WORK] - stored;
    return share * W + stored;
}

/* The step of point q becomes its history. The work of the terms is that of their mean, and in a jump, which
 * is from rest, their share of W. */
static void accept_point(struct body *body, int64_t q)
{
    const struct material *material = &body->materials[body->material[q]];
    const struct prony_step *step = present_step(body, q);
    const double *S = body->prony.stress + q * COMPONENTS;
    double *history = history_of(body, q), F[9], E[9], mean[COMPONENTS] = {0.0}, change[COMPONENTS];
    double share = 0.0;
    for (int k = 0; k < material->prony_terms; k++) {
        share += material->prony[2 * k];
    }
    stress_matrix(body->dim, body->F + q, body->point_count, F);
    green_lagrange(F, E);
    for (int c = 0; c < COMPONENTS; c++) {
        for (int k = 0; k < material->prony_terms; k++) {
            double *h = &history[TERMS + COMPONENTS * k + c], now = term(step, history, k, c, S[c]);
            mean[c] += 0.5 * (*h + now);
            *h = now;
        }
        change[c] = E[place[c]] - history[STRAIN + c];
        history[STRAIN + c] = E[place[c]];
        history[STRESS + c] = S[c];
    }
    history[WORK] +=
        body->prony.step > 0.0 ? contract(mean, change) : share * material_isochoric_energy(material, F);
}

void body_accept(struct body *body)
{
    if (body->prony.terms == 0 || body->prony.accepted) {
        return;
    }
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t q = body->share.begin_point; q < body->share.end_point; q++) {
        if (body->materials[body->material[q]].prony_terms > 0) {
            accept_point(body, q);
        }
    }
    body->prony.accepted = true;
}

void body_collect_history(struct body *body)
{
    const struct prony *prony = &body->prony;
    if (prony->terms > 0) {
        ranks_gather(body->share.ranks, prony->history, (size_t)prony_row(prony) * sizeof(double),
                     body->share.point_first);
    }
}

enum status prony_state(struct body *body, const struct state *state, struct error *error)
{
    struct prony *prony = &body->prony;
    const struct state_value values[] = {
        {"history", STATE_NUMBERS, prony->history, body->point_count * prony_row(prony)},
        {"step", STATE_NUMBERS, &prony->step, 1},
        {"accepted", STATE_FLAGS, &prony->accepted, 1}};
    if (prony->terms == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(state_visit(state, "prony", values, 3, error));
    set_steps(body, prony->step);
    return STATUS_OK;
}
