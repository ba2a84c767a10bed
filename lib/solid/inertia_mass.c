/* The diagonal mass, and what of it and of the conditions the fields feel. */
#include "solid/inertia_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static const double most_change = 1.5; /* of the mass, before the fields are measured again */

/* weight = Z^T D Z: directions do not couple. */
static void weigh_fields(struct inertia *inertia)
{
    int64_t dim = inertia->dim, size = inertia->size;
    double *weight = inertia->weight, value[FIELDS_MOST_AT_NODE];
    int field[FIELDS_MOST_AT_NODE];
    memset(weight, 0, (size_t)(size * size) * sizeof *weight);
    for (int64_t n = 0; n < inertia->node_count; n++) {
        int count = fields_at_node(&inertia->fields, n, field, value);
        for (int i = 0; i < count; i++) {
            for (int k = 0; k < count; k++) {
                weight[field[i] * dim * size + field[k] * dim] += inertia->mass[n] * value[i] * value[k];
            }
        }
    }
    for (int64_t i = 0; i < size; i += dim) {
        for (int64_t a = 1; a < dim; a++) {
            for (int64_t k = 0; k < size; k += dim) {
                weight[(i + a) * size + k + a] = weight[i * size + k];
            }
        }
    }
}

void inertia_add_row(const struct inertia *inertia, const struct average *average, const double *direction,
                     double *row)
{
    int field[FIELDS_MOST_AT_NODE], dim = inertia->dim;
    double value[FIELDS_MOST_AT_NODE];
    for (int64_t i = 0; i < average->length; i++) {
        int count = fields_at_node(&inertia->fields, average->idx[i], field, value);
        for (int k = 0; k < count; k++) {
            for (int a = 0; a < dim; a++) {
                row[field[k] * dim + a] += average->phi[i] * value[k] * direction[a];
            }
        }
    }
}

/* free_weight = Z^T D P Z = Z^T D Z - (G Z)^T (G D^-1 G^T)^-1 G Z: without what the conditions forbid. */
static enum status weigh_conditions(struct inertia *inertia, struct error *error)
{
    enum status status;
    const struct constraint_rows *rows = inertia->constraint.rows;
    int64_t size = inertia->size;
    double *conditions = NULL, *solved = NULL;
    memcpy(inertia->free_weight, inertia->weight, (size_t)(size * size) * sizeof *inertia->weight);
    TRY(NEW_ARRAY(&conditions, rows->count * size, error));
    TRY(NEW_ARRAY(&solved, rows->count, error));
    for (int64_t r = 0; r < rows->count; r++) {
        struct average average = constraint_rows_average(rows, r);
        inertia_add_row(inertia, &average, rows->direction + r * inertia->dim, conditions + r * size);
    }
    for (int64_t k = 0; k < size; k++) {
        double *column = inertia->free_weight + k * size; /* or row: symmetric */
        for (int64_t r = 0; r < rows->count; r++) {
            solved[r] = conditions[r * size + k];
        }
        envelope_solve(&inertia->constraint.factor, solved);
        for (int64_t r = 0; r < rows->count; r++) {
            inertia->held[r * size + k] = solved[r];
            for (int64_t i = 0; i < size && solved[r] != 0.0; i++) {
                column[i] -= solved[r] * conditions[r * size + i];
            }
        }
    }
done:
    free(conditions);
    free(solved);
    return status;
}

enum status inertia_set_mass(struct inertia *inertia, const struct solid_system *system, const double *mass,
                             struct error *error)
{
    memcpy(inertia->mass, mass, (size_t)inertia->node_count * sizeof *mass);
    return inertia_restore(inertia, system, error);
}

enum status inertia_restore(struct inertia *inertia, const struct solid_system *system, struct error *error)
{
    enum status status;
    constraint_free(&inertia->constraint);
    TRY(system_constrain(system, inertia->mass, &inertia->constraint, error));
    if (inertia->size > 0) {
        weigh_fields(inertia);
        TRY(weigh_conditions(inertia, error));
        inertia_invert(inertia, system);
    }
done:
    return status;
}

double inertia_sum_of_mass(const struct inertia *inertia)
{
    double sum = 0.0;
    for (int64_t n = 0; n < inertia->node_count; n++) {
        sum += inertia->mass[n];
    }
    return sum;
}

bool inertia_is_stale(const struct inertia *inertia)
{
    double change = inertia_sum_of_mass(inertia) / inertia->measured_mass;
    return inertia->size > 0 && (change > most_change || change < 1.0 / most_change);
}
