#include "approx/reach_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const reach_names[REACH_RULE_COUNT] = {"cells", "distance"};

/* passes[]: which of the facets that oppose a node may lie between it and x: those that x is not beyond, and
 * whose ball the segment from x to the node may meet. Coordinates are relative to the node, in floats, with
 * an allowance for their round-off. Returns whether there are any. */
static bool find_near(const struct reach *reach, int32_t node, const double *from, int32_t *passes)
{
    int dim = reach->cells.dim;
    int64_t first = reach->opposing_ptr[node], count = reach->opposing_ptr[node + 1] - first;
    const double *own = reach->cells.x + (int64_t)node * dim;
    float within = (float)(1e-4 * reach->grid->radius[node]);
    float x = (float)(from[0] - own[0]), y = (float)(from[1] - own[1]), z = 0.0F;
    int32_t any = 0;
    if (dim == 3) {
        z = (float)(from[2] - own[2]);
    }
    float length2 = x * x + y * y + z * z, inverse = length2 > 0.0F ? 1.0F / length2 : 0.0F;
    float *const *view = reach->opposing_view;
    const float *nx = view[0] + first, *ny = view[1] + first, *nz = view[2] + first, *above = view[3] + first;
    const float *mx = view[4] + first, *my = view[5] + first, *mz = view[6] + first, *size = view[7] + first;
    for (int64_t i = 0; i < count; i++) {
        float height = above[i] + nx[i] * x + ny[i] * y + nz[i] * z;
        float t = (mx[i] * x + my[i] * y + mz[i] * z) * inverse, reached = size[i] + within;
        t = t < 0.0F ? 0.0F : t;
        t = t > 1.0F ? 1.0F : t;
        float dx = mx[i] - t * x, dy = my[i] - t * y, dz = mz[i] - t * z;
        passes[i] = (height <= within) & (dx * dx + dy * dy + dz * dz <= reached * reached);
        any |= passes[i];
    }
    return any != 0;
}

enum status reach_list_facets(const struct reach *reach, const double *x, const int32_t *index, int64_t count,
                              struct reach_work *work, struct error *error)
{
    enum status status;
    TRY(reach_work_reserve(reach, work, error));
    work->near.count = 0;
    for (int64_t i = 0; i < count; i++) {
        int32_t node = index[i];
        int64_t first = reach->opposing_ptr[node], opposing = reach->opposing_ptr[node + 1] - first;
        work->near_begin[node] = (int32_t)work->near.count;
        if (opposing > 0 && find_near(reach, node, x, work->passes)) {
            TRY(index_list_reserve(&work->near, opposing, error));
            for (int64_t k = 0; k < opposing; k++) {
                work->near.index[work->near.count] = reach->opposing[first + k];
                work->near.count += work->passes[k];
            }
        }
        work->near_end[node] = (int32_t)work->near.count;
    }
done:
    return status;
}

enum status reach_begin(const struct reach *reach, const struct reach_places *places, int64_t p,
                        const double *x, struct reach_work *work, struct error *error)
{
    enum status status = reach_work_reserve(reach, work, error);
    if (status != STATUS_OK) {
        return status;
    }
    if (++work->serial >= UINT32_MAX / 2) {
        memset(work->mark, 0, (size_t)reach->cells.node_count * sizeof *work->mark);
        work->serial = 1;
    }
    work->x = x;
    work->outside = false;
    memcpy(work->from, x, (size_t)reach->cells.dim * sizeof *x);
    work->cell_count = -1;
    if (places->nodes) {
        work->cell = reach->star + reach->star_ptr[p];
        work->cell_count = reach->star_ptr[p + 1] - reach->star_ptr[p];
    } else if (places->cell != NULL) {
        int64_t row = p / places->points_per_row, first = places->ptr != NULL ? places->ptr[row] : row;
        int64_t end = places->ptr != NULL ? places->ptr[row + 1] : row + 1;
        work->cell = places->cell + first;
        work->cell_count = end > first && work->cell[0] >= 0 ? end - first : -1;
    }
    return STATUS_OK;
}

/* Mark the candidates that are out of sight; *hidden counts them. A node looked at before is as it was. */
static enum status mark_hidden(const struct reach *reach, double widen, const int32_t *index, int64_t count,
                               struct reach_work *work, int64_t *hidden, struct error *error)
{
    enum status status = STATUS_OK;
    *hidden = 0;
    for (int64_t i = 0; i < count && work->cell_count < 0; i++) {
        if (widen > 1.0 || reach->opposing_ptr[index[i]] < reach->opposing_ptr[index[i] + 1]) {
            TRY(reach_locate(reach, work->x, work, error));
        }
    }
    bool by_facets = widen <= 1.0 && !work->outside;
    if ((by_facets && work->near.count == 0) || work->cell_count <= 0) {
        return STATUS_OK;
    }
    for (int64_t i = 0; i < count; i++) {
        int32_t node = index[i];
        if (by_facets && work->near_begin[node] == work->near_end[node]) {
            continue;
        }
        if (work->mark[node] / 2 != work->serial) {
            bool seen;
            TRY((by_facets ? reach_sees : reach_walk)(reach, work->from, work->cell, work->cell_count, node,
                                                      work, &seen, error));
            work->mark[node] = 2 * work->serial + !seen;
        }
        *hidden += reach_is_hidden(work, node);
    }
done:
    return status;
}

/* Keep the neighbours within reach, with their images. */
static enum status keep(const struct reach *reach, double widen, int32_t *index, int64_t *count,
                        struct reach_work *work, struct error *error)
{
    enum status status = STATUS_OK;
    int dim = reach->cells.dim;
    int64_t kept = 0;
    if (*count > work->capacity) {
        free(work->image);
        work->capacity = 0;
        TRY(NEW_ARRAY(&work->image, 2 * *count * dim, error));
        work->capacity = 2 * *count;
    }
    for (int64_t i = 0; i < *count; i++) {
        int32_t node = index[i];
        double *image = work->image + kept * dim, bend[3], length;
        if (!reach_is_hidden(work, node)) {
            for (int a = 0; a < dim; a++) {
                image[a] = reach->cells.x[(int64_t)node * dim + a] - work->x[a];
            }
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
        double leg = reach_distance(dim, work->x, bend);
        for (int a = 0; a < dim; a++) {
            image[a] = (bend[a] - work->x[a]) * (length / leg);
        }
        index[kept++] = node;
        work->around++;
    }
    *count = kept;
done:
    return status;
}

enum status reach_filter(const struct reach *reach, double widen, int32_t *index, int64_t *count,
                         struct reach_work *work, struct error *error)
{
    enum status status;
    work->around = 0;
    TRY(mark_hidden(reach, widen, index, *count, work, &work->changed, error));
    if (work->changed > 0) {
        TRY(reach_paths(reach, widen, index, *count, work, error));
        TRY(keep(reach, widen, index, count, work, error));
    }
done:
    return status;
}
