#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/vector.h"
#include "solid/contact/contact_between.h"
#include "solid/system/rigid_modes.h"

#include <stdlib.h>
#include <string.h>

/* Nodes for each field at least. */
static const int64_t nodes_per_coarse_field = 8;
/* Unknowns of the coarse space of small bodies at most: up to 16 centres in two dimensions and 8 in three. */
static const int64_t most_unknowns = 96;
/* Nodes for each centre of large bodies of smoothed cells, whose coarse stiffness costs no evaluations: the
 * steps follow the distance of the centres by that of the nodes. */
static const int64_t nodes_per_centre = 1000;
/* Rows of conditions times unknowns of large bodies at most: 8 bytes each, and some more for a while. */
static const int64_t most_held = 1 << 24;

enum { HELD_AT_ONCE = 8 };
enum { ENTRIES_FOR_THREAD = 50000 }; /* of a matrix that is multiplied with; see chunks_of */

static int64_t centre_count(const struct solid_system *system)
{
    int64_t fields = system->dim + 1, most = most_unknowns / (fields * system->dim);
    int64_t count = system->node_count / (nodes_per_coarse_field * fields);
    int64_t of_large = system->body.smoothed ? system->node_count / nodes_per_centre : 0;
    int64_t held = system->rows.count * fields * system->dim;
    of_large = held > 0 && most_held / held < of_large ? most_held / held : of_large;
    most = of_large > most ? of_large : most;
    most = most < COARSE_MOST_CENTRES ? most : COARSE_MOST_CENTRES;
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

/* The coarse fields at the corners opposite to points of contacts. */
static enum status take_fields_opposite(const struct solid_system *system, struct preconditioner *p,
                                        struct error *error)
{
    int64_t corners = 0, at = 0, count = p->coarse.count;
    for (int64_t c = 0; c < system->contact_count; c++) {
        corners += contact_between_corners(&system->contacts[c]);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&p->opposite, corners * count, error));
    for (int64_t c = 0; c < system->contact_count && count > 0; c++) {
        for (int64_t v = 0; v < contact_between_corners(&system->contacts[c]); v++, at++) {
            struct average average = contact_between_corner(&system->contacts[c], v);
            preconditioner_add_fields(p, &average, p->opposite + at * count);
        }
    }
    return STATUS_OK;
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
    cells = p->size * p->size;
    RETURN_IF_ERROR(NEW_ARRAY(&p->active, p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->normal, p->contact_node_count * p->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->creased, p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->turned, p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->idle, 2 * p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->patience, 2 * p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->body, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->weight, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->free_weight, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->held, system->rows.count * p->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->stiffness_factor, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->capacitance_factor, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->amount, 2 * p->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->contacts, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->impact, cells + 2 * p->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->pushed, p->contact_node_count, error));
    RETURN_IF_ERROR(take_fields_opposite(system, p, error));
    if (coarse && system_has_inverse(system)) {
        RETURN_IF_ERROR(build_inverse(system, p, error));
    }
    return ranks_share(p->factor.ranks, p->size, NULL, &p->column_first, error);
}

