#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/vector.h"
#include "solid/constraint/held_directions.h"
#include "solid/contact/contact_between.h"
#include "solid/system/rigid_modes.h"

#include <stdlib.h>
#include <string.h>

/* Nodes for each field at least. */
static const int64_t nodes_per_coarse_field = 8;
/* Unknowns of small bodies at most: 16 centres in two dimensions and 8 in three. */
static const int64_t most_unknowns = 96;
/* Nodes for each centre of large bodies of smoothed cells, whose coarse stiffness costs no evaluations: the
 * steps follow the distance of the centres by that of the nodes. */
static const int64_t nodes_per_centre = 1000;
/* Centres at most: their matrices are dense. */
static const int64_t most_centres = 384;

static int64_t centre_count(const struct solid_system *system)
{
    int64_t fields = system->dim + 1, most = most_unknowns / (fields * system->dim);
    int64_t count = system->node_count / (nodes_per_coarse_field * fields);
    int64_t of_large = system->body.smoothed ? system->node_count / nodes_per_centre : 0;
    most = of_large > most ? of_large : most;
    most = most < most_centres ? most : most_centres;
    return count < most ? count : most;
}

static enum status build_inverse(struct solid_system *system, struct preconditioner *p, struct error *error)
{
    RETURN_IF_ERROR(inverse_stiffness_factor(system, &p->factor, error));
    RETURN_IF_ERROR(inverse_stiffness_rows(&p->factor, &system->rows, &p->factor_rows, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->at_rest, system->node_count, error));
    system_relaxation_mass(system, true, p->at_rest);
    return STATUS_OK;
}

/* Corner i of those opposite to points of contacts. */
static struct average corner_at(const void *system, int64_t i)
{
    const struct solid_system *of = system;
    int64_t c = 0;
    for (; i >= contact_between_corners(&of->contacts[c]); c++) {
        i -= contact_between_corners(&of->contacts[c]);
    }
    return contact_between_corner(&of->contacts[c], i);
}

/* The nodes that the conditions hold in all directions. */
static enum status find_held(const struct solid_system *system, struct preconditioner *p, struct error *error)
{
    FREED_BY(held_free) struct held_directions held = {0};
    RETURN_IF_ERROR(held_build(p->dim, p->node_count, &held, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->held, p->node_count, error));
    held_note(&held, &system->rows, 0, system->rows.count);
    for (int64_t n = 0; n < p->node_count; n++) {
        p->held[n] = held.count[n] == p->dim;
    }
    return STATUS_OK;
}

/* What conditions and opposite corners see of the coarse fields. */
static enum status take_means(const struct solid_system *system, struct preconditioner *p,
                              struct error *error)
{
    int64_t corners = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        corners += contact_between_corners(&system->contacts[c]);
    }
    RETURN_IF_ERROR(p->contact_node_count > 0 ? find_held(system, p, error) : STATUS_OK);
    RETURN_IF_ERROR(coarse_mean_begin(&p->coarse, &p->mean, error));
    RETURN_IF_ERROR(preconditioner_build_coarse_constraints(system, p, error));
    return coarse_mean_table(&p->coarse, corners, corner_at, system, p->held, &p->mean, &p->opposite, error);
}

enum status preconditioner_build(struct solid_system *system, bool coarse, struct preconditioner *p,
                                 struct error *error)
{
    int64_t cells;
    *p = (struct preconditioner){.dim = system->dim, .node_count = system->node_count};
    RETURN_IF_ERROR(system_has_rigid_mode(system, &p->has_rigid_mode, error));
    for (int64_t c = 0; c < system->contact_count; c++) {
        p->contact_node_count += contact_nodes(&system->contacts[c])->count;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&p->mass, system->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->stiffness, system->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->vector, system->node_count * system->dim, error));
    RETURN_IF_ERROR(coarse_space_build(system->dim, system->node_count, system->X, system->node_lists,
                                       coarse ? centre_count(system) : 0, &p->coarse, error));
    p->size = p->coarse.count * p->dim;
    p->slow.size = system->node_count * system->dim;
    cells = p->size * p->size;
    RETURN_IF_ERROR(NEW_ARRAY(&p->active, p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->normal, p->contact_node_count * p->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->creased, p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->turned, p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->idle, 2 * p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->patience, 2 * p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->body, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->weight, p->coarse.count * p->coarse.count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->free_weight, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->stiffness_factor, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->capacitance_factor, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->amount, 4 * p->size, error));
    RETURN_IF_ERROR(p->contact_node_count > 0 ? NEW_ARRAY(&p->contacts, cells, error) : STATUS_OK);
    RETURN_IF_ERROR(NEW_ARRAY(&p->pushed, p->contact_node_count, error));
    if (p->size > 0) {
        RETURN_IF_ERROR(take_means(system, p, error));
    }
    if (coarse && system_has_inverse(system)) {
        RETURN_IF_ERROR(build_inverse(system, p, error));
    }
    return ranks_share(p->factor.ranks, p->size, NULL, &p->column_first, error);
}

