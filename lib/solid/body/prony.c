#include "solid/body/prony.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "solid/body/nodal_volume.h"
#include "solid/body/stress.h"
#include "solid/material/tensor.h"

#include <math.h>
#include <string.h>

int prony_components(const struct body *body)
{
    return PRONY_OFFSETS + (body->smoothed ? CELL_EDGES(body->dim) * body->dim : 0);
}

/* Rows of the history. */
static int rows_of(const struct body *body)
{
    return prony_components(body) * (body->prony.terms + 2) + 1;
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
    int64_t points = body->point_count;
    for (int64_t m = 0; m < body->material_count; m++) {
        int terms = body->materials[m].prony_terms;
        prony->terms = terms > prony->terms ? terms : prony->terms;
    }
    if (prony->terms == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&prony->steps, 2 * body->material_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&prony->left, 2 * body->material_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&prony->history, points * rows_of(body), error));
    RETURN_IF_ERROR(NEW_ARRAY(&prony->rest, points * prony_components(body) + BODY_POINT_PADDING, error));
    RETURN_IF_ERROR(NEW_ARRAY(&prony->stress, points * PRONY_OFFSETS + BODY_POINT_PADDING, error));
    for (int64_t m = 0; m < body->material_count; m++) {
        prony->steps[body->material_count + m] = step_of(&body->materials[m], 0.0);
        prony->left[m] = 1.0;
    }
    set_steps(body, 0.0);
    prony->rest_step = NAN;
    return STATUS_OK;
}

void prony_free(struct prony *prony)
{
    FREE_ALL(prony->steps, prony->left, prony->history, prony->rest, prony->stress);
    time_error_free(&prony->time_error);
    *prony = (struct prony){0};
}

const struct prony_step *prony_steps(const struct body *body)
{
    return body->prony.steps + (body->prony.accepted ? body->material_count : 0);
}

/* Set the constants of a block: keep h - add X. */
static void set_block_rest(const struct body *body, const struct block *block)
{
    const struct prony *prony = &body->prony;
    int64_t components = prony_components(body), row = body->point_count;
    const struct prony_step *steps = prony_steps(body);
    for (int64_t c = 0; c < components; c++) {
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            const struct prony_step *step = &steps[body->material[q]];
            const double *X = prony->history + c * row + q;
            double sum = 0.0;
            for (int k = 0; k < prony->terms; k++) {
                sum += step->keep[k] * X[(k + 1) * components * row] - step->add[k] * X[0];
            }
            prony->rest[c * row + q] = sum;
        }
    }
}

void prony_prepare(struct body *body, bool all)
{
    struct prony *prony = &body->prony;
    const struct body_share *share = &body->share;
    double step = prony->accepted ? 0.0 : prony->step;
    if (prony->terms == 0 || (!all && prony->rest_step == step)) {
        return;
    }
    prony->rest_step = step;
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t b = all ? 0 : share->begin_block; b < (all ? body->block_count : share->end_block); b++) {
        if (body->blocks[b].relaxes) {
            set_block_rest(body, &body->blocks[b]);
        }
    }
}

/* S = F^-1 P */
static void second_stress(const double F[9], const double P[9], double S[PRONY_RATIO])
{
    double C[9], J = determinant(F);
    cofactor(F, C);
    for (int c = 0; c < PRONY_RATIO; c++) {
        int i = tensor_row[c], j = tensor_column[c];
        S[c] = (C[i] * P[j] + C[3 + i] * P[3 + j] + C[6 + i] * P[6 + j]) / J;
    }
}

void prony_stress(const struct body *body, int64_t q, const double F[9], double P[9], double *by_ratio)
{
    const struct prony *prony = &body->prony;
    double factor = prony_steps(body)[body->material[q]].factor, weight = body->weight[q];
    double S[PRONY_OFFSETS], rest[9], added[9];
    second_stress(F, P, S);
    S[PRONY_RATIO] = *by_ratio;
    for (int c = 0; c < PRONY_OFFSETS; c++) {
        prony->stress[c * body->point_count + q] = weight * S[c];
    }
    for (int k = 0; k < 9; k++) {
        rest[k] = prony->rest[tensor_component[k / 3][k % 3] * body->point_count + q] / weight;
    }
    multiply(F, rest, added);
    for (int k = 0; k < 9; k++) {
        P[k] = factor * P[k] + added[k];
    }
    *by_ratio = factor * *by_ratio + prony->rest[PRONY_RATIO * body->point_count + q] / weight;
}

/* What each component counts for in squares and products. */
static double count_of(int64_t component)
{
    return component > 2 && component < PRONY_RATIO ? 2.0 : 1.0;
}

/* |X|^2 of such rows, of S and of the offsets. */
static void squares(const struct body *body, const double *X, double square[2])
{
    square[0] = square[1] = 0.0;
    for (int64_t c = 0; c < prony_components(body); c++) {
        double value = X[c * body->point_count];
        square[c >= PRONY_OFFSETS] += c != PRONY_RATIO ? count_of(c) * value * value : 0.0;
    }
}

