#include "approx/shape/shape.h"

#include "approx/cells/quadrature.h"
#include "base/lists.h"
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
    int64_t room;
    double *offset;
};

/* Set support->image if some of the neighbours [first, last) of the lists, those of the next point, are seen
 * around corners. */
static enum status find_images(int dim, const struct neighbours *lists, int64_t first, int64_t last,
                               struct images *images, struct mls_support *support, struct error *error)
{
    const struct around *around = &lists->around;
    if (images->next == around->count || around->pair[images->next] >= last) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(GROW_ARRAY(&images->offset, (last - first) * dim, &images->room, error));
    for (int64_t i = 0; i < (last - first) * dim; i++) {
        images->offset[i] =
            support->nodes[(int64_t)lists->idx[first + i / dim] * dim + i % dim] - support->x[i % dim];
    }
    for (; images->next < around->count && around->pair[images->next] < last; images->next++) {
        memcpy(images->offset + (around->pair[images->next] - first) * dim,
               around->offset + images->next * dim, (size_t)dim * sizeof *images->offset);
    }
    support->image = images->offset;
    return STATUS_OK;
}

/* The input of a table, and its points. */
struct tabulation {
    const struct mls *mls;
    const double *nodes, *radius;
    const struct neighbours *lists;
    const double *x;
    const char *what;
};

/* phi and, unless NULL, dphi of the points [first, last); the arrays begin with the first pair of these. */
static enum status tabulate(const struct tabulation *table, int64_t first, int64_t last, double *phi,
                            double *dphi, struct error *error)
{
    enum status status = STATUS_OK;
    const struct neighbours *lists = table->lists;
    struct mls_work work = {0};
    const struct around *around = &lists->around; /* neighbours that are seen around corners */
    struct images images = {.next = first_from(around->pair, 0, around->count, lists->ptr[first])};
    int dim = table->mls->dim;
    for (int64_t p = first; p < last; p++) {
        enum mls_verdict verdict;
        int64_t pair = lists->ptr[p], at = pair - lists->ptr[first];
        struct mls_support support = {.x = table->x + p * dim,
                                      .nodes = table->nodes,
                                      .radius = table->radius,
                                      .widen = lists->widen[p],
                                      .neighbours = lists->idx + pair,
                                      .count = lists->ptr[p + 1] - pair};
        TRY(find_images(dim, lists, pair, lists->ptr[p + 1], &images, &support, error));
        TRY(mls_evaluate(table->mls, &support, &work, phi + at, dphi != NULL ? dphi + at * dim : NULL,
                         &verdict, error));
        if (verdict != MLS_GOOD) {
            char place[96];
            point_text(dim, support.x, place);
            status =
                fail(error, STATUS_VERDICT, "%s: row %lld at %s: %s of %s on %lld nodes: widen the support",
                     table->what, (long long)p, place, mls_verdict_text(verdict),
                     basis_names[table->mls->basis], (long long)support.count);
            goto done;
        }
    }
done:
    mls_work_free(&work);
    free(images.offset);
    return status;
}

/* The failure of the first chunk that failed, for any number of threads. */
struct failure {
    int64_t chunk;
    enum status status;
};

static void note_failure(struct failure *first, int64_t chunk, enum status status, const struct error *own,
                         struct error *error)
{
#pragma omp critical(shape_failure)
    if (status != STATUS_OK && (first->status == STATUS_OK || chunk < first->chunk)) {
        *first = (struct failure){chunk, status};
        *error = *own;
    }
}

enum status shape_table(const struct mls *mls, const double *nodes, const double *radius,
                        const struct neighbours *neighbours, const double *x, const char *what, double *phi,
                        double *dphi, struct error *error)
{
    const struct tabulation table = {mls, nodes, radius, neighbours, x, what};
    struct failure failure = {0, STATUS_OK};
    int64_t count = neighbours->count;
#pragma omp parallel for schedule(dynamic, 1)
    for (int64_t first = 0; first < count; first += chunk_points) {
        struct error own;
        int64_t last = first + chunk_points < count ? first + chunk_points : count;
        int64_t pair = neighbours->ptr[first];
        note_failure(
            &failure, first,
            tabulate(&table, first, last, phi + pair, dphi != NULL ? dphi + pair * mls->dim : NULL, &own),
            &own, error);
    }
    return failure.status;
}

/* The points of a row of averages: the first one in the lists, and the weights of their values. */
struct row_points {
    int64_t first;
    int count;
    double weight[OWN_POINTS(3)];
};

