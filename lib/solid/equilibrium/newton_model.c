/* The model of a Newton step, and conjugate gradients that lower it. */
#include "base/round_off.h"
#include "base/vector.h"
#include "solid/equilibrium/newton_private.h"
#include "solid/preconditioner/frequency.h"
#include "solid/system/energy.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 200 }; /* of conjugate gradients; */
enum { MOST_INNER = 4 };        /* augmentations of contacts in a step */
enum { MOST_TURNS = 8 };        /* of the search along a direction */
/* Corrections at a load in which the multipliers of contacts advance in any case; later they do where
 * contacts give way. */
enum { MOST_AUGMENTATIONS = 8 };
/* What is left of the gradient's norm when the multipliers of contacts advance. */
static const double inner_left = 0.3;
/* The slope at the end of that search, by the one at its start: at most. */
static const double slope_left = 0.1;

double newton_longest(const struct newton *n, const double *x, int64_t *node)
{
    return vector_longest(n->system->dim, n->system->node_count, x, node);
}

void newton_touch(struct newton *n, const double *u, struct newton_forces *forces)
{
    if (n->system->contact_count > 0) {
        memset(forces->contact, 0, (size_t)n->size * sizeof *forces->contact);
        system_add_contacts(n->system, u, forces->contact);
        forces->contact_energy = energy_contact(n->system);
    }
}

struct deformation newton_evaluate(struct newton *n, const double *u, struct newton_forces *forces)
{
    struct deformation deformation = system_smooth_residual(n->system, u, forces->smooth);
    n->report->force_evaluations++;
    newton_touch(n, u, forces);
    forces->least_jacobian = deformation.least_jacobian;
    return deformation;
}

double newton_difference(const struct newton *n, const double *move)
{
    double longest = newton_longest(n, move, NULL);
    return DIFFERENCE_STEP * n->scale.spacing / (longest > 0.0 ? longest : 1.0);
}

/* The forces at u + way move, without contacts; follow: prescribed faces that lag behind the load go as far.
 */
static void push(struct newton *n, double way, const double *move, bool follow, double *forces)
{
    n->system->body.cells.prescribed.lag = follow ? 1.0 - way : 1.0;
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + way * move[i];
    }
    (void)system_smooth_residual(n->system, n->trial, forces);
    n->report->force_evaluations++;
}

/* As newton_multiply; follow: along with the change of prescribed faces that lag behind the load. */
static void multiply_along(struct newton *n, const double *move, bool follow, double *product)
{
    double epsilon = newton_difference(n, move), width = epsilon;
    const double *behind = n->at_u.smooth;
    push(n, epsilon, move, follow, product);
    if (n->slackens) {
        push(n, -epsilon, move, follow, n->at_trial.smooth);
        behind = n->at_trial.smooth;
        width = 2.0 * epsilon;
    }
    for (int64_t i = 0; i < n->size; i++) {
        product[i] = (behind[i] - product[i]) / width;
    }
}

void newton_multiply(struct newton *n, const double *move, double *product)
{
    multiply_along(n, move, false, product);
}

double newton_curvature(struct newton *n)
{
    newton_multiply(n, n->cg.search, n->cg.product);
    double curvature = vector_dot(n->size, n->cg.search, n->cg.product);
    (void)newton_evaluate(n, n->u, &n->at_u);
    return curvature;
}

/* The forces of contacts at u + step + share search. */
static void touch(struct newton *n, double share)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + n->step.move[i] + share * n->cg.search[i];
    }
    newton_touch(n, n->trial, &n->model);
}

/* scaled = M^-1 g of minus the model's gradient g at u + step; returns their product. */
static double scale_gradient(struct newton *n)
{
    double *gradient = n->trial;
    for (int64_t i = 0; i < n->size; i++) {
        gradient[i] = n->model.smooth[i] + n->model.contact[i];
    }
    preconditioner_apply(&n->preconditioner, gradient, n->cg.scaled);
    return vector_dot(n->size, gradient, n->cg.scaled);
}

