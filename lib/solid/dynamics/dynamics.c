#include "solid/dynamics/dynamics_private.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

static const int64_t check_interval = 20; /* steps between estimates of the critical step */
static const int first_iterations = 40;   /* of the power iteration, at the start */
static const int later_iterations = 1;    /* at every check; the mode is kept from check to check */
static const double samples = 200.0;      /* of the energies, over the run */

/* Factors of the load curves at a time. Beyond the end they are extrapolated linearly, so that the prescribed
 * velocity does not jump there. */
static void factors_at(const struct dynamics *d, double time, double *factor)
{
    double s = time / d->options->end_time;
    for (int64_t i = 0; i < d->system->curve_count; i++) {
        const struct load_curve *curve = &d->system->curves[i];
        factor[i] = curve_value(curve, s) + (s > 1.0 ? (s - 1.0) * curve_rate(curve, 1.0) : 0.0);
    }
}

/* Give the frames between this step and the next one, by linear interpolation: the velocity is constant
 * there. */
static void give_frames(struct dynamics *d)
{
    const struct dynamics_options *options = d->options;
    double now = dynamics_time_now(d), next = dynamics_time_next(d), slack = 1e-9 * options->end_time;
    while (options->frame != NULL && options->frame_interval > 0.0) {
        double time = (double)(d->frames + 1) * options->frame_interval;
        if (!(time <= next + slack)) {
            return;
        }
        double share = fmin(1.0, (time - now) / (next - now));
        for (int64_t i = 0; i < d->size; i++) {
            d->scratch[i] = d->u[i] + share * (d->next[i] - d->u[i]);
        }
        options->frame(options->context, ++d->frames, time, d->scratch);
    }
}

static bool tell(struct dynamics *d)
{
    body_collect_history(&d->system->body);
    double now = dynamics_time_now(d);
    struct progress progress = {.step = d->report->steps,
                                .time = now,
                                .error = d->report->last_drift,
                                .remaining = 1.0 - now / d->options->end_time,
                                .u = d->u,
                                .state = dynamics_visit,
                                .run = d};
    return d->options->progress == NULL || d->options->progress(d->options->context, &progress);
}

static void swap(double **a, double **b)
{
    double *kept = *a;
    *a = *b;
    *b = kept;
}

/* Set the load factors of the system to those of this step. */
static void use_factors(struct dynamics *d)
{
    for (int64_t i = 0; i < d->system->curve_count; i++) {
        d->system->factor[i] = d->factor_now[i];
    }
}

/* Residual, loads and least J at u; false when a point is inverted. */
static bool evaluate(struct dynamics *d)
{
    struct solid_system *system = d->system;
    use_factors(d);
    struct deformation deformation = system_residual(system, d->u, d->residual);
    d->report->force_evaluations++;
    d->report->least_jacobian = deformation.least_jacobian;
    d->report->point = deformation.point;
    if (d->loads != NULL) {
        memset(d->loads, 0, (size_t)d->size * sizeof *d->loads);
        system_add_loads(system, d->u, d->loads);
    }
    for (int32_t c = 0; d->stored != NULL && c < system->curve_count; c++) {
        d->stored[c] = d->prestressed[c] ? energy_of_prestress(system, d->u, c) : 0.0;
    }
    return deformation.least_jacobian > 0.0;
}

/* Go on to the next step. */
static void accept(struct dynamics *d)
{
    swap(&d->before, &d->after);
    swap(&d->u, &d->next);
    double *kept = d->factor_before;
    d->factor_before = d->factor_now;
    d->factor_now = d->factor_after;
    d->factor_after = kept;
    d->previous_step = d->step;
    d->done++;
    d->left--;
    d->report->steps++;
    d->report->time = dynamics_time_now(d);
}

static bool is_interrupted(const struct dynamics *d)
{
    return d->options->interrupted != NULL &&
           ranks_most(d->system->body.share.ranks, *d->options->interrupted) != 0;
}

/* Step until the run ends. */
static enum dynamics_outcome march(struct dynamics *d, struct error *error)
{
    int64_t most = d->options->most_steps > 0 ? d->options->most_steps : INT64_MAX;
    for (;;) {
        int64_t n = d->report->steps;
        bool is_check = n % check_interval == 0, is_last = n > 0 && d->left == 0;
        body_step(&d->system->body, n > 0 ? d->previous_step : 0.0);
        if (!evaluate(d)) {
            return DYNAMICS_INVERTED;
        }
        body_accept(&d->system->body);
        system_slide(d->system);
        double contact = energy_contact(d->system);
        system_accept(d->system);
        if (is_check && !is_last) {
            dynamics_estimate_frequency(d, n == 0 ? first_iterations : later_iterations);
            system_measure_contacts(d->system, d->u, false);
            if (!dynamics_choose_step(d) || !dynamics_weigh_dashpots(d, error)) {
                return DYNAMICS_COLLAPSED;
            }
        }
        if (n == 0) {
            d->sample_interval = (int64_t)fmax(1.0, ceil((double)d->left / samples));
        }
        factors_at(d, is_last ? d->options->end_time + d->step : dynamics_time_next(d), d->factor_after);
        dynamics_advance(d, n == 0);
        if (n > 0) {
            dynamics_add_work(d, d->before, d->previous_step, d->factor_before, d->factor_now);
        }
        if ((n % d->sample_interval == 0 || is_last) && !dynamics_sample(d, contact, error)) {
            return DYNAMICS_DRIFTED;
        }
        if (is_last) {
            return DYNAMICS_DONE;
        }
        if (n == most) {
            return DYNAMICS_TOO_MANY_STEPS;
        }
        dynamics_add_work(d, d->after, d->step, d->factor_now, d->factor_after);
        give_frames(d);
        accept(d);
        if ((is_check || is_interrupted(d)) && !tell(d)) {
            return DYNAMICS_STOPPED;
        }
    }
}

