/* The diagonal mass, and the matrices of the mass and of the conditions on the coarse fields. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/processor.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { NODES_FOR_THREAD = 1000 }; /* see chunks_of */
enum { FIELDS_AT_ONCE = 8 };
static const double most_change = 1.5; /* of the mass, before the coarse fields are measured again */

/* vector[node_count * FIELDS_AT_ONCE] = the fields from `first` on. */
static void take_fields(const struct coarse_space *coarse, int64_t first, double *vector)
{
    int fields = coarse->dim + 1;
    double value[4];
    memset(vector, 0, (size_t)(coarse->node_count * FIELDS_AT_ONCE) * sizeof *vector);
    for (int64_t c = first / fields; c < coarse->centre_count && c * fields < first + FIELDS_AT_ONCE; c++) {
        for (int64_t i = coarse->of_centre.ptr[c]; i < coarse->of_centre.ptr[c + 1]; i++) {
            int32_t node = coarse->of_centre.idx[i];
            coarse_space_values(coarse, node, c, coarse->of_centre.value[i], value);
            for (int64_t m = 0; m < fields; m++) {
                int64_t at = c * fields + m - first;
                if (at >= 0 && at < FIELDS_AT_ONCE) {
                    vector[(int64_t)node * FIELDS_AT_ONCE + at] = value[m];
                }
            }
        }
    }
}

/* rows[count * FIELDS_AT_ONCE] = Z^T vector, of the centres up to that of field `last`. */
ALL_SETS static void see_fields(const struct coarse_space *coarse, int64_t last, const double *vector,
                                double *rows)
{
    int fields = coarse->dim + 1;
    double value[4];
    for (int64_t c = 0; c < coarse->centre_count && c * fields <= last; c++) {
        double sum[4][FIELDS_AT_ONCE] = {{0.0}};
        for (int64_t i = coarse->of_centre.ptr[c]; i < coarse->of_centre.ptr[c + 1]; i++) {
            int32_t node = coarse->of_centre.idx[i];
            const double *at = vector + (int64_t)node * FIELDS_AT_ONCE;
            coarse_space_values(coarse, node, c, coarse->of_centre.value[i], value);
            for (int m = 0; m < fields; m++) {
                for (int k = 0; k < FIELDS_AT_ONCE; k++) {
                    sum[m][k] += value[m] * at[k];
                }
            }
        }
        memcpy(rows + c * fields * FIELDS_AT_ONCE, sum, (size_t)(fields * FIELDS_AT_ONCE) * sizeof *rows);
    }
}

/* rows = Z^T L^-1 D L^-T times some fields from `first` on. */
static void weigh_fields(const struct preconditioner *p, int64_t first, double *vector, double *rows)
{
    take_fields(&p->coarse, first, vector);
    inverse_factor_solve_transposed(&p->factor, FIELDS_AT_ONCE, vector);
    for (int64_t n = 0; n < p->node_count; n++) {
        for (int64_t i = n * FIELDS_AT_ONCE; i < (n + 1) * FIELDS_AT_ONCE; i++) {
            vector[i] *= p->mass[n];
        }
    }
    inverse_factor_solve(&p->factor, FIELDS_AT_ONCE, vector);
    see_fields(&p->coarse, first + FIELDS_AT_ONCE - 1, vector, rows);
}

