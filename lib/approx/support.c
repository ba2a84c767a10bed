#include "approx/support.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double widen_step = 1.05;
static const double widen_limit = 8.0;
/* Points of one unit of work: fixed, so that the result cannot depend on the number of threads. */
static const int64_t chunk_points = 512;

struct support_options support_defaults(int dim)
{
    return (struct support_options){
        .factor = 1.8, .widen = true, .gradient_bound = 6.0, .mls = mls_default(dim)};
}

void point_text(int dim, const double *x, char text[96])
{
    if (dim == 2) {
        snprintf(text, 96, "(%.6g, %.6g)", x[0], x[1]);
    } else {
        snprintf(text, 96, "(%.6g, %.6g, %.6g)", x[0], x[1], x[2]);
    }
}

static double distance2_of(int dim, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < dim; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sum;
}

/* Mean of the `wanted` least distances, or -1 if there are fewer. */
static double mean_of_least(double *distance, int64_t count, int64_t wanted)
{
    double sum = 0.0;
    if (count < wanted) {
        return -1.0;
    }
    for (int64_t i = 0; i < wanted; i++) {
        int64_t least = i;
        for (int64_t k = i + 1; k < count; k++) {
            least = distance[k] < distance[least] ? k : least;
        }
        double swap = distance[i];
        distance[i] = distance[least];
        distance[least] = swap;
        sum += distance[i];
    }
    return sum / (double)wanted;
}

/* Mean distance to the nearest nodes of one node, asking for ever larger neighbourhoods. */
static enum status spacing_of(const struct point_grid *grid, int64_t node, struct index_list *list,
                              double *spacing, struct error *error)
{
    enum status status = STATUS_OK;
    int dim = grid->dim;
    double *distance = NULL;
    int64_t wanted = grid->node_count - 1 < 2 * dim ? grid->node_count - 1 : 2 * dim;
    *spacing = -1.0;
    for (double factor = 1.0; *spacing < 0.0; factor *= 2.0) {
        const double *x = grid->x + node * dim;
        list->count = 0;
        TRY(point_grid_query(grid, x, factor, list, error));
        free(distance);
        TRY(NEW_ARRAY(&distance, list->count, error));
        int64_t others = 0;
        for (int64_t i = 0; i < list->count; i++) {
            if (list->index[i] != node) {
                distance[others++] = sqrt(distance2_of(dim, x, grid->x + (int64_t)list->index[i] * dim));
            }
        }
        *spacing = mean_of_least(distance, others, wanted);
    }
done:
    free(distance);
    return status;
}

enum status nodes_spacing(int dim, int64_t node_count, const double *x, double *spacing, struct error *error)
{
    enum status status;
    struct point_grid grid = {0};
    struct index_list list = {0};
    double *radius = NULL;
    double low[3], high[3], extent = 0.0;
    for (int a = 0; a < dim; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (int64_t n = 0; n < node_count; n++) {
            low[a] = fmin(low[a], x[n * dim + a]);
            high[a] = fmax(high[a], x[n * dim + a]);
        }
        extent = fmax(extent, high[a] - low[a]);
    }
    if (node_count < 2 || !(extent > 0.0)) {
        return fail(error, STATUS_INPUT, "nodes.x: %lld nodes at one place have no spacing",
                    (long long)node_count);
    }
    /* A first guess of the neighbourhood's size, doubled where it holds too few. */
    TRY(NEW_ARRAY(&radius, node_count, error));
    for (int64_t n = 0; n < node_count; n++) {
        radius[n] = 2.0 * extent / pow((double)node_count, 1.0 / dim);
    }
    TRY(point_grid_build(&grid, dim, node_count, x, radius, error));
    for (int64_t n = 0; n < node_count; n++) {
        TRY(spacing_of(&grid, n, &list, &spacing[n], error));
    }
done:
    point_grid_free(&grid);
    free(list.index);
    free(radius);
    return status;
}

enum status support_radii(const struct support_options *options, int64_t node_count, const double *spacing,
                          double *radius, struct error *error)
{
    for (int64_t n = 0; n < node_count; n++) {
        radius[n] = options->radius > 0.0 ? options->radius : options->factor * spacing[n];
        if (!(radius[n] > 0.0) || !isfinite(radius[n])) {
            return fail(error, STATUS_INPUT,
                        "nodes.x: row %lld: the node has no spacing: it coincides with others", (long long)n);
        }
    }
    return STATUS_OK;
}

/* One thread's growing lists and scratch. */
struct worker {
    struct index_list list;
    struct mls_work work;
    double *phi, *dphi, *order;
    int64_t capacity;
};

static void worker_free(struct worker *worker)
{
    free(worker->list.index);
    free(worker->phi);
    free(worker->dphi);
    free(worker->order);
    mls_work_free(&worker->work);
}