void preconditioner_free(struct preconditioner *p)
{
    constraint_free(&p->constraint);
    slow_modes_free(&p->slow);
    coarse_space_free(&p->coarse);
    inverse_factor_free(&p->factor);
    constraint_rows_free(&p->factor_rows);
    sparse_free(&p->opposite);
    sparse_free(&p->conditions);
    sparse_free(&p->of_field);
    coarse_mean_free(&p->mean);
    FREE_ALL(p->column_first, p->vector, p->at_rest, p->stiffness, p->mass, p->body, p->active, p->normal,
             p->creased, p->turned, p->held, p->idle, p->patience, p->weight, p->free_weight, p->on_list,
             p->value, p->stiffness_factor, p->capacitance_factor, p->amount, p->contacts, p->pushed);
    *p = (struct preconditioner){0};
}

/* y = matrix x, the matrix symmetric */
static void multiply(int64_t n, const double *matrix, const double *x, double *restrict y)
{
    memset(y, 0, (size_t)n * sizeof *y);
    for (int64_t k = 0; k < n; k++) {
        for (int64_t i = 0; i < n; i++) {
            y[i] += x[k] * matrix[k * n + i];
        }
    }
}

/* amount[size] := what it is by the inverse of the factorised matrix; 0 where the coarse fields are not used.
 */
static void solve(const struct preconditioner *p, const double *factor, double *amount)
{
    if (p->uses_coarse) {
        dense_solve_large(p->size, factor, amount);
    } else {
        memset(amount, 0, (size_t)p->size * sizeof *amount);
    }
}

/* y = D^-1 x */
static void divide_by_mass(const struct preconditioner *p, const double *x, double *y)
{
    for (int64_t n = 0; n < p->node_count; n++) {
        double inverse = 1.0 / p->mass[n];
        for (int64_t i = n * p->dim; i < (n + 1) * p->dim; i++) {
            y[i] = inverse * x[i];
        }
    }
}

void preconditioner_smooth(struct preconditioner *p, const double *force, double *result)
{
    const struct inverse_factor *inverse = &p->factor;
    double *within = p->vector;
    if (inverse->rows.row_count == 0) {
        divide_by_mass(p, force, result);
        return;
    }
    inverse_factor_apply(inverse, p->dim, force, within);
    divide_by_mass(p, within, within);
    inverse_factor_apply_transposed(inverse, p->dim, within, result);
}

enum status preconditioner_row_forces(struct preconditioner *p, const double *residual, double *scratch,
                                      double *row_force, struct error *error)
{
    struct constraint *constraint = &p->constraint;
    preconditioner_smooth(p, residual, scratch);
    constraint_project(constraint, NULL, scratch);
    memcpy(row_force, constraint->multiplier, (size_t)constraint->rows->count * sizeof *row_force);
    return constraint_share_out(constraint, row_force, error);
}

void preconditioner_restrict_force(struct preconditioner *p, const double *force, double *acceleration,
                                   double *amount)
{
    const struct constraint_rows *rows = p->constraint.rows;
    double *multiplier = p->constraint.multiplier;
    preconditioner_smooth(p, force, acceleration);
    if (p->size > 0) {
        coarse_space_restrict(&p->coarse, force, amount);
    }
    if (rows == NULL || rows->count == 0) {
        return;
    }
    constraint_values(&p->constraint, acceleration, multiplier);
    constraint_solve(&p->constraint, multiplier);
    if (p->size > 0) {
        preconditioner_subtract_constraint_forces(p, multiplier, amount);
    }
}