void preconditioner_free(struct preconditioner *p)
{
    constraint_free(&p->constraint);
    coarse_space_free(&p->coarse);
    inverse_factor_free(&p->factor);
    constraint_rows_free(&p->factor_rows);
    FREE_ALL(p->column_first, p->vector, p->at_rest, p->stiffness, p->mass, p->body, p->active, p->normal,
             p->creased, p->turned, p->idle, p->patience, p->weight, p->free_weight, p->held,
             p->stiffness_factor, p->capacitance_factor, p->amount, p->contacts, p->impact, p->pushed,
             p->opposite);
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

/* amount[k] -= column k of S^-1 G Z times values, for `count` columns from k on. */
static void release_columns(const struct preconditioner *p, int64_t k, int64_t count, const double *values,
                            double *amount)
{
    int64_t rows = p->constraint.rows->count;
    const double *held = p->held + k * rows;
    double sum[HELD_AT_ONCE];
    memcpy(sum, amount + k, (size_t)count * sizeof *sum);
    for (int64_t r = 0; r < rows; r++) {
        if (count == HELD_AT_ONCE) {
            for (int c = 0; c < HELD_AT_ONCE; c++) {
                sum[c] -= held[c * rows + r] * values[r];
            }
        } else {
            for (int c = 0; c < count; c++) {
                sum[c] -= held[c * rows + r] * values[r];
            }
        }
    }
    memcpy(amount + k, sum, (size_t)count * sizeof *sum);
}

/* amount -= (S^-1 G Z)^T values, of the rows of the conditions: P^T of what `values` are the rows' share of.
 */
static void release_rows(const struct preconditioner *p, const double *values, double *amount)
{
    const struct constraint_rows *rows = p->constraint.rows;
    const struct ranks *ranks = p->factor.ranks;
    const int64_t *first = p->column_first + ranks_rank(ranks);
    int64_t columns = first[1] - first[0];
    struct chunks chunks = chunks_for_threads(columns, columns * rows->count, ENTRIES_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        int64_t end = first[0] + chunks_begin(&chunks, c + 1);
        for (int64_t k = first[0] + chunks_begin(&chunks, c); k < end; k += HELD_AT_ONCE) {
            release_columns(p, k, end - k < HELD_AT_ONCE ? end - k : HELD_AT_ONCE, values, amount);
        }
    }
    ranks_gather(ranks, amount, sizeof *amount, p->column_first);
}

void preconditioner_restrict_force(struct preconditioner *p, const double *force, double *acceleration,
                                   double *amount)
{
    const struct constraint_rows *rows = p->constraint.rows;
    double *seen = p->constraint.multiplier;
    preconditioner_smooth(p, force, acceleration);
    if (p->size > 0) {
        coarse_space_restrict(&p->coarse, force, amount);
    }
    if (rows == NULL) {
        return;
    }
    constraint_values(&p->constraint, acceleration, seen);
    release_rows(p, seen, amount);
}

/* y += a x */
ALL_SETS static void add_held(int64_t count, double a, const double *x, double *restrict y)
{
    for (int64_t i = 0; i < count; i++) {
        y[i] += a * x[i];
    }
}

void preconditioner_apply(struct preconditioner *p, const double *force, double *acceleration)
{
    struct constraint *constraint = &p->constraint;
    const struct constraint_rows *rows = constraint->rows;
    double *multiplier = constraint->multiplier, *amount = p->amount;
    preconditioner_restrict_force(p, force, acceleration, amount);
    if (p->size > 0) {
        solve(p, p->stiffness_factor, amount);
        coarse_space_prolongate(&p->coarse, amount, acceleration);
    }
    if (rows == NULL || rows->count == 0) {
        return;
    }
    constraint_solve(constraint, multiplier);
    struct chunks chunks = chunks_for_threads(rows->count, rows->count * p->size, ENTRIES_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        int64_t begin = chunks_begin(&chunks, c), end = chunks_begin(&chunks, c + 1);
        for (int64_t k = 0; k < p->size; k++) {
            add_held(end - begin, amount[k], p->held + k * rows->count + begin, multiplier + begin);
        }
        for (int64_t r = begin; r < end; r++) {
            multiplier[r] = -multiplier[r];
        }
    }
    constraint_spread(constraint, multiplier, acceleration);
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
    double sum = 0.0, *amount = p->amount, *solved = p->amount + p->size;
    if (p->size == 0) {
        return preconditioner_square_diagonal(p, x);
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
}

void preconditioner_momentum(struct preconditioner *p, const double *velocity, double *amount,
                             double *momentum)
{
    preconditioner_unsmooth(p, velocity, p->vector);
    coarse_space_restrict(&p->coarse, p->vector, momentum);
    if (p->constraint.rows != NULL) {
        constraint_values(&p->constraint, velocity, p->constraint.multiplier);
        release_rows(p, p->constraint.multiplier, momentum);
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

enum status preconditioner_state(struct preconditioner *p, const struct state *state, struct error *error)
{
    const struct state_value values[] = {
        {"mass", STATE_NUMBERS, p->mass, p->node_count},
        {"stiffness", STATE_NUMBERS, p->stiffness, p->node_count},
        {"body", STATE_NUMBERS, p->body, p->size * p->size},
        {"measured", STATE_NUMBERS, &p->measured_mass, 1},
        {"touching", STATE_FLAGS, p->active, p->contact_node_count},
        {"normal", STATE_NUMBERS, p->normal, p->contact_node_count * p->dim},
        {"creased", STATE_FLAGS, p->creased, p->contact_node_count},
        {"turned", STATE_FLAGS, p->turned, p->contact_node_count},
        {"idle", STATE_COUNTS, p->idle, 2 * p->contact_node_count},
        {"patience", STATE_COUNTS, p->patience, 2 * p->contact_node_count},
    };
    return state_visit(state, "inertia", values, sizeof values / sizeof *values, error);
}
