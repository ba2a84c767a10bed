/* The state of newton_run and the functions of its parts. */
#pragma once

#include "solid/preconditioner/preconditioner.h"
#include "solid/equilibrium/newton.h"

/* Forces at some parameters: of the body and its loads, and of the contacts; node_count * dim each. */
struct newton_forces {
    double *smooth, *contact;
    double contact_energy; /* J (2D: J/m) */
    double least_jacobian; /* of a cell */
};

enum { NEWTON_MOST_ITERATIONS = 500 }; /* of conjugate gradients */

/* Search directions that are kept: the next one is made conjugate to them, move_k . K move = 0, so that what
 * they have lowered stays so. Where K is symmetric the last one would do, but for the round-off of
 * differences of forces. At the rim of a following pressure it is not, and more are kept (Saad, Iterative
 * Methods for Sparse Linear Systems, 2003, 6.4: direct incomplete orthogonalisation). */
enum { NEWTON_DIRECTIONS = 2, NEWTON_DIRECTIONS_UNSYMMETRIC = 5 };

struct newton_directions {
    int count; /* of directions since they were forgotten; */
    int most;  /* the last so many are kept, in turns, */
    double *move[NEWTON_MOST_ITERATIONS];
    double *product[NEWTON_MOST_ITERATIONS];  /* K move, with the stiffness of all but the contacts; */
    double *contact[NEWTON_MOST_ITERATIONS];  /* what the forces of contacts lost along it, by the way; */
    double curvature[NEWTON_MOST_ITERATIONS]; /* move . (product + contact), not 0 */
    double part; /* of the last one in the search direction that was made conjugate to them */
};

/* The load, a share of the whole. */
struct newton_load {
    double now;            /* that at u; */
    double next, most;     /* the span of the next increment, and the largest, see newton_span; */
    double hold;           /* where the next equilibrium is reported */
    double last, *move;    /* the span of the last increment, and its change of u; 0: none yet */
    double *factor_change; /* of the load curves */
    bool waits;            /* until u is almost in equilibrium */
    int64_t corrections;   /* since the last increment */
    int64_t frames;        /* equilibria reported so far */
};

/* The step that is tried. */
struct newton_step {
    double *move;   /* the minimum of the model, from u */
    double length;  /* of the node that moves most, m; INFINITY: it was cut short */
    double radius;  /* bound of a step at each node, m */
    double square;  /* r . M^-1 r at its start */
    bool collapses; /* a cell, in the step that was tried last */
};

/* Steps in a row that have not lowered the energy. */
struct newton_watch {
    int64_t steps;         /* their number, */
    double *start, length; /* where they began, and the length of the first, m, */
    double above;          /* and by how much the energy is higher, J (2D: J/m) */
};

/* What making the preconditioner anew would save. */
struct newton_rate {
    double usual;  /* products by which the residual falls to 1/e, the fewest since it was made, */
    double excess; /* the products that were more than these, since then, */
    int64_t cost;  /* and one more than the evaluations that making it took */
};

struct newton_friction {
    bool slides;  /* a contact has friction: every increment of the load ends in an equilibrium, */
    bool rests;   /* at which u is, of the increment before the next one */
    bool sticks;  /* no point that presses slips, until that is in equilibrium, */
    bool settled; /* at which u is, with the pressures there */
};

struct newton_progress {
    double error, load;  /* the least since the load has grown, to that, */
    double *u;           /* and u then; */
    int64_t step, moves; /* the step then: the error has not halved since, or not for as many in a row */
    double largest_move; /* so far, of a node, m */
};

/* Where corrections may take the body from the state after an increment; farther is a jump. */
struct newton_path {
    double *u, reach; /* that state; m, INFINITY: anywhere */
    double from;      /* the load before */
    bool returned;    /* to the state before, where u is */
    double most;      /* span of an increment since the first jump; INFINITY: any */
};

/* Lengths, m. */
struct newton_scale {
    double spacing, body; /* mean spacing of the nodes; diagonal of their box */
    double longest_step;  /* of a node */
    double round_off;     /* see statics_round_off */
};

