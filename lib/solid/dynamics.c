#include "solid/dynamics.h"

#include "base/clock.h"
#include "base/memory.h"
#include "solid/frequency.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int64_t check_interval = 20; /* steps between estimates of the critical step */
static const int first_iterations = 40;   /* of the power iteration, at the begin */
static const int later_iterations = 1;    /* at every check: the mode is kept, so that it sharpens */
static const double samples = 200.0;      /* of the energies, over the run */

struct dynamics {
    struct solid_system *system;
    const struct dynamics_options *options;
    struct dynamics_report *report;
    struct constraint constraint;
    int64_t size;
    double *u, *next;       /* at this step, at the next one */
    double *before, *after; /* velocities half a step before and after this one */
    double *residual, *mode, *scratch;
    double *loads;                                     /* NULL without loads */
    double *factor_before, *factor_now, *factor_after; /* of the load curves */
    double *factor_change;                             /* in this step */
    /* Time runs in spans of equal steps: t = mark + done * step; `left` more of them end at T. */
    double mark, step, previous_step;
    int64_t done, left;
    double frequency;       /* largest, followed */
    double contact_squared; /* bound of what contacts add to its square */
    int64_t sample_interval;
    int64_t frames;
    struct energy_balance balance;
    double tie_work;        /* energy put in as ties followed the pressure */
    struct energy_log *log; /* the caller's, or NULL */
};

static enum status allocate(struct dynamics *d, struct error *error)
{
    enum status status;
    const struct solid_system *system = d->system;
    TRY(NEW_ARRAY(&d->u, d->size, error));
    TRY(NEW_ARRAY(&d->next, d->size, error));
    TRY(NEW_ARRAY(&d->before, d->size, error));
    TRY(NEW_ARRAY(&d->after, d->size, error));
    TRY(NEW_ARRAY(&d->residual, d->size, error));
    TRY(NEW_ARRAY(&d->mode, d->size, error));
    TRY(NEW_ARRAY(&d->scratch, 2 * d->size, error));
    if (system->load_count + system->pressure_count > 0) {
        TRY(NEW_ARRAY(&d->loads, d->size, error));
    }
    TRY(NEW_ARRAY(&d->factor_before, system->curve_count, error));
    TRY(NEW_ARRAY(&d->factor_now, system->curve_count, error));
    TRY(NEW_ARRAY(&d->factor_after, system->curve_count, error));
    TRY(NEW_ARRAY(&d->factor_change, system->curve_count, error));
done:
    return status;
}

static void release(struct dynamics *d)
{
    free(d->u);
    free(d->next);
    free(d->before);
    free(d->after);
    free(d->residual);
    free(d->mode);
    free(d->scratch);
    free(d->loads);
    free(d->factor_before);
    free(d->factor_now);
    free(d->factor_after);
    free(d->factor_change);
    constraint_free(&d->constraint);
}

static double time_now(const struct dynamics *d)
{
    return d->left == 0 ? d->options->end_time : d->mark + (double)d->done * d->step;
}

static double time_next(const struct dynamics *d)
{
    return d->left == 1 ? d->options->end_time : d->mark + (double)(d->done + 1) * d->step;
}

/* Factors of the load curves at a time; beyond the end they go on as they arrive there, so that the motion
 * ends without a jerk. */
static void factors_at(const struct dynamics *d, double time, double *factor)
{
    double s = time / d->options->end_time;
    for (int64_t i = 0; i < d->system->curve_count; i++) {
        const struct load_curve *curve = &d->system->curves[i];
        factor[i] = curve_value(curve, s) + (s > 1.0 ? (s - 1.0) * curve_rate(curve, 1.0) : 0.0);
    }
}

/* Bound of the largest eigenvalue of M^-1 K for the penalties of all contacts, as if all hats touched: the
 * largest sum of a row's magnitudes. */
static double contact_bound(const struct solid_system *system, double *stiffness)
{
    double bound = 0.0;
    for (int64_t n = 0; n < system->node_count; n++) {
        stiffness[n] = 0.0;
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct boundary_averages *averages = system->contacts[c].averages;
        for (int64_t a = 0; a < averages->count; a++) {
            double sum = 0.0;
            for (int64_t i = averages->ptr[a]; i < averages->ptr[a + 1]; i++) {
                sum += fabs(averages->phi[i]);
            }
            sum *= system->contacts[c].stiffness * averages->area[a];
            for (int64_t i = averages->ptr[a]; i < averages->ptr[a + 1]; i++) {
                stiffness[averages->idx[i]] += sum * fabs(averages->phi[i]);
            }
        }
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        bound = fmax(bound, stiffness[n] / system->lumped_mass[n]);
    }
    return bound;
}

