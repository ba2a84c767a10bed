/* Folds of a run (see solid/folds/folds.h): searched for while it lasts, reported at its end. */
#pragma once

#include "base/state.h"
#include "approx/support/support_space.h"
#include "solid/folds/folds.h"

struct run;

/* Consecutive searches that find a fold. */
struct fold_spell {
    bool seen;
    double since, until; /* times as in struct progress; until: INFINITY while it lasts */
    struct fold fold;    /* at the first of them */
    bool counts;         /* reported also when it has ended: a frame shows it, or the run is dynamic */
    int64_t kept[5];     /* the fold's whole numbers, as they are kept in a checkpoint: never negative */
};

/* FOLDED: the map of the body is no longer one-to-one, a verdict. NOTED: cells that are
 * just inverted, or else a free side beyond the plane of a support, which the scene as it is does not forbid.
 */
enum { FOLDED, NOTED, FOLD_SPELLS };

struct run_folds {
    struct folds folds;
    bool *held, *slides; /* whether the displacement is prescribed at each face of the boundary; along its
                            normal alone */
    double *field;       /* scratch: node_count * dim */
    int64_t *node_first; /* the nodes at which each process evaluates it */
    bool *stopped, *in_contact, *turned; /* scratch: node_count */
    int32_t *flat;                       /* scratch: cell_count */
    bool has_space;
    struct support_space space; /* for the field within cells, made when it is needed */
    bool reported;              /* in the message that ends the run */
    struct fold_spell now[FOLD_SPELLS];
    struct fold_spell past[FOLD_SPELLS]; /* the first one that ended and counts */
};

/* Before the first step; the model must be built. With a checkpoint: what was seen before it. */
void run_folds_begin(struct run *run);
void run_folds_free(struct run *run);

/* Bodies that interpenetrate at rest are an error, unless the scene allows folds. */
void run_folds_at_rest(const struct run *run);

/* Look at parameters u at a time of the run; `is_frame`: the state is given as a frame. */
void run_folds_look(struct run *run, const double *u, double time, bool is_frame);

/* What was seen, as state of the run. */
MUST_CHECK enum status run_folds_state(struct run *run, const struct state *state, struct error *error);

/* Where and from when on, for FOLDED or NOTED, into text[size]; empty when that was not seen. */
void run_folds_describe(const struct run *run, int which, char *text, size_t size);

/* Whether the scene lets parts of the boundary touch, and not all of it. */
bool run_touches_in_part(const struct run *run);

/* Whether parts of the boundary have passed through each other though the scene lets some touch: it should
 * let all. */
bool run_folds_touch_in_part(const struct run *run);

/* Forget what was seen. */
void run_folds_forget(struct run *run);

/* Whether parts of the boundary have passed through each other, and contact would hold them apart: tells so,
 * and the run is to end without a verdict (run->again). */
bool run_folds_let_touch(struct run *run);

/* After the last step: a body that folds ends the run with a verdict, unless the scene allows it; what is to
 * be noted is. */
void run_folds_judge(struct run *run);
