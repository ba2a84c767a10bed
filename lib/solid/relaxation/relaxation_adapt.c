/* Load, mass, time step and contacts adapted to the state of a relaxation. */
#include "base/box.h"
#include "base/vector.h"
#include "solid/relaxation/relaxation_private.h"

#include <math.h>
#include <string.h>

/* Steps of loading for a prescribed motion by the spacing of the nodes, and by the body's size; the least
 * number for a run from rest, and for one with a given start. */
static const double steps_per_spacing = 20.0, steps_per_size = 400.0, least_ramp = 75.0,
                    least_of_start = 20.0;
/* The coarse space is measured anew when a node has moved by this multiple of the body's thickness, or the
 * largest frequency has risen by this factor. Soft directions turn with the body and become stiff, the more
 * so the slenderer the body is. */
static const double most_moved = 1.4, most_raised = 1.25;
/* The rate of loading is reduced when a node moves by more than this share of the body's size in a step, a
 * little more than prescribed motions do. */
static const double most_move_per_step = 1.0 / 320.0;
/* And not further than to this share: while the body snaps to another state the load is practically held, and
 * goes on soon after. */
static const double least_rate = 1e-3;
/* First guess of the lowest eigenvalue, by the result of FIRST_ITERATIONS, which is up to about seven times
 * too large. */
static const double first_share = 0.15;
static const double first_share_of_largest =
    1e-4; /* the same by the largest eigenvalue, if that result is negative and the run is from rest */
static const int64_t most_backtracks = 8;                        /* from inverted points */
static const double most_stiffening = 1.1, most_softening = 0.5; /* of a node since its mass was set */
/* A mode is slow if its frequency is below the largest one by this factor. It is alone if the cosine between
 * increment and velocity has exceeded this value at so many checks in a row. */
static const double slow_ratio = 50.0, steady_cosine = 0.99;
static const int64_t least_steady_checks = 5;
static const int calm_iterations = 5;       /* of the power iteration on a mode that may be unstable */
static const double most_mass_checks = 5.0; /* between checks of the mass */

/* Of contacts at a load. */
static const int64_t most_augmentations = 100;

double relaxation_body_size(const struct solid_system *system)
{
    struct box box = box_of(system->dim, system->node_count, system->X);
    return box_diagonal(&box);
}

double relaxation_thickness(const struct solid_system *system)
{
    return pow(body_volume(&system->body) / relaxation_body_size(system), 1.0 / (system->dim - 1));
}

int64_t relaxation_choose_ramp(const struct relaxation *r)
{
    double largest = system_longest_change(r->system);
    double steps = fmax(steps_per_spacing * largest / r->spacing, steps_per_size * largest / r->body_size);
    steps = fmax(steps, r->system->rows.start != NULL ? least_of_start : least_ramp);
    return steps > 1e7 ? 10000000 : (int64_t)steps;
}

void relaxation_control_load(struct relaxation *r)
{
    double allowed = CHECK_INTERVAL * most_move_per_step * r->body_size;
    r->load_rate *= fmin(1.2, allowed / r->moved);
    r->load_rate = fmin(r->top_rate, fmax(least_rate * r->top_rate, r->load_rate));
}

/* Set the time step by the largest frequency at u. */
static void update_time_step(struct relaxation *r, const double *u, int iterations)
{
    double frequency = system_largest_frequency(r->system, &r->preconditioner, u, r->residual, iterations,
                                                r->mode, r->scratch);
    r->report->force_evaluations += iterations;
    /* The power iteration estimates from below and fluctuates: follow a rise at once, a fall slowly. */
    r->frequency = frequency > r->frequency ? frequency : 0.98 * r->frequency + 0.02 * frequency;
    r->time_step = r->step_safety * r->options->time_step_margin * 2.0 / r->frequency;
}

void relaxation_follow_time_step(struct relaxation *r, const double *u, int iterations)
{
    double before = r->frequency;
    update_time_step(r, u, iterations);
    if (r->held_steps == 0) {
        r->time_step *= fmin(1.0, before / r->frequency);
    }
}

/* Whether the mass is to be set anew, at a change above 1. Otherwise schedule the next check for when the
 * stiffness, at its present rate, has gone half the remaining way: a check costs as much as several
 * evaluations. */