static struct row_points points_of_row(const struct faces *faces, int64_t r)
{
    const struct quadrature_rule rule = quadrature_face_rule(faces->dim);
    struct row_points row = {.first = face_row_point(faces, r), .count = 1, .weight = {1.0}};
    if (r < faces->own_count) {
        row.count = rule.points;
        memcpy(row.weight, rule.weight, (size_t)rule.points * sizeof *rule.weight);
    }
    return row;
}

/* Merge the ascending lists of the points of row r into idx, and the weighted values phi of their pairs into
 * mean; if idx is NULL, only count. Returns the length. */
static int64_t merge_row(const struct neighbours *lists, const struct faces *faces, int64_t r,
                         const double *phi, int32_t *idx, double *mean)
{
    const struct row_points row = points_of_row(faces, r);
    int64_t first = lists->ptr[row.first], at[OWN_POINTS(3)], count = 0;
    const int64_t *end = lists->ptr + row.first + 1;
    for (int g = 0; g < row.count; g++) {
        at[g] = lists->ptr[row.first + g];
    }
    for (;; count++) {
        int32_t node = INT32_MAX;
        double sum = 0.0;
        for (int g = 0; g < row.count; g++) {
            node = at[g] < end[g] && lists->idx[at[g]] < node ? lists->idx[at[g]] : node;
        }
        if (node == INT32_MAX) {
            return count;
        }
        for (int g = 0; g < row.count; g++) {
            if (at[g] < end[g] && lists->idx[at[g]] == node) {
                sum += idx != NULL ? row.weight[g] * phi[at[g] - first] : 0.0;
                at[g]++;
            }
        }
        if (idx != NULL) {
            idx[count] = node;
            mean[count] = sum;
        }
    }
}

/* Evaluate rows [first, last) into a scratch array, average them, and copy the values of boundary faces. */
static enum status average_rows(const struct tabulation *table, const struct faces *faces, int64_t first,
                                int64_t last, struct face_averages *averages, struct error *error)
{
    const int64_t *ptr = table->lists->ptr;
    int64_t point = face_row_point(faces, first), pair = ptr[point];
    SCRATCH double *phi = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&phi, ptr[face_row_point(faces, last)] - pair, error));
    RETURN_IF_ERROR(tabulate(table, point, face_row_point(faces, last), phi, NULL, error));
    for (int64_t r = first; r < last; r++) {
        int64_t at = averages->ptr[r];
        (void)merge_row(table->lists, faces, r, phi + (ptr[face_row_point(faces, r)] - pair),
                        averages->idx + at, averages->phi + at);
    }
    int64_t end = last < faces->boundary_count ? last : faces->boundary_count;
    if (first < end) {
        memcpy(averages->boundary_phi + pair, phi,
               (size_t)(ptr[face_row_point(faces, end)] - pair) * sizeof *phi);
    }
    return STATUS_OK;
}

enum status shape_average_faces(const struct mls *mls, const double *nodes, const double *radius,
                                const struct neighbours *neighbours, const double *x, const char *what,
                                const struct faces *faces, struct face_averages *averages,
                                struct error *error)
{
    const struct tabulation table = {mls, nodes, radius, neighbours, x, what};
    const int64_t chunk = chunk_points / OWN_POINTS(faces->dim), count = faces->row_count;
    struct failure failure = {0, STATUS_OK};
    *averages = (struct face_averages){.count = count};
    RETURN_IF_ERROR(NEW_ARRAY(&averages->ptr, count + 1, error));
#pragma omp parallel for schedule(static)
    for (int64_t r = 0; r < count; r++) {
        averages->ptr[r + 1] = merge_row(neighbours, faces, r, NULL, NULL, NULL);
    }
    for (int64_t r = 0; r < count; r++) {
        averages->ptr[r + 1] += averages->ptr[r];
    }
    RETURN_IF_ERROR(NEW_ARRAY(&averages->idx, averages->ptr[count], error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->phi, averages->ptr[count], error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->boundary_phi,
                              neighbours->ptr[face_row_point(faces, faces->boundary_count)], error));
#pragma omp parallel for schedule(dynamic, 1)
    for (int64_t first = 0; first < count; first += chunk) {
        struct error own;
        int64_t last = first + chunk < count ? first + chunk : count;
        note_failure(&failure, first, average_rows(&table, faces, first, last, averages, &own), &own, error);
    }
    return failure.status;
}

void face_averages_free(struct face_averages *averages)
{
    FREE_ALL(averages->ptr, averages->idx, averages->phi, averages->boundary_phi);
    *averages = (struct face_averages){0};
}
