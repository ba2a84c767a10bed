/* The length of the steps of explicit dynamics, and the move itself. */
#include "solid/dynamics/dynamics_private.h"

#include "solid/contact/contact_between.h"
#include "solid/preconditioner/frequency.h"

#include <omp.h>
#include <math.h>

double dynamics_time_now(const struct dynamics *d)
{
    return d->left == 0 ? d->options->end_time : d->mark + (double)d->done * d->step;
}

double dynamics_time_next(const struct dynamics *d)
{
    return d->left == 1 ? d->options->end_time : d->mark + (double)(d->done + 1) * d->step;
}

/* The bound of M^-1 K for the penalties of all contacts. */
void dynamics_bound_contacts(struct dynamics *d)
{
    const struct solid_system *system = d->system;
    double *stiffness = d->scratch;
    for (int64_t n = 0; n < system->node_count; n++) {
        stiffness[n] = 0.0;
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_add_to_bound(&system->contacts[c], true, stiffness);
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        d->contact_squared = fmax(d->contact_squared, stiffness[n] / system->lumped_mass[n]);
    }
}

void dynamics_estimate_frequency(struct dynamics *d, int iterations)
{
    struct preconditioner preconditioner = {
        .dim = d->system->dim, .node_count = d->system->node_count, .mass = d->system->lumped_mass};
    double frequency = system_largest_frequency(d->system, &preconditioner, d->u, d->residual, iterations,
                                                d->mode, d->scratch);
    d->report->force_evaluations += iterations;
    frequency = sqrt(frequency * frequency + d->contact_squared);
    /* The estimate is a lower bound that fluctuates: follow a rise at once, a fall slowly. */
    d->frequency = frequency > d->frequency ? frequency : 0.98 * d->frequency + 0.02 * frequency;
}

bool dynamics_choose_step(struct dynamics *d)
{
    struct dynamics_report *report = d->report;
    double margin = d->options->time_step_margin, critical = 2.0 / d->frequency;
    double too_long = (margin + 0.3 * (1.0 - margin)) * critical, too_short = 0.8 * margin * critical;
    bool is_first = d->step == 0.0;
    if (!is_first && d->step <= too_long && d->step >= too_short) {
        return true;
    }
    double now = is_first ? 0.0 : dynamics_time_now(d), to_go = d->options->end_time - now;
    double steps = ceil(to_go / (margin * critical));
    if (!(steps < 1e15) || (!is_first && to_go / steps < DYNAMICS_LEAST_STEP * report->first_step &&
                            margin * critical < DYNAMICS_LEAST_STEP * report->first_step)) {
        return false;
    }
    d->left = steps > 1.0 ? (int64_t)steps : 1;
    d->mark = now;
    d->done = 0;
    d->step = to_go / (double)d->left;
    if (is_first) {
        report->first_step = report->least_step = d->step;
        report->critical_step = critical;
        d->previous_step = d->step;
    } else {
        report->least_step = fmin(report->least_step, d->step);
        report->step_changes++;
    }
    return true;
}

bool dynamics_weigh_dashpots(struct dynamics *d, struct error *error)
{
    const struct solid_system *system = d->system;
    if (d->drag == NULL || d->weighed_step == d->step) {
        return true;
    }
    double half = 0.5 * d->step / (1.0 + 0.5 * d->options->damping * d->step);
    for (int64_t n = 0; n < system->node_count; n++) {
        d->mass[n] = system->lumped_mass[n] + half * system->dashpot[n];
    }
    d->weighed_step = d->step;
    if (system->rows.count > 0) {
        constraint_free(&d->constraint);
        d->failure = constraint_build(&system->rows, system->node_count, d->mass, &d->constraint, error);
    }
    return d->failure == STATUS_OK;
}

/* The forces of the dashpots in a step that has been made. */
static void find_drag(struct dynamics *d, double push)
{
    const struct solid_system *system = d->system;
    for (int64_t i = 0; i < d->size; i++) {
        int64_t n = i / system->dim;
        double added = d->mass[n] - system->lumped_mass[n];
        d->drag[i] = system->dashpot[n] * d->before[i] + added / push * (d->after[i] - d->before[i]);
    }
}

void dynamics_advance(struct dynamics *d, bool is_first)
{
    const struct solid_system *system = d->system;
    int dim = system->dim;
    double c = d->options->damping, dt = d->step, h = 0.5 * (d->previous_step + dt);
    double grow = 1.0 + 0.5 * c * h, keep = (1.0 - 0.5 * c * h) / grow, push = h / grow;
    if (is_first) { /* from the velocity at time 0 */
        keep = 1.0 - 0.5 * c * dt;
        push = 0.5 * dt;
    }
    double *move = d->after;
    for (int64_t n = 0; n < system->node_count; n++) {
        double share = push / d->mass[n], kept = keep;
        if (d->drag != NULL) { /* c v-, and the momentum of the added mass */
            double whole = system->lumped_mass[n];
            kept = (keep * whole + d->mass[n] - whole - push * system->dashpot[n]) / d->mass[n];
        }
        for (int64_t i = n * dim; i < (n + 1) * dim; i++) {
            move[i] = dt * (kept * d->before[i] + share * d->residual[i]);
        }
    }
    if (system->rows.count > 0) {
        double started = omp_get_wtime();
        for (int64_t i = 0; i < system->curve_count; i++) {
            d->factor_change[i] = d->factor_after[i] - d->factor_now[i];
        }
        constraint_project(&d->constraint, d->factor_change, move);
        for (int64_t r = 0; r < system->rows.count; r++) {
            d->constraint.multiplier[r] /= dt * push;
        }
        d->system->cost.constraints += omp_get_wtime() - started;
    }
    for (int64_t i = 0; i < d->size; i++) {
        d->next[i] = d->u[i] + move[i];
        d->after[i] = move[i] / dt;
    }
    if (d->drag != NULL) {
        find_drag(d, push);
    }
    if (is_first) { /* the velocity half a step before the start, with the same acceleration */
        for (int64_t i = 0; i < d->size; i++) {
            d->before[i] = 2.0 * d->before[i] - d->after[i];
        }
    }
}
