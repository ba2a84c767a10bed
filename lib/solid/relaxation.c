#include "solid/relaxation.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int64_t check_interval = 20;     /* steps between estimates */
static const int first_iterations = 40;       /* of the power iteration, at rest */
static const int most_augmentations = 20;     /* of the contacts' multipliers */
static const double penetration_share = 1e-4; /* of the body's size: what a contact may penetrate */
static const int later_iterations = 1;        /* at every check: the mode is kept, so that it sharpens */
enum { WINDOWS = 8 };                         /* recent Rayleigh quotients that the error estimate looks at */

struct relaxation {
    struct solid_system *system;
    const struct relaxation_options *options;
    struct relaxation_report *report;
    struct constraint constraint;
    int64_t size;
    double *mass, *velocity, *residual, *before;
    double *mode, *scratch;
    double *last_u, *last_acceleration; /* at the last check */
    double *acceleration;
    double time_step, damping, frequency; /* current; frequency: largest */
    double low2;                          /* current estimate of the lowest frequency, squared */
    double window[WINDOWS];
    int64_t checks;
    double penetration_allowed; /* m */
    int augmentations;
};

static enum status allocate(struct relaxation *r, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&r->mass, r->system->node_count, error));
    TRY(NEW_ARRAY(&r->velocity, r->size, error));
    TRY(NEW_ARRAY(&r->residual, r->size, error));
    TRY(NEW_ARRAY(&r->before, r->size, error));
    TRY(NEW_ARRAY(&r->mode, r->size, error));
    TRY(NEW_ARRAY(&r->scratch, 2 * r->size, error));
    TRY(NEW_ARRAY(&r->last_u, r->size, error));
    TRY(NEW_ARRAY(&r->last_acceleration, r->size, error));
    TRY(NEW_ARRAY(&r->acceleration, r->size, error));
done:
    return status;
}

static void release(struct relaxation *r)
{
    free(r->mass);
    free(r->velocity);
    free(r->residual);
    free(r->before);
    free(r->mode);
    free(r->scratch);
    free(r->last_u);
    free(r->last_acceleration);
    free(r->acceleration);
    constraint_free(&r->constraint);
}

/* sum m_i x_i y_i */
static double mass_product(const struct relaxation *r, const double *x, const double *y)
{
    int dim = r->system->dim;
    double sum = 0.0;
    for (int64_t n = 0; n < r->system->node_count; n++) {
        double part = 0.0;
        for (int a = 0; a < dim; a++) {
            part += x[n * dim + a] * y[n * dim + a];
        }
        sum += r->mass[n] * part;
    }
    return sum;
}

