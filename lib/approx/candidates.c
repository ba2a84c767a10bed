#include "approx/candidates.h"

#include "base/memory.h"

#include <stdlib.h>

static enum status reserve(struct candidates *candidates, int64_t count, struct error *error)
{
    enum status status = STATUS_OK;
    if (count > candidates->capacity) {
        int64_t capacity = (2 * count + 64) / 8 * 8;
        struct index_list list = candidates->list;
        candidates->list = (struct index_list){0};
        candidates_free(candidates);
        candidates->list = list;
        TRY(NEW_ARRAY(&candidates->place, 3 * capacity, error));
        TRY(NEW_ARRAY(&candidates->reach2, capacity, error));
        TRY(NEW_ARRAY(&candidates->margin, capacity, error));
        candidates->capacity = capacity;
    }
done:
    return status;
}

void candidates_free(struct candidates *candidates)
{
    free(candidates->list.index);
    free(candidates->place);
    free(candidates->reach2);
    free(candidates->margin);
    *candidates = (struct candidates){0};
}

enum status candidates_find(struct candidates *candidates, const struct point_grid *grid, const double *low,
                            const double *high, double factor, struct error *error)
{
    enum status status;
    candidates->list.count = 0;
    TRY(point_grid_query_box(grid, low, high, factor, &candidates->list, error));
    TRY(reserve(candidates, candidates->list.count, error));
    candidates->dim = grid->dim;
    for (int64_t i = 0; i < candidates->list.count; i++) {
        int64_t node = candidates->list.index[i];
        double radius = grid->radius[node] * factor;
        for (int a = 0; a < grid->dim; a++) {
            candidates->place[a * candidates->capacity + i] = grid->x[node * grid->dim + a];
        }
        candidates->reach2[i] = radius * radius;
    }
done:
    return status;
}

/* margin = reach^2 - distance^2: positive within, to the last bit. */
static inline __attribute__((always_inline)) void margins(int dim, struct candidates *candidates,
                                                          const double *x)
{
    const double *place = candidates->place, *reach2 = candidates->reach2;
    double *restrict margin = candidates->margin;
    int64_t capacity = candidates->capacity;
    for (int64_t i = 0; i < candidates->list.count; i++) {
        double distance2 = 0.0;
        for (int a = 0; a < dim; a++) {
            double difference = place[a * capacity + i] - x[a];
            distance2 += difference * difference;
        }
        margin[i] = reach2[i] - distance2;
    }
}

enum status candidates_within(struct candidates *candidates, const double *x, struct index_list *list,
                              struct error *error)
{
    int64_t count = candidates->list.count, found = 0;
    enum status status = index_list_reserve(list, count, error);
    if (status != STATUS_OK) {
        return status;
    }
    if (candidates->dim == 2) {
        margins(2, candidates, x);
    } else {
        margins(3, candidates, x);
    }
    int32_t *index = list->index + list->count;
    for (int64_t i = 0; i < count; i++) {
        index[found] = candidates->list.index[i];
        found += candidates->margin[i] > 0.0;
    }
    list->count += found;
    return STATUS_OK;
}
