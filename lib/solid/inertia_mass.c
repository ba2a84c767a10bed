/* The diagonal mass, and the mass matrices of the coarse space with and without the rows H. */
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

/* free_weight = Z^T D P Z = Z^T D Z - (H Z)^T S^-1 H Z. */
static enum status weigh_rows(struct inertia *inertia, struct error *error)
{
    enum status status;
    int64_t size = inertia->size, rows = inertia_row_count(inertia);
    double *seen = NULL, *solved = NULL, *field = NULL; /* the first two by fields */
    memcpy(inertia->free_weight, inertia->weight, (size_t)(size * size) * sizeof *inertia->weight);
    TRY(NEW_ARRAY(&seen, rows * size, error));
    TRY(NEW_ARRAY(&solved, rows * size, error));
    TRY(NEW_ARRAY(&field, inertia->node_count * inertia->dim, error));
    for (int64_t k = 0; k < size; k++) {
        memset(inertia->amount, 0, (size_t)size * sizeof *inertia->amount);
        memset(field, 0, (size_t)(inertia->node_count * inertia->dim) * sizeof *field);
        inertia->amount[k] = 1.0;
        fields_add(&inertia->fields, inertia->amount, field);
        inertia_rows_see(inertia, field, seen + k * rows);
    }
    memcpy(solved, seen, (size_t)(rows * size) * sizeof *seen);
    TRY(inertia_rows_solve_many(inertia, size, solved, error));
    for (int64_t k = 0; k < size; k++) {
        for (int64_t i = 0; i < size; i++) {
            double sum = 0.0;
            for (int64_t r = 0; r < rows; r++) {
                sum += solved[k * rows + r] * seen[i * rows + r];
            }
            inertia->free_weight[k * size + i] -= sum; /* or column: symmetric */
        }
        for (int64_t r = 0; r < rows; r++) {
            inertia->held[r * size + k] = solved[k * rows + r];
        }
    }
done:
    free(seen);
    free(solved);
    free(field);
    return status;
}

enum status inertia_set_mass(struct inertia *inertia, const struct solid_system *system, const double *mass,
                             struct error *error)
{
    enum status status;
    memcpy(inertia->mass, mass, (size_t)inertia->node_count * sizeof *mass);
    if (inertia->volumes.count > 0) {
        TRY(volume_rows_set(&system->body, &inertia->volumes, error));
    }
    TRY(inertia_restore(inertia, system, error));
done:
    return status;
}

enum status inertia_restore(struct inertia *inertia, const struct solid_system *system, struct error *error)
{
    enum status status;
    constraint_free(&inertia->constraint);
    TRY(system_constrain(system, inertia->mass, &inertia->constraint, error));
    TRY(inertia_couple(inertia, error));
    if (inertia->size > 0) {
        weigh_fields(inertia);
        TRY(weigh_rows(inertia, error));
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
