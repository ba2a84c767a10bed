/* Whether the equilibria of a quasi-static run are stable: a body that is compressed far enough buckles,
 * wrinkles or creases. Then either the state that was found is unstable, or the body has gone over to another
 * state. Checked while the run lasts, reported at its end. */
#pragma once

#include "base/state.h"
#include "solid/system/progress.h"

struct run;

/* Looks whose largest move counts: one alone may catch a node that turns back. */
enum { RUN_STABILITY_SAMPLES = 4 };

struct run_stability {
    /* The state nearest to equilibrium since the load is held; while no contact has
     * pressed. */
    double load;                        /* that is held */
    double move[RUN_STABILITY_SAMPLES]; /* of the last samples, m: in turn */
    int64_t samples;                    /* since then */
    double least;                       /* the smallest value so far of the largest of these moves, m */
    double *near;                       /* the parameters when `least` was found, node_count * dim */
    /* What was seen first. */
    bool left;     /* the body has left `near`, which is kept, */
    bool negative; /* or: the stiffness has a negative eigenvalue */
    double since;  /* load */
    int64_t node;  /* negative: where its mode moves most */
};

/* Before the first step; with a checkpoint: what was seen before it. */
void run_stability_begin(struct run *run);
void run_stability_free(struct run *run);

/* Look at a state on the way. */
void run_stability_follow(struct run *run, const struct progress *progress);

/* Look at a state of equilibrium. */
void run_stability_look(struct run *run, double load);

/* What was seen, as state of the run. */
MUST_CHECK enum status run_stability_state(struct run *run, const struct state *state, struct error *error);

/* What was seen up to the final state run->u, into text[size]; empty when all is stable. True where that is a
 * note: the body has buckled, which is a matter of its shape, and the state that it has come to is stable. */
bool run_stability_describe(const struct run *run, char *text, size_t size);
