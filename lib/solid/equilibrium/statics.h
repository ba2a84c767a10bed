/* Options and report of a search for equilibrium: newton.h, relaxation.h. */
#pragma once

#include "solid/system/progress.h"
#include "solid/system/system.h"

#include <signal.h>

/* Largest ratio of the bulk to the shear modulus in a step, that of Poisson's ratio .49; multipliers, the
 * nodal pressures held, carry the rest. */
#define STATICS_BULK_LIMIT 50.0

/* By the body's size: a body that moves farther, and farther than what is prescribed, has no equilibrium. */
#define STATICS_MOST_SIZES 10.0

struct statics_options {
    double tolerance;        /* on the estimated remaining error relative to the displacement, e.g. 1e-6 */
    double time_step_margin; /* relaxation: share of the critical step, e.g. .9 */
    int64_t ramp_steps;      /* relaxation: steps over which the load is applied; 0: chosen from the largest
                                displacement */
    int64_t most_steps;      /* 0: 1e5 of Newton's method, 1e6 of relaxation */
    int64_t frames;          /* equilibria to report, evenly over the load; the last one is the result; with
                                hold any number above 0 */
    int64_t steps; /* Newton's method: of the load, each of which ends in an equilibrium if there is friction;
                      0 or a multiple of frames */
    bool in_time;  /* Newton's method: the body stands at time 0 already, under the loads there; frame 0 is
                      that equilibrium, and a frame may change the body, as a step of time does (body_step) */
    double (*hold)(void *context, double load); /* the load of the next equilibrium to report; NULL: evenly */
    frame_function
        *frame; /* NULL: none. Frame 0 is otherwise the initial u. In a call, the system's last evaluation is
                   at the frame's u, and the caller's row_force holds the forces there */
    progress_function *progress;
    void *context;                /* of frame and progress */
    const struct state *restored; /* NULL: start anew; else the state of a run of the same system and options
                                     (see struct progress), from which to continue */
};

enum statics_outcome {
    STATICS_CONVERGED, /* report.error may exceed the tolerance where round-off or contacts prevent less */
    STATICS_TOO_MANY_STEPS,
    STATICS_STALLED,  /* the error no longer falls, well above round-off */
    STATICS_AWAY,     /* see STATICS_MOST_SIZES; or friction alone may not hold the body */
    STATICS_INVERTED, /* J <= 0 or not a number at a point, or close to it however short the step */
    STATICS_STOPPED   /* by the progress function */
};

struct statics_report {
    enum statics_outcome outcome;
    int64_t steps;
    int64_t loading_steps; /* of these, those in which the load grew */
    int64_t force_evaluations;
    double error; /* estimated remaining error at the worst node, relative to the present displacement */
    double move;  /* the largest displacement of a node, m, at least the tolerance times the largest of the
                   * run: the scale of error and penetration_allowed */
    bool lost;    /* something acts on the body, but moves it by no more than statics_round_off: error is 0 */
    double penetration, penetration_allowed; /* of contacts, m: see contact_miss */
    double load;                             /* share of the load at u, 0..1 */
    int64_t worst_node;     /* the farthest from equilibrium at the last estimate, the caller's index */
    int64_t inverted_point; /* the caller's index, STATICS_INVERTED */
    double least_jacobian;
};

/* ---- what both methods need ---- */

/* The load of the next equilibrium, `frames` of which have been reported: that of the next frame, or 1. */
double statics_load_to_hold(const struct statics_options *options, int64_t frames);

/* The share of the load at u where it has grown to `load`. A run with a given start (system_start) has the
 * whole load from its first step on. */
double statics_load_share(const struct solid_system *system, double load);

/* Set the load; change[curve_count]: by how much the load curves change from those at load `from`. */
void statics_change_load(struct solid_system *system, double from, double load, double *change);

/* Report u, which is in equilibrium at that share of the load, as the next frame, if there are frames. */
void statics_give_frame(const struct statics_options *options, double share, const double *u,
                        int64_t *frames);

/* Call the caller's progress function for a run whose state `visit` visits; false where that ends it. */
bool statics_tell(const struct statics_options *options, const struct statics_report *report, double share,
                  const double *u, state_function *visit, void *run);

/* How far round-off may move a body on which nothing acts yet, m: one that moves no more is at rest. */
double statics_round_off(const struct solid_system *system);

/* Whether the body has moved farther than any equilibrium is. */
bool statics_is_away(const struct solid_system *system, const struct statics_report *report,
                     double body_size);
