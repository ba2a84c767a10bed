/* What the parts of the relaxation share; see relaxation.h. */
#pragma once

#include "solid/preconditioner/frequency.h"
#include "solid/preconditioner/preconditioner.h"
#include "solid/relaxation/relaxation.h"

enum { CHECK_INTERVAL = 10 };   /* steps between estimates */
enum { FIRST_ITERATIONS = 30 }; /* of Lanczos, where the preconditioner was measured */
enum { WINDOWS = 8 };           /* recent Rayleigh quotients that the error estimate uses */

/* Between augmentations, of contacts and of nodal pressures: damping times time. Modes that swing are stable
 * above 2 ln 3. */
#define RELAXATION_PAUSE 3.0

/* A state to go back to. */
struct kept_state {
    double *u; /* and behind it the velocity */
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
    double low2;                          /* current estimate of the lowest frequency, squared */
    double spectrum2; /* what it may not be above: found at the load that is held; before, INFINITY */
    double window[WINDOWS];
    int64_t checks;
    double best_error; /* at the load that is held, since best_step: not yet half of it */
    int64_t best_step;
    double spacing;                           /* mean, of the nodes, m */
    double body_size;                         /* diagonal of the nodes' box, m */
    double thickness;                         /* mean, across that, m */
    double measured_frequency, measured_move; /* the largest ones, when the preconditioner was measured */
    double usual_residual2;                   /* what the residual's norm, squared, is compared with */
    bool unstable;                            /* it grew far above that in the last step */
    int64_t calmed_step;                      /* the last step at which that was mended */
    int64_t back_step;                        /* the last step that went back to a kept state */
    int64_t augmented_step;                   /* when multipliers took over last */
    int64_t augmentations;                    /* of contacts at the load that is held */
    int64_t steady_augmentations;             /* of pressures, all under the load that is held */
    double pressures_lack; /* part of the nodal pressures that is still to come; see body_augment */
    enum status failure;
    double load, load_rate;      /* steps of the ramp applied so far, and per step, at most top_rate */
    double top_rate;             /* 1 until an inversion */
    double moved;                /* of a node between the last two checks, m */
    double largest_displacement; /* so far, in the norm of the mass */
    double largest_move;         /* so far, of a node, m */
    bool spectrum_known;         /* spectrum2 is of the mass and the load as they are */
    double step_safety;          /* on the time step: 1 until an inversion */
    int64_t backtracks;
    struct kept_state newer, older;            /* every so often, */
    struct kept_state check_now, check_before; /* at the last two checks */
    int64_t frames;                            /* given so far, but for the first, 0 */
    int64_t
        at_full_load; /* steps since the load that is held, that of a frame or the full one, was reached */
    int64_t converged_checks; /* checks in a row with a small error */
    double mass_change;       /* of the stiffness since the mass was set: 1 where it is set anew */
    int64_t last_mass_check, next_mass_check; /* numbers of the last check of the mass and of the next */
};

/* ---- relaxation_error.c: how far from equilibrium ---- */

/* After a measured step: the Rayleigh quotient of the increments since the last check, the damping, the
 * error. `before` holds the u at which the acceleration was measured. */
void relaxation_estimate(struct relaxation *r);

/* Find the lowest mode at u, where the residual is known: while fast modes die out a slow one does not show
 * in the increments. Takes the damping from it. False on failure. */
bool relaxation_find_lowest_mode(struct relaxation *r, const double *u, struct error *error);

/* The spectrum at u, where the residual is known, by at most so many evaluations. False on failure. */
bool relaxation_find_spectrum(struct relaxation *r, const double *u, int most_iterations,
                              struct spectrum *spectrum, struct error *error);

/* The lowest eigenvalue is at most this. */
void relaxation_damp_at_most(struct relaxation *r, double low2);

/* Whether the error has not halved for so many periods of the lowest mode and steps. At the full load only.
 */
bool relaxation_stays(const struct relaxation *r, double periods, int64_t steps);

