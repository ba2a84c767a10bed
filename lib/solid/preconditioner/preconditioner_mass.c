/* The diagonal mass, and the matrices of the mass and of the conditions on the coarse fields. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/sparse.h"

#include <stdlib.h>
#include <string.h>

enum { NODES_FOR_THREAD = 1000 };      /* see chunks_of */
static const double most_change = 1.5; /* of the mass, before the coarse fields are measured again */

/* rows[count * dim]: for each field k what L^-1 D L^-T makes of field `first` + a along it, in direction a.
 * The fields stand for the directions of moves, field[node_count * dim] and force, as many. */
static void weigh_fields(const struct preconditioner *p, int64_t first, double *field, double *force,
                         double *rows)
{
    int64_t dim = p->dim, count = p->coarse.count;
    memset(field, 0, (size_t)(p->node_count * dim) * sizeof *field);
    memset(rows, 0, (size_t)(count * dim) * sizeof *rows);
    for (int64_t a = 0; a < dim && first + a < count; a++) {
        rows[(first + a) * dim + a] = 1.0;
    }
    coarse_space_prolongate(&p->coarse, rows, field);
    preconditioner_unsmooth(p, field, force);
    coarse_space_restrict(&p->coarse, force, rows);
}

/* weight = Z^T B^-1 Z, `dim` fields at a time, each process and each thread some of these. */
static enum status weigh_inverse_fields(struct preconditioner *p, struct error *error)
{
    const struct ranks *ranks = p->factor.ranks;
    int64_t dim = p->dim, count = p->coarse.count, values = p->node_count * dim;
    int64_t times = (count + dim - 1) / dim;
    SCRATCH int64_t *firsts = NULL;
    SCRATCH double *rows = NULL, *vectors = NULL;
    RETURN_IF_ERROR(ranks_share(ranks, times, NULL, &firsts, error));
    RETURN_IF_ERROR(NEW_ARRAY(&rows, times * count * dim, error));
    const int64_t *first = firsts + ranks_rank(ranks);
    struct chunks chunks = chunks_for_threads(first[1] - first[0], values, NODES_FOR_THREAD);
    RETURN_IF_ERROR(NEW_ARRAY(&vectors, 2 * chunks.count * values, error));
#pragma omp parallel for schedule(static, 1) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        double *own = vectors + 2 * c * values;
        for (int64_t t = first[0] + chunks_begin(&chunks, c); t < first[0] + chunks_begin(&chunks, c + 1);
             t++) {
            weigh_fields(p, t * dim, own, own + values, rows + t * count * dim);
        }
    }
    ranks_gather(ranks, rows, (size_t)(count * dim) * sizeof *rows, firsts);
    for (int64_t i = 0; i < count; i++) {
        for (int64_t k = 0; k <= i; k++) {
            double weight = rows[(i / dim * count + k) * dim + i % dim];
            for (int64_t a = 0; a < dim; a++) {
                p->weight[(i * dim + a) * p->size + k * dim + a] = weight;
                p->weight[(k * dim + a) * p->size + i * dim + a] = weight;
            }
        }
    }
    return STATUS_OK;
}

