#include "approx/support.h"

#include "approx/candidates.h"
#include "approx/steep_bound.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double widen_step = 1.05;
static const double widen_limit = 8.0;
/* Points of one unit of work: fixed, so that the result cannot depend on the number of threads. */
static const int64_t chunk_points = 512;
/* A group of points shares its search: at most so many of them, in a box of that share of the radius. */
enum { MOST_OF_GROUP = 32 };
static const double extent_of_group = 0.8;
/* Fewer than that are sooner judged one by one than bounded together. */
static const int64_t fewest_to_bound = 3;

struct support_options support_defaults(int dim)
{
    return (struct support_options){
        .factor = dim == 2 ? 1.8 : 2.2, .widen = true, .gradient_bound = 6.0, .mls = mls_default(dim)};
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

/* One thread's growing lists and scratch. */
struct worker {
    struct index_list list;
    struct candidates candidates;
    double bounds[MOST_OF_GROUP]; /* on the gradients at each point of the group, see steep_bounds */
    struct mls_work work;
    struct steep_work steep;
    double *order;
    int64_t capacity;
};

static void worker_free(struct worker *worker)
{
    free(worker->list.index);
    candidates_free(&worker->candidates);
    free(worker->order);
    mls_work_free(&worker->work);
    steep_work_free(&worker->steep);
}

/* Keep the `most` nearest of the neighbours in index[count], ties going to the lower index. */
static enum status keep_nearest(const struct point_grid *grid, const double *x, int64_t most, int32_t *index,
                                int64_t *count, struct worker *worker, struct error *error)
{
    if (most <= 0 || *count <= most) {
        return STATUS_OK;
    }
    if (*count > worker->capacity) {
        int64_t capacity = 2 * *count + 64;
        free(worker->order);
        worker->capacity = 0;
        enum status status = NEW_ARRAY(&worker->order, capacity, error);
        if (status != STATUS_OK) {
            return status;
        }
        worker->capacity = capacity;
    }
    double *distance2 = worker->order;
    for (int64_t i = 0; i < *count; i++) {
        distance2[i] = distance2_of(grid->dim, x, grid->x + (int64_t)index[i] * grid->dim);
    }
    /* Drop the farthest (of equals the highest index) until `most` remain; the order stays ascending. */
    for (; *count > most; --*count) {
        int64_t farthest = 0;
        for (int64_t i = 1; i < *count; i++) {
            farthest = distance2[i] >= distance2[farthest] ? i : farthest;
        }
        for (int64_t i = farthest; i + 1 < *count; i++) {
            index[i] = index[i + 1];
            distance2[i] = distance2[i + 1];
        }
    }
    return STATUS_OK;
}

/* Mean spacing of the nodes in a support: the edge of the cube (square) that each of them has to itself. A
 * list cut to the nearest reaches only as far as its farthest node. */
static double spacing_within(const struct support_options *options, const struct point_grid *grid,
                             const double *x, const int32_t *index, int64_t count, double widen)
{
    double reach = 0.0;
    if (count == options->most) {
        for (int64_t i = 0; i < count; i++) {
            double distance2 = distance2_of(grid->dim, x, grid->x + (int64_t)index[i] * grid->dim);
            reach = distance2 > reach ? distance2 : reach;
        }
        reach = sqrt(reach);
    } else {
        for (int64_t i = 0; i < count; i++) {
            reach = grid->radius[index[i]] > reach ? grid->radius[index[i]] : reach;
        }
        reach *= widen;
    }
    double unit_ball = grid->dim == 2 ? 3.141592653589793 : 4.1887902047863905;
    return reach * pow(unit_ball / (double)count, 1.0 / grid->dim);
}

/* Whether a support serves: enough nodes, a good moment matrix, bounded gradients. They need not be looked at
 * where `bound`, known of them, says enough. */
static enum status judge(const struct support_options *options, const struct point_grid *grid,
                         const double *x, double widen, const int32_t *index, int64_t count, double bound,
                         struct worker *worker, bool *serves, struct error *error)
{
    enum mls_verdict verdict;
    struct mls_support support = {.x = x,
                                  .nodes = grid->x,
                                  .radius = grid->radius,
                                  .widen = widen,
                                  .neighbours = index,
                                  .count = count};
    double steepest;
    *serves = false;
    if (count < options->least) {
        return STATUS_OK;
    }
    double spacing = spacing_within(options, grid, x, index, count, widen);
    if (bound * spacing <= options->gradient_bound) {
        *serves = true;
        return STATUS_OK;
    }
    enum status status = mls_steepest(&options->mls, &support, &worker->work, &steepest, &verdict, error);
    if (status == STATUS_OK && verdict == MLS_GOOD) {
        *serves = steepest * spacing <= options->gradient_bound;
    }
    return status;
}

/* Append one point's neighbours to the worker's list; a point in a group has its candidates found. */
static enum status find_support(const struct support_options *options, const struct point_grid *grid,
                                const double *x, bool grouped, double bound, struct worker *worker,
                                double *widen, bool *serves, struct error *error)
{
    enum status status = STATUS_OK;
    int64_t first = worker->list.count;
    for (*widen = 1.0; *widen <= widen_limit; *widen *= widen_step) {
        worker->list.count = first;
        if (*widen > 1.0 || !grouped) {
            TRY(point_grid_query(grid, x, *widen, &worker->list, error));
        } else {
            TRY(candidates_within(&worker->candidates, x, &worker->list, error));
        }
        int64_t count = worker->list.count - first;
        int32_t *index = worker->list.index + first;
        TRY(keep_nearest(grid, x, options->most, index, &count, worker, error));
        worker->list.count = first + count;
        *serves = true;
        if (options->widen) {
            TRY(judge(options, grid, x, *widen, index, count, *widen > 1.0 ? INFINITY : bound, worker, serves,
                      error));
        }
        if (*serves) {
            return STATUS_OK;
        }
    }
done:
    return status;
}

static bool is_finite(int dim, const double *x)
{
    for (int a = 0; a < dim; a++) {
        if (!isfinite(x[a])) {
            return false;
        }
    }
    return true;
}

/* What the `count` points x in the box low .. high share: the search for candidates, and bounds on their
 * gradients where those will be asked for. */
static enum status study_group(const struct support_options *options, const struct point_grid *grid,
                               const double *x, int64_t count, const double *low, const double *high,
                               struct worker *worker, struct error *error)
{
    enum status status = STATUS_OK;
    for (int64_t p = 0; p < count; p++) {
        worker->bounds[p] = INFINITY;
    }
    if (count > 1) {
        TRY(candidates_find(&worker->candidates, grid, low, high, 1.0, error));
        if (options->widen && options->most <= 0 && count >= fewest_to_bound) {
            TRY(steep_bounds(&options->mls, &worker->candidates, count, x, &worker->steep, worker->bounds,
                             error));
        }
    }
done:
    return status;
}

/* Study the points that follow `first` within a box of edges up to `extent`; returns the end of that group.
 * The first point is finite. */
static enum status begin_group(const struct support_options *options, const struct point_grid *grid,
                               const double *x, int64_t first, int64_t last, double extent,
                               struct worker *worker, int64_t *end, struct error *error)
{
    double low[3], high[3];
    int dim = grid->dim;
    memcpy(low, x + first * dim, (size_t)dim * sizeof *low);
    memcpy(high, x + first * dim, (size_t)dim * sizeof *high);
    last = first + MOST_OF_GROUP < last ? first + MOST_OF_GROUP : last;
    for (*end = first + 1; *end < last && is_finite(dim, x + *end * dim); ++*end) {
        const double *point = x + *end * dim;
        double new_low[3], new_high[3], edge = 0.0;
        for (int a = 0; a < dim; a++) {
            new_low[a] = point[a] < low[a] ? point[a] : low[a];
            new_high[a] = point[a] > high[a] ? point[a] : high[a];
            edge = new_high[a] - new_low[a] > edge ? new_high[a] - new_low[a] : edge;
        }
        if (edge > extent) {
            break;
        }
        memcpy(low, new_low, (size_t)dim * sizeof *low);
        memcpy(high, new_high, (size_t)dim * sizeof *high);
    }
    return study_group(options, grid, x + first * dim, *end - first, low, high, worker, error);
}

/* How far apart the points of a group may be where these are the neighbours of one: candidates are found once
 * for all, and judged for each. */
static double extent_there(const struct point_grid *grid, const int32_t *index, int64_t count)
{
    double least = count > 0 ? INFINITY : 0.0;
    for (int64_t i = 0; i < count; i++) {
        least = grid->radius[index[i]] < least ? grid->radius[index[i]] : least;
    }
    return extent_of_group * least;
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

/* Fill the worker's list with the neighbours of the points [first, last); their numbers go to lists->ptr. */
static enum status build_chunk(const struct support_options *options, const struct point_grid *grid,
                               int64_t first, int64_t last, const double *x, const char *what,
                               struct support_lists *lists, struct worker *worker, struct error *error)
{
    enum status status = STATUS_OK;
    int dim = grid->dim;
    double extent = 0.0;
    int64_t group = first, end_of_group = first;
    worker->list.count = 0;
    for (int64_t p = first; p < last; p++) {
        bool serves;
        const double *point = x + p * dim;
        if (!is_finite(dim, point)) {
            return fail(error, STATUS_INPUT, "%s: row %lld: not a finite coordinate", what, (long long)p);
        }
        if (p == end_of_group) {
            group = p;
            TRY(begin_group(options, grid, x, p, last, extent, worker, &end_of_group, error));
        }
        int64_t before = worker->list.count;
        TRY(find_support(options, grid, point, end_of_group > group + 1, worker->bounds[p - group], worker,
                         &lists->widen[p], &serves, error));
        const int32_t *index = worker->list.index + before;
        int64_t count = worker->list.count - before;
        if (!serves) {
            return fail_support(grid, what, p, point, index, count, error);
        }
        lists->ptr[p + 1] = count;
        if (p + 1 == end_of_group) {
            extent = extent_there(grid, index, count);
        }
    }
done:
    return status;
}

/* Append the list of the points [first, last), which follow those of `all`; sum the counts and take stock. */
static enum status append_chunk(struct support_lists *lists, int64_t first, int64_t last,
                                const struct index_list *own, struct index_list *all, struct error *error)
{
    enum status status = index_list_reserve(all, own->count, error);
    if (status != STATUS_OK) {
        return status;
    }
    if (own->count > 0) {
        memcpy(all->index + all->count, own->index, (size_t)own->count * sizeof *own->index);
        all->count += own->count;
    }
    for (int64_t p = first; p < last; p++) {
        int64_t neighbours = lists->ptr[p + 1];
        lists->fewest = p == 0 || neighbours < lists->fewest ? neighbours : lists->fewest;
        lists->most = neighbours > lists->most ? neighbours : lists->most;
        lists->ptr[p + 1] += lists->ptr[p];
        lists->widened += lists->widen[p] > 1.0;
        lists->widest = fmax(lists->widest, lists->widen[p]);
    }
    return STATUS_OK;
}

/* All chunks, appended to `all` in their order whichever thread has built them. Of several that fail the
 * first tells. */
static enum status build_chunks(const struct support_options *options, const struct point_grid *grid,
                                const double *x, const char *what, struct support_lists *lists,
                                struct index_list *all, struct error *error)
{
    int64_t chunk_count = (lists->count + chunk_points - 1) / chunk_points;
    enum status failure = STATUS_OK;
#pragma omp parallel
    {
        struct worker worker = {0};
#pragma omp for ordered schedule(dynamic, 1)
        for (int64_t c = 0; c < chunk_count; c++) {
            struct error own;
            int64_t first = c * chunk_points;
            int64_t last = first + chunk_points < lists->count ? first + chunk_points : lists->count;
            enum status outcome = build_chunk(options, grid, first, last, x, what, lists, &worker, &own);
#pragma omp ordered
            if (failure == STATUS_OK) {
                failure = outcome == STATUS_OK ? append_chunk(lists, first, last, &worker.list, all, &own)
                                               : outcome;
                if (failure != STATUS_OK) {
                    *error = own;
                }
            }
        }
        worker_free(&worker);
    }
    return failure;
}

enum status support_build(const struct support_options *options, const struct point_grid *grid, int64_t count,
                          const double *x, const char *what, struct support_lists *lists, struct error *error)
{
    enum status status;
    struct index_list all = {0};
    *lists = (struct support_lists){.count = count, .widest = 1.0};
    TRY(NEW_ARRAY(&lists->ptr, count + 1, error));
    TRY(NEW_ARRAY(&lists->widen, count, error));
    TRY(build_chunks(options, grid, x, what, lists, &all, error));
    lists->idx = array_grow(all.index, all.count, sizeof *all.index); /* no longer than it need be */
    if (lists->idx == NULL) {
        TRY(fail_memory(error, "neighbour list"));
    }
    all.index = NULL;
done:
    free(all.index);
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
