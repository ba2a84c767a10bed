#include "solid/inertia_private.h"

#include "base/memory.h"
#include "solid/freedom.h"

#include <stdlib.h>
#include <string.h>

/* Nodes for each field at least: each field costs an evaluation for each direction at the begin. With twice
 * FIELDS_MOST_CENTRES steps are no fewer. */
static const int64_t nodes_per_field = 8;

static int64_t centre_count(const struct solid_system *system)
{
    int64_t count = system->node_count / (nodes_per_field * (system->dim + 1));
    return count < FIELDS_MOST_CENTRES ? count : FIELDS_MOST_CENTRES;
}

enum status inertia_build(const struct solid_system *system, bool coarse, struct inertia *inertia,
                          struct error *error)
{
    enum status status;
    int64_t cells;
    *inertia = (struct inertia){.dim = system->dim, .node_count = system->node_count};
    inertia->floats = system_floats(system);
    for (int64_t c = 0; c < system->contact_count; c++) {
        inertia->hat_count += system->contacts[c].count;
    }
    TRY(NEW_ARRAY(&inertia->mass, system->node_count, error));
    TRY(fields_build(system->dim, system->node_count, system->X, coarse ? centre_count(system) : 0,
                     &inertia->fields, error));
    inertia->size = inertia->fields.count * inertia->dim;
    cells = inertia->size * inertia->size;
    TRY(NEW_ARRAY(&inertia->touching, inertia->hat_count, error));
    TRY(NEW_ARRAY(&inertia->normal, inertia->hat_count * inertia->dim, error));
    TRY(NEW_ARRAY(&inertia->body, cells, error));
    TRY(NEW_ARRAY(&inertia->weight, cells, error));
    TRY(NEW_ARRAY(&inertia->free_weight, cells, error));
    TRY(NEW_ARRAY(&inertia->held, system->rows.count * inertia->size, error));
    TRY(NEW_ARRAY(&inertia->inverse, cells, error));
    TRY(NEW_ARRAY(&inertia->beside, cells, error));
    TRY(NEW_ARRAY(&inertia->amount, 2 * inertia->size, error));
done:
    if (status != STATUS_OK) {
        inertia_free(inertia);
    }
    return status;
}

void inertia_free(struct inertia *inertia)
{
    constraint_free(&inertia->constraint);
    fields_free(&inertia->fields);
    free(inertia->mass);
    free(inertia->body);
    free(inertia->touching);
    free(inertia->normal);
    free(inertia->weight);
    free(inertia->free_weight);
    free(inertia->held);
    free(inertia->inverse);
    free(inertia->beside);
    free(inertia->amount);
    *inertia = (struct inertia){0};
}

void inertia_collect(const struct inertia *inertia, const double *move, double *amount)
{
    fields_collect(&inertia->fields, inertia->mass, move, amount);
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

void inertia_collect_force(struct inertia *inertia, const double *force, double *acceleration, double *amount)
{
    const struct constraint_rows *rows = inertia->constraint.rows;
    double *seen = inertia->constraint.multiplier;
    for (int64_t n = 0; n < inertia->node_count; n++) {
        double inverse = 1.0 / inertia->mass[n];
        for (int64_t i = n * inertia->dim; i < (n + 1) * inertia->dim; i++) {
            acceleration[i] = inverse * force[i];
        }
    }
    if (inertia->size > 0) {
        fields_collect(&inertia->fields, NULL, force, amount);
    }
    if (rows == NULL) {
        return;
    }
    constraint_rows_values(rows, acceleration, seen);
    for (int64_t r = 0; r < rows->count; r++) {
        const double *held = inertia->held + r * inertia->size;
        for (int64_t k = 0; k < inertia->size && seen[r] != 0.0; k++) {
            amount[k] -= held[k] * seen[r];
        }
    }
}

void inertia_accelerate(struct inertia *inertia, const double *force, double *acceleration)
{
    struct constraint *constraint = &inertia->constraint;
    const struct constraint_rows *rows = constraint->rows;
    double *multiplier = constraint->multiplier, *solved = inertia->amount + inertia->size;
    inertia_collect_force(inertia, force, acceleration, inertia->amount);
    if (inertia->size > 0) {
        multiply(inertia->size, inertia->inverse, inertia->amount, solved);
        fields_add(&inertia->fields, solved, acceleration);
    }
    if (rows == NULL || rows->count == 0) {
        return;
    }
    envelope_solve(&constraint->factor, multiplier);
    for (int64_t r = 0; r < rows->count; r++) {
        const double *held = inertia->held + r * inertia->size;
        double sum = multiplier[r];
        for (int64_t k = 0; k < inertia->size; k++) {
            sum += held[k] * solved[k];
        }
        multiplier[r] = -sum;
    }
    constraint_rows_spread(rows, multiplier, inertia->mass, acceleration);
}

double inertia_product_alone(const struct inertia *inertia, const double *x, const double *y)
{
    int dim = inertia->dim;
    double sum = 0.0;
    for (int64_t n = 0; n < inertia->node_count; n++) {
        double part = 0.0;
        for (int a = 0; a < dim; a++) {
            part += x[n * dim + a] * y[n * dim + a];
        }
        sum += inertia->mass[n] * part;
    }
    return sum;
}

double inertia_product(const struct inertia *inertia, const double *x, const double *y)
{
    double *amount = inertia->amount, *solved = inertia->amount + inertia->size;
    double sum = inertia_product_alone(inertia, x, y);
    if (inertia->size > 0) {
        inertia_collect(inertia, x, amount);
        multiply(inertia->size, inertia->beside, amount, solved);
        if (y != x) {
            inertia_collect(inertia, y, amount);
        }
        for (int64_t k = 0; k < inertia->size; k++) {
            sum -= amount[k] * solved[k];
        }
    }
    return sum;
}

enum status inertia_state(struct inertia *inertia, const struct state *state, struct error *error)
{
    const struct state_value values[] = {
        {"mass", STATE_NUMBERS, inertia->mass, inertia->node_count},
        {"body", STATE_NUMBERS, inertia->body, inertia->size * inertia->size},
        {"measured", STATE_NUMBERS, &inertia->measured_mass, 1},
        {"touching", STATE_FLAGS, inertia->touching, inertia->hat_count},
        {"normal", STATE_NUMBERS, inertia->normal, inertia->hat_count * inertia->dim},
    };
    return state_visit(state, "inertia", values, sizeof values / sizeof *values, error);
}
