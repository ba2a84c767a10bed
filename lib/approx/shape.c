#include "approx/shape.h"

#include "approx/support.h"
#include "base/memory.h"

#include <stdlib.h>

static const int64_t chunk_points = 512;

static enum status chunk_of_table(const struct mls *mls, const double *nodes, const double *radius,
                                  const struct neighbours *lists, int64_t first, int64_t last,
                                  const double *x, const char *what, double *phi, double *dphi,
                                  struct error *error)
{
    enum status status = STATUS_OK;
    struct mls_work work = {0};
    int dim = mls->dim;
    for (int64_t p = first; p < last; p++) {
        enum mls_verdict verdict;
        int64_t at = lists->ptr[p];
        struct mls_support support = {.x = x + p * dim,
                                      .nodes = nodes,
                                      .radius = radius,
                                      .widen = lists->widen[p],
                                      .neighbours = lists->idx + at,
                                      .count = lists->ptr[p + 1] - at};
        TRY(mls_evaluate(mls, &support, &work, phi + at, dphi != NULL ? dphi + at * dim : NULL, &verdict,
                         error));
        if (verdict != MLS_GOOD) {
            char place[96];
            point_text(dim, support.x, place);
            status =
                fail(error, STATUS_VERDICT, "%s: row %lld at %s: %s of %s on %lld nodes: widen the support",
                     what, (long long)p, place, mls_verdict_text(verdict), basis_names[mls->basis],
                     (long long)support.count);
            goto done;
        }
    }
done:
    mls_work_free(&work);
    return status;
}

enum status shape_table(const struct mls *mls, const double *nodes, const double *radius,
                        const struct neighbours *neighbours, const double *x, const char *what, double *phi,
                        double *dphi, struct error *error)
{
    int64_t chunk_count = (neighbours->count + chunk_points - 1) / chunk_points;
    int64_t failed = chunk_count;
    enum status failure = STATUS_OK;
#pragma omp parallel for schedule(dynamic, 1)
    for (int64_t c = 0; c < chunk_count; c++) {
        struct error own;
        int64_t first = c * chunk_points;
        int64_t last = first + chunk_points < neighbours->count ? first + chunk_points : neighbours->count;
        enum status outcome =
            chunk_of_table(mls, nodes, radius, neighbours, first, last, x, what, phi, dphi, &own);
        if (outcome != STATUS_OK) {
#pragma omp critical(shape_failure)
            if (c < failed) {
                failed = c;
                failure = outcome;
                *error = own;
            }
        }
    }
    return failure;
}