/* What is known of u. */
struct newton_verdict {
    double lowest;         /* least eigenvalue of M^-1 K, from above; INFINITY: not known at this load */
    bool judged;           /* the stability, of a state near u */
    bool gives_way;        /* what the contacts lack is more than an equilibrium may have */
    double pressures_lack; /* share of the nodal pressures that the multipliers lack, see body_augment;
                            INFINITY: not known at this load */
};

struct newton {
    struct solid_system *system;
    const struct statics_options *options;
    struct statics_report *report;
    struct preconditioner preconditioner;
    int64_t size;
    double *u, *row_force;         /* the caller's; row_force may be NULL */
    struct newton_forces at_u;     /* residual at u, */
    struct newton_forces at_trial; /* and at parameters that are tried: */
    double *trial;
    struct newton_forces model; /* minus the gradient of the model at u + step */
    struct {
        double *search, *product, *scaled;
    } cg; /* of the conjugate gradients */
    struct newton_directions directions;
    struct newton_load load;
    struct newton_step step;
    struct newton_watch watch;
    struct newton_rate rate;
    bool slackens; /* a material's fibres may */
    struct newton_friction friction;
    struct newton_progress progress;
    struct newton_path path;
    struct newton_scale scale;
    struct newton_verdict verdict;
    enum status failure;
};

/* By the largest Rayleigh quotient, about 1: a smaller one is within the round-off of differences of forces.
 */
#define NEWTON_LEAST_TOLD 1e-6

/* The step after one that went too far, and the increment after a jump, by that. */
#define NEWTON_SHORTER 0.25

/* ---- newton_directions.c ---- */

/* How many are kept but by the verdict on stability; and let so many be kept: none has been dropped yet. */
int newton_usual_directions(const struct newton *n);
MUST_CHECK enum status newton_keep_directions(struct newton *n, int count, struct error *error);
void newton_free_directions(struct newton *n);
void newton_forget_directions(struct newton *n);

/* How many directions are kept; the place of the one that came `before` others. */
int newton_directions_kept(const struct newton_directions *directions);
int newton_direction(const struct newton_directions *directions, int before);

/* Make n->cg.search conjugate to the directions kept, and n->cg.product, K times it, that of the result. */
void newton_conjugate(struct newton *n);

/* Keep a direction, K times which is n->cg.product, and what the forces of contacts lost along it, by the way
 * (NULL: not wanted). */
void newton_keep_direction(struct newton *n, const double *move, const double *lost, double curvature);

/* After the multipliers of contacts have advanced, go along the directions kept to the minimum of the model:
 * no product is needed. n->model.contact is then an estimate. */
void newton_descend_again(struct newton *n);

/* ---- newton_model.c ---- */

/* By what a move is multiplied for a difference of forces that gives the stiffness along it. */
double newton_difference(const struct newton *n, const double *move);

/* product = K move, with the stiffness K at u of all but the contacts. Where fibres may slacken, it is the
 * mean of both ways: at a kink of the stress that of one way is no linear function of the move. */
void newton_multiply(struct newton *n, const double *move, double *product);

/* The forces at u, and how far from inversion it is; only those of contacts. */
struct deformation newton_evaluate(struct newton *n, const double *u, struct newton_forces *forces);
void newton_touch(struct newton *n, const double *u, struct newton_forces *forces);

/* Lower the model at u, from n->step.move, along the last increment, by `of_last` times it at most, and then
 * until the norm of its gradient is below `share` of what it was. False where the step reaches the radius at
 * a node before, or where a body that friction alone holds has not come to rest, as the pressures have not
 * settled. n->step.square: that norm, squared. */
bool newton_solve_model(struct newton *n, double of_last, double share, double radius);

/* search . K search at u, with the stiffness of all but the contacts. */
double newton_curvature(struct newton *n);

/* r . M^-1 r of a residual r, without reactions; M^-1 r is left in n->cg.scaled. */
double newton_square(struct newton *n, const struct newton_forces *forces);

