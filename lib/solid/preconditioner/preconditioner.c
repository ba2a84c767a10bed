#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/vector.h"
#include "solid/constraint/held_directions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Nodes across a group at least. */
enum { NODES_ACROSS_GROUP = 4 };
/* Unknowns at most where each costs an evaluation: 16 groups in two dimensions and 8 in three. */
static const int64_t most_unknowns = 96;
/* Groups at most where the stiffness is assembled, by the number of nodes to this power: its factor costs
 * about as much as some evaluations then. */
static const double most_groups_2d = 4.0, power_2d = 1.0 / 2.0, most_groups_3d = 9.0, power_3d = 1.0 / 3.0;

static int64_t group_count(const struct solid_system *system)
{
    int64_t fields = system->dim + 1, most = most_unknowns / (fields * system->dim);
    int64_t nodes = system->dim == 2 ? NODES_ACROSS_GROUP * NODES_ACROSS_GROUP
                                     : NODES_ACROSS_GROUP * NODES_ACROSS_GROUP * NODES_ACROSS_GROUP;
    int64_t count = system->node_count / nodes;
    if (system->body.smoothed) {
        double all = (double)system->node_count;
        most = (int64_t)(system->dim == 2 ? most_groups_2d * pow(all, power_2d)
                                          : most_groups_3d * pow(all, power_3d));
    }
    return count < most ? count : most;
}

static enum status build_inverse(struct solid_system *system, struct preconditioner *p, struct error *error)
{
    RETURN_IF_ERROR(inverse_stiffness_factor(system, &p->factor, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->at_rest, system->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->rotation, system->node_count * system->dim * system->dim, error));
    system_relaxation_mass(system, true, p->at_rest);
    return STATUS_OK;
}

/* Let the coarse fields be zero at nodes that the conditions hold in all directions: P takes what they would
 * move there, and contacts and elements are to see the fields without it. */
static enum status leave_out_held(const struct solid_system *system, struct coarse_space *coarse,
                                  struct error *error)
{
    FREED_BY(held_free) struct held_directions held = {0};
    RETURN_IF_ERROR(held_build(system->dim, system->node_count, &held, error));
    held_note(&held, &system->rows, 0, system->rows.count);
    for (int64_t n = 0; n < system->node_count && coarse->count > 0; n++) {
        int64_t end = held.count[n] == system->dim ? coarse->shares.ptr[n + 1] : 0;
        for (int64_t i = coarse->shares.ptr[n]; i < end; i++) {
            coarse->shares.value[i] = 0.0;
        }
    }
    sparse_free(&coarse->of_group);
    return coarse->count > 0 ? sparse_transpose(&coarse->shares, &coarse->of_group, error) : STATUS_OK;
}

enum status preconditioner_build(struct solid_system *system, bool coarse, struct preconditioner *p,
                                 struct error *error)
{
    *p = (struct preconditioner){.dim = system->dim,
                                 .node_count = system->node_count,
                                 .has_rigid_mode = system->floats,
                                 .turns = system->turns};
    RETURN_IF_ERROR(system_constrain(system, NULL, &p->constraint, error));
    for (int64_t c = 0; c < system->contact_count; c++) {
        p->contact_node_count += contact_nodes(&system->contacts[c])->count;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&p->mass, system->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->stiffness, system->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->vector, system->node_count * system->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->force, system->node_count * system->dim, error));
    coarse = coarse && system->node_lists != NULL;
    RETURN_IF_ERROR(coarse_space_build(system->dim, system->node_count, system->X, system->node_lists,
                                       coarse ? group_count(system) : 0, &p->coarse, error));
    RETURN_IF_ERROR(leave_out_held(system, &p->coarse, error));
    p->size = p->coarse.count * p->dim;
    RETURN_IF_ERROR(coarse_rows_begin(&p->coarse, &p->rows, error));
    RETURN_IF_ERROR(preconditioner_lay_out(p, system, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->along, p->contact_node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->normal, p->contact_node_count * p->dim, error));
    if (system_has_friction(system)) {
        RETURN_IF_ERROR(NEW_ARRAY(&p->across, p->contact_node_count, error));
    }
    RETURN_IF_ERROR(NEW_ARRAY(&p->body, p->profile.size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->stiffness_factor, p->profile.size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->weight, p->coarse.count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->amount, p->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->turned, p->turns.column_count, error));
    if (coarse && system_has_inverse(system)) {
        RETURN_IF_ERROR(build_inverse(system, p, error));
    }
    return STATUS_OK;
}

void preconditioner_free(struct preconditioner *p)
{
    constraint_free(&p->constraint);
    coarse_space_free(&p->coarse);
    inverse_factor_free(&p->factor);
    coarse_rows_free(&p->rows);
    profile_free(&p->profile);
    FREE_ALL(p->vector, p->force, p->at_rest, p->rotation, p->stiffness, p->mass, p->body, p->along,
             p->normal, p->across, p->weight, p->stiffness_factor, p->amount, p->turned);
    *p = (struct preconditioner){0};
}

