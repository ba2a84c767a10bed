#include "solid/relaxation.h"

#include "base/clock.h"
#include "base/memory.h"
#include "solid/lowest_frequency.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int64_t check_interval = 20;                        /* steps between estimates */
static const int64_t keep_interval = 200;                        /* steps between states to go back to */
static const int64_t most_retreats = 8;                          /* from inverted points */
static const int first_iterations = 40;                          /* of the power iteration, at rest */
static const double most_stiffening = 1.1, most_softening = 0.5; /* of a node since its mass was set */
static const int64_t most_augmentations = 20;                    /* of the contacts' multipliers */
static const double penetration_share = 1e-4; /* of the body's size: what a contact may penetrate */
static const int later_iterations = 3;        /* at every check: the mode is kept, so that it sharpens */
enum { WINDOWS = 8 };                         /* recent Rayleigh quotients that the error estimate looks at */
static const double pi = 3.14159265358979324;
static const int most_spectrum_iterations = 1000;
static const double spectrum_share = 0.8; /* of its estimate from above */

/* A state to go back to. */
struct kept_state {
    double *u;
    double load;
};

struct relaxation {
    struct solid_system *system;
    const struct relaxation_options *options;
    struct relaxation_report *report;
    struct constraint constraint;
    int64_t size;
    double *u; /* the caller's */
    double *mass, *velocity, *residual, *before;
    const double *residual_at; /* where the residual is known, at a check: u or before */
    double *factor_change;     /* of the load curves in this step */
    double *mode, *scratch;
    double *last_u, *last_acceleration; /* at the last check */
    double *acceleration;
    double time_step, damping, frequency; /* current; frequency: largest */
    double low2;                          /* current estimate of the lowest frequency, squared */
    double spectrum2; /* what it may not be above: found at the full load; before, INFINITY */
    double window[WINDOWS];
    int64_t checks;
    double best_error; /* at the full load, since best_step: not yet half of it */
    int64_t best_step;
    double spacing;             /* mean, of the nodes, m */
    double penetration_allowed; /* m */
    int64_t augmentations;
    bool mass_changed; /* since the last check: increments of the acceleration mean nothing */
    enum status failure;
    double load, load_rate;      /* steps of the ramp applied so far, and per step */
    double largest_displacement; /* so far, in the norm of the mass */
    double largest_move;         /* so far, of a node, m */
    bool spectrum_known;         /* spectrum2 is of the mass and the load as they are */
    double caution;              /* on the time step: 1 until an inversion */
    int64_t retreats;
    struct kept_state newer, older;
    int64_t frames;       /* given so far */
    int64_t at_full_load; /* steps since the full load was reached */
    int64_t settled;      /* checks in a row with a small error */
    bool ties_settled;
};

static enum status allocate(struct relaxation *r, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&r->mass, r->system->node_count, error));
    TRY(NEW_ARRAY(&r->velocity, r->size, error));
    TRY(NEW_ARRAY(&r->residual, r->size, error));
    TRY(NEW_ARRAY(&r->before, r->size, error));
    TRY(NEW_ARRAY(&r->factor_change, r->system->curve_count, error));
    TRY(NEW_ARRAY(&r->mode, r->size, error));
    TRY(NEW_ARRAY(&r->scratch, 2 * r->size, error));
    TRY(NEW_ARRAY(&r->last_u, r->size, error));
    TRY(NEW_ARRAY(&r->last_acceleration, r->size, error));
    TRY(NEW_ARRAY(&r->acceleration, r->size, error));
    TRY(NEW_ARRAY(&r->newer.u, r->size, error));
    TRY(NEW_ARRAY(&r->older.u, r->size, error));
done:
    return status;
}