/* Project u and v onto the conditions at time 0. The change of the energy counts as work. */
static void meet_conditions(struct dynamics *d)
{
    struct solid_system *system = d->system;
    factors_at(d, 0.0, d->factor_now);
    use_factors(d);
    double energy = body_energy(&system->body, d->u) + system_spring_energy(system, d->u) +
                    system_pull_membranes(system, d->u, NULL) + energy_kinetic(system, d->before, d->before);
    constraint_project(&d->constraint, d->factor_now, d->u);
    for (int64_t i = 0; i < system->curve_count; i++) {
        d->factor_now[i] = curve_rate(&system->curves[i], 0.0) / d->options->end_time;
    }
    constraint_project(&d->constraint, d->factor_now, d->before);
    d->balance.work = energy_internal(system, d->u) + energy_kinetic(system, d->before, d->before) - energy;
}

/* Start from u and v (NULL: at rest) at time 0. */
static void begin(struct dynamics *d, const double *u, const double *v)
{
    size_t bytes = (size_t)d->size * sizeof *u;
    memcpy(d->u, u, bytes);
    if (v != NULL) {
        memcpy(d->before, v, bytes);
    }
    d->balance = energy_balance_begin(d->system);
    dynamics_bound_contacts(d);
    if (d->system->rows.count > 0) {
        meet_conditions(d);
    }
    factors_at(d, 0.0, d->factor_now);
}

/* The node of the largest component of a nodal vector; NaN counts as the largest. */
static int64_t node_of_largest(const struct dynamics *d, const double *vector)
{
    int64_t largest = 0;
    for (int64_t i = 0; i < d->size && !isnan(vector[largest]); i++) {
        largest = fabs(vector[i]) <= fabs(vector[largest]) ? largest : i;
    }
    return largest / d->system->dim;
}

enum status dynamics_run(struct solid_system *system, const struct dynamics_options *options, double *u,
                         double *v, double *row_force, struct energy_log *log, struct dynamics_report *report,
                         struct error *error)
{
    FREED_BY(dynamics_release)
    struct dynamics d = {.system = system,
                         .options = options,
                         .report = report,
                         .size = system->node_count * system->dim,
                         .log = log};
    *report = (struct dynamics_report){.least_jacobian = 1.0};
    RETURN_IF_ERROR(dynamics_allocate(&d, error));
    RETURN_IF_ERROR(system_constrain(system, system->lumped_mass, &d.constraint, error));
    if (options->restored != NULL) {
        RETURN_IF_ERROR(dynamics_visit(&d, options->restored, error));
        (void)dynamics_weigh_dashpots(&d, error);
        RETURN_IF_ERROR(d.failure);
    } else {
        begin(&d, u, v);
    }
    int64_t first = report->steps;
    report->outcome = march(&d, error);
    RETURN_IF_ERROR(d.failure);
    report->last_good = report->outcome == DYNAMICS_DRIFTED ? -1.0 : report->time;
    if (report->outcome == DYNAMICS_INVERTED) {
        report->last_good = report->steps > first ? report->time - d.previous_step : -1.0;
        swap(&d.u, &d.next);
    }
    memcpy(u, d.u, (size_t)d.size * sizeof *u);
    for (int64_t i = 0; v != NULL && i < d.size; i++) {
        v[i] = report->outcome == DYNAMICS_DONE ? 0.5 * (d.before[i] + d.after[i]) : d.before[i];
    }
    if (report->outcome == DYNAMICS_COLLAPSED || report->outcome == DYNAMICS_DRIFTED) {
        report->node = node_of_largest(&d, report->outcome == DYNAMICS_COLLAPSED ? d.mode : d.before);
    }
    if (row_force != NULL && system->rows.count > 0) {
        memcpy(row_force, d.constraint.multiplier, (size_t)system->rows.count * sizeof *row_force);
        RETURN_IF_ERROR(constraint_share_out(&d.constraint, row_force, error));
    }
    return STATUS_OK;
}
