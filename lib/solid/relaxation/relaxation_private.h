/* The state of a relaxation and the functions of its parts; see relaxation.h. */
#pragma once

#include "solid/preconditioner/frequency.h"
#include "solid/preconditioner/preconditioner.h"
#include "solid/relaxation/relaxation.h"

enum { CHECK_INTERVAL = 10 };   /* steps between estimates */
enum { FIRST_ITERATIONS = 30 }; /* of Lanczos, after the coarse space was measured */
enum { WINDOWS = 8 };           /* recent Rayleigh quotients that the error estimate uses */

/* Least time between augmentations, of contacts and of nodal pressures, times the damping. Oscillating modes
 * are stable above 2 ln 3. */
#define RELAXATION_PAUSE 3.0

/* A state to which the run may return. */
struct kept_state {
    double *u; /* followed by the velocity */
    double load;
};

struct relaxation {
    struct solid_system *system;
    const struct relaxation_options *options;
    struct relaxation_report *report;
    struct preconditioner preconditioner;
    int64_t size;
    double *u, *row_force; /* the caller's; row_force may be NULL */
    double *velocity, *residual, *before;
    const double *residual_at; /* where the residual is known, at a check: u or before */
    double *factor_change;     /* of the load curves in this step */
    double *mode;
    double *scratch;                /* 5 * size */
    double *last_u, *last_residual; /* at the last check */
    double *acceleration;
    double time_step, damping, frequency; /* current; frequency: largest */
    double lowest_eigenvalue; /* estimate (26) of that of M^-1 K that is still active; dimensionless */
    double lanczos_bound; /* upper bound of it, by Lanczos iteration at the load that is held; INFINITY until
                             then */
    double window[WINDOWS];
    double quotient;        /* Rayleigh quotient (26) at the last check, before limits; 0 if nothing moved */
    int64_t steady_checks;  /* in a row, at which the motion went on in one direction */
    int64_t slow_mode_step; /* of the last slow mode that was added to the preconditioner */
    int64_t checks;
    double best_error; /* at the load that is held, reached in best_step; the error has not halved since */
    int64_t best_step;
    double spacing;                           /* mean, of the nodes, m */
    double body_size;                         /* diagonal of the nodes' box, m */
    double thickness;                         /* mean, across that diagonal, m */
    double measured_frequency, measured_move; /* the largest ones when the coarse space was measured */
    double usual_square;                      /* r . M^-1 r of the residual is compared with it */
    bool unstable;                /* r . M^-1 r exceeded a multiple of usual_square in the last step */
    int64_t calmed_step;          /* of the last relaxation_calm */
    int64_t back_step;            /* of the last return to a kept state */
    int64_t augmented_step;       /* of the last augmentation */
    int64_t augmentations;        /* of contacts at the load that is held */
    int64_t steady_augmentations; /* consecutive ones of pressures at the load that is held */
    double pressures_lack; /* share of the nodal pressures that the multipliers lack; see body_augment */
    enum status failure;
    double load,
        load_rate;   /* applied so far, in steps of the ramp; and its rate per step, at most top_rate */
    double top_rate; /* 1 until an inversion */
    double moved;    /* of a node between the last two checks, m */
    double largest_displacement; /* so far, in the norm of the mass */
    double largest_move;         /* so far, of a node, m */
    double displacement, move;   /* scales of errors: those of the present field, but no less than the
                                  * tolerance times the largest so far: a scene may end at rest */
    bool spectrum_known;         /* lanczos_bound belongs to the present mass and load */
    double step_safety;          /* on the time step: 1 until an inversion */
    int64_t backtracks;
    struct kept_state newer, older;            /* the last two of relaxation_keep_state, */
    struct kept_state check_now, check_before; /* and those of the last two checks */
    int64_t frames;                            /* reported so far, without frame 0 */
    int64_t
        held_steps; /* steps in a row at a constant load, that of a frame or the full one; 0 while it grows */
    int64_t converged_checks; /* checks in a row with a small error */
    double mass_change; /* of the stiffness since the mass was set, by the change at which it is set anew */
    int64_t last_mass_check, next_mass_check; /* numbers of the last check of the mass and of the next */
};

/* ---- relaxation_error.c: how far from equilibrium ---- */

/* After a measured step: the Rayleigh quotient of the increments since the last check, which stay in
 * scratch[size], the damping, the error. `before` holds the u at which the acceleration was measured. */
void relaxation_estimate(struct relaxation *r);

/* Compute the lowest mode at u, where the residual is known, and set the damping by it. The increments do not
 * show a slow mode while fast modes decay. False on failure. */
bool relaxation_find_lowest_mode(struct relaxation *r, const double *u, struct error *error);

/* The bounds of the spectrum at u, where the residual is known, by at most most_iterations evaluations. False
 * on failure. */
bool relaxation_find_spectrum(struct relaxation *r, const double *u, int most_iterations,
                              struct spectrum *spectrum, struct error *error);

/* Lower the estimate of the lowest eigenvalue to lowest_eigenvalue if it is larger, and the damping with it.
 */
void relaxation_damp_at_most(struct relaxation *r, double lowest_eigenvalue);