/* weight = Z^T B^-1 Z: directions do not couple. */
static enum status weigh_coarse_space(struct preconditioner *p, struct error *error)
{
    int64_t dim = p->dim, size = p->size;
    double *weight = p->weight, value[COARSE_MOST_AT_NODE];
    int field[COARSE_MOST_AT_NODE];
    memset(weight, 0, (size_t)(size * size) * sizeof *weight);
    if (p->factor.rows.row_count > 0) {
        return weigh_inverse_fields(p, error);
    }
    for (int64_t n = 0; n < p->node_count; n++) {
        int count = coarse_space_at_node(&p->coarse, n, field, value);
        for (int i = 0; i < count; i++) {
            for (int k = 0; k < count; k++) {
                weight[field[i] * dim * size + field[k] * dim] += p->mass[n] * value[i] * value[k];
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
    return STATUS_OK;
}

void preconditioner_add_fields(const struct preconditioner *p, const struct average *average, double *field)
{
    int number[COARSE_MOST_AT_NODE];
    double value[COARSE_MOST_AT_NODE];
    for (int64_t i = 0; i < average->length; i++) {
        int count = coarse_space_at_node(&p->coarse, average->idx[i], number, value);
        for (int k = 0; k < count; k++) {
            field[number[k]] += average->phi[i] * value[k];
        }
    }
}

/* The coarse fields' means in the rows of the conditions, but for the rows' directions, as a sparse matrix.
 */
static enum status take_conditions(const struct preconditioner *p, struct sparse *conditions,
                                   struct error *error)
{
    const struct constraint_rows *rows = p->constraint.rows;
    int64_t count = p->coarse.count, most = 0;
    double *field = p->amount;
    for (int64_t r = 0; r < rows->count; r++) {
        int64_t entries = COARSE_MOST_AT_NODE * constraint_rows_average(rows, r).length;
        most += entries < count ? entries : count;
    }
    RETURN_IF_ERROR(sparse_new(rows->count, count, most, conditions, error));
    for (int64_t r = 0, at = 0; r < rows->count; r++) {
        struct average average = constraint_rows_average(rows, r);
        memset(field, 0, (size_t)count * sizeof *field);
        preconditioner_add_fields(p, &average, field);
        for (int64_t k = 0; k < count; k++) {
            if (field[k] != 0.0) {
                conditions->idx[at] = (int32_t)k;
                conditions->value[at++] = field[k];
            }
        }
        conditions->ptr[r + 1] = at;
    }
    return STATUS_OK;
}

/* free_weight = Z^T B^-1 P Z = Z^T B^-1 Z - (G Z)^T (G B G^T)^-1 G Z: without what the conditions forbid.
 * Each process computes some columns. */
static enum status weigh_conditions(struct preconditioner *p, struct error *error)
{
    const struct ranks *ranks = p->factor.ranks;
    const struct constraint_rows *rows = p->constraint.rows;
    const int64_t *first = p->column_first;
    int64_t size = p->size, dim = p->dim;
    FREED_BY(sparse_free) struct sparse conditions = {0};
    RETURN_IF_ERROR(take_conditions(p, &conditions, error));
    memcpy(p->free_weight, p->weight, (size_t)(size * size) * sizeof *p->weight);
    memset(p->held, 0, (size_t)(size * rows->count) * sizeof *p->held);
    for (int64_t r = 0; r < rows->count; r++) {
        for (int64_t i = conditions.ptr[r] * dim; i < conditions.ptr[r + 1] * dim; i++) {
            p->held[(conditions.idx[i / dim] * dim + i % dim) * rows->count + r] =
                conditions.value[i / dim] * rows->direction[r * dim + i % dim];
        }
    }
    for (int64_t k = first[ranks_rank(ranks)]; k < first[ranks_rank(ranks) + 1]; k++) {
        double *weight = p->free_weight + k * size; /* or row: symmetric */
        double *column = p->held + k * rows->count;
        envelope_solve(&p->constraint.factor, column);
        for (int64_t r = 0; r < rows->count; r++) {
            for (int64_t i = conditions.ptr[r] * dim; i < conditions.ptr[r + 1] * dim; i++) {
                weight[conditions.idx[i / dim] * dim + i % dim] -=
                    column[r] * (conditions.value[i / dim] * rows->direction[r * dim + i % dim]);
            }
        }
    }
    ranks_gather(ranks, p->free_weight, (size_t)size * sizeof(double), first);
    ranks_gather(ranks, p->held, (size_t)rows->count * sizeof(double), first);
    return STATUS_OK;
}

enum status preconditioner_set_mass(struct preconditioner *p, const struct solid_system *system,
                                    const double *stiffness, struct error *error)
{
    for (int64_t n = 0; n < p->node_count; n++) {
        p->stiffness[n] = stiffness[n];
        p->mass[n] = p->at_rest != NULL ? stiffness[n] / p->at_rest[n] : stiffness[n];
    }
    return preconditioner_restore(p, system, error);
}

enum status preconditioner_restore(struct preconditioner *p, const struct solid_system *system,
                                   struct error *error)
{
    constraint_free(&p->constraint);
    bool within = p->factor.rows.row_count > 0;
    RETURN_IF_ERROR(system_constrain(system, p->mass, within ? &p->factor : NULL,
                                     within ? &p->factor_rows : NULL, &p->constraint, error));
    if (p->size > 0) {
        RETURN_IF_ERROR(weigh_coarse_space(p, error));
        RETURN_IF_ERROR(weigh_conditions(p, error));
        preconditioner_factorise_both(p, system);
    }
    return STATUS_OK;
}

double preconditioner_sum_of_mass(const struct preconditioner *p)
{
    double sum = 0.0;
    for (int64_t n = 0; n < p->node_count; n++) {
        sum += p->mass[n];
    }
    return sum;
}

bool preconditioner_is_stale(const struct preconditioner *p)
{
    double change = preconditioner_sum_of_mass(p) / p->measured_mass;
    return p->size > 0 && (change > most_change || change < 1.0 / most_change);
}
