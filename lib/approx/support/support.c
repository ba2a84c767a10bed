#include "approx/support/support.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SUPPORT_WIDEN_LIMIT 8.0

/* The input of a search for neighbours. */
struct search {
    const struct support_options *options;
    const struct visibility *visibility;
    bool looks; /* else all nodes within their radius are neighbours */
    struct visibility_places places;
    const double *x;
    const char *what;
    double *steepness; /* of each point, as of its support */
};

/* One thread's growing lists and scratch. */
struct worker {
    struct index_list list;
    struct visibility_work visibility;
    int32_t side; /* from which the current point sees supports: its own, or -1 far from interfaces */
    struct mls_work work;
    struct placed *order;
    double *gradient;
    int64_t order_room, gradient_room;
};

/* The support of a point. */
struct found {
    double widen;
    double steepness;         /* largest |grad phi| times the spacing where that exceeds the bound; else 0 */
    enum mls_verdict verdict; /* if not MLS_GOOD, why there is none */
};

static const double widen_step = 1.05;

/* The support of a node, seen from the worker's point. */
static struct own_support seen(const struct search *search, int64_t node, const struct worker *worker)
{
    const struct visibility *visibility = search->visibility;
    return supports_seen(&visibility->supports, visibility->cells.dim, node, worker->side);
}

/* The square of |A (x - x_j)| of a node j. */
static double distance2(const struct search *search, const double *x, int64_t node, const double *A)
{
    const struct cells *cells = &search->visibility->cells;
    double difference[3];
    vector_subtract(cells->dim, x, cells->x + node * cells->dim, difference);
    return vector_square(cells->dim, A, difference);
}

/* Keep the `most` nearest of the neighbours index[count], of equally near ones those with lower index. */
static enum status keep_nearest(const struct search *search, const double *x, int32_t *index, int64_t *count,
                                struct worker *worker, struct error *error)
{
    int64_t most = search->options->most;
    if (most <= 0 || *count <= most) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(GROW_ARRAY(&worker->order, *count, &worker->order_room, error));
    for (int64_t i = 0; i < *count; i++) {
        worker->order[i] =
            (struct placed){distance2(search, x, index[i], seen(search, index[i], worker).stretch), index[i]};
    }
    qsort(worker->order, (size_t)*count, sizeof *worker->order, compare_placed);
    for (int64_t i = 0; i < most; i++) {
        index[i] = (int32_t)worker->order[i].item;
    }
    qsort(index, (size_t)most, sizeof *index, compare_int32);
    *count = most;
    return STATUS_OK;
}

/* Mean spacing of the nodes in a support: the edge of the cube (square) with the volume per node. A list
 * limited to the nearest extends only to its farthest node. */
static double spacing_within(const struct search *search, const double *x, const int32_t *index,
                             int64_t count, double widen, const struct worker *worker)
{
    bool limited = count == search->options->most;
    double farthest = 0.0;
    for (int64_t i = 0; i < count; i++) {
        struct own_support own = seen(search, index[i], worker);
        farthest =
            fmax(farthest, limited ? sqrt(distance2(search, x, index[i], own.stretch)) : own.radius * widen);
    }
    double unit_ball = search->visibility->cells.dim == 2 ? 3.141592653589793 : 4.1887902047863905;
    return farthest * pow(unit_ball / (double)count, 1.0 / search->visibility->cells.dim);
}

/* |A^-1 g|^2 of a gradient; stretch: A, or NULL, 1. */
static double square_in_support(int dim, const double *stretch, const double *g)
{
    double A[3][3] = {{0.0}, {0.0}, {0.0, 0.0, 1.0}}, inverse[3][3], gradient[3] = {0.0};
    if (stretch == NULL) {
        return vector_dot(dim, g, g);
    }
    for (int a = 0; a < dim; a++) {
        memcpy(A[a], stretch + a * dim, (size_t)dim * sizeof *g);
        gradient[a] = g[a];
    }
    (void)matrix_inverse(A[0], A[1], A[2], inverse);
    return vector_square(3, inverse[0], gradient);
}

/* Judge a support: the verdict on its number of nodes and moment matrix, and the largest gradient times the
 * spacing. */
