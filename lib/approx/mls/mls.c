#include "approx/mls/mls.h"

#include "approx/mls/mls_kernel.h"
#include "base/memory.h"

#include <stdlib.h>

const char *const basis_names[BASIS_COUNT] = {"mls1", "mls2", "mmls2"};
const char *const weight_names[WEIGHT_COUNT] = {"quartic", "regularised"};

struct mls mls_default(int dim)
{
    struct mls mls = {.dim = dim, .basis = BASIS_MODIFIED, .weight = WEIGHT_QUARTIC};
    for (int k = 0; k < MLS_MAX_SECOND; k++) {
        mls.mu[k] = MLS_DEFAULT_MU;
    }
    return mls;
}

int mls_second_order_count(int dim)
{
    return dim * (dim + 1) / 2;
}

int mls_basis_size(const struct mls *mls)
{
    return 1 + mls->dim + (mls->basis == BASIS_LINEAR ? 0 : mls_second_order_count(mls->dim));
}

const char *mls_verdict_text(enum mls_verdict verdict)
{
    switch (verdict) {
    case MLS_GOOD:
        return "good";
    case MLS_TOO_FEW:
        return "too few neighbours";
    case MLS_ILL_CONDITIONED:
        break;
    }
    return "singular or ill-conditioned moment matrix";
}

void mls_work_free(struct mls_work *work)
{
    free(work->values);
    *work = (struct mls_work){0};
}

/* Scratch for `count` neighbours, or NULL (memory). */
static double *work_reserve(struct mls_work *work, int64_t count)
{
    if (count > work->capacity) {
        int64_t capacity = (count + count / 2 + 16) / 8 * 8;
        double *values = array_new(capacity + MLS_PADDING, sizeof *values * MLS_ROWS);
        if (values == NULL) {
            return NULL;
        }
        free(work->values);
        work->values = values;
        work->capacity = capacity;
    }
    return work->values;
}

enum status mls_evaluate(const struct mls *mls, const struct mls_support *support, struct mls_work *work,
                         double *phi, double *dphi, enum mls_verdict *verdict, struct error *error)
{
    int m = mls_basis_size(mls);
    *verdict = MLS_TOO_FEW;
    if (support->count < (mls->basis == BASIS_QUADRATIC ? m : mls->dim + 1)) {
        return STATUS_OK;
    }
    double *scratch = work_reserve(work, support->count);
    if (scratch == NULL) {
        return fail_memory(error, "moving least squares");
    }
    int64_t stride = work->capacity + MLS_PADDING;
    *verdict = MLS_GOOD;
    if (!mls_kernel(mls, support, scratch, stride, phi, dphi)) {
        *verdict = mls_orthogonal(mls, support, scratch, stride, phi, dphi);
    }
    return STATUS_OK;
}