void preconditioner_apply(struct preconditioner *p, const double *force, double *acceleration)
{
    struct constraint *constraint = &p->constraint;
    double *multiplier = constraint->multiplier, *amount = p->amount;
    int64_t rows = constraint->rows != NULL ? constraint->rows->count : 0;
    preconditioner_restrict_force(p, force, acceleration, amount);
    for (int64_t r = 0; r < rows; r++) {
        multiplier[r] = -multiplier[r];
    }
    if (p->size > 0) {
        solve(p, p->stiffness_factor, amount);
        coarse_space_prolongate(&p->coarse, amount, acceleration);
    }
    if (p->size > 0 && rows > 0) {
        preconditioner_coarse_constraint_values(p, amount, p->value);
        constraint_solve(constraint, p->value);
        for (int64_t r = 0; r < rows; r++) {
            multiplier[r] -= p->value[r];
        }
    }
    if (rows > 0) {
        constraint_spread(constraint, multiplier, acceleration);
    }
    slow_modes_accelerate(&p->slow, force, acceleration);
}

static void add_slow_mode(struct preconditioner *p, const double *mode)
{
    preconditioner_multiply(p, mode, slow_modes_next_momentum(&p->slow));
    slow_modes_add(&p->slow, mode);
}

enum status preconditioner_add_slow_mode(struct preconditioner *p, const double *mode, struct error *error)
{
    if (p->slow.count == SLOW_MODES_MOST) { /* the momenta of the others were formed with the first one */
        p->slow.count = 0;
        for (int64_t k = 1; k < SLOW_MODES_MOST; k++) {
            add_slow_mode(p, p->slow.mode + k * p->slow.size);
        }
    }
    RETURN_IF_ERROR(slow_modes_reserve(&p->slow, p->slow.count + 1, error));
    add_slow_mode(p, mode);
    return STATUS_OK;
}

void preconditioner_drop_slow_modes(struct preconditioner *p)
{
    p->slow.count = 0;
}

/* y = D x */
static void multiply_by_mass(const struct preconditioner *p, const double *x, double *y)
{
    for (int64_t n = 0; n < p->node_count; n++) {
        for (int64_t i = n * p->dim; i < (n + 1) * p->dim; i++) {
            y[i] = p->mass[n] * x[i];
        }
    }
}

void preconditioner_unsmooth(const struct preconditioner *p, const double *move, double *force)
{
    const struct inverse_factor *inverse = &p->factor;
    if (inverse->rows.row_count == 0) {
        multiply_by_mass(p, move, force);
        return;
    }
    memcpy(force, move, (size_t)(p->node_count * p->dim) * sizeof *move);
    inverse_factor_solve_transposed(inverse, p->dim, force);
    multiply_by_mass(p, force, force);
    inverse_factor_solve(inverse, p->dim, force);
}

double preconditioner_square_diagonal(struct preconditioner *p, const double *x)
{
    int dim = p->dim;
    double sum = 0.0;
    if (p->factor.rows.row_count > 0) {
        memcpy(p->vector, x, (size_t)(p->node_count * dim) * sizeof *x);
        inverse_factor_solve_transposed(&p->factor, dim, p->vector);
        x = p->vector;
    }
    for (int64_t n = 0; n < p->node_count; n++) {
        sum += p->mass[n] * vector_dot(dim, x + n * dim, x + n * dim);
    }
    return sum;
}

double preconditioner_square(struct preconditioner *p, const double *x)
{
    double sum = slow_modes_square(&p->slow, x), *amount = p->amount, *solved = p->amount + p->size;
    if (p->size == 0) {
        return sum + preconditioner_square_diagonal(p, x);
    }
    preconditioner_unsmooth(p, x, p->vector);
    for (int64_t i = 0; i < p->node_count * p->dim; i++) {
        sum += x[i] * p->vector[i];
    }
    coarse_space_restrict(&p->coarse, p->vector, amount);
    memcpy(solved, amount, (size_t)p->size * sizeof *amount);
    solve(p, p->capacitance_factor, solved);
    for (int64_t k = 0; k < p->size; k++) {
        sum -= amount[k] * solved[k];
    }
    return sum;
}