static enum status judge(const struct search *search, const double *x, const int32_t *index, int64_t count,
                         struct worker *worker, struct found *found, struct error *error)
{
    const struct support_options *options = search->options;
    struct mls_support support = {.x = x,
                                  .nodes = search->visibility->cells.x,
                                  .supports = search->visibility->supports,
                                  .widen = found->widen,
                                  .side = worker->side,
                                  .neighbours = index,
                                  .count = count};
    double largest2 = 0.0;
    int dim = search->visibility->cells.dim;
    found->verdict = MLS_TOO_FEW;
    if (count < options->least) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(GROW_ARRAY(&worker->gradient, count * dim, &worker->gradient_room, error));
    RETURN_IF_ERROR(
        mls_evaluate(&options->mls, &support, &worker->work, NULL, worker->gradient, &found->verdict, error));
    for (int64_t i = 0; i < count && found->verdict == MLS_GOOD; i++) {
        const double *A = seen(search, index[i], worker).stretch;
        largest2 = fmax(largest2, square_in_support(dim, A, worker->gradient + i * dim));
    }
    found->steepness = sqrt(largest2) * spacing_within(search, x, index, count, found->widen, worker);
    return STATUS_OK;
}

/* Whether any of these nodes may have supports by sides. */
static bool on_interface(const struct visibility *visibility, const int32_t *index, int64_t count)
{
    bool any = false, sided = visibility->supports.side_count > 0 && visibility->node_side != NULL;
    for (int64_t i = 0; i < count && sided; i++) {
        any = any || visibility->node_side[index[i]] < 0;
    }
    return any;
}

/* Replace the neighbours from `first` on of the worker's list by those within the supports times
 * found->widen. */
static enum status gather(const struct search *search, const double *x, int64_t first, struct worker *worker,
                          const struct found *found, struct error *error)
{
    const struct visibility *visibility = search->visibility;
    worker->list.count = first;
    RETURN_IF_ERROR(point_grid_query(&visibility->grid, x, found->widen, &worker->list, error));
    int32_t *index = worker->list.index + first;
    int64_t near = worker->list.count - first, count = 0;
    bool by_sides = on_interface(visibility, index, near);
    bool balls = visibility->supports.stretch == NULL && !by_sides; /* as they are found */
    worker->side = by_sides ? worker->visibility.side : -1;
    for (int64_t i = 0; i < near && !balls; i++) {
        struct own_support own = seen(search, index[i], worker);
        double radius = own.radius * found->widen;
        index[count] = index[i];
        count += distance2(search, x, index[i], own.stretch) < radius * radius;
    }
    count = balls ? near : count;
    if (search->looks) {
        RETURN_IF_ERROR(
            visibility_filter(visibility, found->widen, index, &count, &worker->visibility, error));
    }
    RETURN_IF_ERROR(keep_nearest(search, x, index, &count, worker, error));
    worker->list.count = first + count;
    return STATUS_OK;
}

/* Widen the radii until the support, of neighbours from `first` on of the worker's list, is admissible. */
static enum status widen(const struct search *search, int64_t p, int64_t first, struct worker *worker,
                         struct found *found, struct error *error)
{
    const struct support_options *options = search->options;
    const double *x = search->x + p * search->visibility->cells.dim;
    struct found best = {.steepness = INFINITY};
    *found = (struct found){.widen = 1.0};
    if (!options->widen) {
        return gather(search, x, first, worker, found, error);
    }
    for (; found->widen <= SUPPORT_WIDEN_LIMIT; found->widen *= widen_step) {
        RETURN_IF_ERROR(gather(search, x, first, worker, found, error));
        RETURN_IF_ERROR(
            judge(search, x, worker->list.index + first, worker->list.count - first, worker, found, error));
        bool good = found->verdict == MLS_GOOD;
        best = good && found->steepness < best.steepness ? *found : best;
        if (good && found->steepness <= options->gradient_bound) {
            found->steepness = 0.0;
            return STATUS_OK;
        }
    }
    if (best.widen > 0.0) {
        *found = best;
        return gather(search, x, first, worker, found, error);
    }
    return STATUS_OK;
}

/* Append the neighbours of point p to the worker's list. The radii are widened until the support is
 * admissible, at most by SUPPORT_WIDEN_LIMIT. If gradients exceed their bound with all radii, those that
 * exceed it least are taken. Without a good support on its side, the point sees the whole body. */
static enum status support_find(const struct search *search, int64_t p, struct worker *worker,
                                struct found *found, struct error *error)
{
    const struct visibility *visibility = search->visibility;
    bool sided = search->looks && visibility->cell_side != NULL, good = false;
    int64_t first = worker->list.count;
    for (int whole = 0; whole <= (sided ? 1 : 0) && !good; whole++) {
        if (search->looks) {
            RETURN_IF_ERROR(visibility_begin(visibility, &search->places, p,
                                             search->x + p * visibility->cells.dim, whole == 1,
                                             &worker->visibility, error));
        }
        RETURN_IF_ERROR(widen(search, p, first, worker, found, error));
        good = found->verdict == MLS_GOOD && !(found->steepness > 0.0);
    }
    return STATUS_OK;
}

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

