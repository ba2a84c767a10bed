#include "approx/support/support_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Points of one chunk of work: fixed, so that the result does not depend on the number of threads. */
static const int64_t chunk_points = 512;

struct support_options support_defaults(int dim)
{
    return (struct support_options){
        .factor = dim == 2 ? 1.8 : 2.0, .widen = true, .gradient_bound = 6.0, .mls = mls_default(dim)};
}

const char *point_text(int dim, const double *x, char text[96])
{
    snprintf(text, 96, dim == 2 ? "(%.6g, %.6g)" : "(%.6g, %.6g, %.6g)", x[0], x[1], x[dim - 1]);
    return text;
}

static void worker_free(struct worker *worker)
{
    visibility_work_free(&worker->visibility);
    FREE_ALL(worker->list.index, worker->order, worker->gradient);
    mls_work_free(&worker->work);
}

static enum status check_finite(const struct search *search, int64_t count, struct error *error)
{
    for (int64_t i = 0; i < count * search->grid->dim; i++) {
        if (!isfinite(search->x[i])) {
            return fail(error, STATUS_INPUT, "%s: row %lld: not a finite coordinate", search->what,
                        (long long)(i / search->grid->dim));
        }
    }
    return STATUS_OK;
}

/* The message for a point without a good support; the radius in it reveals a stray node. */
static enum status fail_support(const struct search *search, int64_t row, const int32_t *index, int64_t count,
                                enum mls_verdict verdict, struct error *error)
{
    char place[96], stray[96] = "";
    const double *radius = search->grid->radius;
    point_text(search->grid->dim, search->x + row * search->grid->dim, place);
    if (count > 0) {
        int32_t widest = index[0];
        for (int64_t i = 1; i < count; i++) {
            widest = radius[index[i]] > radius[widest] ? index[i] : widest;
        }
        snprintf(stray, sizeof stray, ", the largest radius being %.3g m, of node %d", radius[widest],
                 widest);
    }
    return fail(error, STATUS_VERDICT,
                "%s: row %lld at %s: no good support even at %g times the radius (%lld nodes within%s%s): %s",
                search->what, (long long)row, place, SUPPORT_WIDEN_LIMIT, (long long)count,
                search->visibility != NULL ? " reach through the cells" : "", stray,
                verdict == MLS_TOO_FEW
                    ? "too few"
                    : "they lie in a plane or on a line (for mls2: on a quadric), or nearly so");
}

static void add_steep(struct steep_points *steep, const struct steep_points *more)
{
    if (more->steepness > steep->steepness) {
        steep->point = more->point;
        steep->steepness = more->steepness;
    }
    steep->count += more->count;
}

/* Append the neighbours of the points [first, last) to the worker's list; lists->ptr receives their
 * numbers. */
static enum status build_chunk(const struct search *search, int64_t first, int64_t last,
                               struct support_lists *lists, struct worker *worker, struct error *error)
{
    worker->list.count = 0;
    worker->steep = (struct steep_points){0};
    for (int64_t p = first; p < last; p++) {
        struct found found;
        int64_t before = worker->list.count;
        RETURN_IF_ERROR(support_find(search, p, worker, &found, error));
        int64_t count = worker->list.count - before;
        if (found.verdict != MLS_GOOD) {
            return fail_support(search, p, worker->list.index + before, count, found.verdict, error);
        }
        lists->widen[p] = found.widen;
        if (found.steepness > 0.0) {
            add_steep(&worker->steep, &(struct steep_points){1, p, found.steepness});
        }
        lists->ptr[p + 1] = count;
    }
    return STATUS_OK;
}

/* Append a worker's list of the points [first, last) to `all`; turn counts into lists->ptr, and update the
 * statistics. */
static enum status append_chunk(struct support_lists *lists, int64_t first, int64_t last,
                                const struct worker *worker, struct index_list *all, struct error *error)
{
    const struct index_list *own = &worker->list;
    RETURN_IF_ERROR(index_list_reserve(all, own->count, error));
    add_steep(&lists->steep, &worker->steep);
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

/* Build all chunks and append them to `all` in order. The failure of the first chunk that failed is
 * reported. */
static enum status build_chunks(const struct search *search, struct support_lists *lists,
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
            enum status outcome = build_chunk(search, first, last, lists, &worker, &own);
#pragma omp ordered
            if (failure == STATUS_OK) {
                failure =
                    outcome == STATUS_OK ? append_chunk(lists, first, last, &worker, all, &own) : outcome;
                if (failure != STATUS_OK) {
                    *error = own;
                }
            }
        }
        worker_free(&worker);
    }
    return failure;
}

enum status support_space_build(const struct support_options *options, const struct cells *cells,
                                const double *radius, struct support_space *space, struct error *error)
{
    *space = (struct support_space){.cells = *cells, .radius = radius};
    RETURN_IF_ERROR(point_grid_build(&space->grid, cells->dim, cells->node_count, cells->x, radius, error));
    return options->visibility == VISIBILITY_CELLS && cells->count > 0
               ? visibility_build(cells, options->side, &space->grid, &space->visibility, error)
               : STATUS_OK;
}

void support_space_free(struct support_space *space)
{
    visibility_free(&space->visibility);
    point_grid_free(&space->grid);
    *space = (struct support_space){0};
}

enum status support_build(const struct support_options *options, const struct support_space *space,
                          const struct visibility_places *places, int64_t count, const double *x,
                          const char *what, struct support_lists *lists, struct error *error)
{
    FREED_BY(index_list_free) struct index_list all = {0};
    *lists = (struct support_lists){.count = count, .widest = 1.0};
    struct search search = {.options = options,
                            .grid = &space->grid,
                            .visibility = space->visibility.grid != NULL ? &space->visibility : NULL,
                            .x = x,
                            .what = what};
    RETURN_IF_ERROR(NEW_ARRAY(&lists->ptr, count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lists->widen, count, error));
    if (places != NULL) {
        search.places = *places;
    }
    RETURN_IF_ERROR(check_finite(&search, count, error));
    RETURN_IF_ERROR(build_chunks(&search, lists, &all, error));
    lists->idx = array_grow(all.index, all.count, sizeof *all.index); /* release what is not used */
    if (lists->idx == NULL) {
        return fail_memory(error, "neighbour list");
    }
    all.index = NULL;
    return STATUS_OK;
}

void support_free(struct support_lists *lists)
{
    FREE_ALL(lists->ptr, lists->idx, lists->widen);
    *lists = (struct support_lists){0};
}