/* Along the search direction the model falls by `down` at first, and contacts apart by `slope` less `bend`
 * times the way: the way to its minimum, at most `most`. Leaves the forces of contacts there. */
static double search_along(struct newton *n, double down, double slope, double bend, double most)
{
    double way = bend * most > down ? down / bend : most, low = 0.0, high = INFINITY, at_low = down,
           at_high = 0.0;
    if (n->system->contact_count == 0) {
        return way;
    }
    for (int turn = 0;; turn++) {
        touch(n, way);
        double at = slope - way * bend + vector_dot(n->size, n->cg.search, n->model.contact);
        if (fabs(at) <= slope_left * down || (at > 0.0 && way >= most) || turn == MOST_TURNS) {
            return way;
        }
        if (at > 0.0) {
            low = way;
            at_low = at;
        } else {
            high = way;
            at_high = at;
        }
        double part = fmin(0.9, fmax(0.1, at_low / (at_low - at_high)));
        way = isinf(high) ? fmin(most, 2.0 * way) : low + part * (high - low);
    }
}

/* search = scaled, made conjugate to the directions before, or scaled alone where that does not lead down.
 * Returns by how much the model falls along it at first. */
static double turn_search(struct newton *n)
{
    for (;;) {
        double down = 0.0;
        bool alone = n->directions.count == 0;
        memcpy(n->cg.search, n->cg.scaled, (size_t)n->size * sizeof *n->cg.search);
        newton_multiply(n, n->cg.search, n->cg.product);
        newton_conjugate(n);
        for (int64_t i = 0; i < n->size; i++) {
            down += n->cg.search[i] * (n->model.smooth[i] + n->model.contact[i]);
        }
        if (down > 0.0 || alone) {
            return down;
        }
        newton_forget_directions(n);
    }
}

/* Begin the model at u + step: minus its gradient, without the reactions of conditions: under a large
 * pressure their round-off would be more than what is left. */
static void begin_model(struct newton *n)
{
    memcpy(n->model.smooth, n->at_u.smooth, (size_t)n->size * sizeof *n->model.smooth);
    if (newton_longest(n, n->step.move, NULL) > 0.0) { /* the first step of an increment */
        multiply_along(n, n->step.move, true, n->cg.product);
        add_scaled((int)n->size, -1.0, n->cg.product, n->model.smooth);
    }
    constraint_project(&n->preconditioner.constraint, NULL, n->model.smooth);
    memset(n->cg.search, 0, (size_t)n->size * sizeof *n->cg.search);
    newton_forget_directions(n);
    touch(n, 0.0);
}

double newton_square(struct newton *n, const struct newton_forces *forces)
{
    memcpy(n->cg.product, forces->smooth, (size_t)n->size * sizeof *n->cg.product);
    constraint_project(&n->preconditioner.constraint, NULL, n->cg.product);
    for (int64_t i = 0; i < n->size; i++) {
        n->cg.product[i] += n->system->contact_count > 0 ? forces->contact[i] : 0.0;
    }
    preconditioner_apply(&n->preconditioner, n->cg.product, n->cg.scaled);
    return vector_dot(n->size, n->cg.product, n->cg.scaled);
}

/* Lanczos's matrix of M^-1 K, from conjugate gradients. */
struct lanczos {
    int count;
    double diagonal[MOST_ITERATIONS], off_diagonal[MOST_ITERATIONS];
    double way; /* of the last step */
};

/* Add a step: the way along the search direction, and the part of the one before in that. */
static void add_step(struct lanczos *l, double way, double part)
{
    if (l->count > 0) {
        l->off_diagonal[l->count - 1] = sqrt(part) / l->way;
    }
    l->diagonal[l->count] = 1.0 / way + (l->count > 0 ? part / l->way : 0.0);
    l->way = way;
    l->count++;
}

/* The least eigenvalue; INFINITY without steps. */
static double least_eigenvalue(const struct lanczos *l)
{
    return l->count > 0 ? tridiagonal_least(l->count, l->diagonal, l->off_diagonal) : INFINITY;
}

/* Note how many products have made the residual's square fall to this share, and the least eigenvalue that
 * they show. */