/* Follow the largest frequency; `residual` is that at u. */
static void estimate_frequency(struct dynamics *d, int iterations)
{
    double frequency = system_largest_frequency(d->system, d->system->lumped_mass, d->u, d->residual,
                                                iterations, d->mode, d->scratch);
    d->report->force_evaluations += iterations;
    frequency = sqrt(frequency * frequency + d->contact_squared);
    /* The estimate is from below and wanders: follow rises at once, falls slowly. */
    d->frequency = frequency > d->frequency ? frequency : 0.98 * d->frequency + 0.02 * frequency;
}

/* Start a span of equal steps to the end where the last ones have become too long, or shorter than need be.
 * false: the step has collapsed. */
static bool choose_step(struct dynamics *d)
{
    struct dynamics_report *report = d->report;
    double margin = d->options->time_step_margin, critical = 2.0 / d->frequency;
    double too_long = (margin + 0.3 * (1.0 - margin)) * critical, too_short = 0.8 * margin * critical;
    bool is_first = d->step == 0.0;
    if (!is_first && d->step <= too_long && d->step >= too_short) {
        return true;
    }
    double now = is_first ? 0.0 : time_now(d), to_go = d->options->end_time - now;
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

/* v+ and the next u from the residual at u, the conditions met; the forces of the conditions, N, are left in
 * constraint.multiplier. */
static void advance(struct dynamics *d, bool is_first)
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
        double share = push / system->lumped_mass[n];
        for (int64_t i = n * dim; i < (n + 1) * dim; i++) {
            move[i] = dt * (keep * d->before[i] + share * d->residual[i]);
        }
    }
    if (system->rows.count > 0) {
        double started = clock_seconds();
        for (int64_t i = 0; i < system->curve_count; i++) {
            d->factor_change[i] = d->factor_after[i] - d->factor_now[i];
        }
        constraint_project(&d->constraint, d->factor_change, move);
        for (int64_t r = 0; r < system->rows.count; r++) {
            d->constraint.multiplier[r] /= dt * push;
        }
        d->system->cost.constraints += clock_seconds() - started;
    }
    for (int64_t i = 0; i < d->size; i++) {
        d->next[i] = d->u[i] + move[i];
        d->after[i] = move[i] / dt;
    }
    if (is_first) { /* the velocity half a step before the begin, by the same acceleration */
        for (int64_t i = 0; i < d->size; i++) {
            d->before[i] = 2.0 * d->before[i] - d->after[i];
        }
    }
}