/* Length of the longest of the nodes' vectors, and its node. */
double newton_longest(const struct newton *n, const double *x, int64_t *node);

/* ---- newton_steps.c ---- */

/* Set the load; n->load.factor_change becomes the change of the load curves from those at load `from`. */
void newton_set_load(struct newton *n, double from, double load);

/* How far loads and prescribed motions go between two loads: the largest change of a curve, by its largest
 * value. The first load after `from` at which that is `span`, or which is to be reported; of 0, as where no
 * curve changes, n->load.most. */
double newton_span(const struct newton *n, double from, double to);
double newton_load_after(const struct newton *n, double from, double span);

/* Increase the load and find the step of the model there. False where that has no minimum. */
bool newton_begin_increment(struct newton *n, double from, double to);

/* Go along that step with the load, not so far that the body would move too far or cells would invert. False
 * where no increment is small enough. */
bool newton_take_increment(struct newton *n, double from, double to);

/* Return to a state at this load, and accept it. */
void newton_return(struct newton *n, const double *u);

/* A Newton step at this load. False where not even a short one is admitted, and u is not in equilibrium. */
bool newton_correct(struct newton *n);

/* Leave an equilibrium along the last search direction if the stiffness along it is negative, twice as far
 * each time while the energy falls. False where cells invert at once. */
bool newton_leave(struct newton *n);

/* Let points slip again, at an equilibrium u without slip. */
void newton_let_slip(struct newton *n);

/* ---- newton_ends.c ---- */

/* Let the multipliers of nodal pressures and contacts advance by what was evaluated at u, and take the
 * forces with the new ones. */
void newton_augment(struct newton *n);

/* Estimate the error of u, with the residual of the multipliers that were advanced. */
void newton_estimate(struct newton *n);

/* Whether the run at this load ends, and its outcome, or n->failure. stuck: no step from u is admitted. */
bool newton_ends(struct newton *n, bool stuck, enum statics_outcome *outcome, struct error *error);

/* ---- newton_stability.c ---- */

/* The least eigenvalue of M^-1 K at u, into n->verdict.lowest, and whether u is stable, into
 * system->stability: conjugate gradients on a pseudo-random residual meet a direction of negative stiffness,
 * if there is one. Until they have, they reduce the residual along it by nothing: their polynomial is 1 at 0,
 * its roots are positive. So there is none once the residual's square, r . M^-1 r, is less than the share of
 * one mode. Of a K that is not symmetric, such a direction says nothing: the eigenvalues in the space that
 * was searched, once the residual is that small, say whether one has a negative real part. STATUS_SYSTEM:
 * memory. */
MUST_CHECK enum status newton_judge_stability(struct newton *n, struct error *error);

/* ---- newton_path.c ---- */

/* The state u has followed an increment of the load from `from`. */
void newton_begin_path(struct newton *n, double from);

/* Along a path of equilibria, corrections are short beside the increment that they follow. Where they are
 * not, the body has jumped: return to the state before, and let a shorter increment follow; after a short
 * one, or where the state before was none of equilibrium, let it leave the path. */
void newton_keep_to_path(struct newton *n);

/* The body leaves the path here, most of all at a node: note that in system->stability. Not with contacts,
 * which open and close, nor in time, nor from a given start. */
void newton_leave_path(struct newton *n, int64_t node);

/* ---- newton_state.c: memory, checkpoints, progress and frames ---- */

MUST_CHECK enum status newton_allocate(struct newton *n, struct error *error);
void newton_release(struct newton *n);

/* Visit all that the next step needs from the steps before; see base/state.h. */
MUST_CHECK enum status newton_visit(void *run, const struct state *state, struct error *error);

/* Call the caller's progress function; false where that ends the run. */
bool newton_tell(struct newton *n);

/* The forces of the conditions at u, which balance the residual along them, N (2D: N/m), into n->row_force.
 */
MUST_CHECK enum status newton_row_forces(struct newton *n, struct error *error);

/* Report u, which is in equilibrium, as the next frame. */
MUST_CHECK enum status newton_give_frame(struct newton *n, struct error *error);