void preconditioner_multiply(struct preconditioner *p, const double *x, double *force)
{
    double *amount = p->amount;
    memcpy(p->vector, x, (size_t)(p->node_count * p->dim) * sizeof *x);
    if (p->size > 0) {
        preconditioner_unsmooth(p, x, force);
        coarse_space_restrict(&p->coarse, force, amount);
        solve(p, p->capacitance_factor, amount);
        for (int64_t k = 0; k < p->size; k++) {
            amount[k] = -amount[k];
        }
        coarse_space_prolongate(&p->coarse, amount, p->vector);
    }
    preconditioner_unsmooth(p, p->vector, force);
    slow_modes_multiply(&p->slow, x, force);
}

void preconditioner_momentum(struct preconditioner *p, const double *velocity, double *amount,
                             double *momentum)
{
    preconditioner_unsmooth(p, velocity, p->vector);
    coarse_space_restrict(&p->coarse, p->vector, momentum);
    if (p->constraint.rows != NULL && p->constraint.rows->count > 0) {
        constraint_values(&p->constraint, velocity, p->constraint.multiplier);
        constraint_solve(&p->constraint, p->constraint.multiplier);
        preconditioner_subtract_constraint_forces(p, p->constraint.multiplier, momentum);
    }
    memcpy(amount, momentum, (size_t)p->size * sizeof *momentum);
    solve(p, p->capacitance_factor, amount);
    multiply(p->size, p->free_weight, amount, p->amount);
    for (int64_t k = 0; k < p->size; k++) {
        momentum[k] -= p->amount[k];
    }
}

void preconditioner_prolongate(struct preconditioner *p, const double *amount, double *field)
{
    memset(field, 0, (size_t)(p->node_count * p->dim) * sizeof *field);
    coarse_space_prolongate(&p->coarse, amount, field);
    constraint_project(&p->constraint, NULL, field);
}

/* The slow modes of a checkpoint: their number, then these. */
static enum status slow_modes_state(struct slow_modes *modes, const struct state *state, struct error *error)
{
    const struct state_value count[] = {{"count", STATE_COUNTS, &modes->count, 1}};
    RETURN_IF_ERROR(state_visit(state, "slow", count, 1, error));
    if (modes->count > SLOW_MODES_MOST) {
        return fail(error, STATUS_INPUT, "slow.count: %lld modes are too many", (long long)modes->count);
    }
    RETURN_IF_ERROR(slow_modes_reserve(modes, modes->count, error));
    const struct state_value values[] = {
        {"mode", STATE_NUMBERS, modes->mode, modes->count * modes->size},
        {"momentum", STATE_NUMBERS, modes->momentum, modes->count * modes->size},
    };
    return state_visit(state, "slow", values, sizeof values / sizeof *values, error);
}

enum status preconditioner_state(struct preconditioner *p, const struct state *state, struct error *error)
{
    const struct state_value values[] = {
        {"mass", STATE_NUMBERS, p->mass, p->node_count},
        {"stiffness", STATE_NUMBERS, p->stiffness, p->node_count},
        {"body", STATE_NUMBERS, p->body, p->size * p->size},
        {"measured", STATE_NUMBERS, &p->measured_mass, 1},
        {"active", STATE_FLAGS, p->active, p->contact_node_count},
        {"normal", STATE_NUMBERS, p->normal, p->contact_node_count * p->dim},
        {"creased", STATE_FLAGS, p->creased, p->contact_node_count},
        {"turned", STATE_FLAGS, p->turned, p->contact_node_count},
        {"idle", STATE_COUNTS, p->idle, 2 * p->contact_node_count},
        {"patience", STATE_COUNTS, p->patience, 2 * p->contact_node_count},
    };
    RETURN_IF_ERROR(slow_modes_state(&p->slow, state, error));
    return state_visit(state, "preconditioner", values, sizeof values / sizeof *values, error);
}
