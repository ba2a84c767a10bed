#include "solid/preconditioner_private.h"

#include "base/memory.h"
#include "solid/rigid_modes.h"

#include <stdlib.h>
#include <string.h>

/* Nodes for each field at least: each field costs an evaluation for each direction at the begin. With twice
 * COARSE_MOST_CENTRES steps are no fewer. */
static const int64_t nodes_per_coarse_field = 8;

static int64_t centre_count(const struct solid_system *system)
{
    int64_t count = system->node_count / (nodes_per_coarse_field * (system->dim + 1));
    return count < COARSE_MOST_CENTRES ? count : COARSE_MOST_CENTRES;
}

/* L^-T Z of the scalar coarse fields, by rows. */
static enum status transform_fields(struct preconditioner *preconditioner, int threads, struct error *error)
{
    enum status status;
    const struct ranks *ranks = preconditioner->factor.ranks;
    int64_t nodes = preconditioner->node_count, *first = NULL;
    int field[COARSE_MOST_AT_NODE];
    double value[COARSE_MOST_AT_NODE];
    TRY(ranks_share(ranks, preconditioner->coarse.count, NULL, &preconditioner->field_first, error));
    first = preconditioner->field_first;
    TRY(NEW_ARRAY(&preconditioner->inverse_fields, preconditioner->coarse.count * nodes, error));
    for (int64_t n = 0; n < nodes; n++) {
        int count = coarse_space_at_node(&preconditioner->coarse, n, field, value);
        for (int k = 0; k < count; k++) {
            preconditioner->inverse_fields[field[k] * nodes + n] = value[k];
        }
    }
    int64_t begin = first[ranks_rank(ranks)], end = first[ranks_rank(ranks) + 1];
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int64_t k = begin; k < end; k++) {
        inverse_factor_solve_transposed(&preconditioner->factor, 1,
                                        preconditioner->inverse_fields + k * nodes);
    }
    ranks_gather(ranks, preconditioner->inverse_fields, (size_t)nodes * sizeof(double), first);
done:
    return status;
}

static enum status build_inverse(struct solid_system *system, struct preconditioner *preconditioner,
                                 struct error *error)
{
    enum status status;
    TRY(inverse_factor_build(system, &preconditioner->factor, error));
    TRY(inverse_factor_transform_rows(&preconditioner->factor, &system->rows, &preconditioner->factor_rows,
                                      error));
    TRY(NEW_ARRAY(&preconditioner->at_rest, system->node_count, error));
    TRY(NEW_ARRAY(&preconditioner->on_inverse, 2 * system->node_count * system->dim, error));
    system_relaxation_mass(system, true, preconditioner->at_rest);
    TRY(transform_fields(preconditioner, system->body.threads, error));
done:
    return status;
}

enum status preconditioner_build(struct solid_system *system, bool coarse,
                                 struct preconditioner *preconditioner, struct error *error)
{
    enum status status;
    int64_t cells;
    *preconditioner = (struct preconditioner){.dim = system->dim, .node_count = system->node_count};
    preconditioner->has_rigid_mode = system_has_rigid_mode(system);
    for (int64_t c = 0; c < system->contact_count; c++) {
        preconditioner->contact_node_count += contact_nodes(&system->contacts[c])->count;
    }
    TRY(NEW_ARRAY(&preconditioner->mass, system->node_count, error));
    TRY(NEW_ARRAY(&preconditioner->stiffness, system->node_count, error));
    TRY(coarse_space_build(system->dim, system->node_count, system->X, coarse ? centre_count(system) : 0,
                           &preconditioner->coarse, error));
    preconditioner->size = preconditioner->coarse.count * preconditioner->dim;
    cells = preconditioner->size * preconditioner->size;
    TRY(NEW_ARRAY(&preconditioner->active, preconditioner->contact_node_count, error));
    TRY(NEW_ARRAY(&preconditioner->normal, preconditioner->contact_node_count * preconditioner->dim, error));
    TRY(NEW_ARRAY(&preconditioner->creased, preconditioner->contact_node_count, error));
    TRY(NEW_ARRAY(&preconditioner->turned, preconditioner->contact_node_count, error));
    TRY(NEW_ARRAY(&preconditioner->idle, 2 * preconditioner->contact_node_count, error));
    TRY(NEW_ARRAY(&preconditioner->patience, 2 * preconditioner->contact_node_count, error));
    TRY(NEW_ARRAY(&preconditioner->body, cells, error));
    TRY(NEW_ARRAY(&preconditioner->weight, cells, error));
    TRY(NEW_ARRAY(&preconditioner->free_weight, cells, error));
    TRY(NEW_ARRAY(&preconditioner->held, system->rows.count * preconditioner->size, error));
    TRY(NEW_ARRAY(&preconditioner->inverse, cells, error));
    TRY(NEW_ARRAY(&preconditioner->capacitance_inverse, cells, error));
    TRY(NEW_ARRAY(&preconditioner->amount, 2 * preconditioner->size, error));
    if (coarse && system_has_inverse(system)) {
        TRY(build_inverse(system, preconditioner, error));
    }
    TRY(ranks_share(preconditioner->factor.ranks, preconditioner->size, NULL, &preconditioner->column_first,
                    error));
done:
    if (status != STATUS_OK) {
        preconditioner_free(preconditioner);
    }
    return status;
}

