/* Explicit dynamics: central differences (leapfrog, velocities at half steps; equations (21) and (22) of
 * lib/README.md) with the lumped mass, which is never scaled. Projection meets the conditions exactly in each
 * step (constraint.h). Contacts act by their penalty.
 *
 * The step is a share of the critical one, 2 / w, where w bounds the largest frequency of M^-1 K. A power
 * iteration at the start estimates w; one iteration at regular intervals continues it. The stiffness of all
 * contacts is added as a bound, so that a touch cannot make the step too long. The last step ends exactly at
 * the end time. */
#pragma once

#include "solid/system/energy.h"
#include "solid/system/progress.h"
#include "solid/system/system.h"

#include <signal.h>

struct dynamics_options {
    double end_time;         /* T, s, > 0; load curves are taken at t / T */
    double time_step_margin; /* share of the critical step, within (0, 1) */
    double damping;          /* c >= 0, 1/s: forces - c M v */
    int64_t most_steps;      /* 0: no bound */
    double frame_interval;   /* s between frames, 0: none; the last one may be at T */
    frame_function *frame;   /* NULL: none */
    progress_function *progress;
    void *context;                            /* of frame and progress */
    const volatile sig_atomic_t *interrupted; /* unless NULL: progress is called at the end of the step in
                                                 which this became other than 0 */
    const struct state *restored; /* NULL: from the start; else the state of a run of the same system and
                                 options (see struct progress), which is continued */
};

/* Largest admissible error of the energy balance, relative to the largest energy. */
#define DYNAMICS_MOST_DRIFT 0.05
#define DYNAMICS_NOTED_DRIFT 0.01 /* the share above which it is noted */

/* A step below this share of the first one counts as a collapse. */
#define DYNAMICS_LEAST_STEP 1e-3

enum dynamics_outcome {
    DYNAMICS_DONE,
    DYNAMICS_TOO_MANY_STEPS,
    DYNAMICS_INVERTED,  /* J <= 0 or not a number at a point */
    DYNAMICS_COLLAPSED, /* the critical step fell below DYNAMICS_LEAST_STEP of the first one */
    DYNAMICS_DRIFTED,   /* the energy balance is off by more than DYNAMICS_MOST_DRIFT */
    DYNAMICS_STOPPED    /* by the progress function */
};

struct dynamics_report {
    enum dynamics_outcome outcome;
    int64_t steps;             /* done */
    int64_t force_evaluations; /* those of the power iteration and of the energies included */
    int64_t step_changes;
    double time;      /* reached, s */
    double last_good; /* time of the state u: that reached, or for DYNAMICS_INVERTED that of the step before;
                     negative: there is no good state */
    double first_step, least_step;    /* s */
    double critical_step;             /* at the start, s */
    double largest_drift, last_drift; /* |error| of the energy balance, relative */
    double least_jacobian;            /* over the body, at the last check */
    int64_t point;                    /* where: the caller's index */
    int64_t node; /* DYNAMICS_COLLAPSED: where the highest mode is largest; DYNAMICS_DRIFTED: the fastest */
};

/* Step from the parameters u and their velocities v (m/s; NULL: at rest) at time 0 to the end time; both are
 * replaced by those at the time reached. At the start, u and v are projected onto the conditions, which
 * counts as work. row_force[system->rows.count], unless NULL, receives the forces of the conditions at the
 * end, inertia included, N (2D: N/m). log, unless NULL, receives the first and the last state and about 200
 * rows between. STATUS_VERDICT for inconsistent conditions. An outcome other than done is not an error
 * status: see the report. */
MUST_CHECK enum status dynamics_run(struct solid_system *system, const struct dynamics_options *options,
                                    double *u, double *v, double *row_force, struct energy_log *log,
                                    struct dynamics_report *report, struct error *error);
