/* Quasi-static solution by dynamic relaxation: central differences with a fictitious mass (preconditioner.h)
 * and a damping that follows the lowest mode still active (a running Rayleigh quotient), stopped by an
 * estimate of the remaining error (Underwood 1983; Papadrakakis 1981; equations (21) to (28) of
 * lib/README.md).
 *
 * Error estimate: with the acceleration a of the residual and the lowest frequency w, |e| <= |a| / w^2, which
 * is exact for a mode of a linear system. It is taken in the norm of the mass without its coarse fields,
 * relative to the largest displacement, and at the worst node, relative to the node that moved most. While
 * fast modes die out the increments do not show a slow one: before a state is accepted, the lowest frequency
 * is computed by Lanczos iteration, and the relaxation continues with it where it is lower. */
#pragma once

#include "solid/system/progress.h"
#include "solid/system/system.h"

#include <signal.h>

struct relaxation_options {
    double tolerance;        /* on the estimated remaining error relative to the displacement, e.g. 1e-6 */
    double time_step_margin; /* share of the critical step, e.g. .9 */
    int64_t ramp_steps; /* steps over which the load is applied; 0: chosen from the largest displacement */
    int64_t most_steps; /* 0: 1e6 */
    int64_t frames; /* equilibria to report, evenly over the ramp: at each the load is held until the error is
                       below the tolerance; the last one is the result */
    bool in_time;   /* Newton's method: the body stands at time 0 already, under the loads there; frame 0 is
                       that   equilibrium, and a frame may change the body, as a step of time does (body_step) */
    frame_function
        *frame; /* NULL: none. Frame 0 is otherwise the initial u. In a call, the system's last evaluation is
                   at the frame's u, and the caller's row_force holds the forces there */
    progress_function *progress;
    void *context;                            /* of frame and progress */
    const volatile sig_atomic_t *interrupted; /* unless NULL: progress is called at the end of the step in
                                                 which this becomes nonzero */
    const bool *folded; /* unless NULL: whether the state at the last call of progress is folded. Then a run
                           whose error does not fall ends after fewer steps, as a folded state is no result */
    const struct state *restored; /* NULL: start anew; else the state of a run of the same system and options
                                     (see struct progress), from which to continue */
};

enum relaxation_outcome {
    RELAXATION_CONVERGED, /* report.error may exceed the tolerance where round-off or contacts prevent less */
    RELAXATION_TOO_MANY_STEPS,
    RELAXATION_STALLED, /* the error no longer falls, well above round-off */
    RELAXATION_AWAY, /* a node has moved by many sizes of the body, and farther than any prescribed motion */
    RELAXATION_INVERTED, /* J <= 0 or not a number at a point */
    RELAXATION_STOPPED   /* by the progress function */
};

struct relaxation_report {
    enum relaxation_outcome outcome;
    int64_t steps;
    int64_t ramp_steps;    /* planned number of steps of loading, */
    int64_t loading_steps; /* and the actual one, backtracks included */
    int64_t force_evaluations;
    double error; /* estimated remaining error, relative to the present displacement: the larger of
                   * those on the whole and at the worst node */
    double move;  /* the largest displacement of a node, m, at least the tolerance times the
                   * largest of the run: the scale of error and penetration_allowed */
    double largest_frequency; /* in the fictitious mass's units */
    double lowest_frequency;
    double penetration, penetration_allowed; /* of contacts, m: see contact_miss */
    double load;            /* share of the load at u, 0..1; RELAXATION_INVERTED: u is an earlier state */
    int64_t worst_node;     /* the farthest from equilibrium at the last estimate, the caller's index */
    int64_t inverted_point; /* the caller's index, RELAXATION_INVERTED */
    double least_jacobian;
};

/* Relax from u (usually zeros) to equilibrium at the full load. row_force[system->rows.count], zeros,
 * unless NULL, receives the forces of the conditions at each frame and at the end, N (2D: N/m).
 * STATUS_VERDICT for constraints that depend on each other (the message names the node); an outcome other
 * than converged is no error status: see the report. */
MUST_CHECK enum status relaxation_run(struct solid_system *system, const struct relaxation_options *options,
                                      double *u, double *row_force, struct relaxation_report *report,
                                      struct error *error);
