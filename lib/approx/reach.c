#include "approx/reach_private.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

const char *const reach_names[REACH_RULE_COUNT] = {"cells", "distance"};

enum status reach_begin(const struct reach *reach, const struct reach_places *places, int64_t p,
                        const double *x, struct reach_work *work, struct error *error)
{
    RETURN_IF_ERROR(reach_work_reserve(reach, work, error));
    if (++work->serial >= UINT32_MAX / 2) {
        memset(work->mark, 0, (size_t)reach->cells.node_count * sizeof *work->mark);
        work->serial = 1;
    }
    work->point = p;
    work->x = x;
    work->outside = false;
    memcpy(work->from, x, (size_t)reach->cells.dim * sizeof *x);
    work->cell_count = work->node = -1;
    if (places->nodes) {
        work->node = places->node != NULL ? places->node[p] : p;
        work->cell = reach->star + reach->star_ptr[work->node];
        work->cell_count = reach->star_ptr[work->node + 1] - reach->star_ptr[work->node];
    } else if (places->cell != NULL) {
        work->cell = reach_places_cells(places, p, &work->cell_count);
        work->cell_count = work->cell_count > 0 && work->cell[0] >= 0 ? work->cell_count : -1;
    }
    return STATUS_OK;
}

/* Mark the candidates that are out of sight; *hidden counts them. A node checked before keeps its mark. */
static enum status mark_hidden(const struct reach *reach, const struct reach_shadows *shadows, double widen,
                               const int32_t *index, int64_t count, struct reach_work *work, int64_t *hidden,
                               struct error *error)
{
    *hidden = 0;
    for (int64_t i = 0; i < count && work->cell_count < 0; i++) {
        if (widen > 1.0 || reach->shadowed[index[i]]) {
            RETURN_IF_ERROR(reach_locate(reach, work->x, work, error));
        }
    }
    if (work->cell_count <= 0) {
        return STATUS_OK;
    }
    if (widen <= 1.0 && work->node >= 0) {
        *hidden = reach->hidden_ptr[work->node + 1] - reach->hidden_ptr[work->node];
        for (int64_t i = 0; i < *hidden; i++) {
            work->mark[reach->hidden[reach->hidden_ptr[work->node] + i]] = 2 * work->serial + 1;
        }
        return STATUS_OK;
    }
    if (widen <= 1.0 && !work->outside) {
        return reach_mark_shadows(reach, shadows, work->point, work, hidden, error);
    }
    for (int64_t i = 0; i < count; i++) {
        int32_t node = index[i];
        if (work->mark[node] / 2 != work->serial) {
            bool seen;
            RETURN_IF_ERROR(
                reach_walk(reach, work->from, work->cell, work->cell_count, node, work, &seen, error));
            work->mark[node] = 2 * work->serial + !seen;
        }
        *hidden += reach_is_hidden(work, node);
    }
    return STATUS_OK;
}

/* Keep the neighbours within reach, with their images. */
static enum status keep(const struct reach *reach, double widen, int32_t *index, int64_t *count,
                        struct reach_work *work, struct error *error)
{
    int dim = reach->cells.dim;
    int64_t kept = 0;
    RETURN_IF_ERROR(GROW_ARRAY(&work->image, *count * dim, &work->image_room, error));
    for (int64_t i = 0; i < *count; i++) {
        int32_t node = index[i];
        double *image = work->image + kept * dim, bend[3], length;
        if (!reach_is_hidden(work, node)) {
            vector_subtract(dim, reach->cells.x + (int64_t)node * dim, work->x, image);
            index[kept++] = node;
            continue;
        }
        if (!(work->length[node] < INFINITY)) {
            continue;
        }
        reach_first_bend(reach, node, work, bend, &length);
        if (!(length < widen * reach->grid->radius[node])) {
            continue;
        }
        double leg = vector_distance(dim, work->x, bend);
        for (int a = 0; a < dim; a++) {
            image[a] = (bend[a] - work->x[a]) * (length / leg);
        }
        index[kept++] = node;
        work->around++;
    }
    *count = kept;
    return STATUS_OK;
}

enum status reach_filter(const struct reach *reach, const struct reach_shadows *shadows, double widen,
                         int32_t *index, int64_t *count, struct reach_work *work, struct error *error)
{
    work->around = 0;
    RETURN_IF_ERROR(mark_hidden(reach, shadows, widen, index, *count, work, &work->changed, error));
    if (work->changed > 0) {
        RETURN_IF_ERROR(reach_paths(reach, widen, index, *count, work, error));
        RETURN_IF_ERROR(keep(reach, widen, index, count, work, error));
    }
    return STATUS_OK;
}

void reach_free(struct reach *reach)
{
    FREE_ALL(reach->across, reach->star_ptr, reach->star, reach->facet, reach->shadow, reach->shadowed,
             reach->corner, reach->edge_ptr, reach->edge, reach->seen_ptr, reach->seen, reach->seen_length,
             reach->hidden_ptr, reach->hidden);
    *reach = (struct reach){0};
}