static void release(struct relaxation *r)
{
    free(r->mass);
    free(r->velocity);
    free(r->residual);
    free(r->before);
    free(r->factor_change);
    free(r->mode);
    free(r->scratch);
    free(r->last_u);
    free(r->last_acceleration);
    free(r->acceleration);
    free(r->newer.u);
    free(r->older.u);
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

/* Length of the longest of the nodes' vectors. */
static double largest_of_nodes(const struct relaxation *r, const double *x)
{
    int dim = r->system->dim;
    double largest2 = 0.0;
    for (int64_t n = 0; n < r->system->node_count; n++) {
        double sum = 0.0;
        for (int a = 0; a < dim; a++) {
            sum += x[n * dim + a] * x[n * dim + a];
        }
        largest2 = fmax(largest2, sum);
    }
    return sqrt(largest2);
}

static double ratio(double part, double whole)
{
    return whole > 0.0 ? part / whole : part > 0.0 ? INFINITY : 0.0;
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

/* Mean spacing of the nodes. */
static double node_spacing(const struct solid_system *system)
{
    double volume = 0.0;
    for (int64_t q = 0; q < system->body.point_count; q++) {
        volume += system->body.weight[q];
    }
    return pow(volume / (double)system->node_count, 1.0 / system->dim);
}

/* Steps to apply the load in: slow enough that a cell is strained by no more than half a percent a step. */
static int64_t choose_ramp(const struct relaxation *r)
{
    double largest = 0.0;
    for (int64_t i = 0; i < r->system->rows.count; i++) {
        largest = fmax(largest, fabs(r->system->rows.target[i]));
    }
    double steps = 200.0 * largest / r->spacing;
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
    r->time_step = r->caution * r->options->time_step_margin * 2.0 / r->frequency;
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
    double *move = r->velocity;
    for (int64_t n = 0; n < system->node_count; n++) {
        double push = 2.0 * dt / (grow * r->mass[n]);
        for (int64_t i = n * dim; i < (n + 1) * dim; i++) {
            move[i] = dt * (keep * r->velocity[i] + push * r->residual[i]);
        }
    }
    /* The move is projected, not u: round-off relative to u would keep the residual from vanishing. */
    double started = clock_seconds();
    constraint_project(&r->constraint, r->factor_change, move);
    system->cost.constraints += clock_seconds() - started;
    for (int64_t i = 0; i < r->size; i++) {
        u[i] += move[i];
        r->velocity[i] = move[i] / dt;
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

/* The lowest frequency that recent estimates have shown, squared. */
static double least_of_window(const struct relaxation *r)
{
    double least2 = INFINITY;
    for (int i = 0; i < WINDOWS; i++) {
        least2 = fmin(least2, r->window[i]);
    }
    return least2;
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
    if (quotient > 0.0 && r->checks > 0 && !r->mass_changed) {
        quotient = fmin(quotient, r->frequency * r->frequency);
        r->low2 = quotient < r->low2 ? quotient : fmin(quotient, 1.2 * r->low2);
        r->low2 = fmin(r->low2, r->spectrum2);
        r->damping = 2.0 * sqrt(r->low2);
        r->window[r->checks % WINDOWS] = r->low2;
    }
    r->checks++;
    r->mass_changed = false;
    double least2 = least_of_window(r);
    r->largest_displacement = fmax(r->largest_displacement, sqrt(mass_product(r, r->before, r->before)));
    r->largest_move = fmax(r->largest_move, largest_of_nodes(r, r->before));
    /* Of the largest so far: a scene may end at rest. */
    double on_the_whole =
        ratio(sqrt(mass_product(r, r->acceleration, r->acceleration)) / least2, r->largest_displacement);
    double at_worst = ratio(largest_of_nodes(r, r->acceleration) / least2, r->largest_move);
    r->report->error = fmax(on_the_whole, at_worst);
    r->report->lowest_frequency = sqrt(least2);
}

/* What the next step needs of those before: see base/state.h. */
static enum status visit(void *run, const struct state *state, struct error *error)
{
    struct relaxation *r = run;
    struct relaxation_report *report = r->report;
    const struct state_value values[] = {
        {"u", STATE_NUMBERS, r->u, r->size},
        {"velocity", STATE_NUMBERS, r->velocity, r->size},
        {"mass", STATE_NUMBERS, r->mass, r->system->node_count},
        {"mode", STATE_NUMBERS, r->mode, r->size},
        {"last_u", STATE_NUMBERS, r->last_u, r->size},
        {"last_acceleration", STATE_NUMBERS, r->last_acceleration, r->size},
        {"newer.u", STATE_NUMBERS, r->newer.u, r->size},
        {"newer.load", STATE_NUMBERS, &r->newer.load, 1},
        {"older.u", STATE_NUMBERS, r->older.u, r->size},
        {"older.load", STATE_NUMBERS, &r->older.load, 1},
        {"steps", STATE_COUNTS, &report->steps, 1},
        {"time_step", STATE_NUMBERS, &r->time_step, 1},
        {"damping", STATE_NUMBERS, &r->damping, 1},
        {"frequency", STATE_NUMBERS, &r->frequency, 1},
        {"low2", STATE_NUMBERS, &r->low2, 1},
        {"window", STATE_NUMBERS, r->window, WINDOWS},
        {"spectrum2", STATE_NUMBERS, &r->spectrum2, 1},
        {"spectrum_known", STATE_FLAGS, &r->spectrum_known, 1},
        {"best_error", STATE_NUMBERS, &r->best_error, 1},
        {"best_step", STATE_COUNTS, &r->best_step, 1},
        {"largest_move", STATE_NUMBERS, &r->largest_move, 1},
        {"checks", STATE_COUNTS, &r->checks, 1},
        {"mass_changed", STATE_FLAGS, &r->mass_changed, 1},
        {"largest_displacement", STATE_NUMBERS, &r->largest_displacement, 1},
        {"ramp_steps", STATE_COUNTS, &report->ramp_steps, 1},
        {"load", STATE_NUMBERS, &r->load, 1},
        {"load_rate", STATE_NUMBERS, &r->load_rate, 1},
        {"caution", STATE_NUMBERS, &r->caution, 1},
        {"retreats", STATE_COUNTS, &r->retreats, 1},
        {"augmentations", STATE_COUNTS, &r->augmentations, 1},
        {"frames", STATE_COUNTS, &r->frames, 1},
        {"at_full_load", STATE_COUNTS, &r->at_full_load, 1},
        {"settled", STATE_COUNTS, &r->settled, 1},
        {"ties_settled", STATE_FLAGS, &r->ties_settled, 1},
        {"force_evaluations", STATE_COUNTS, &report->force_evaluations, 1},
        {"error", STATE_NUMBERS, &report->error, 1},
        {"lowest_frequency", STATE_NUMBERS, &report->lowest_frequency, 1},
        {"least_jacobian", STATE_NUMBERS, &report->least_jacobian, 1},
    };
    enum status status = state_visit(state, NULL, values, sizeof values / sizeof *values, error);
    return status == STATUS_OK ? system_state(r->system, state, error) : status;
}

static bool tell(struct relaxation *r)
{
    if (r->options->progress == NULL) {
        return true;
    }
    int64_t at = r->report->steps;
    struct progress progress = {
        .step = at, .u = r->u, .error = r->report->error, .remaining = -1.0, .state = visit, .run = r};
    double ramp = (double)r->report->ramp_steps;
    progress.time = r->load / ramp;
    if (r->load >= ramp && r->report->error > 0.0 && isfinite(r->report->error)) {
        /* The error falls by about exp(-w dt) a step. */
        double to_go = log(fmax(1.0, r->report->error / r->options->tolerance)) /
                       (r->report->lowest_frequency * r->time_step);
        progress.remaining = to_go / (to_go + (double)at);
    }
    return r->options->progress(r->options->context, &progress);
}

/* Frames that are due at step n of the ramp; the last one is not given before the end. */
static void give_frames(struct relaxation *r, int64_t n, const double *u)
{
    const struct relaxation_options *options = r->options;
    double each = (double)r->report->ramp_steps / (double)options->frames;
    while (r->frames + 1 < options->frames && (double)n >= each * (double)(r->frames + 1)) {
        options->frame(options->context, ++r->frames, (double)n / (double)r->report->ramp_steps, u);
    }
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

/* Let the mass follow the stiffness where the body has stiffened or softened since it was last set, so that
 * the critical step holds through large strains. False on failure. */
static bool update_mass(struct relaxation *r, struct error *error)
{
    double *mass = r->scratch, highest = 0.0, lowest = INFINITY;
    system_relaxation_mass(r->system, mass);
    for (int64_t n = 0; n < r->system->node_count; n++) {
        highest = fmax(highest, mass[n] / r->mass[n]);
        lowest = fmin(lowest, mass[n] / r->mass[n]);
    }
    if (!(highest > most_stiffening || lowest < most_softening)) {
        return true;
    }
    memcpy(r->mass, mass, (size_t)r->system->node_count * sizeof *mass);
    constraint_free(&r->constraint);
    r->failure = system_constrain(r->system, r->mass, &r->constraint, error);
    r->mass_changed = true;
    r->spectrum2 = INFINITY;
    r->spectrum_known = false;
    return r->failure == STATUS_OK;
}

/* Keep the state every so often; the older of two is safely before any instability that shows. */
static void keep_state(struct relaxation *r, const double *u)
{
    double *spare = r->older.u;
    r->older = r->newer;
    r->newer.u = spare;
    r->newer.load = r->load;
    memcpy(r->newer.u, u, (size_t)r->size * sizeof *u);
}

/* An inverted point: go back to a state before it, at rest, and go on with smaller steps and a slower load.
 * False when that has been tried often enough: the deformation itself inverts. */
static bool step_back(struct relaxation *r, double *u)
{
    if (r->retreats == most_retreats) {
        return false;
    }
    r->retreats++;
    r->caution *= 0.8;
    r->load_rate *= 0.5;
    r->load = r->older.load;
    memcpy(u, r->older.u, (size_t)r->size * sizeof *u);
    memcpy(r->newer.u, r->older.u, (size_t)r->size * sizeof *u);
    r->newer.load = r->older.load;
    memset(r->velocity, 0, (size_t)r->size * sizeof *r->velocity);
    memset(r->mode, 0, (size_t)r->size * sizeof *r->mode);
    r->mass_changed = true;
    system_load_factors(r->system, fmin(1.0, r->load / (double)r->report->ramp_steps));
    (void)system_residual(r->system, u, r->residual);
    update_time_step(r, u, first_iterations);
    return true;
}

/* Whether a converged state may stand; contacts that penetrate too deep are augmented and relaxed again. */
static bool contacts_hold(struct relaxation *r)
{
    if (r->augmentations == most_augmentations || !(largest_penetration(r) > r->penetration_allowed)) {
        return true;
    }
    augment(r);
    return false;
}

/* Set the load factors, and by how much they change. */
static void change_load(struct relaxation *r, double s)
{
    struct solid_system *system = r->system;
    for (int64_t i = 0; i < system->curve_count; i++) {
        r->factor_change[i] = -system->factor[i];
    }
    system_load_factors(system, s);
    for (int64_t i = 0; i < system->curve_count; i++) {
        r->factor_change[i] += system->factor[i];
    }
}

/* Find the lowest mode at u, where the residual is known: while fast modes die out a slow one does not show
 * in the increments. Takes the damping from it. False on failure. */
static bool find_lowest_mode(struct relaxation *r, const double *u, struct error *error)
{
    double *work = NULL, value = 0.0;
    int iterations = 0;
    r->failure = NEW_ARRAY(&work, 4 * r->size, error);
    if (r->failure == STATUS_OK) {
        memcpy(work, r->velocity, (size_t)r->size * sizeof *work);
        r->failure =
            system_lowest_eigenvalue(r->system, &r->constraint, u, r->residual, most_spectrum_iterations,
                                     work, work + r->size, &value, &iterations, error);
    }
    free(work);
    if (r->failure != STATUS_OK) {
        return false;
    }
    r->report->force_evaluations += iterations;
    r->spectrum2 = INFINITY;
    if (value > 0.0 && isfinite(value)) {
        r->spectrum2 = spectrum_share * value;
        r->low2 = fmin(r->low2, r->spectrum2);
        r->damping = 2.0 * sqrt(r->low2);
        for (int i = 0; i < WINDOWS; i++) {
            r->window[i] = fmin(r->window[i], r->low2);
        }
        double least2 = least_of_window(r);
        r->report->error *= r->report->lowest_frequency * r->report->lowest_frequency / least2;
        r->report->lowest_frequency = sqrt(least2);
    }
    r->spectrum_known = true;
    return true;
}

/* Whether the error has not halved for so many periods of the lowest mode and steps. At the full load only.
 */
static bool stays(const struct relaxation *r, double periods, int64_t steps)
{
    double period = 2.0 * pi / (r->report->lowest_frequency * r->time_step);
    return (double)(r->report->steps - r->best_step) > periods * period + (double)steps;
}

/* The estimate that round-off alone makes: forces are known to some units in the last place of a cell's
 * stiffness times its size, which the mass is, and most of that is no slow mode. */
static double round_off(const struct relaxation *r)
{
    double low = r->report->lowest_frequency;
    return 32.0 * DBL_EPSILON * r->spacing / (low * low * r->largest_move);
}

static void note_best(struct relaxation *r)
{
    if (r->at_full_load <= check_interval || r->report->error < 0.5 * r->best_error) {
        r->best_error = r->report->error;
        r->best_step = r->report->steps;
    }
}

/* After a measured step: the error, and what follows the state: mass, time step, ties. False on failure. */
static bool follow(struct relaxation *r, struct error *error)
{
    double *u = r->u, ramp = (double)r->report->ramp_steps;
    estimate(r);
    if (r->at_full_load <= check_interval) { /* take out what round-off has left */
        constraint_project(&r->constraint, r->system->factor, u);
    }
    if (r->report->steps % keep_interval == 0) {
        keep_state(r, u);
    }
    /* Near the end the ties stay as they are, so that the last digits converge. */
    r->ties_settled = r->ties_settled ||
                      (r->at_full_load > 0 && (r->report->error < 1e-3 || (double)r->at_full_load > ramp));
    r->residual_at = r->before;
    if (!r->ties_settled) {
        compatibility_update(&r->system->body);
        (void)system_residual(r->system, u, r->residual);
        r->report->force_evaluations++;
        r->residual_at = u;
    }
    if (!update_mass(r, error)) {
        return false;
    }
    update_time_step(r, r->residual_at, later_iterations);
    return true;
}

/* Whether the run ends at this check, and how. A failure ends it, too. */
static bool ends(struct relaxation *r, enum relaxation_outcome *outcome, struct error *error)
{
    const double *error_now = &r->report->error, tolerance = r->options->tolerance;
    bool small = r->at_full_load > 2 * check_interval && *error_now <= tolerance;
    r->settled = small ? r->settled + 1 : 0;
    *outcome = RELAXATION_STOPPED;
    if (r->settled >= 2 && !r->spectrum_known && !find_lowest_mode(r, r->residual_at, error)) {
        return true;
    }
    *outcome = RELAXATION_CONVERGED;
    if (r->settled >= 2 && *error_now <= tolerance) {
        if (contacts_hold(r)) {
            return true;
        }
        r->settled = 0;
    }
    note_best(r);
    if (*error_now <= round_off(r) && stays(r, 2.0, 200) && contacts_hold(r)) {
        return true;
    }
    *outcome = RELAXATION_STALLED;
    return stays(r, 20.0, 5000);
}

static bool is_interrupted(const struct relaxation *r)
{
    return r->options->interrupted != NULL && *r->options->interrupted != 0;
}

static enum relaxation_outcome iterate(struct relaxation *r, struct error *error)
{
    double ramp = (double)r->report->ramp_steps;
    int64_t most = r->options->most_steps > 0 ? r->options->most_steps : 1000000;
    bool gives_frames = r->options->frame != NULL && r->options->frames > 0;
    enum relaxation_outcome outcome;
    while (r->report->steps < most) {
        bool measure = ++r->report->steps % check_interval == 0;
        r->load = fmin(ramp, r->load + r->load_rate);
        r->at_full_load = r->load < ramp ? 0 : r->at_full_load + 1;
        change_load(r, r->load / ramp);
        if (!step(r, r->u, measure)) {
            measure = false;
            if (!step_back(r, r->u)) {
                return RELAXATION_INVERTED;
            }
        } else if (gives_frames && r->load < ramp) {
            give_frames(r, (int64_t)r->load, r->u);
        }
        if (measure && !follow(r, error)) {
            return RELAXATION_STOPPED;
        }
        if (measure && ends(r, &outcome, error)) {
            return outcome;
        }
        if ((measure || is_interrupted(r)) && !tell(r)) {
            return RELAXATION_STOPPED;
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

/* From u, brought onto the conditions, at rest and without load. */
static enum status begin(struct relaxation *r, struct error *error)
{
    enum status status;
    struct solid_system *system = r->system;
    size_t bytes = (size_t)r->size * sizeof *r->u;
    system_load_factors(system, 0.0);
    (void)system_residual(system, r->u, r->residual);
    system_relaxation_mass(system, r->mass);
    TRY(system_constrain(system, r->mass, &r->constraint, error));
    constraint_project(&r->constraint, system->factor, r->u);
    (void)system_residual(system, r->u, r->residual);
    memcpy(r->newer.u, r->u, bytes);
    memcpy(r->older.u, r->u, bytes);
    r->report->ramp_steps = r->options->ramp_steps > 0 ? r->options->ramp_steps : choose_ramp(r);
    update_time_step(r, r->u, first_iterations);
    r->low2 = r->frequency * r->frequency * 1e-4;
    r->damping = 2.0 * sqrt(r->low2);
    for (int i = 0; i < WINDOWS; i++) {
        r->window[i] = r->low2;
    }
done:
    return status;
}

/* From where another run was. */
static enum status resume(struct relaxation *r, struct error *error)
{
    enum status status;
    TRY(visit(r, r->options->restored, error));
    TRY(system_constrain(r->system, r->mass, &r->constraint, error));
done:
    return status;
}

enum status relaxation_run(struct solid_system *system, const struct relaxation_options *options, double *u,
                           double *row_force, struct relaxation_report *report, struct error *error)
{
    enum status status;
    struct relaxation r = {.system = system,
                           .options = options,
                           .report = report,
                           .size = system->node_count * system->dim,
                           .u = u,
                           .load_rate = 1.0,
                           .caution = 1.0,
                           .spectrum2 = INFINITY};
    *report = (struct relaxation_report){.least_jacobian = 1.0};
    TRY(allocate(&r, error));
    r.spacing = node_spacing(system);
    r.penetration_allowed = penetration_share * body_size(system);
    TRY(options->restored != NULL ? resume(&r, error) : begin(&r, error));
    report->outcome = iterate(&r, error);
    TRY(r.failure);
    report->largest_frequency = r.frequency;
    if (report->outcome == RELAXATION_CONVERGED && options->frame != NULL && options->frames > 0) {
        options->frame(options->context, options->frames, 1.0, u);
    }
    if (row_force != NULL && system->rows.count > 0) {
        measure_row_forces(&r, u, row_force);
    }
done:
    release(&r);
    return status;
}