/* weight = Z^T B^-1 Z, some fields at a time, each process and each thread some of these. */
static enum status weigh_inverse_fields(struct preconditioner *p, struct error *error)
{
    const struct ranks *ranks = p->factor.ranks;
    int64_t count = p->coarse.count, values = p->node_count * FIELDS_AT_ONCE;
    int64_t times = (count + FIELDS_AT_ONCE - 1) / FIELDS_AT_ONCE;
    SCRATCH int64_t *firsts = NULL;
    SCRATCH double *vectors = NULL;
    RETURN_IF_ERROR(ranks_share(ranks, times, NULL, &firsts, error));
    NEW_SCRATCH(double, rows, times * count * FIELDS_AT_ONCE, error);
    const int64_t *first = firsts + ranks_rank(ranks);
    struct chunks chunks = chunks_for_threads(first[1] - first[0], values, NODES_FOR_THREAD);
    RETURN_IF_ERROR(NEW_ARRAY_UNTOUCHED(&vectors, chunks.threads * values, error));
#pragma omp parallel for schedule(dynamic, 1) num_threads(chunks.threads)
    for (int64_t t = first[0]; t < first[1]; t++) {
        weigh_fields(p, t * FIELDS_AT_ONCE, vectors + omp_get_thread_num() * values,
                     rows + t * count * FIELDS_AT_ONCE);
    }
    ranks_gather(ranks, rows, (size_t)(count * FIELDS_AT_ONCE) * sizeof *rows, firsts);
    for (int64_t i = 0; i < count; i++) {
        for (int64_t k = 0; k <= i; k++) {
            double weight = rows[(i / FIELDS_AT_ONCE * count + k) * FIELDS_AT_ONCE + i % FIELDS_AT_ONCE];
            p->weight[i * count + k] = p->weight[k * count + i] = weight;
        }
    }
    return STATUS_OK;
}

/* weight = Z^T B^-1 Z */
static enum status weigh_coarse_space(struct preconditioner *p, struct error *error)
{
    const struct coarse_space *coarse = &p->coarse;
    const struct sparse *shares = &coarse->shares;
    int64_t fields = p->dim + 1;
    double one[4], other[4];
    if (p->factor.rows.row_count > 0) {
        return weigh_inverse_fields(p, error);
    }
    memset(p->weight, 0, (size_t)(coarse->count * coarse->count) * sizeof *p->weight);
    for (int64_t n = 0; n < p->node_count; n++) {
        for (int64_t i = shares->ptr[n]; i < shares->ptr[n + 1]; i++) {
            coarse_space_values(coarse, n, shares->idx[i], shares->value[i], one);
            for (int64_t k = shares->ptr[n]; k < shares->ptr[n + 1]; k++) {
                double *to = p->weight + shares->idx[i] * fields * coarse->count + shares->idx[k] * fields;
                coarse_space_values(coarse, n, shares->idx[k], shares->value[k], other);
                for (int64_t m = 0; m < fields * fields; m++) {
                    to[m / fields * coarse->count + m % fields] +=
                        p->mass[n] * one[m / fields] * other[m % fields];
                }
            }
        }
    }
    return STATUS_OK;
}

/* free_weight = Z^T B^-1 P Z = Z^T B^-1 Z - (G Z)^T (G B G^T)^-1 G Z: without what the conditions forbid.
 * Each process computes some columns. */
static enum status weigh_conditions(struct preconditioner *p, struct error *error)
{
    const struct ranks *ranks = p->factor.ranks;
    const int64_t *first = p->column_first;
    int64_t dim = p->dim;
    NEW_SCRATCH(double, column, p->constraint.rows->count, error);
    for (int64_t k = first[ranks_rank(ranks)]; k < first[ranks_rank(ranks) + 1]; k++) {
        double *weight = p->free_weight + k * p->size; /* or row: symmetric */
        memset(weight, 0, (size_t)p->size * sizeof *weight);
        for (int64_t i = 0; i < p->coarse.count; i++) {
            weight[i * dim + k % dim] = p->weight[k / dim * p->coarse.count + i];
        }
        if (preconditioner_constrain_field(p, k, column)) {
            preconditioner_subtract_constraint_forces(p, column, weight);
        }
    }
    ranks_gather(ranks, p->free_weight, (size_t)p->size * sizeof(double), first);
    return STATUS_OK;
}

enum status preconditioner_set_mass(struct preconditioner *p, const struct solid_system *system,
                                    const double *stiffness, struct error *error)
{
    for (int64_t n = 0; n < p->node_count; n++) {
        p->stiffness[n] = stiffness[n];
        p->mass[n] = p->at_rest != NULL ? stiffness[n] / p->at_rest[n] : stiffness[n];
    }
    preconditioner_drop_slow_modes(p);
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
    }
    if (p->size > 0 && p->measured_mass > 0.0) { /* else nothing is known of A yet */
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