/* Whether the load is held and the error has not halved for at least this many periods of the lowest mode and
 * this many steps. */
bool relaxation_stays(const struct relaxation *r, double periods, int64_t steps);

/* The error estimate that round-off alone causes. The round-off of forces is some units in the last place of
 * a cell's stiffness times its size. The mass is in proportion to that stiffness, and most of this noise is
 * orthogonal to slow modes. */
double relaxation_round_off(const struct relaxation *r);

/* Update best_error and best_step. */
void relaxation_note_best(struct relaxation *r);

/* ---- relaxation_adapt.c: load, mass, time step and contacts that follow the run ---- */

/* Length of the diagonal of the nodes' box. */
double relaxation_body_size(const struct solid_system *system);

/* Width of a bar that is as long as the box's diagonal and has the body's volume. */
double relaxation_thickness(const struct solid_system *system);

/* The number of steps of loading. In a step the body as a whole is strained by less than half a percent, so
 * that mass and time step can follow the state. Cells beside a moving boundary are strained by a few percent
 * at most before the front of the load, which passes about one cell in a step, reaches the next ones. If a
 * cell is inverted nevertheless, the loading continues more slowly (relaxation_step_back). */
int64_t relaxation_choose_ramp(const struct relaxation *r);

/* If the load is held and the increment du[size] since the last check has been parallel to the velocity at
 * enough checks, and is slow: add it to the slow modes of M. Checks within an interval of an augmentation do
 * not count. False on failure. */
bool relaxation_add_slow_mode(struct relaxation *r, const double *du, struct error *error);

/* Reduce the rate of loading while the body moves farther in a step than prescribed displacements would move
 * it: forces may. */
void relaxation_control_load(struct relaxation *r);

/* Set the time step by the largest frequency at u, from this many power iterations, at a check. While the
 * load grows, the frequency is assumed to rise until the next check as much as since the last one. */
void relaxation_follow_time_step(struct relaxation *r, const double *u, int iterations);

/* Set the mass anew if the body has stiffened or softened enough since it was last set, so that the critical
 * step holds through large strains; and schedule the next such check. False on failure. */
bool relaxation_update_mass(struct relaxation *r, struct error *error);

/* Discard what was computed of the lowest mode with the mass before. */
void relaxation_note_new_mass(struct relaxation *r);

/* Measure the coarse space anew if the body has changed enough since the last time. False on failure. */
bool relaxation_update_preconditioner(struct relaxation *r, struct error *error);

/* Measure the stiffness along the coarse fields of the preconditioner at r->residual_at, and set the time
 * step anew. */
MUST_CHECK enum status relaxation_measure_preconditioner(struct relaxation *r, struct error *error);

/* Keep the state of a check. */
void relaxation_keep_check(struct relaxation *r);

/* Keep a state. Of two kept ones the older precedes any instability that has become visible. */
void relaxation_keep_state(struct relaxation *r);

/* After an inverted point: return to an earlier state, at rest, and continue with smaller steps and a slower
 * load. False after too many attempts, as the deformation itself inverts points, and on failure. */
bool relaxation_step_back(struct relaxation *r, struct error *error);

/* Whether the contacts need an augmentation. While the load grows they always do, as otherwise the
 * multipliers would change at once at the end. At a held load they do while the penetration, or the work of
 * the contact forces along it, exceeds its limit. */
bool relaxation_contacts_lack(const struct relaxation *r);

/* Whether the contacts admit a converged state; reports their penetration. */
bool relaxation_contacts_hold(struct relaxation *r);

/* Return to a kept state and its load. */
void relaxation_go_back(struct relaxation *r, const struct kept_state *kept);

/* If the mode of the acceleration is unstable at the present time step, return to the state of the check
 * before the last, set the time step by that mode, and return true. */
bool relaxation_calm(struct relaxation *r, const double *acceleration);

/* ---- relaxation_report.c: progress and frames ---- */

/* The share of the load at u. A run with a given start (system_start) has the whole load from its first step
 * on. */
double relaxation_load_share(const struct relaxation *r);

/* Call the caller's progress function; false where that ends the run. */
bool relaxation_tell(struct relaxation *r);

/* Evaluate the system at u. row_force[system->rows.count], unless NULL: the forces of the conditions, which
 * balance the residual along them, N (2D: N/m). */
MUST_CHECK enum status relaxation_row_forces(struct relaxation *r, const double *u, double *row_force,
                                             struct error *error);

/* Whether the caller asks for frames. */
bool relaxation_gives_frames(const struct relaxation *r);

/* The load of the next equilibrium, in steps of the ramp: that of the next frame, or the whole load. */
double relaxation_load_to_hold(const struct relaxation *r);

/* Report u, which is in equilibrium, as the next frame. False on failure. */
bool relaxation_give_frame(struct relaxation *r, struct error *error);

/* ---- relaxation_state.c: memory and checkpoints ---- */

MUST_CHECK enum status relaxation_allocate(struct relaxation *r, struct error *error);

void relaxation_release(struct relaxation *r);

/* Visit all that the next step needs from the steps before; see base/state.h. */
MUST_CHECK enum status relaxation_visit(void *run, const struct state *state, struct error *error);