static bool note_mass_change(struct relaxation *r, double change)
{
    double a_check = fabs(change - r->mass_change) / (double)(r->checks - r->last_mass_check);
    r->mass_change = change > 1.0 ? 0.0 : change;
    r->last_mass_check = r->checks;
    r->next_mass_check =
        r->checks + (int64_t)fmin(most_mass_checks, fmax(1.0, 0.5 * (1.0 - r->mass_change) / a_check));
    return change > 1.0;
}

bool relaxation_update_mass(struct relaxation *r, struct error *error)
{
    double *mass = r->scratch, highest = 1.0, lowest = 1.0;
    system_relaxation_mass(r->system, false, mass);
    for (int64_t n = 0; n < r->system->node_count; n++) {
        highest = fmax(highest, mass[n] / r->preconditioner.stiffness[n]);
        lowest = fmin(lowest, mass[n] / r->preconditioner.stiffness[n]);
    }
    if (!note_mass_change(r, fmax(log(highest) / log(most_stiffening), log(lowest) / log(most_softening)))) {
        return true;
    }
    r->failure = preconditioner_set_mass(&r->preconditioner, r->system, mass, error);
    relaxation_note_new_mass(r);
    return r->failure == STATUS_OK;
}

bool relaxation_update_preconditioner(struct relaxation *r, struct error *error)
{
    bool moved = r->largest_move > r->measured_move + most_moved * r->thickness;
    bool stiffened = r->frequency > most_raised * r->measured_frequency;
    if (r->preconditioner.size == 0 || !(moved || stiffened || preconditioner_is_stale(&r->preconditioner))) {
        return true;
    }
    r->failure = relaxation_measure_preconditioner(r, error);
    return r->failure == STATUS_OK;
}

void relaxation_note_new_mass(struct relaxation *r)
{
    r->lanczos_bound = INFINITY;
    r->spectrum_known = false;
}

enum status relaxation_measure_preconditioner(struct relaxation *r, struct error *error)
{
    struct spectrum spectrum;
    enum status status = preconditioner_measure(&r->preconditioner, r->system, r->residual_at,
                                                &r->report->force_evaluations, error);
    (void)system_residual(r->system, r->residual_at, r->residual); /* the body's last evaluation again */
    (void)preconditioner_follow(&r->preconditioner, r->system, true, NULL, NULL);
    relaxation_note_new_mass(r);
    RETURN_IF_ERROR(status);
    if (!relaxation_find_spectrum(r, r->residual_at, FIRST_ITERATIONS, &spectrum, error)) {
        return r->failure;
    }
    r->frequency = sqrt(fmax(spectrum.largest, 0.0));
    update_time_step(r, r->residual_at, 1); /* contacts that may close are not in the spectrum */
    /* A given start may be far from equilibrium: with hardly any damping it would be thrown farther off. */
    bool by_lowest = spectrum.lowest > 0.0 || r->system->rows.start != NULL;
    relaxation_damp_at_most(r, by_lowest ? first_share * fabs(spectrum.lowest)
                                         : first_share_of_largest * spectrum.largest);
    r->measured_frequency = r->frequency;
    r->measured_move = r->largest_move;
    return STATUS_OK;
}

bool relaxation_add_slow_mode(struct relaxation *r, const double *du, struct error *error)
{
    if (r->held_steps <= CHECK_INTERVAL || r->report->steps - r->augmented_step < CHECK_INTERVAL) {
        return true;
    }
    double square = vector_product(r->size, du, du), along = vector_product(r->size, du, r->velocity);
    double speed2 = vector_product(r->size, r->velocity, r->velocity);
    bool steady = r->quotient > 0.0 && along > steady_cosine * sqrt(square * speed2);
    r->steady_checks = steady ? r->steady_checks + 1 : 0;
    if (r->steady_checks < least_steady_checks ||
        !(slow_ratio * slow_ratio * r->quotient < r->frequency * r->frequency)) {
        return true;
    }
    r->failure = preconditioner_add_slow_mode(&r->preconditioner, du, error);
    r->steady_checks = 0;
    r->slow_mode_step = r->report->steps;
    r->usual_square = 0.0;
    relaxation_note_new_mass(r);
    return r->failure == STATUS_OK;
}