void preconditioner_free(struct preconditioner *preconditioner)
{
    constraint_free(&preconditioner->constraint);
    coarse_space_free(&preconditioner->coarse);
    inverse_factor_free(&preconditioner->factor);
    constraint_rows_free(&preconditioner->factor_rows);
    free(preconditioner->inverse_fields);
    free(preconditioner->field_first);
    free(preconditioner->column_first);
    free(preconditioner->on_inverse);
    free(preconditioner->at_rest);
    free(preconditioner->stiffness);
    free(preconditioner->mass);
    free(preconditioner->body);
    free(preconditioner->active);
    free(preconditioner->normal);
    free(preconditioner->creased);
    free(preconditioner->turned);
    free(preconditioner->idle);
    free(preconditioner->patience);
    free(preconditioner->weight);
    free(preconditioner->free_weight);
    free(preconditioner->held);
    free(preconditioner->inverse);
    free(preconditioner->capacitance_inverse);
    free(preconditioner->amount);
    *preconditioner = (struct preconditioner){0};
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

/* y = D^-1 x */
static void divide_by_mass(const struct preconditioner *preconditioner, const double *x, double *y)
{
    for (int64_t n = 0; n < preconditioner->node_count; n++) {
        double inverse = 1.0 / preconditioner->mass[n];
        for (int64_t i = n * preconditioner->dim; i < (n + 1) * preconditioner->dim; i++) {
            y[i] = inverse * x[i];
        }
    }
}

void preconditioner_smooth(struct preconditioner *preconditioner, const double *force, double *result)
{
    const struct inverse_factor *inverse = &preconditioner->factor;
    double *on_inverse = preconditioner->on_inverse;
    if (inverse->rows.row_count == 0) {
        divide_by_mass(preconditioner, force, result);
        return;
    }
    inverse_factor_apply(inverse, preconditioner->dim, force, on_inverse);
    divide_by_mass(preconditioner, on_inverse, on_inverse);
    inverse_factor_apply_transposed(inverse, preconditioner->dim, on_inverse, result);
}

void preconditioner_restrict_force(struct preconditioner *preconditioner, const double *force,
                                   double *acceleration, double *amount)
{
    const struct constraint_rows *rows = preconditioner->constraint.rows;
    double *seen = preconditioner->constraint.multiplier;
    preconditioner_smooth(preconditioner, force, acceleration);
    if (preconditioner->size > 0) {
        coarse_space_restrict(&preconditioner->coarse, NULL, force, amount);
    }
    if (rows == NULL) {
        return;
    }
    constraint_values(&preconditioner->constraint, acceleration, seen);
    const struct ranks *ranks = preconditioner->factor.ranks;
    const int64_t *first = preconditioner->column_first + ranks_rank(ranks);
    for (int64_t r = 0; r < rows->count; r++) {
        const double *held = preconditioner->held + r * preconditioner->size;
        for (int64_t k = first[0]; k < first[1] && seen[r] != 0.0; k++) {
            amount[k] -= held[k] * seen[r];
        }
    }
    ranks_gather(ranks, amount, sizeof *amount, preconditioner->column_first);
}

void preconditioner_apply(struct preconditioner *preconditioner, const double *force, double *acceleration)
{
    struct constraint *constraint = &preconditioner->constraint;
    const struct constraint_rows *rows = constraint->rows;
    double *multiplier = constraint->multiplier, *solved = preconditioner->amount + preconditioner->size;
    preconditioner_restrict_force(preconditioner, force, acceleration, preconditioner->amount);
    if (preconditioner->size > 0) {
        multiply(preconditioner->size, preconditioner->inverse, preconditioner->amount, solved);
        coarse_space_prolongate(&preconditioner->coarse, solved, acceleration);
    }
    if (rows == NULL || rows->count == 0) {
        return;
    }
    constraint_solve(constraint, multiplier);
    for (int64_t r = 0; r < rows->count; r++) {
        const double *held = preconditioner->held + r * preconditioner->size;
        double sum = multiplier[r];
        for (int64_t k = 0; k < preconditioner->size; k++) {
            sum += held[k] * solved[k];
        }
        multiplier[r] = -sum;
    }
    constraint_spread(constraint, multiplier, acceleration);
}

/* L^-T move, into scratch; or the move itself. */
static const double *on_inverse(const struct preconditioner *preconditioner, const double *move,
                                double *scratch)
{
    if (preconditioner->factor.rows.row_count == 0) {
        return move;
    }
    memcpy(scratch, move, (size_t)(preconditioner->node_count * preconditioner->dim) * sizeof *move);
    inverse_factor_solve_transposed(&preconditioner->factor, preconditioner->dim, scratch);
    return scratch;
}

/* x . D y */
static double weighted_product(const struct preconditioner *preconditioner, const double *x, const double *y)
{
    int dim = preconditioner->dim;
    double sum = 0.0;
    for (int64_t n = 0; n < preconditioner->node_count; n++) {
        double part = 0.0;
        for (int a = 0; a < dim; a++) {
            part += x[n * dim + a] * y[n * dim + a];
        }
        sum += preconditioner->mass[n] * part;
    }
    return sum;
}

/* amount[size] = Z^T B^-1 move = (L^-T Z)^T D L^-T move, of moved = L^-T move. */
static void restrict_move(const struct preconditioner *preconditioner, const double *moved, double *amount)
{
    int dim = preconditioner->dim;
    int64_t nodes = preconditioner->node_count;
    if (preconditioner->factor.rows.row_count == 0) {
        coarse_space_restrict(&preconditioner->coarse, preconditioner->mass, moved, amount);
        return;
    }
    const struct ranks *ranks = preconditioner->factor.ranks;
    const int64_t *first = preconditioner->field_first;
    memset(amount, 0, (size_t)preconditioner->size * sizeof *amount);
    for (int64_t k = first[ranks_rank(ranks)]; k < first[ranks_rank(ranks) + 1]; k++) {
        const double *field = preconditioner->inverse_fields + k * nodes;
        for (int64_t n = 0; n < nodes; n++) {
            double weight = preconditioner->mass[n] * field[n];
            for (int a = 0; a < dim; a++) {
                amount[k * dim + a] += weight * moved[n * dim + a];
            }
        }
    }
    ranks_gather(ranks, amount, (size_t)dim * sizeof *amount, first);
}

/* Both moves in terms of L. */
static void take_moves(struct preconditioner *preconditioner, const double **x, const double **y)
{
    double *scratch = preconditioner->on_inverse;
    bool same = *x == *y;
    *x = on_inverse(preconditioner, *x, scratch);
    *y = same ? *x
              : on_inverse(preconditioner, *y, scratch + preconditioner->node_count * preconditioner->dim);
}

double preconditioner_product_diagonal(struct preconditioner *preconditioner, const double *x,
                                       const double *y)
{
    take_moves(preconditioner, &x, &y);
    return weighted_product(preconditioner, x, y);
}

double preconditioner_product(struct preconditioner *preconditioner, const double *x, const double *y)
{
    double *amount = preconditioner->amount, *solved = preconditioner->amount + preconditioner->size;
    take_moves(preconditioner, &x, &y);
    double sum = weighted_product(preconditioner, x, y);
    if (preconditioner->size > 0) {
        restrict_move(preconditioner, x, amount);
        multiply(preconditioner->size, preconditioner->capacitance_inverse, amount, solved);
        if (y != x) {
            restrict_move(preconditioner, y, amount);
        }
        for (int64_t k = 0; k < preconditioner->size; k++) {
            sum -= amount[k] * solved[k];
        }
    }
    return sum;
}

enum status preconditioner_state(struct preconditioner *preconditioner, const struct state *state,
                                 struct error *error)
{
    const struct state_value values[] = {
        {"mass", STATE_NUMBERS, preconditioner->mass, preconditioner->node_count},
        {"stiffness", STATE_NUMBERS, preconditioner->stiffness, preconditioner->node_count},
        {"body", STATE_NUMBERS, preconditioner->body, preconditioner->size * preconditioner->size},
        {"measured", STATE_NUMBERS, &preconditioner->measured_mass, 1},
        {"touching", STATE_FLAGS, preconditioner->active, preconditioner->contact_node_count},
        {"normal", STATE_NUMBERS, preconditioner->normal,
         preconditioner->contact_node_count * preconditioner->dim},
        {"creased", STATE_FLAGS, preconditioner->creased, preconditioner->contact_node_count},
        {"turned", STATE_FLAGS, preconditioner->turned, preconditioner->contact_node_count},
        {"idle", STATE_COUNTS, preconditioner->idle, 2 * preconditioner->contact_node_count},
        {"patience", STATE_COUNTS, preconditioner->patience, 2 * preconditioner->contact_node_count},
    };
    return state_visit(state, "inertia", values, sizeof values / sizeof *values, error);
}