/* weight: the diagonal of Z^T D Z */
static void weigh_coarse_space(struct preconditioner *p)
{
    const struct sparse *shares = &p->coarse.shares;
    int64_t fields = p->dim + 1;
    double value[4];
    memset(p->weight, 0, (size_t)p->coarse.count * sizeof *p->weight);
    for (int64_t n = 0; n < p->node_count && p->size > 0; n++) {
        for (int64_t i = shares->ptr[n]; i < shares->ptr[n + 1]; i++) {
            coarse_space_values(&p->coarse, n, shares->idx[i], shares->value[i], value);
            for (int64_t m = 0; m < fields; m++) {
                p->weight[shares->idx[i] * fields + m] += p->stiffness[n] * value[m] * value[m];
            }
        }
    }
}

void preconditioner_set_mass(struct preconditioner *p, const double *stiffness)
{
    for (int64_t n = 0; n < p->node_count; n++) {
        p->stiffness[n] = stiffness[n];
        p->mass[n] = p->at_rest != NULL ? stiffness[n] / p->at_rest[n] : stiffness[n];
    }
    if (p->weight != NULL) {
        weigh_coarse_space(p);
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

/* y = B x; not the same array */
static void smooth(struct preconditioner *p, const double *x, double *y)
{
    if (p->factor.node_count == 0) {
        divide_by_mass(p, x, y);
        return;
    }
    preconditioner_turn(p, true, x, y);
    inverse_factor_apply(&p->factor, y, p->vector);
    divide_by_mass(p, p->vector, p->vector);
    inverse_factor_apply_transposed(&p->factor, p->vector, y);
    preconditioner_turn(p, false, y, y);
}

void preconditioner_project(struct preconditioner *p, double *x)
{
    constraint_project(&p->constraint, NULL, x);
    constraint_project(&p->constraint, NULL, x);
    const struct sparse *turns = &p->turns;
    if (turns->row_count == 0) {
        return;
    }
    memset(p->turned, 0, (size_t)turns->column_count * sizeof *p->turned);
    for (int64_t r = 0; r < turns->row_count; r++) {
        for (int64_t i = turns->ptr[r]; i < turns->ptr[r + 1]; i++) {
            p->turned[turns->idx[i]] -= turns->value[i] * x[r];
        }
    }
    sparse_add_rows(turns, 0, turns->row_count, 1, p->turned, x);
}

enum status preconditioner_row_forces(struct preconditioner *p, const double *residual, double *scratch,
                                      double *row_force, struct error *error)
{
    struct constraint *constraint = &p->constraint;
    memcpy(scratch, residual, (size_t)(p->node_count * p->dim) * sizeof *residual);
    constraint_project(constraint, NULL, scratch);
    memcpy(row_force, constraint->multiplier, (size_t)constraint->rows->count * sizeof *row_force);
    return constraint_share_out(constraint, row_force, error);
}

void preconditioner_apply(struct preconditioner *p, const double *force, double *acceleration)
{
    if (p->constraint.rows != NULL && p->constraint.mass == NULL) { /* an orthogonal projection */
        memcpy(p->force, force, (size_t)(p->node_count * p->dim) * sizeof *force);
        preconditioner_project(p, p->force);
        force = p->force;
    }
    smooth(p, force, acceleration);
    if (p->uses_coarse) {
        coarse_space_restrict(&p->coarse, force, p->amount);
        profile_solve(&p->profile, p->stiffness_factor, p->amount);
        coarse_space_prolongate(&p->coarse, p->amount, acceleration);
    }
    preconditioner_project(p, acceleration);
}

double preconditioner_square_diagonal(struct preconditioner *p, const double *x)
{
    double sum = 0.0;
    for (int64_t n = 0; n < p->node_count; n++) {
        sum += p->stiffness[n] * vector_dot(p->dim, x + n * p->dim, x + n * p->dim);
    }
    return sum;
}

enum status preconditioner_state(struct preconditioner *p, const struct state *state, struct error *error)
{
    const struct state_value values[] = {
        {"mass", STATE_NUMBERS, p->mass, p->node_count},
        {"stiffness", STATE_NUMBERS, p->stiffness, p->node_count},
        {"weight", STATE_NUMBERS, p->weight, p->coarse.count},
        {"body", STATE_NUMBERS, p->body, p->profile.size},
        {"rotation", STATE_NUMBERS, p->rotation, p->rotation != NULL ? p->node_count * p->dim * p->dim : 0},
        {"along", STATE_NUMBERS, p->along, p->contact_node_count},
        {"normal", STATE_NUMBERS, p->normal, p->contact_node_count * p->dim},
    };
    const struct state_value across = {"across", STATE_NUMBERS, p->across, p->contact_node_count};
    RETURN_IF_ERROR(state_visit(state, "preconditioner", values, sizeof values / sizeof *values, error));
    return p->across != NULL ? state_visit(state, "preconditioner", &across, 1, error) : STATUS_OK;
}
