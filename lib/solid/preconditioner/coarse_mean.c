/* Means of the coarse fields, and what conditions see of the fields. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/memory.h"
#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

enum status coarse_mean_begin(const struct coarse_space *coarse, struct coarse_mean *mean,
                              struct error *error)
{
    *mean = (struct coarse_mean){0};
    RETURN_IF_ERROR(NEW_ARRAY(&mean->centre, coarse->centre_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&mean->seen, coarse->centre_count, error));
    return NEW_ARRAY(&mean->field, coarse->count, error);
}

void coarse_mean_free(struct coarse_mean *mean)
{
    FREE_ALL(mean->centre, mean->seen, mean->field);
    *mean = (struct coarse_mean){0};
}

void coarse_mean_clear(const struct coarse_space *coarse, struct coarse_mean *mean)
{
    int fields = coarse->dim + 1;
    for (int64_t i = 0; i < mean->count; i++) {
        mean->seen[mean->centre[i]] = false;
        memset(mean->field + (int64_t)mean->centre[i] * fields, 0, (size_t)fields * sizeof *mean->field);
    }
    mean->count = 0;
}

void coarse_mean_add(const struct coarse_space *coarse, int64_t field, double value, struct coarse_mean *mean)
{
    int64_t centre = field / (coarse->dim + 1);
    if (!mean->seen[centre]) {
        mean->seen[centre] = true;
        mean->centre[mean->count++] = (int32_t)centre;
    }
    mean->field[field] += value;
}

void coarse_mean_of_average(const struct coarse_space *coarse, const struct average *average,
                            const bool *held, struct coarse_mean *mean)
{
    const struct sparse *shares = &coarse->shares;
    double value[4];
    coarse_mean_clear(coarse, mean);
    for (int64_t i = 0; i < average->length; i++) {
        int32_t node = average->idx[i];
        int64_t end = held != NULL && held[node] ? shares->ptr[node] : shares->ptr[node + 1];
        for (int64_t k = shares->ptr[node]; k < end; k++) {
            int64_t field = (int64_t)shares->idx[k] * (coarse->dim + 1);
            coarse_space_values(coarse, node, shares->idx[k], shares->value[k], value);
            for (int m = 0; m <= coarse->dim; m++) {
                coarse_mean_add(coarse, field + m, average->phi[i] * value[m], mean);
            }
        }
    }
}

enum status coarse_mean_table(const struct coarse_space *coarse, int64_t count,
                              struct average (*average)(const void *context, int64_t i), const void *context,
                              const bool *held, struct coarse_mean *mean, struct sparse *table,
                              struct error *error)
{
    int fields = coarse->dim + 1;
    int64_t entries = 0, at = 0;
    for (int way = 0; way < 2; way++) { /* first only their number */
        for (int64_t r = 0; r < count; r++) {
            struct average of = average(context, r);
            coarse_mean_of_average(coarse, &of, held, mean);
            entries += way == 0 ? mean->count * fields : 0;
            for (int64_t i = 0; i < mean->count * fields && way == 1; i++, at++) {
                table->idx[at] = mean->centre[i / fields] * fields + (int32_t)(i % fields);
                table->value[at] = mean->field[table->idx[at]];
            }
            if (way == 1) {
                table->ptr[r + 1] = at;
            }
        }
        if (way == 0) {
            RETURN_IF_ERROR(sparse_new(count, coarse->count, entries, table, error));
        }
    }
    return STATUS_OK;
}

static struct average list_at(const void *rows, int64_t list)
{
    const struct constraint_rows *of = rows;
    return constraint_rows_average(of, of->first[list]);
}

enum status preconditioner_build_coarse_constraints(const struct solid_system *system,
                                                    struct preconditioner *p, struct error *error)
{
    const struct constraint_rows *rows = &system->rows;
    RETURN_IF_ERROR(coarse_mean_table(&p->coarse, rows->list_count, list_at, rows, NULL, &p->mean,
                                      &p->conditions, error));
    return sparse_transpose(&p->conditions, &p->of_field, error);
}

bool preconditioner_constrain_field(const struct preconditioner *p, int64_t k, double *column)
{
    const struct constraint_rows *rows = p->constraint.rows;
    const struct sparse *lists = &p->of_field;
    int64_t field = k / p->dim, a = k % p->dim;
    if (lists->ptr[field] == lists->ptr[field + 1]) {
        return false;
    }
    memset(column, 0, (size_t)rows->count * sizeof *column);
    for (int64_t i = lists->ptr[field]; i < lists->ptr[field + 1]; i++) {
        for (int64_t r = rows->first[lists->idx[i]]; r < rows->first[lists->idx[i] + 1]; r++) {
            column[r] = lists->value[i] * rows->direction[r * p->dim + a];
        }
    }
    envelope_solve(&p->constraint.factor, column);
    return true;
}
