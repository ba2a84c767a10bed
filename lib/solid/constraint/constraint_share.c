/* Forces of linearly dependent conditions. */
#include "base/dense.h"
#include "base/memory.h"
#include "solid/constraint/constraint.h"

#include <string.h>

/* null[count * dropped]: for each dropped row the linear combination of rows that is zero. */
static enum status null_rows(const struct constraint *constraint, double *null, struct error *error)
{
    const struct constraint_rows *rows = constraint->rows;
    int64_t size = constraint->node_count * rows->dim;
    NEW_SCRATCH(int64_t, dropped, constraint->factor.dropped, error);
    NEW_SCRATCH(double, unit, rows->count, error);
    NEW_SCRATCH(double, u, size, error);
    envelope_dropped(&constraint->factor, dropped);
    for (int64_t d = 0; d < constraint->factor.dropped; d++) {
        double *combination = null + d * rows->count;
        memset(u, 0, (size_t)size * sizeof *u);
        unit[dropped[d]] = 1.0;
        constraint_spread(constraint, unit, u);
        unit[dropped[d]] = 0.0;
        constraint_rows_take(rows, 0, rows->list_count, u, combination);
        envelope_solve(&constraint->factor, combination);
        combination[dropped[d]] -= 1.0;
    }
    return STATUS_OK;
}

/* scale[count] = the diagonal of G M^-1 G^T */
static void diagonal(const struct constraint *constraint, double *scale)
{
    const struct constraint_rows *rows = constraint->rows;
    for (int64_t r = 0; r < rows->count; r++) {
        struct average average = constraint_rows_average(rows, r);
        scale[r] = 0.0;
        for (int64_t i = 0; i < average.length; i++) {
            double mass = constraint->mass != NULL ? constraint->mass[average.idx[i]] : 1.0;
            scale[r] += average.phi[i] * average.phi[i] / mass;
        }
    }
}

enum status constraint_share_out(const struct constraint *constraint, double *force, struct error *error)
{
    int64_t dropped = constraint->factor.dropped, count = dropped > 0 ? constraint->rows->count : 0;
    if (dropped == 0) {
        return STATUS_OK;
    }
    NEW_SCRATCH(double, null, count * dropped, error);
    NEW_SCRATCH(double, scale, count, error);
    RETURN_IF_ERROR(null_rows(constraint, null, error));
    diagonal(constraint, scale);
    NEW_SCRATCH(double, gram, dropped * dropped, error);
    NEW_SCRATCH(double, amount, dropped, error);
    for (int64_t i = 0; i < dropped; i++) {
        for (int64_t r = 0; r < count; r++) {
            double part = scale[r] * null[i * count + r];
            amount[i] += part * force[r];
            for (int64_t k = 0; k <= i && fpclassify(part) != FP_ZERO; k++) {
                gram[i * dropped + k] += part * null[k * count + r];
            }
        }
    }
    /* Each combination has a row of its own: positive definite. */
    if (!dense_factorise(dropped, gram)) {
        return fail(error, STATUS_VERDICT, "constraints: the shares of dependent conditions are singular");
    }
    dense_solve(dropped, gram, amount);
    for (int64_t i = 0; i < dropped; i++) {
        for (int64_t r = 0; r < count; r++) {
            force[r] -= amount[i] * null[i * count + r];
        }
    }
    return STATUS_OK;
}
