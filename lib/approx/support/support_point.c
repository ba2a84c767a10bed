/* The support of one point. */
#include "approx/support/support_private.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

static const double widen_step = 1.05;

/* Keep the `most` nearest of the neighbours index[count], of equally near ones those with lower index. */
static enum status keep_nearest(const struct point_grid *grid, const double *x, int64_t most, int32_t *index,
                                int64_t *count, struct worker *worker, struct error *error)
{
    int dim = grid->dim;
    if (most <= 0 || *count <= most) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(GROW_ARRAY(&worker->order, *count, &worker->order_room, error));
    double *distance2 = worker->order;
    for (int64_t i = 0; i < *count; i++) {
        distance2[i] = vector_distance2(dim, x, grid->x + (int64_t)index[i] * dim);
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

/* Mean spacing of the nodes in a support: the edge of the cube (square) with the volume per node. A list
 * limited to the nearest extends only to its farthest node. */
static double spacing_within(const struct support_options *options, const struct point_grid *grid,
                             const double *x, const int32_t *index, int64_t count, double widen)
{
    double farthest = 0.0;
    if (count == options->most) {
        for (int64_t i = 0; i < count; i++) {
            double distance2 = vector_distance2(grid->dim, x, grid->x + (int64_t)index[i] * grid->dim);
            farthest = distance2 > farthest ? distance2 : farthest;
        }
        farthest = sqrt(farthest);
    } else {
        for (int64_t i = 0; i < count; i++) {
            farthest = grid->radius[index[i]] > farthest ? grid->radius[index[i]] : farthest;
        }
        farthest *= widen;
    }
    double unit_ball = grid->dim == 2 ? 3.141592653589793 : 4.1887902047863905;
    return farthest * pow(unit_ball / (double)count, 1.0 / grid->dim);
}

/* Judge a support: the verdict on its number of nodes and moment matrix, and the largest gradient times the
 * spacing. */
static enum status judge(const struct support_options *options, const struct point_grid *grid,
                         const double *x, const int32_t *index, int64_t count, struct worker *worker,
                         struct found *found, struct error *error)
{
    struct mls_support support = {.x = x,
                                  .nodes = grid->x,
                                  .radius = grid->radius,
                                  .widen = found->widen,
                                  .neighbours = index,
                                  .count = count};
    double largest2 = 0.0;
    int dim = grid->dim;
    found->verdict = MLS_TOO_FEW;
    if (count < options->least) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(GROW_ARRAY(&worker->gradient, count * dim, &worker->gradient_room, error));
    RETURN_IF_ERROR(
        mls_evaluate(&options->mls, &support, &worker->work, NULL, worker->gradient, &found->verdict, error));
    for (int64_t i = 0; i < count && found->verdict == MLS_GOOD; i++) {
        double square = vector_dot(dim, worker->gradient + i * dim, worker->gradient + i * dim);
        largest2 = square > largest2 ? square : largest2;
    }
    found->steepness = sqrt(largest2) * spacing_within(options, grid, x, index, count, found->widen);
    return STATUS_OK;
}

/* Replace the neighbours from `first` on of the worker's list by those within the radii times found->widen.
 */
static enum status gather(const struct search *search, int64_t p, int64_t first, struct worker *worker,
                          const struct found *found, struct error *error)
{
    const struct point_grid *grid = search->grid;
    const double *x = search->x + p * grid->dim;
    worker->list.count = first;
    RETURN_IF_ERROR(point_grid_query(grid, x, found->widen, &worker->list, error));
    int64_t count = worker->list.count - first;
    int32_t *index = worker->list.index + first;
    if (search->visibility != NULL) {
        RETURN_IF_ERROR(
            visibility_filter(search->visibility, found->widen, index, &count, &worker->visibility, error));
    }
    RETURN_IF_ERROR(keep_nearest(grid, x, search->options->most, index, &count, worker, error));
    worker->list.count = first + count;
    return STATUS_OK;
}

/* Widen the radii until the support, of neighbours from `first` on of the worker's list, is admissible. */
static enum status widen(const struct search *search, int64_t p, int64_t first, struct worker *worker,
                         struct found *found, struct error *error)
{
    const struct support_options *options = search->options;
    const struct point_grid *grid = search->grid;
    const double *x = search->x + p * grid->dim;
    struct found best = {.steepness = INFINITY};
    *found = (struct found){.widen = 1.0};
    if (!options->widen) {
        return gather(search, p, first, worker, found, error);
    }
    for (; found->widen <= SUPPORT_WIDEN_LIMIT; found->widen *= widen_step) {
        RETURN_IF_ERROR(gather(search, p, first, worker, found, error));
        RETURN_IF_ERROR(judge(options, grid, x, worker->list.index + first, worker->list.count - first,
                              worker, found, error));
        bool good = found->verdict == MLS_GOOD;
        best = good && found->steepness < best.steepness ? *found : best;
        if (good && found->steepness <= options->gradient_bound) {
            found->steepness = 0.0;
            return STATUS_OK;
        }
    }
    if (best.widen > 0.0) {
        *found = best;
        return gather(search, p, first, worker, found, error);
    }
    return STATUS_OK;
}

enum status support_find(const struct search *search, int64_t p, struct worker *worker, struct found *found,
                         struct error *error)
{
    const struct visibility *visibility = search->visibility;
    bool sided = visibility != NULL && visibility->cell_side != NULL, good = false;
    int64_t first = worker->list.count;
    for (int whole = 0; whole <= (sided ? 1 : 0) && !good; whole++) {
        if (visibility != NULL) {
            RETURN_IF_ERROR(visibility_begin(visibility, &search->places, p,
                                             search->x + p * search->grid->dim, whole == 1,
                                             &worker->visibility, error));
        }
        RETURN_IF_ERROR(widen(search, p, first, worker, found, error));
        good = found->verdict == MLS_GOOD && !(found->steepness > 0.0);
    }
    return STATUS_OK;
}