static double product(const double *x, const double *y, int64_t size)
{
    double sum = 0.0;
    for (int64_t i = 0; i < size; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

/* Half of the work that the forces at this step do over the step before or after it. */
static void add_work(struct dynamics *d, const double *velocity, double step, const double *factor_from,
                     const double *factor_to)
{
    const struct solid_system *system = d->system;
    const struct constraint_rows *rows = &system->rows;
    double work = 0.0;
    if (d->loads != NULL) {
        work += step * product(d->loads, velocity, d->size);
    }
    for (int64_t r = 0; r < rows->count; r++) {
        double path = rows->target[r] * (factor_to[rows->curve[r]] - factor_from[rows->curve[r]]);
        work += d->constraint.multiplier[r] * path;
    }
    const struct constraint_rows *springs = &system->springs;
    for (int64_t r = 0; r < springs->count; r++) {
        double path = springs->target[r] * (factor_to[springs->curve[r]] - factor_from[springs->curve[r]]);
        if (path != 0.0) {
            work += system_spring_force(system, r, d->u) * path;
        }
    }
    d->balance.work += 0.5 * work;
    if (d->options->damping > 0.0) {
        double speed =
            energy_kinetic(system, d->before, velocity) + energy_kinetic(system, d->after, velocity);
        d->balance.dissipated += 0.5 * step * d->options->damping * speed;
    }
}

/* Energies at this step; false when their balance is off. */
static bool sample(struct dynamics *d, bool is_first, double contact, enum status *status,
                   struct error *error)
{
    struct energy row = {.time = is_first ? 0.0 : time_now(d),
                         .kinetic = energy_kinetic(d->system, d->before, d->after),
                         .internal = energy_internal(d->system, d->u),
                         .contact = contact};
    d->report->force_evaluations++;
    energy_balance_complete(&d->balance, is_first, &row);
    d->report->last_drift = fabs(row.error);
    d->report->largest_drift = d->balance.worst;
    d->report->tie_work = d->tie_work / d->balance.largest;
    *status = d->log != NULL ? energy_log_add(d->log, &row, error) : STATUS_OK;
    return d->balance.worst <= DYNAMICS_MOST_DRIFT;
}

/* Frames between this step and the next one: the scheme moves on straight lines between them. */
static void give_frames(struct dynamics *d)
{
    const struct dynamics_options *options = d->options;
    double now = time_now(d), next = time_next(d), slack = 1e-9 * options->end_time;
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

/* What the next step needs of those before: see base/state.h. */
static enum status visit(void *run, const struct state *state, struct error *error)
{
    enum status status;
    struct dynamics *d = run;
    struct dynamics_report *report = d->report;
    int64_t curves = d->system->curve_count;
    const struct state_value values[] = {
        {"u", STATE_NUMBERS, d->u, d->size},
        {"velocity", STATE_NUMBERS, d->before, d->size},
        {"mode", STATE_NUMBERS, d->mode, d->size},
        {"factor_before", STATE_NUMBERS, d->factor_before, curves},
        {"factor_now", STATE_NUMBERS, d->factor_now, curves},
        {"steps", STATE_COUNTS, &report->steps, 1},
        {"time", STATE_NUMBERS, &report->time, 1},
        {"mark", STATE_NUMBERS, &d->mark, 1},
        {"step", STATE_NUMBERS, &d->step, 1},
        {"previous_step", STATE_NUMBERS, &d->previous_step, 1},
        {"steps_done", STATE_COUNTS, &d->done, 1},
        {"steps_left", STATE_COUNTS, &d->left, 1},
        {"frequency", STATE_NUMBERS, &d->frequency, 1},
        {"contact_squared", STATE_NUMBERS, &d->contact_squared, 1},
        {"sample_interval", STATE_COUNTS, &d->sample_interval, 1},
        {"frames", STATE_COUNTS, &d->frames, 1},
        {"balance.start", STATE_NUMBERS, &d->balance.start, 1},
        {"balance.work", STATE_NUMBERS, &d->balance.work, 1},
        {"balance.dissipated", STATE_NUMBERS, &d->balance.dissipated, 1},
        {"balance.largest", STATE_NUMBERS, &d->balance.largest, 1},
        {"balance.worst", STATE_NUMBERS, &d->balance.worst, 1},
        {"tie_work", STATE_NUMBERS, &d->tie_work, 1},
        {"force_evaluations", STATE_COUNTS, &report->force_evaluations, 1},
        {"step_changes", STATE_COUNTS, &report->step_changes, 1},
        {"first_step", STATE_NUMBERS, &report->first_step, 1},
        {"least_step", STATE_NUMBERS, &report->least_step, 1},
        {"critical_step", STATE_NUMBERS, &report->critical_step, 1},
        {"largest_drift", STATE_NUMBERS, &report->largest_drift, 1},
        {"last_drift", STATE_NUMBERS, &report->last_drift, 1},
        {"share_of_ties", STATE_NUMBERS, &report->tie_work, 1},
        {"least_jacobian", STATE_NUMBERS, &report->least_jacobian, 1},
    };
    TRY(state_visit(state, NULL, values, sizeof values / sizeof *values, error));
    if (d->sample_interval == 0) {
        status = fail(error, STATUS_INPUT, "sample_interval: is 0");
        goto done;
    }
    if (d->log != NULL) {
        TRY(energy_log_state(d->log, state, error));
    }
    TRY(system_state(d->system, state, error));
done:
    return status;
}

static bool tell(struct dynamics *d)
{
    double now = time_now(d);
    struct progress progress = {.step = d->report->steps,
                                .time = now,
                                .error = d->report->last_drift,
                                .remaining = 1.0 - now / d->options->end_time,
                                .u = d->u,
                                .state = visit,
                                .run = d};
    return d->options->progress == NULL || d->options->progress(d->options->context, &progress);
}

static void swap(double **a, double **b)
{
    double *kept = *a;
    *a = *b;
    *b = kept;
}

/* The loads of this instant; a system without load curves has no factors. */
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
    return deformation.least_jacobian > 0.0;
}

/* Let the ties of the gradients (compatibility.h) follow the pressure; the energy that this takes counts as
 * work. */
static bool follow_ties(struct dynamics *d)
{
    struct body *body = &d->system->body;
    if (body->compatibility == NULL) {
        return true;
    }
    bool were_active = body->compatibility->active;
    double energy = compatibility_energy(body);
    compatibility_update(body);
    if (!were_active && !body->compatibility->active) {
        return true;
    }
    bool is_good = evaluate(d);
    energy = compatibility_energy(body) - energy;
    d->balance.work += energy;
    d->tie_work += energy;
    return is_good;
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
    d->report->time = time_now(d);
}

static bool is_interrupted(const struct dynamics *d)
{
    return d->options->interrupted != NULL && *d->options->interrupted != 0;
}

static enum dynamics_outcome march(struct dynamics *d, enum status *status, struct error *error)
{
    int64_t most = d->options->most_steps > 0 ? d->options->most_steps : INT64_MAX;
    for (;;) {
        int64_t n = d->report->steps;
        if (!evaluate(d) || (n % check_interval == 0 && !follow_ties(d))) {
            return DYNAMICS_INVERTED;
        }
        double contact = energy_contact(d->system);
        bool is_last = n > 0 && d->left == 0;
        if (n % check_interval == 0 && !is_last) {
            estimate_frequency(d, n == 0 ? first_iterations : later_iterations);
            if (!choose_step(d)) {
                return DYNAMICS_COLLAPSED;
            }
        }
        if (n == 0) {
            d->sample_interval = (int64_t)fmax(1.0, ceil((double)d->left / samples));
        }
        factors_at(d, is_last ? d->options->end_time + d->step : time_next(d), d->factor_after);
        advance(d, n == 0);
        if (n > 0) {
            add_work(d, d->before, d->previous_step, d->factor_before, d->factor_now);
        }
        if (n % d->sample_interval == 0 || is_last) {
            bool is_balanced = sample(d, n == 0, contact, status, error);
            if (*status != STATUS_OK || !is_balanced) {
                return DYNAMICS_DRIFTED;
            }
        }
        if (is_last) {
            return DYNAMICS_DONE;
        }
        if (n == most) {
            return DYNAMICS_TOO_MANY_STEPS;
        }
        add_work(d, d->after, d->step, d->factor_now, d->factor_after);
        give_frames(d);
        accept(d);
        if ((n % check_interval == 0 || is_interrupted(d)) && !tell(d)) {
            return DYNAMICS_STOPPED;
        }
    }
}

/* Bring u and v onto the conditions at time 0; what that takes is work. */
static void meet_conditions(struct dynamics *d)
{
    struct solid_system *system = d->system;
    factors_at(d, 0.0, d->factor_now);
    use_factors(d);
    double energy = body_energy(&system->body, d->u) + energy_kinetic(system, d->before, d->before);
    constraint_project(&d->constraint, d->factor_now, d->u);
    for (int64_t i = 0; i < system->curve_count; i++) {
        d->factor_now[i] = curve_rate(&system->curves[i], 0.0) / d->options->end_time;
    }
    constraint_project(&d->constraint, d->factor_now, d->before);
    d->balance.work = energy_internal(system, d->u) + energy_kinetic(system, d->before, d->before) - energy;
}

/* From u and v (NULL: at rest) at time 0. */
static void begin(struct dynamics *d, const double *u, const double *v)
{
    size_t bytes = (size_t)d->size * sizeof *u;
    memcpy(d->u, u, bytes);
    if (v != NULL) {
        memcpy(d->before, v, bytes);
    }
    d->balance = energy_balance_begin(d->system);
    d->contact_squared = contact_bound(d->system, d->scratch);
    if (d->system->rows.count > 0) {
        meet_conditions(d);
    }
    factors_at(d, 0.0, d->factor_now);
}

/* Where the largest component of a vector of the nodes is; NaN counts as the largest. */
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
    enum status status;
    struct dynamics d = {.system = system,
                         .options = options,
                         .report = report,
                         .size = system->node_count * system->dim,
                         .log = log};
    *report = (struct dynamics_report){.least_jacobian = 1.0};
    TRY(allocate(&d, error));
    TRY(system_constrain(system, system->lumped_mass, &d.constraint, error));
    if (options->restored != NULL) {
        TRY(visit(&d, options->restored, error));
    } else {
        begin(&d, u, v);
    }
    int64_t first = report->steps;
    report->outcome = march(&d, &status, error);
    TRY(status);
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
    }
done:
    release(&d);
    return status;
}
