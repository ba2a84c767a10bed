/* How far a relaxation is from equilibrium, and its damping. */
#include "solid/preconditioner/frequency.h"
#include "solid/relaxation/relaxation_private.h"

#include "base/memory.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979324;
static const double most_growth = 2.0; /* of the damping's square, from check to check */
/* On the estimate: several modes may be left, and the norms are not the mass's own. Costs a few steps. */
static const double safety = 2.0;
static const int most_spectrum_iterations = 1000;
static const double spectrum_share = 0.8; /* of its estimate from above */

static double ratio(double part, double whole)
{
    return whole > 0.0 ? part / whole : part > 0.0 ? INFINITY : 0.0;
}

/* The scale of errors for a field that is that large now; updates the largest so far. */
static double scale(const struct relaxation *r, double now, double *largest)
{
    *largest = fmax(*largest, now);
    return fmax(now, r->options->tolerance * *largest);
}

/* The lowest frequency that recent estimates have shown, squared. */
static double least_of_window(const struct relaxation *r)
{
    double least_eigenvalue = INFINITY;
    for (int i = 0; i < WINDOWS; i++) {
        least_eigenvalue = fmin(least_eigenvalue, r->window[i]);
    }
    return least_eigenvalue;
}

void relaxation_estimate(struct relaxation *r)
{
    double *du = r->scratch, along = 0.0; /* the change of the residual along du */
    for (int64_t i = 0; i < r->size; i++) {
        du[i] = r->before[i] - r->last_u[i];
    }
    r->moved = vector_longest(r->system->dim, r->system->node_count, du, NULL);
    memcpy(r->last_u, r->before, (size_t)r->size * sizeof *r->before);
    constraint_project(&r->preconditioner.constraint, NULL, du);
    for (int64_t i = 0; i < r->size; i++) {
        along += du[i] * (r->last_residual[i] - r->residual[i]);
    }
    memcpy(r->last_residual, r->residual, (size_t)r->size * sizeof *r->residual);
    double bottom = preconditioner_square(&r->preconditioner, du);
    double quotient = r->quotient = bottom > 0.0 ? along / bottom : 0.0;
    bool augmented = r->report->steps - r->augmented_step < CHECK_INTERVAL;
    if (quotient > 0.0 && r->checks > 0 && !augmented) {
        quotient = fmin(quotient, r->frequency * r->frequency);
        r->lowest_eigenvalue =
            quotient < r->lowest_eigenvalue ? quotient : fmin(quotient, most_growth * r->lowest_eigenvalue);
        r->lowest_eigenvalue = fmin(r->lowest_eigenvalue, r->lanczos_bound);
        r->damping = 2.0 * sqrt(r->lowest_eigenvalue);
        r->window[r->checks % WINDOWS] = r->lowest_eigenvalue;
    }
    r->checks++;
    double least_eigenvalue = least_of_window(r);
    r->displacement = scale(r, sqrt(preconditioner_square_diagonal(&r->preconditioner, r->before)),
                            &r->largest_displacement);
    r->move =
        scale(r, vector_longest(r->system->dim, r->system->node_count, r->before, NULL), &r->largest_move);
    double on_the_whole =
        ratio(sqrt(preconditioner_square_diagonal(&r->preconditioner, r->acceleration)) / least_eigenvalue,
              r->displacement);
    double at_worst =
        ratio(vector_longest(r->system->dim, r->system->node_count, r->acceleration, &r->report->worst_node) /
                  least_eigenvalue,
              r->move);
    /* Moves below the round-off of positions are none. */
    bool at_rest = r->move <= DBL_EPSILON * r->body_size;
    r->report->error = at_rest ? 0.0 : safety * fmax(on_the_whole, at_worst);
    r->report->lowest_frequency = sqrt(least_eigenvalue);
}

bool relaxation_find_spectrum(struct relaxation *r, const double *u, int most_iterations,
                              struct spectrum *spectrum, struct error *error)
{
    r->failure = system_spectrum(r->system, &r->preconditioner, u, r->residual, most_iterations, r->velocity,
                                 r->scratch, spectrum, error);
    r->report->force_evaluations += spectrum->iterations;
    return r->failure == STATUS_OK;
}

void relaxation_damp_at_most(struct relaxation *r, double lowest_eigenvalue)
{
    r->lowest_eigenvalue = fmin(r->lowest_eigenvalue, lowest_eigenvalue);
    r->damping = 2.0 * sqrt(r->lowest_eigenvalue);
    for (int i = 0; i < WINDOWS; i++) {
        r->window[i] = fmin(r->window[i], r->lowest_eigenvalue);
    }
}

/* Whether the state u, of which that is the spectrum, is stable. Stiffness is known to about the error of the
 * state, by the largest. False on failure. */
static bool note_stability(struct relaxation *r, const double *u, const struct spectrum *spectrum,
                           struct error *error)
{
    struct stability *stability = &r->system->stability;
    r->failure = system_unstable_mode(r->system, &r->preconditioner, u, r->residual, spectrum, r->velocity,
                                      r->scratch, stability, error);
    if (stability->least > -r->report->error) {
        stability->least = fmax(stability->least, 0.0);
    }
    return r->failure == STATUS_OK;
}

bool relaxation_find_lowest_mode(struct relaxation *r, const double *u, struct error *error)
{
    struct spectrum spectrum;
    if (!relaxation_find_spectrum(r, u, most_spectrum_iterations, &spectrum, error) ||
        !note_stability(r, u, &spectrum, error)) {
        return false;
    }
    r->lanczos_bound = INFINITY;
    if (spectrum.lowest > 0.0 && isfinite(spectrum.lowest)) {
        r->lanczos_bound = spectrum_share * spectrum.lowest;
        relaxation_damp_at_most(r, r->lanczos_bound);
        double least_eigenvalue = least_of_window(r);
        r->report->error *= r->report->lowest_frequency * r->report->lowest_frequency / least_eigenvalue;
        r->report->lowest_frequency = sqrt(least_eigenvalue);
    }
    r->spectrum_known = true;
    return true;
}

bool relaxation_stays(const struct relaxation *r, double periods, int64_t steps)
{
    double period = 2.0 * pi / (r->report->lowest_frequency * r->time_step);
    return (double)(r->report->steps - r->best_step) > periods * period + (double)steps;
}

double relaxation_round_off(const struct relaxation *r)
{
    double low = r->report->lowest_frequency;
    return 32.0 * DBL_EPSILON * r->spacing / (low * low * r->move);
}

void relaxation_note_best(struct relaxation *r)
{
    if (r->held_steps <= CHECK_INTERVAL || r->report->error < 0.5 * r->best_error) {
        r->best_error = r->report->error;
        r->best_step = r->report->steps;
    }
}