double prony_energy(const struct body *body, int64_t q, double W, double W_v, double *dissipated)
{
    const struct material *material = &body->materials[body->material[q]];
    const double *X = body->prony.history + q;
    double volume_modulus = material->shear_modulus * body->weight[q], share = 1.0, stored = 0.0, square[2];
    squares(body, X, square);
    double of_stress = 0.25 / volume_modulus, of_offsets = square[1] > 0.0 ? W_v / square[1] : 0.0;
    double whole = of_stress * square[0] + of_offsets * square[1];
    for (int k = 0; k < material->prony_terms; k++) {
        double g = material->prony[2 * k];
        squares(body, X + (k + 1) * prony_components(body) * body->point_count, square);
        double of_term = (of_stress * square[0] + of_offsets * square[1]) / g;
        share -= g;
        stored += whole > COARSE_ROUND_OFF * volume_modulus ? of_term * W / whole : fmax(of_term, g * W);
    }
    *dissipated += X[(rows_of(body) - 1) * body->point_count] - stored;
    return share * W + stored;
}

/* Of point q in a jump, which is from rest: the work of the terms is their share of the energy. */
static double jump_work(const struct body *body, int64_t q)
{
    const struct material *material = &body->materials[body->material[q]];
    double F[9], volumetric;
    stress_gradient(body, q, F);
    double coupling = stress_coupling_energy(body, q, F, body->J[q]);
    double W = body->weight[q] * (material_isochoric_energy(material, F) + coupling);
    W += body->smoothed ? stress_variance_energy(body, q, &volumetric) : 0.0;
    return (1.0 - material_long_term(material)) * W;
}

/* The state of a block evaluated last becomes its history. The work of the terms is that of their mean. */
static void accept_block(const struct body *body, int64_t b)
{
    const struct prony *prony = &body->prony;
    const struct block *block = &body->blocks[b];
    int64_t components = prony_components(body), row = body->point_count;
    double *work = prony->history + (rows_of(body) - 1) * row + block->first_point;
    prony_rows X, x;
    force_prony_state(body, b, X, x);
    for (int64_t c = 0; c < components; c++) {
        for (int64_t i = 0; i < block->point_count; i++) {
            double *before = prony->history + c * row + block->first_point + i, mean = 0.0;
            double *strain = before + (prony->terms + 1) * components * row;
            const struct prony_step *step = &prony->steps[body->material[block->first_point + i]];
            for (int k = 0; k < prony->terms; k++) {
                double *h = before + (k + 1) * components * row;
                double now = step->keep[k] * *h + step->add[k] * (X[c][i] - *before);
                mean += 0.5 * (*h + now);
                *h = now;
            }
            work[i] += count_of(c) * mean * (x[c][i] - *strain);
            *strain = x[c][i];
            *before = X[c][i];
        }
    }
    for (int64_t i = 0; i < block->point_count && !(prony->step > 0.0); i++) {
        work[i] = jump_work(body, block->first_point + i);
    }
}

void body_accept(struct body *body)
{
    struct prony *prony = &body->prony;
    if (prony->terms == 0 || prony->accepted) {
        return;
    }
    if (prony->time_error.rows != NULL) {
        time_error_note(body);
    }
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t b = body->share.begin_block; b < body->share.end_block; b++) {
        if (body->blocks[b].relaxes) {
            accept_block(body, b);
            set_block_rest(body, &body->blocks[b]);
        }
    }
    prony->rest_step = prony->step;
    prony->accepted = true;
}

void body_collect_history(struct body *body)
{
    for (int r = 0; body->prony.terms > 0 && r < rows_of(body); r++) {
        double *row = body->prony.history + r * body->point_count;
        ranks_gather(body->share.ranks, row, sizeof *row, body->share.point_first);
    }
}

void body_fade(struct body *body)
{
    const struct prony *prony = &body->prony;
    int64_t row = body->point_count, term = prony_components(body) * row;
    double *left = prony->left, *whole = left + body->material_count;
    if (prony->terms == 0) {
        return;
    }
    memset(left, 0, (size_t)(2 * body->material_count) * sizeof *left);
    for (int64_t i = 0; i < PRONY_RATIO * row; i++) {
        const double *X = prony->history + i;
        int32_t m = body->material[i % row];
        const struct material *material = &body->materials[m];
        double strain = count_of(i / row) * X[(prony->terms + 1) * term];
        whole[m] += strain * *X;
        left[m] += strain * material_long_term(material) * *X;
        for (int k = 0; k < material->prony_terms; k++) {
            left[m] += strain * X[(k + 1) * term];
        }
    }
    for (int64_t m = 0; m < body->material_count; m++) {
        double least = material_long_term(&body->materials[m]);
        left[m] = whole[m] > 0.0 ? fmin(fmax(left[m] / whole[m], least), 1.0) : 1.0;
    }
    stiffening_take(body);
}

enum status prony_state(struct body *body, const struct state *state, struct error *error)
{
    struct prony *prony = &body->prony;
    if (prony->terms == 0) {
        return STATUS_OK;
    }
    const struct state_value values[] = {
        {"history", STATE_NUMBERS, prony->history, body->point_count * rows_of(body)},
        {"step", STATE_NUMBERS, &prony->step, 1},
        {"left", STATE_NUMBERS, prony->left, body->material_count},
        {"accepted", STATE_FLAGS, &prony->accepted, 1}};
    RETURN_IF_ERROR(state_visit(state, "prony", values, 4, error));
    set_steps(body, prony->step);
    prony->rest_step = NAN;
    return time_error_state(body, state, error);
}