static enum status worker_reserve(struct worker *worker, int dim, int64_t count, struct error *error)
{
    enum status status = STATUS_OK;
    if (count > worker->capacity) {
        int64_t capacity = count * 2 + 64;
        free(worker->phi);
        free(worker->dphi);
        free(worker->order);
        worker->phi = worker->dphi = worker->order = NULL;
        worker->capacity = 0;
        TRY(NEW_ARRAY(&worker->phi, capacity, error));
        TRY(NEW_ARRAY(&worker->dphi, capacity * dim, error));
        TRY(NEW_ARRAY(&worker->order, capacity, error));
        worker->capacity = capacity;
    }
done:
    return status;
}

/* Keep the `most` nearest of the neighbours in index[count], ties going to the lower index. */
static int64_t keep_nearest(const struct point_grid *grid, const double *x, int64_t most, int32_t *index,
                            int64_t count, double *distance2)
{
    if (most <= 0 || count <= most) {
        return count;
    }
    for (int64_t i = 0; i < count; i++) {
        distance2[i] = distance2_of(grid->dim, x, grid->x + (int64_t)index[i] * grid->dim);
    }
    /* Drop the farthest (of equals the highest index) until `most` remain; the order stays ascending. */
    while (count > most) {
        int64_t farthest = 0;
        for (int64_t i = 1; i < count; i++) {
            farthest = distance2[i] >= distance2[farthest] ? i : farthest;
        }
        for (int64_t i = farthest; i + 1 < count; i++) {
            index[i] = index[i + 1];
            distance2[i] = distance2[i + 1];
        }
        count--;
    }
    return count;
}

/* Mean spacing of the nodes in a support: the edge of the cube (square) that each of them has to itself. A
 * list cut to the nearest reaches only as far as its farthest node. */
static double spacing_within(const struct support_options *options, const struct point_grid *grid,
                             const double *x, const int32_t *index, int64_t count, double widen)
{
    double largest = 0.0, farthest2 = 0.0;
    for (int64_t i = 0; i < count; i++) {
        largest = fmax(largest, grid->radius[index[i]]);
        farthest2 = fmax(farthest2, distance2_of(grid->dim, x, grid->x + (int64_t)index[i] * grid->dim));
    }
    double reach = count == options->most ? sqrt(farthest2) : largest * widen;
    double unit_ball = grid->dim == 2 ? 3.141592653589793 : 4.1887902047863905;
    return reach * pow(unit_ball / (double)count, 1.0 / grid->dim);
}

/* Whether a support serves: enough nodes, a good moment matrix, bounded gradients. */
static enum status judge(const struct support_options *options, const struct point_grid *grid,
                         const double *x, double widen, const int32_t *index, int64_t count,
                         struct worker *worker, bool *serves, struct error *error)
{
    enum mls_verdict verdict;
    struct mls_support support = {.x = x,
                                  .nodes = grid->x,
                                  .radius = grid->radius,
                                  .widen = widen,
                                  .neighbours = index,
                                  .count = count};
    *serves = false;
    if (count < options->least) {
        return STATUS_OK;
    }
    enum status status = worker_reserve(worker, grid->dim, count, error);
    if (status == STATUS_OK) {
        status =
            mls_evaluate(&options->mls, &support, &worker->work, worker->phi, worker->dphi, &verdict, error);
    }
    if (status != STATUS_OK || verdict != MLS_GOOD) {
        return status;
    }
    double largest2 = 0.0;
    for (int64_t i = 0; i < count; i++) {
        double sum = 0.0;
        for (int a = 0; a < grid->dim; a++) {
            sum += worker->dphi[i * grid->dim + a] * worker->dphi[i * grid->dim + a];
        }
        largest2 = fmax(largest2, sum);
    }
    *serves =
        sqrt(largest2) * spacing_within(options, grid, x, index, count, widen) <= options->gradient_bound;
    return STATUS_OK;
}

/* Append one point's neighbours to the worker's list. */
static enum status find_support(const struct support_options *options, const struct point_grid *grid,
                                const double *x, struct worker *worker, double *widen, bool *serves,
                                struct error *error)
{
    enum status status = STATUS_OK;
    int64_t first = worker->list.count;
    for (*widen = 1.0; *widen <= widen_limit; *widen *= widen_step) {
        worker->list.count = first;
        TRY(point_grid_query(grid, x, *widen, &worker->list, error));
        int64_t count = worker->list.count - first;
        int32_t *index = worker->list.index + first;
        TRY(worker_reserve(worker, grid->dim, count, error));
        count = keep_nearest(grid, x, options->most, index, count, worker->order);
        worker->list.count = first + count;
        *serves = true;
        if (options->widen) {
            TRY(judge(options, grid, x, *widen, index, count, worker, serves, error));
        }
        if (*serves) {
            return STATUS_OK;
        }
    }
done:
    return status;
}