/* Length of the diagonal of the nodes' box. */
static double body_size(const struct solid_system *system)
{
    double sum = 0.0;
    for (int a = 0; a < system->dim; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t n = 0; n < system->node_count; n++) {
            low = fmin(low, system->X[n * system->dim + a]);
            high = fmax(high, system->X[n * system->dim + a]);
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

/* Steps to apply the load in: slow enough that a cell is strained by no more than half a percent a step. */
static int64_t choose_ramp(const struct relaxation *r)
{
    const struct constraint_rows *rows = &r->system->rows;
    const struct body *body = &r->system->body;
    double largest = 0.0, volume = 0.0;
    for (int64_t i = 0; i < rows->count; i++) {
        largest = fmax(largest, fabs(rows->target[i]));
    }
    for (int64_t q = 0; q < body->point_count; q++) {
        volume += body->weight[q];
    }
    double spacing = pow(volume / (double)r->system->node_count, 1.0 / r->system->dim);
    double steps = 200.0 * largest / spacing;
    return steps > 1e7 ? 10000000 : steps > 200.0 ? (int64_t)steps : 200;
}

/* Take the critical step at u from the largest frequency. */
static void update_time_step(struct relaxation *r, const double *u, int iterations)
{
    double frequency =
        system_largest_frequency(r->system, r->mass, u, r->residual, iterations, r->mode, r->scratch);
    r->report->force_evaluations += iterations;
    /* The estimate is from below and wanders: follow rises at once, falls slowly. */
    r->frequency = frequency > r->frequency ? frequency : 0.98 * r->frequency + 0.02 * frequency;
    r->time_step = r->options->time_step_margin * 2.0 / r->frequency;
}

/* One step; with `measure` the acceleration of the projected residual at the old u is kept. */
static bool step(struct relaxation *r, double *u, bool measure)
{
    struct solid_system *system = r->system;
    int dim = system->dim;
    double dt = r->time_step, grow = 2.0 + r->damping * dt, keep = (2.0 - r->damping * dt) / grow;
    struct deformation deformation = system_residual(system, u, r->residual);
    r->report->force_evaluations++;
    r->report->least_jacobian = deformation.least_jacobian;
    if (!(deformation.least_jacobian > 0.0)) {
        r->report->inverted_point = deformation.point;
        return false;
    }
    if (measure) {
        memcpy(r->acceleration, r->velocity, (size_t)r->size * sizeof *r->velocity);
    }
    memcpy(r->before, u, (size_t)r->size * sizeof *u);
    for (int64_t n = 0; n < system->node_count; n++) {
        double push = 2.0 * dt / (grow * r->mass[n]);
        for (int64_t i = n * dim; i < (n + 1) * dim; i++) {
            u[i] += dt * (keep * r->velocity[i] + push * r->residual[i]);
        }
    }
    constraint_project(&r->constraint, system->factor, u);
    for (int64_t i = 0; i < r->size; i++) {
        r->velocity[i] = (u[i] - r->before[i]) / dt;
    }
    if (measure) {
        /* (2 + c dt) v_new = (2 - c dt) v_old + 2 dt a */
        for (int64_t i = 0; i < r->size; i++) {
            r->acceleration[i] =
                (grow * r->velocity[i] - (2.0 - r->damping * dt) * r->acceleration[i]) / (2.0 * dt);
        }
    }
    return true;
}

/* After a measured step: the Rayleigh quotient of the increments since the last check, the damping, the
 * error. `before` holds the u at which the acceleration was measured. */
static void estimate(struct relaxation *r)
{
    double *du = r->scratch, *da = r->scratch + r->size;
    for (int64_t i = 0; i < r->size; i++) {
        du[i] = r->before[i] - r->last_u[i];
        da[i] = r->last_acceleration[i] - r->acceleration[i];
    }
    double bottom = mass_product(r, du, du);
    double quotient = bottom > 0.0 ? mass_product(r, du, da) / bottom : 0.0;
    memcpy(r->last_u, r->before, (size_t)r->size * sizeof *r->before);
    memcpy(r->last_acceleration, r->acceleration, (size_t)r->size * sizeof *r->acceleration);
    if (quotient > 0.0 && r->checks > 0) {
        quotient = fmin(quotient, r->frequency * r->frequency);
        r->low2 = quotient < r->low2 ? quotient : fmin(quotient, 1.2 * r->low2);
        r->damping = 2.0 * sqrt(r->low2);
        r->window[r->checks % WINDOWS] = r->low2;
    }
    r->checks++;
    double least2 = INFINITY;
    for (int i = 0; i < WINDOWS; i++) {
        least2 = fmin(least2, r->window[i]);
    }
    double remaining = sqrt(mass_product(r, r->acceleration, r->acceleration)) / least2;
    double displacement = sqrt(mass_product(r, r->before, r->before));
    r->report->error = displacement > 0.0 ? remaining / displacement : remaining > 0.0 ? INFINITY : 0.0;
    r->report->lowest_frequency = sqrt(least2);
}

static bool tell(const struct relaxation *r, int64_t at, const double *u)
{
    if (r->options->progress == NULL) {
        return true;
    }
    struct progress progress = {.step = at, .u = u, .error = r->report->error, .remaining = -1.0};
    double ramp = (double)r->report->ramp_steps;
    progress.time = fmin(1.0, (double)at / ramp);
    if (at > r->report->ramp_steps && r->report->error > 0.0 && isfinite(r->report->error)) {
        /* The error falls by about exp(-w dt) a step. */
        double to_go = log(fmax(1.0, r->report->error / r->options->tolerance)) /
                       (r->report->lowest_frequency * r->time_step);
        progress.remaining = to_go / (to_go + (double)at);
    }
    return r->options->progress(r->options->context, &progress);
}

/* Deepest penetration of all contacts at the last evaluation, m. */
static double largest_penetration(const struct relaxation *r)
{
    double deepest = 0.0;
    for (int64_t c = 0; c < r->system->contact_count; c++) {
        for (int64_t a = 0; a < r->system->contacts[c].count; a++) {
            deepest = fmax(deepest, -r->system->contacts[c].gap[a]);
        }
    }
    return deepest;
}

/* Move what the penalties carry into the multipliers, so that the next equilibrium penetrates less. */
static void augment(struct relaxation *r)
{
    for (int64_t c = 0; c < r->system->contact_count; c++) {
        (void)contact_augment(&r->system->contacts[c]);
    }
    r->augmentations++;
}

static enum relaxation_outcome iterate(struct relaxation *r, double *u)
{
    int64_t ramp = r->report->ramp_steps;
    int64_t most = r->options->most_steps > 0 ? r->options->most_steps : 1000000;
    int64_t settled = 0;
    for (int64_t n = 1; n <= most; n++) {
        bool measure = n % check_interval == 0;
        system_load_factors(r->system, n < ramp ? (double)n / (double)ramp : 1.0);
        if (!step(r, u, measure)) {
            return RELAXATION_INVERTED;
        }
        r->report->steps = n;
        if (!measure) {
            continue;
        }
        estimate(r);
        (void)system_residual(r->system, u, r->residual);
        r->report->force_evaluations++;
        update_time_step(r, u, later_iterations);
        if (!tell(r, n, u)) {
            return RELAXATION_STOPPED;
        }
        settled = n > ramp + WINDOWS * check_interval && r->report->error <= r->options->tolerance
                      ? settled + 1
                      : 0;
        if (settled >= 2) {
            if (r->augmentations == most_augmentations ||
                !(largest_penetration(r) > r->penetration_allowed)) {
                return RELAXATION_CONVERGED;
            }
            augment(r);
            settled = 0;
        }
    }
    return RELAXATION_TOO_MANY_STEPS;
}

/* Forces of the constraints: what balances the residual along them. */
static void measure_row_forces(struct relaxation *r, const double *u, double *row_force)
{
    int dim = r->system->dim;
    (void)system_residual(r->system, u, r->residual);
    for (int64_t i = 0; i < r->size; i++) {
        r->scratch[i] = r->residual[i] / r->mass[i / dim];
    }
    constraint_project(&r->constraint, NULL, r->scratch);
    memcpy(row_force, r->constraint.multiplier, (size_t)r->system->rows.count * sizeof *row_force);
}

enum status relaxation_run(struct solid_system *system, const struct relaxation_options *options, double *u,
                           double *row_force, struct relaxation_report *report, struct error *error)
{
    enum status status;
    struct relaxation r = {
        .system = system, .options = options, .report = report, .size = system->node_count * system->dim};
    int64_t dependent;
    *report = (struct relaxation_report){.least_jacobian = 1.0};
    TRY(allocate(&r, error));
    system_relaxation_mass(system, r.mass);
    status = constraint_build(&system->rows, system->node_count, r.mass, &r.constraint, &dependent, error);
    if (status == STATUS_VERDICT && dependent >= 0) {
        status =
            fail(error, STATUS_VERDICT, "the condition at node %d follows from others: prescribe it once",
                 system->rows.node[dependent]);
    }
    TRY(status);
    r.penetration_allowed = penetration_share * body_size(system);
    report->ramp_steps = options->ramp_steps > 0 ? options->ramp_steps : choose_ramp(&r);
    system_load_factors(system, 0.0);
    (void)system_residual(system, u, r.residual);
    update_time_step(&r, u, first_iterations);
    r.low2 = r.frequency * r.frequency * 1e-4;
    r.damping = 2.0 * sqrt(r.low2);
    for (int i = 0; i < WINDOWS; i++) {
        r.window[i] = r.low2;
    }
    report->outcome = iterate(&r, u);
    report->largest_frequency = r.frequency;
    if (row_force != NULL && system->rows.count > 0) {
        measure_row_forces(&r, u, row_force);
    }
done:
    release(&r);
    return status;
}