static void note_products(struct newton *n, int products, double fallen, const struct lanczos *lanczos)
{
    double least = least_eigenvalue(lanczos);
    n->verdict.lowest = least > 0.0 ? fmin(n->verdict.lowest, least) : n->verdict.lowest;
    if (products > 0 && fallen < 1.0) {
        double rate = -2.0 * products / log(fallen);
        n->rate.usual = fmin(n->rate.usual, rate);
        n->rate.excess += products * (1.0 - n->rate.usual / rate);
    }
}

/* Go along the search direction from u + step to the minimum of the model, by `most` times it at most, and
 * keep it. Returns the way. The model falls by `down` at first. */
static double lower(struct newton *n, double down, double most)
{
    double curvature = vector_dot(n->size, n->cg.search, n->cg.product);
    double *lost = n->system->contact_count > 0 ? n->cg.scaled : NULL;
    if (lost != NULL) {
        memcpy(lost, n->model.contact, (size_t)n->size * sizeof *lost);
    }
    double way = search_along(n, down, vector_dot(n->size, n->cg.search, n->model.smooth), curvature, most);
    for (int64_t i = 0; i < n->size; i++) {
        n->step.move[i] += way * n->cg.search[i];
        n->model.smooth[i] -= way * n->cg.product[i];
    }
    if (lost != NULL) {
        for (int64_t i = 0; i < n->size; i++) {
            lost[i] = (lost[i] - n->model.contact[i]) / way;
        }
        curvature += vector_dot(n->size, n->cg.search, lost);
    }
    if (curvature > 0.0) {
        newton_keep_direction(n, n->cg.search, lost, curvature);
    }
    return way;
}

/* Lower the model along the last increment's step. */
static void continue_last(struct newton *n, double most)
{
    memcpy(n->cg.search, n->load.move, (size_t)n->size * sizeof *n->cg.search);
    constraint_project(&n->preconditioner.constraint, NULL, n->cg.search);
    double down = vector_dot(n->size, n->cg.search, n->model.smooth) +
                  vector_dot(n->size, n->cg.search, n->model.contact);
    if (down > 0.0) {
        newton_multiply(n, n->cg.search, n->cg.product);
        (void)lower(n, down, most);
    }
}

bool newton_solve_model(struct newton *n, double of_last, double share, double radius)
{
    double now = 0.0, mark = 0.0;
    int augmentations = n->load.corrections < MOST_AUGMENTATIONS || n->verdict.gives_way ? MOST_INNER : 0;
    struct lanczos lanczos = {0};
    begin_model(n);
    if (of_last > 0.0) {
        continue_last(n, of_last);
    }
    double length = newton_longest(n, n->step.move, NULL);
    double none = n->report->move <= n->scale.round_off ? n->scale.round_off : DBL_EPSILON * n->scale.body;
    for (int k = 0; k < MOST_ITERATIONS; k++) {
        now = scale_gradient(n);
        n->step.square = k == 0 ? now : n->step.square;
        mark = k == 0 ? now : mark;
        if (n->system->contact_count > 0 && now < inner_left * inner_left * mark && augmentations > 0) {
            augmentations--;
            system_augment_contacts(n->system);
            touch(n, 0.0);
            newton_descend_again(n);
            touch(n, 0.0);
            now = mark = scale_gradient(n);
        }
        bool round_off = newton_longest(n, n->cg.scaled, NULL) <= none;
        if (!(now > share * share * n->step.square) || round_off) {
            note_products(n, k, now / n->step.square, &lanczos);
            return true;
        }
        double down = turn_search(n);
        double most = (radius - length) / newton_longest(n, n->cg.search, NULL);
        double way = lower(n, down, most);
        if (way >= most) {
            return false;
        }
        add_step(&lanczos, way, fmax(0.0, n->directions.part));
        length = newton_longest(n, n->step.move, NULL);
    }
    note_products(n, MOST_ITERATIONS, now / n->step.square, &lanczos);
    return !system_held_by_friction(n->system) || n->friction.settled;
}