/* The estimate that round-off alone makes: forces are known to some units in the last place of a cell's
 * stiffness times its size, which the mass is, and most of that is no slow mode. */
double relaxation_round_off(const struct relaxation *r);

/* Keep the least error at the full load in view. */
void relaxation_note_best(struct relaxation *r);

/* ---- relaxation_adapt.c: load, mass, time step and contacts that follow the run ---- */

/* Length of the diagonal of the nodes' box. */
double relaxation_body_size(const struct solid_system *system);

/* Width of a bar that is as long as the box's diagonal and has the body's volume. */
double relaxation_thickness(const struct solid_system *system);

/* Steps to apply the load in: slow enough that the whole is strained by less than half a percent a step, so
 * that what follows the state can do so, and cells beside what moves by a few percent at most before the
 * front of the load, which passes about a cell in a step, takes the next ones along. Where that is too fast
 * for a cell it is inverted, and the load goes on slower (relaxation_step_back). */
int64_t relaxation_choose_ramp(const struct relaxation *r);

/* Let the load go on only as fast as the body can follow: forces may move it as far as prescribed
 * displacements never do in a step. */
void relaxation_control_load(struct relaxation *r);

/* Take the critical step at u from the largest frequency. */
void relaxation_update_time_step(struct relaxation *r, const double *u, int iterations);

/* The same at a check: while the load grows the frequency is taken to rise until the next check as it did
 * since the last one. */
void relaxation_follow_time_step(struct relaxation *r, const double *u, int iterations);

/* Let the mass follow the stiffness where the body has stiffened or softened since it was last set, so that
 * the critical step holds through large strains; and say when to look again. False on failure. */
bool relaxation_update_mass(struct relaxation *r, struct error *error);

/* What was known of the lowest mode was of another mass. */
void relaxation_note_new_mass(struct relaxation *r);

/* Measure the preconditioner anew where the body has changed since that was done. False on failure. */
bool relaxation_update_preconditioner(struct relaxation *r, struct error *error);

/* Measure the stiffness along the coarse fields of the preconditioner at the state where the residual is
 * known, and take the time step from it. */
MUST_CHECK enum status relaxation_measure_preconditioner(struct relaxation *r, struct error *error);

/* At a check: keep the state. */
void relaxation_keep_check(struct relaxation *r);

/* Keep the state every so often; the older of two is safely before any instability that shows. */
void relaxation_keep_state(struct relaxation *r);

/* An inverted point: go back to a state before it, at rest, and go on with smaller steps and a slower load.
 * False when that has been tried often enough - the deformation itself inverts - and on failure. */
bool relaxation_step_back(struct relaxation *r, struct error *error);

/* Whether multipliers of contacts have to follow: always while the load grows, as left to the end they would
 * change at once; at the load that is held where contacts give way by more than they may, for displacements
 * or for forces. */
bool relaxation_contacts_lack(const struct relaxation *r);

/* Whether a converged state may stand; notes what contacts penetrate. */
bool relaxation_contacts_hold(struct relaxation *r);

/* A mode may be unstable, which the acceleration shows. If it is: go on from the check before the last, at
 * rest, with the time step of that mode. */
void relaxation_calm(struct relaxation *r, const double *acceleration);

/* ---- relaxation_report.c: what the caller is told on the way ---- */

/* The share of the load at which u is. A run that begins near its result has all of it from its first step
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

/* The load at which the next equilibrium is sought, in steps of the ramp: that of the next frame, at last the
 * whole load. */
double relaxation_load_to_hold(const struct relaxation *r);

/* Give u, which is in equilibrium, as the next frame. False on failure. */
bool relaxation_give_frame(struct relaxation *r, struct error *error);

/* ---- relaxation_state.c: memory, and what a checkpoint holds ---- */

MUST_CHECK enum status relaxation_allocate(struct relaxation *r, struct error *error);

void relaxation_release(struct relaxation *r);

/* What the next step needs of those before: see base/state.h. */
MUST_CHECK enum status relaxation_visit(void *run, const struct state *state, struct error *error);
