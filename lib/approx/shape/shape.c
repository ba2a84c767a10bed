#include "approx/shape/shape.h"

#include "approx/cells/face_edges.h"
#include "base/memory.h"

#include <string.h>

static const int64_t chunk_points = 512;

/* phi and, unless NULL, dphi of the points [first, last); the arrays begin with the first pair of these. */
static enum status tabulate(const struct mls *mls, struct mls_support support, const struct neighbours *lists,
                            const double *x, const char *what, int64_t first, int64_t last, double *phi,
                            double *dphi, struct error *error)
{
    FREED_BY(mls_work_free) struct mls_work work = {0};
    for (int64_t p = first; p < last; p++) {
        enum mls_verdict verdict;
        int64_t pair = lists->ptr[p], at = pair - lists->ptr[first];
        support.x = x + p * mls->dim;
        support.widen = lists->widen[p];
        support.side = lists->side != NULL ? lists->side[p] : -1;
        support.neighbours = lists->idx + pair;
        support.count = lists->ptr[p + 1] - pair;
        RETURN_IF_ERROR(mls_evaluate(mls, &support, &work, phi + at,
                                     dphi != NULL ? dphi + at * mls->dim : NULL, &verdict, error));
        if (verdict != MLS_GOOD) {
            return fail(
                error, STATUS_VERDICT, "%s: row %lld at %s: %s of %s on %lld nodes: widen the support", what,
                (long long)p, POINT_TEXT(mls->dim, support.x),
                verdict == MLS_TOO_FEW ? "too few neighbours" : "singular or ill-conditioned moment matrix",
                basis_names[mls->basis], (long long)support.count);
        }
    }
    return STATUS_OK;
}

enum status shape_table(const struct mls *mls, const double *nodes, struct supports supports,
                        const struct neighbours *neighbours, const double *x, const char *what, double *phi,
                        double *dphi, struct error *error)
{
    const struct mls_support support = {.nodes = nodes, .supports = supports};
    struct first_failure failure = {STATUS_OK};
    int64_t count = neighbours->count;
#pragma omp parallel for schedule(dynamic, 1)
    for (int64_t first = 0; first < count; first += chunk_points) {
        struct error own;
        int64_t last = first + chunk_points < count ? first + chunk_points : count;
        int64_t pair = neighbours->ptr[first];
        note_failure(&failure, first,
                     tabulate(mls, support, neighbours, x, what, first, last, phi + pair,
                              dphi != NULL ? dphi + pair * mls->dim : NULL, &own),
                     &own, error);
    }
    return failure.status;
}

void shape_rows_free(struct shape_rows *rows)
{
    FREE_ALL(rows->ptr, rows->idx, rows->phi);
    *rows = (struct shape_rows){0};
}

/* Merge the lists of `count` points from `first` on, ascending, into idx, and the means of their values into
 * mean; or, where idx is NULL, count only. Returns the length. */
static int64_t merge_points(const struct neighbours *points, const double *phi, int64_t first, int count,
                            int32_t *idx, double *mean)
{
    const int64_t *ptr = points->ptr + first;
    int64_t at[FACE_POINTS(3)], length = 0;
    memcpy(at, ptr, (size_t)count * sizeof *at);
    for (;; length++) {
        int32_t node = INT32_MAX;
        double sum = 0.0;
        for (int g = 0; g < count; g++) {
            node = at[g] < ptr[g + 1] && points->idx[at[g]] < node ? points->idx[at[g]] : node;
        }
        if (node == INT32_MAX) {
            return length;
        }
        for (int g = 0; g < count; g++) {
            if (at[g] < ptr[g + 1] && points->idx[at[g]] == node) {
                sum += phi[at[g]] / count;
                at[g]++;
            }
        }
        if (idx != NULL) {
            idx[length] = node;
            mean[length] = sum;
        }
    }
}

enum status shape_on_edges(const struct neighbours *points, const double *phi, const struct faces *faces,
                           struct shape_rows *rows, struct error *error)
{
    int64_t row_count = face_row_count(faces);
    RETURN_IF_ERROR(NEW_ARRAY(&rows->ptr, row_count + 1, error));
#pragma omp parallel for schedule(static)
    for (int64_t r = 0; r < row_count; r++) {
        int count;
        int64_t first = face_row_points(faces, r, &count);
        rows->ptr[r + 1] = merge_points(points, phi, first, count, NULL, NULL);
    }
    for (int64_t r = 0; r < row_count; r++) {
        rows->ptr[r + 1] += rows->ptr[r];
    }
    RETURN_IF_ERROR(NEW_ARRAY(&rows->idx, rows->ptr[row_count], error));
    RETURN_IF_ERROR(NEW_ARRAY(&rows->phi, rows->ptr[row_count], error));
#pragma omp parallel for schedule(static)
    for (int64_t r = 0; r < row_count; r++) {
        int count;
        int64_t first = face_row_points(faces, r, &count);
        (void)merge_points(points, phi, first, count, rows->idx + rows->ptr[r], rows->phi + rows->ptr[r]);
    }
    return STATUS_OK;
}