/* Copy *newer to *older, and the present state to *newer. */
static void keep(const struct relaxation *r, struct kept_state *newer, struct kept_state *older)
{
    double *spare = older->u;
    *older = *newer;
    newer->u = spare;
    newer->load = r->load;
    memcpy(newer->u, r->u, (size_t)r->size * sizeof *r->u);
    memcpy(newer->u + r->size, r->velocity, (size_t)r->size * sizeof *r->velocity);
}

void relaxation_keep_state(struct relaxation *r)
{
    keep(r, &r->newer, &r->older);
}

void relaxation_keep_check(struct relaxation *r)
{
    keep(r, &r->check_now, &r->check_before);
}

void relaxation_go_back(struct relaxation *r, const struct kept_state *kept)
{
    r->load = kept->load;
    r->back_step = r->report->steps;
    r->steady_checks = 0;
    memcpy(r->u, kept->u, (size_t)r->size * sizeof *r->u);
    memcpy(r->velocity, kept->u + r->size, (size_t)r->size * sizeof *r->velocity);
    system_load_factors(r->system, fmin(1.0, r->load / (double)r->report->ramp_steps));
}

bool relaxation_step_back(struct relaxation *r, struct error *error)
{
    if (r->backtracks == most_backtracks) {
        return false;
    }
    r->backtracks++;
    r->step_safety *= 0.8;
    r->top_rate *= 0.5;
    r->load_rate = r->top_rate;
    relaxation_go_back(r, &r->older);
    memset(r->velocity, 0, (size_t)r->size * sizeof *r->velocity);
    for (int i = 0; i < 2; i++) { /* the states kept since then lead to the inversion */
        relaxation_keep_state(r);
        relaxation_keep_check(r);
    }
    memset(r->mode, 0, (size_t)r->size * sizeof *r->mode);
    r->residual_at = r->u;
    if (!(system_residual(r->system, r->u, r->residual).least_jacobian > 0.0)) {
        return false;
    }
    memcpy(r->last_u, r->u, (size_t)r->size * sizeof *r->u); /* the return is no increment of the motion */
    memcpy(r->last_residual, r->residual, (size_t)r->size * sizeof *r->residual);
    system_relaxation_mass(r->system, false, r->scratch);
    r->mass_change = 0.0;
    r->last_mass_check = r->next_mass_check = r->checks;
    r->failure = preconditioner_set_mass(&r->preconditioner, r->system, r->scratch, error);
    if (r->failure == STATUS_OK) {
        r->failure = relaxation_measure_preconditioner(r, error);
    }
    return r->failure == STATUS_OK;
}

/* Whether the frequency of the acceleration's mode exceeds the stability limit of the time step. */
static bool is_unstable(struct relaxation *r, const double *acceleration)
{
    memcpy(r->mode, acceleration, (size_t)r->size * sizeof *r->mode);
    (void)system_residual(r->system, r->u, r->residual);
    double frequency = system_largest_frequency(r->system, &r->preconditioner, r->u, r->residual,
                                                calm_iterations, r->mode, r->scratch);
    r->report->force_evaluations += calm_iterations + 1;
    return !(frequency * r->time_step < 2.0);
}

bool relaxation_calm(struct relaxation *r, const double *acceleration)
{
    r->calmed_step = r->report->steps;
    r->usual_square = 0.0;
    if (!is_unstable(r, acceleration)) {
        (void)system_residual(r->system, r->before, r->residual); /* the last evaluation again */
        r->report->force_evaluations++;
        return false;
    }
    relaxation_go_back(r, &r->check_before);
    relaxation_keep_check(r);
    r->residual_at = r->u;
    (void)system_residual(r->system, r->residual_at, r->residual);
    r->report->force_evaluations++;
    update_time_step(r, r->residual_at, calm_iterations);
    return true;
}

bool relaxation_contacts_lack(const struct relaxation *r)
{
    return r->held_steps == 0 ||
           (r->augmentations < most_augmentations &&
            system_contacts_give_way(r->system, r->residual_at, r->move, r->options->tolerance));
}

bool relaxation_contacts_hold(struct relaxation *r)
{
    system_measure_contacts(r->system, r->residual_at, false);
    r->report->penetration = system_contact_miss(r->system);
    r->report->penetration_allowed = system_penetration_allowed(r->move);
    return !relaxation_contacts_lack(r);
}
