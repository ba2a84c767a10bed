#include "solid/body/time_error.h"

#include "base/memory.h"
#include "solid/body/kernel.h"

#include <math.h>

/* Rows: the rates, what is summed over the points, and the terms. */
enum { ERROR = PRONY_RATIO, STEADY, STRESS, TERMS };

/* Per step. */
static const double most_growth = 2.0, least_growth = 0.2;

static int rows_of(const struct body *body)
{
    return TERMS + body->prony.terms;
}

enum status body_estimate_time_error(struct body *body, struct error *error)
{
    struct time_error *estimate = &body->prony.time_error;
    return body->prony.terms > 0 ? NEW_ARRAY(&estimate->rows, body->point_count * rows_of(body), error)
                                 : STATUS_OK;
}

void time_error_free(struct time_error *estimate)
{
    FREE_ALL(estimate->rows);
}

/* d of x, for small x by its series. */
static double defect(double x)
{
    return x < 1e-3 ? x * x * x / 12.0 : 0.5 * x - 1.0 + exp(-x) * (1.0 + 0.5 * x);
}

/* Of a point whose S changes by X'' of that norm: the error, and what it would be after many such steps. In
 * the first step after a jump the change is not known; it is taken from the second. */
static void note_terms(struct body *body, int64_t q, double change, double *error, double *steady)
{
    const struct time_error *estimate = &body->prony.time_error;
    const struct material *material = &body->materials[body->material[q]];
    for (int k = 0; k < material->prony_terms; k++) {
        double g = material->prony[2 * k], tau = material->prony[2 * k + 1];
        double x = body->prony.step / tau, d = defect(x);
        double *bound = estimate->rows + (TERMS + k) * body->point_count + q;
        double first = estimate->steps == 1 ? exp(-x) * defect(estimate->before / tau) : 0.0;
        *bound = exp(-x) * *bound + g * tau * tau * (d + first) * change;
        *error += *bound;
        *steady += x > 0.0 ? g * tau * tau * d / -expm1(-x) * change : 0.0;
    }
}

/* The stress of a component with the terms, of which X is what relaxes. */
static double whole_stress(const struct body *body, int64_t q, int c, double X)
{
    const struct prony *prony = &body->prony;
    const struct material *material = &body->materials[body->material[q]];
    const struct prony_step *step = &prony->steps[body->material[q]];
    int64_t row = body->point_count;
    const double *before = prony->history + c * row + q;
    double sum = step->factor * X;
    for (int k = 0; k < material->prony_terms; k++) {
        sum += step->keep[k] * before[(k + 1) * prony_components(body) * row] - step->add[k] * *before;
    }
    return sum;
}

static void note_block(struct body *body, int64_t b)
{
    struct time_error *estimate = &body->prony.time_error;
    const struct block *block = &body->blocks[b];
    double dt = body->prony.step, apart = 0.5 * (dt + estimate->before);
    prony_rows X, x;
    force_prony_state(body, b, X, x);
    for (int64_t i = 0; i < block->point_count; i++) {
        int64_t q = block->first_point + i, row = body->point_count;
        double *rows = estimate->rows + q, change = 0.0, stress = 0.0, error = 0.0, steady = 0.0;
        for (int c = 0; c < PRONY_RATIO; c++) {
            double count = tensor_row[c] == tensor_column[c] ? 1.0 : 2.0;
            double rate = dt > 0.0 ? (X[c][i] - body->prony.history[c * row + q]) / dt : 0.0;
            double second = estimate->steps > 0 ? (rate - rows[c * row]) / apart : 0.0;
            double whole = whole_stress(body, q, c, X[c][i]);
            change += count * second * second;
            stress += count * whole * whole;
            rows[c * row] = rate;
        }
        note_terms(body, q, sqrt(change), &error, &steady);
        rows[ERROR * row] = error * error / body->weight[q];
        rows[STEADY * row] = steady * steady / body->weight[q];
        rows[STRESS * row] = stress / body->weight[q];
    }
}

/* The root of the sum of a row over the points, by that of the volume. */
static double norm(const struct body *body, int row)
{
    double sum = 0.0;
    for (int64_t q = 0; q < body->point_count; q++) {
        sum += body->prony.time_error.rows[row * body->point_count + q];
    }
    return sqrt(sum / body_volume(body));
}

void time_error_note(struct body *body)
{
    struct time_error *estimate = &body->prony.time_error;
#pragma omp parallel for schedule(static) num_threads(body->threads)
    for (int64_t b = body->share.begin_block; b < body->share.end_block; b++) {
        if (body->blocks[b].relaxes) {
            note_block(body, b);
        }
    }
    for (int r = 0; r < rows_of(body); r++) {
        double *row = estimate->rows + r * body->point_count;
        ranks_gather(body->share.ranks, row, sizeof *row, body->share.point_first);
    }
    estimate->steps = body->prony.step > 0.0 ? estimate->steps + 1 : 0;
    estimate->before = body->prony.step;
    estimate->stress = fmax(estimate->stress, norm(body, STRESS));
    estimate->largest = fmax(estimate->largest, norm(body, ERROR));
    estimate->steady = norm(body, STEADY);
}

double body_time_error(const struct body *body)
{
    const struct time_error *estimate = &body->prony.time_error;
    return estimate->stress > 0.0 ? estimate->largest / estimate->stress : 0.0;
}

double body_first_step(const struct body *body, double error)
{
    double fastest = 0.0;
    for (int64_t m = 0; m < body->material_count; m++) {
        const struct material *material = &body->materials[m];
        double rate = 0.0;
        for (int k = 0; k < material->prony_terms; k++) {
            rate += material->prony[2 * k] / material->prony[2 * k + 1];
        }
        fastest = fmax(fastest, rate);
    }
    return sqrt(12.0 * error) / fastest;
}

double body_next_step(const struct body *body, double error)
{
    const struct time_error *estimate = &body->prony.time_error;
    double by = error * estimate->stress / estimate->steady;
    return estimate->steps < 2 || !(by < most_growth * most_growth) ? most_growth
                                                                    : fmax(least_growth, sqrt(by));
}

void body_turn(struct body *body)
{
    body->prony.time_error.steps = 0;
}

enum status time_error_state(struct body *body, const struct state *state, struct error *error)
{
    struct time_error *estimate = &body->prony.time_error;
    const struct state_value values[] = {
        {"rows", STATE_NUMBERS, estimate->rows, body->point_count * rows_of(body)},
        {"steps", STATE_COUNTS, &estimate->steps, 1},
        {"before", STATE_NUMBERS, &estimate->before, 1},
        {"stress", STATE_NUMBERS, &estimate->stress, 1},
        {"largest", STATE_NUMBERS, &estimate->largest, 1},
        {"steady", STATE_NUMBERS, &estimate->steady, 1}};
    return estimate->rows != NULL ? state_visit(state, "time_error", values, 6, error) : STATUS_OK;
}
