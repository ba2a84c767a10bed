#include "approx/shape.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static const int64_t chunk_points = 512;

struct neighbours support_view(const struct support_lists *lists)
{
    return (struct neighbours){
        .count = lists->count,
        .ptr = lists->ptr,
        .idx = lists->idx,
        .widen = lists->widen,
        .around = {lists->around_count, lists->around_pair, lists->around_offset},
    };
}

/* Images of the neighbours of points: see mls_support. */
struct images {
    int64_t next; /* of struct around */
    int64_t capacity;
    double *offset;
};

/* Set support->image where neighbours [first, last) of the lists, those of the next point, are seen around
 * corners. */
static enum status find_images(int dim, const struct neighbours *lists, int64_t first, int64_t last,
                               struct images *images, struct mls_support *support, struct error *error)
{
    enum status status = STATUS_OK;
    const struct around *around = &lists->around;
    if (images->next == around->count || around->pair[images->next] >= last) {
        return STATUS_OK;
    }
    if (last - first > images->capacity) {
        free(images->offset);
        images->capacity = 0;
        TRY(NEW_ARRAY(&images->offset, 2 * (last - first) * dim, error));
        images->capacity = 2 * (last - first);
    }
    for (int64_t i = 0; i < (last - first) * dim; i++) {
        images->offset[i] =
            support->nodes[(int64_t)lists->idx[first + i / dim] * dim + i % dim] - support->x[i % dim];
    }
    for (; images->next < around->count && around->pair[images->next] < last; images->next++) {
        memcpy(images->offset + (around->pair[images->next] - first) * dim,
               around->offset + images->next * dim, (size_t)dim * sizeof *images->offset);
    }
    support->image = images->offset;
done:
    return status;
}

/* The first neighbour from `pair` on that is seen around a corner. */
static int64_t first_around(const struct around *around, int64_t pair)
{
    int64_t low = 0, high = around->count;
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (around->pair[middle] < pair) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static enum status chunk_of_table(const struct mls *mls, const double *nodes, const double *radius,
                                  const struct neighbours *lists, int64_t first, int64_t last,
                                  const double *x, const char *what, double *phi, double *dphi,
                                  struct error *error)
{
    enum status status = STATUS_OK;
    struct mls_work work = {0};
    struct images images = {.next = first_around(&lists->around, lists->ptr[first])};
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
        TRY(find_images(dim, lists, at, lists->ptr[p + 1], &images, &support, error));
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
    free(images.offset);
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