/* The message for a point without a good support; a stray node shows by its radius. */
static enum status fail_support(const struct point_grid *grid, const char *what, int64_t row, const double *x,
                                const int32_t *index, int64_t count, struct error *error)
{
    char place[96], stray[96] = "";
    int64_t widest = 0;
    point_text(grid->dim, x, place);
    for (int64_t i = 1; i < count; i++) {
        widest = grid->radius[index[i]] > grid->radius[index[widest]] ? i : widest;
    }
    if (count > 0) {
        snprintf(stray, sizeof stray, ", the largest radius being %.3g m, of node %d",
                 grid->radius[index[widest]], index[widest]);
    }
    return fail(error, STATUS_VERDICT,
                "%s: row %lld at %s: no good support even at %g times the radius (%lld nodes within%s): "
                "coplanar, stray or too few nodes there",
                what, (long long)row, place, widen_limit, (long long)count, stray);
}

/* The lists of one chunk of points. */
struct chunk {
    int32_t *index;
    int64_t count;
};

static enum status build_chunk(const struct support_options *options, const struct point_grid *grid,
                               int64_t first, int64_t last, const double *x, const char *what,
                               struct support_lists *lists, struct chunk *chunk, struct error *error)
{
    enum status status = STATUS_OK;
    struct worker worker = {0};
    int dim = grid->dim;
    for (int64_t p = first; p < last; p++) {
        bool serves;
        const double *point = x + p * dim;
        for (int a = 0; a < dim; a++) {
            if (!isfinite(point[a])) {
                status =
                    fail(error, STATUS_INPUT, "%s: row %lld: not a finite coordinate", what, (long long)p);
                goto done;
            }
        }
        int64_t before = worker.list.count;
        TRY(find_support(options, grid, point, &worker, &lists->widen[p], &serves, error));
        if (!serves) {
            status = fail_support(grid, what, p, point, worker.list.index + before,
                                  worker.list.count - before, error);
            goto done;
        }
        lists->ptr[p + 1] = worker.list.count - before;
    }
    chunk->index = worker.list.index;
    chunk->count = worker.list.count;
    worker.list.index = NULL;
done:
    worker_free(&worker);
    return status;
}

/* Join the chunks in order and sum the counts. */
static enum status join(struct support_lists *lists, const struct chunk *chunks, int64_t chunk_count,
                        struct error *error)
{
    enum status status;
    for (int64_t p = 0; p < lists->count; p++) {
        lists->ptr[p + 1] += lists->ptr[p];
        lists->widened += lists->widen[p] > 1.0;
        lists->widest = fmax(lists->widest, lists->widen[p]);
    }
    TRY(NEW_ARRAY(&lists->idx, lists->ptr[lists->count], error));
    int64_t at = 0;
    for (int64_t c = 0; c < chunk_count; c++) {
        if (chunks[c].count > 0) {
            memcpy(lists->idx + at, chunks[c].index, (size_t)chunks[c].count * sizeof *lists->idx);
        }
        at += chunks[c].count;
    }
done:
    return status;
}

enum status support_build(const struct support_options *options, const struct point_grid *grid, int64_t count,
                          const double *x, const char *what, struct support_lists *lists, struct error *error)
{
    enum status status;
    int64_t chunk_count = (count + chunk_points - 1) / chunk_points;
    int64_t failed = chunk_count; /* the first chunk that failed: the same whichever thread came first */
    enum status failure = STATUS_OK;
    struct chunk *chunks = NULL;
    *lists = (struct support_lists){.count = count, .widest = 1.0};
    TRY(NEW_ARRAY(&chunks, chunk_count, error));
    TRY(NEW_ARRAY(&lists->ptr, count + 1, error));
    TRY(NEW_ARRAY(&lists->widen, count, error));
#pragma omp parallel for schedule(dynamic, 1)
    for (int64_t c = 0; c < chunk_count; c++) {
        struct error own;
        int64_t first = c * chunk_points;
        int64_t last = first + chunk_points < count ? first + chunk_points : count;
        enum status outcome = build_chunk(options, grid, first, last, x, what, lists, &chunks[c], &own);
        if (outcome != STATUS_OK) {
#pragma omp critical(support_failure)
            if (c < failed) {
                failed = c;
                failure = outcome;
                *error = own;
            }
        }
    }
    TRY(failure);
    TRY(join(lists, chunks, chunk_count, error));
done:
    for (int64_t c = 0; chunks != NULL && c < chunk_count; c++) {
        free(chunks[c].index);
    }
    free(chunks);
    if (status != STATUS_OK) {
        support_free(lists);
    }
    return status;
}

void support_free(struct support_lists *lists)
{
    free(lists->ptr);
    free(lists->idx);
    free(lists->widen);
    *lists = (struct support_lists){0};
}