/* The message for a point without a good support; the radius in it reveals a stray node. */
static enum status fail_support(const struct search *search, int64_t row, const int32_t *index, int64_t count,
                                enum mls_verdict verdict, struct error *error)
{
    char stray[96] = "";
    int dim = search->visibility->cells.dim;
    const double *radius = search->visibility->supports.radius;
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
                search->what, (long long)row, POINT_TEXT(dim, search->x + row * dim), SUPPORT_WIDEN_LIMIT,
                (long long)count, search->looks ? " reach through the cells" : "", stray,
                verdict == MLS_TOO_FEW
                    ? "too few"
                    : "they lie in a plane or on a line (for mls2: on a quadric), or nearly so");
}

/* Append the neighbours of the points [first, last) to the worker's list; lists->ptr receives their
 * numbers. */
static enum status build_chunk(const struct search *search, int64_t first, int64_t last,
                               struct neighbours *lists, struct worker *worker, struct error *error)
{
    int dim = search->visibility->cells.dim;
    worker->list.count = 0;
    for (int64_t p = first; p < last; p++) {
        struct found found;
        for (const double *x = search->x + p * dim; x < search->x + (p + 1) * dim; x++) {
            if (!isfinite(*x)) {
                return fail(error, STATUS_INPUT, "%s: row %lld: not a finite coordinate", search->what,
                            (long long)p);
            }
        }
        int64_t before = worker->list.count;
        RETURN_IF_ERROR(support_find(search, p, worker, &found, error));
        int64_t count = worker->list.count - before;
        if (found.verdict != MLS_GOOD) {
            return fail_support(search, p, worker->list.index + before, count, found.verdict, error);
        }
        lists->widen[p] = found.widen;
        if (lists->side != NULL) {
            lists->side[p] = worker->side;
        }
        search->steepness[p] = found.steepness;
        lists->ptr[p + 1] = count;
    }
    return STATUS_OK;
}

/* Append a worker's list of the points [first, last) to `all`; turn counts into lists->ptr, and update the
 * statistics. */
static enum status append_chunk(const struct search *search, struct neighbours *lists, int64_t first,
                                int64_t last, const struct worker *worker, struct index_list *all,
                                struct error *error)
{
    const struct index_list *own = &worker->list;
    RETURN_IF_ERROR(index_list_reserve(all, own->count, error));
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
        lists->steep.count += search->steepness[p] > 0.0;
        if (search->steepness[p] > lists->steep.steepness) {
            lists->steep.point = p;
            lists->steep.steepness = search->steepness[p];
        }
    }
    return STATUS_OK;
}

/* Build all chunks and append them to `all` in order. The failure of the first chunk that failed is
 * reported. */
static enum status build_chunks(const struct search *search, struct neighbours *lists, struct index_list *all,
                                struct error *error)
{
    int64_t chunk_count = (lists->count + chunk_points - 1) / chunk_points;
    enum status failure = STATUS_OK;
#pragma omp parallel
    {
        struct worker worker = {.side = -1};
#pragma omp for ordered schedule(dynamic, 1)
        for (int64_t c = 0; c < chunk_count; c++) {
            struct error own;
            int64_t first = c * chunk_points;
            int64_t last = first + chunk_points < lists->count ? first + chunk_points : lists->count;
            enum status outcome = build_chunk(search, first, last, lists, &worker, &own);
#pragma omp ordered
            if (failure == STATUS_OK) {
                failure = outcome == STATUS_OK ? append_chunk(search, lists, first, last, &worker, all, &own)
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

enum status support_build(const struct support_options *options, const struct visibility *visibility,
                          const struct visibility_places *places, int64_t count, const double *x,
                          const char *what, struct neighbours *lists, struct error *error)
{
    FREED_BY(index_list_free) struct index_list all = {0};
    *lists = (struct neighbours){.count = count, .widest = 1.0};
    NEW_SCRATCH(double, steepness, count, error);
    struct search search = {.options = options,
                            .visibility = visibility,
                            .looks = visibility->across != NULL,
                            .x = x,
                            .what = what,
                            .steepness = steepness};
    RETURN_IF_ERROR(NEW_ARRAY(&lists->ptr, count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lists->widen, count, error));
    RETURN_IF_ERROR(visibility->supports.side_count > 0 ? NEW_ARRAY(&lists->side, count, error) : STATUS_OK);
    if (places != NULL) {
        search.places = *places;
    }
    RETURN_IF_ERROR(build_chunks(&search, lists, &all, error));
    lists->idx = array_grow(all.index, all.count, sizeof *all.index); /* release what is not used */
    if (lists->idx == NULL) {
        return fail_memory(error, "neighbour list");
    }
    all.index = NULL;
    return STATUS_OK;
}

void support_free(struct neighbours *lists)
{
    FREE_ALL(lists->ptr, lists->idx, lists->widen, lists->side);
    *lists = (struct neighbours){0};
}
