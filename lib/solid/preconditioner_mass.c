/* The diagonal mass, and what of it and of the conditions the coarse fields feel. */
#include "solid/preconditioner_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static const double most_change = 1.5; /* of the mass, before the coarse fields are measured again */

/* weight = (L^-T Z)^T D L^-T Z */
static void weigh_inverse_fields(struct preconditioner *preconditioner)
{
    int64_t dim = preconditioner->dim, size = preconditioner->size, nodes = preconditioner->node_count;
    for (int64_t i = 0; i < preconditioner->coarse.count; i++) {
        const double *first = preconditioner->inverse_fields + i * nodes;
        for (int64_t k = 0; k <= i; k++) {
            const double *second = preconditioner->inverse_fields + k * nodes;
            double sum = 0.0;
            for (int64_t n = 0; n < nodes; n++) {
                sum += preconditioner->mass[n] * first[n] * second[n];
            }
            for (int64_t a = 0; a < dim; a++) {
                preconditioner->weight[(i * dim + a) * size + k * dim + a] =
                    preconditioner->weight[(k * dim + a) * size + i * dim + a] = sum;
            }
        }
    }
}

/* weight = Z^T B^-1 Z: directions do not couple. */
static void weigh_coarse_space(struct preconditioner *preconditioner)
{
    int64_t dim = preconditioner->dim, size = preconditioner->size;
    double *weight = preconditioner->weight, value[COARSE_MOST_AT_NODE];
    int field[COARSE_MOST_AT_NODE];
    memset(weight, 0, (size_t)(size * size) * sizeof *weight);
    if (preconditioner->factor.rows.row_count > 0) {
        weigh_inverse_fields(preconditioner);
        return;
    }
    for (int64_t n = 0; n < preconditioner->node_count; n++) {
        int count = coarse_space_at_node(&preconditioner->coarse, n, field, value);
        for (int i = 0; i < count; i++) {
            for (int k = 0; k < count; k++) {
                weight[field[i] * dim * size + field[k] * dim] +=
                    preconditioner->mass[n] * value[i] * value[k];
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

void preconditioner_add_row(const struct preconditioner *preconditioner, const struct average *average,
                            const double *direction, double *row)
{
    int field[COARSE_MOST_AT_NODE], dim = preconditioner->dim;
    double value[COARSE_MOST_AT_NODE];
    for (int64_t i = 0; i < average->length; i++) {
        int count = coarse_space_at_node(&preconditioner->coarse, average->idx[i], field, value);
        for (int k = 0; k < count; k++) {
            for (int a = 0; a < dim; a++) {
                row[field[k] * dim + a] += average->phi[i] * value[k] * direction[a];
            }
        }
    }
}

/* free_weight = Z^T B^-1 P Z = Z^T B^-1 Z - (G Z)^T (G B G^T)^-1 G Z: without what the conditions forbid.
 * Each process computes some columns. */
static enum status weigh_conditions(struct preconditioner *preconditioner, struct error *error)
{
    enum status status;
    const struct ranks *ranks = preconditioner->factor.ranks;
    const struct constraint_rows *rows = preconditioner->constraint.rows;
    const int64_t *first = preconditioner->column_first;
    int64_t size = preconditioner->size;
    double *conditions = NULL, *solved = NULL; /* solved: by columns */
    memcpy(preconditioner->free_weight, preconditioner->weight,
           (size_t)(size * size) * sizeof *preconditioner->weight);
    TRY(NEW_ARRAY(&conditions, rows->count * size, error));
    TRY(NEW_ARRAY(&solved, rows->count * size, error));
    for (int64_t r = 0; r < rows->count; r++) {
        struct average average = constraint_rows_average(rows, r);
        preconditioner_add_row(preconditioner, &average, rows->direction + r * preconditioner->dim,
                               conditions + r * size);
    }
    for (int64_t k = first[ranks_rank(ranks)]; k < first[ranks_rank(ranks) + 1]; k++) {
        double *weight = preconditioner->free_weight + k * size; /* or row: symmetric */
        double *column = solved + k * rows->count;
        for (int64_t r = 0; r < rows->count; r++) {
            column[r] = conditions[r * size + k];
        }
        envelope_solve(&preconditioner->constraint.factor, column);
        for (int64_t r = 0; r < rows->count; r++) {
            for (int64_t i = 0; i < size && column[r] != 0.0; i++) {
                weight[i] -= column[r] * conditions[r * size + i];
            }
        }
    }
    ranks_gather(ranks, preconditioner->free_weight, (size_t)size * sizeof(double), first);
    ranks_gather(ranks, solved, (size_t)rows->count * sizeof(double), first);
    for (int64_t r = 0; r < rows->count; r++) {
        for (int64_t k = 0; k < size; k++) {
            preconditioner->held[r * size + k] = solved[k * rows->count + r];
        }
    }
done:
    free(conditions);
    free(solved);
    return status;
}

enum status preconditioner_set_mass(struct preconditioner *preconditioner, const struct solid_system *system,
                                    const double *stiffness, struct error *error)
{
    for (int64_t n = 0; n < preconditioner->node_count; n++) {
        preconditioner->stiffness[n] = stiffness[n];
        preconditioner->mass[n] =
            preconditioner->at_rest != NULL ? stiffness[n] / preconditioner->at_rest[n] : stiffness[n];
    }
    return preconditioner_restore(preconditioner, system, error);
}

enum status preconditioner_restore(struct preconditioner *preconditioner, const struct solid_system *system,
                                   struct error *error)
{
    enum status status;
    constraint_free(&preconditioner->constraint);
    bool within = preconditioner->factor.rows.row_count > 0;
    TRY(system_constrain_within(system, preconditioner->mass, within ? &preconditioner->factor : NULL,
                                within ? &preconditioner->factor_rows : NULL, &preconditioner->constraint,
                                error));
    if (preconditioner->size > 0) {
        weigh_coarse_space(preconditioner);
        TRY(weigh_conditions(preconditioner, error));
        preconditioner_invert(preconditioner, system);
    }
done:
    return status;
}

double preconditioner_sum_of_mass(const struct preconditioner *preconditioner)
{
    double sum = 0.0;
    for (int64_t n = 0; n < preconditioner->node_count; n++) {
        sum += preconditioner->mass[n];
    }
    return sum;
}

bool preconditioner_is_stale(const struct preconditioner *preconditioner)
{
    double change = preconditioner_sum_of_mass(preconditioner) / preconditioner->measured_mass;
    return preconditioner->size > 0 && (change > most_change || change < 1.0 / most_change);
}
