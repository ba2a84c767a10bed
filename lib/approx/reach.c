#include "approx/reach_private.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const reach_names[REACH_RULE_COUNT] = {"cells", "distance"};

/* The segments from a node to the points of a row: those in a ball. */
struct row_view {
    float middle[3], inverse; /* of the ball, from the node; 1 / its squared distance */
    float within;             /* radius of the ball, and an allowance for round-off */
};

static struct row_view view_row(const struct reach *reach, int32_t node, const struct reach_work *work)
{
    int dim = reach->cells.dim;
    const double *own = reach->cells.x + (int64_t)node * dim;
    struct row_view row = {.within = (float)(work->row_radius + 1e-4 * reach->grid->radius[node])};
    float distance2 = 0.0F;
    for (int a = 0; a < dim; a++) {
        row.middle[a] = (float)(work->row_middle[a] - own[a]);
        distance2 += row.middle[a] * row.middle[a];
    }
    row.inverse = distance2 > 0.0F ? 1.0F / distance2 : 0.0F;
    return row;
}

/* passes[REACH_BLOCK]: which of the facets from `first` on may hide the node from the row: the row is not
 * beyond them, and the segments may meet their balls. Returns whether there are any. */
static inline bool block_passes(float *const *view, int64_t first, const struct row_view *row,
                                int32_t *passes)
{
    const float *nx = view[0] + first, *ny = view[1] + first, *nz = view[2] + first, *above = view[3] + first;
    const float *mx = view[4] + first, *my = view[5] + first, *mz = view[6] + first, *size = view[7] + first;
    float x = row->middle[0], y = row->middle[1], z = row->middle[2], within = row->within;
    int32_t any = 0;
    for (int i = 0; i < REACH_BLOCK; i++) {
        float height = above[i] + nx[i] * x + ny[i] * y + nz[i] * z;
        float t = (mx[i] * x + my[i] * y + mz[i] * z) * row->inverse, reached = size[i] + within;
        t = t < 0.0F ? 0.0F : t;
        t = t > 1.0F ? 1.0F : t;
        float dx = mx[i] - t * x, dy = my[i] - t * y, dz = mz[i] - t * z;
        passes[i] = (height <= within) & (dx * dx + dy * dy + dz * dz <= reached * reached);
        any |= passes[i];
    }
    return any != 0;
}

/* List those of the facets opposing[first, last); returns how many. */
static int64_t list_passing(const struct reach *reach, int64_t first, int64_t last,
                            const struct row_view *row, int32_t *list)
{
    int64_t count = 0;
    for (int64_t i = first; i < last; i += REACH_BLOCK) {
        int32_t passes[REACH_BLOCK];
        if (block_passes(reach->opposing_view, i, row, passes)) {
            for (int64_t k = i; k < i + REACH_BLOCK && k < last; k++) {
                list[count] = reach->opposing[k];
                count += passes[k - i];
            }
        }
    }
    return count;
}

enum status reach_list_facets(const struct reach *reach, const int32_t *index, int64_t count,
                              struct reach_work *work, struct error *error)
{
    for (int64_t i = 0; i < count; i++) {
        int32_t node = index[i];
        int64_t first = reach->opposing_ptr[node], last = reach->opposing_ptr[node + 1];
        if (work->listed[node] == work->row_serial) {
            continue;
        }
        work->listed[node] = work->row_serial;
        work->near_begin[node] = (int32_t)work->near.count;
        if (first < last) {
            struct row_view row = view_row(reach, node, work);
            RETURN_IF_ERROR(index_list_reserve(&work->near, last - first + 1, error));
            work->near.count += list_passing(reach, first, last, &row, work->near.index + work->near.count);
        }
        work->near_end[node] = (int32_t)work->near.count;
    }
    return STATUS_OK;
}

void reach_begin_row(const struct reach *reach, const double *x, int64_t count, struct reach_work *work)
{
    int dim = reach->cells.dim;
    if (++work->row_serial == UINT32_MAX) {
        memset(work->listed, 0, (size_t)reach->cells.node_count * sizeof *work->listed);
        work->row_serial = 1;
    }
    work->near.count = 0;
    work->row_radius = 0.0;
    for (int a = 0; a < dim; a++) {
        work->row_middle[a] = 0.0;
        for (int64_t i = 0; i < count; i++) {
            work->row_middle[a] += x[i * dim + a] / (double)count;
        }
    }
    for (int64_t i = 0; i < count; i++) {
        work->row_radius = fmax(work->row_radius, vector_distance(dim, work->row_middle, x + i * dim));
    }
}

enum status reach_begin(const struct reach *reach, const struct reach_places *places, int64_t p,
                        const double *x, struct reach_work *work, struct error *error)
{
    RETURN_IF_ERROR(reach_work_reserve(reach, work, error));
    if (++work->serial >= UINT32_MAX / 2) {
        memset(work->mark, 0, (size_t)reach->cells.node_count * sizeof *work->mark);
        work->serial = 1;
    }
    work->x = x;
    work->outside = false;
    memcpy(work->from, x, (size_t)reach->cells.dim * sizeof *x);
    work->cell_count = -1;
    if (places->nodes) {
        int64_t node = places->node != NULL ? places->node[p] : p;
        work->cell = reach->star + reach->star_ptr[node];
        work->cell_count = reach->star_ptr[node + 1] - reach->star_ptr[node];
    } else if (places->cell != NULL) {
        work->cell = reach_places_cells(places, p, &work->cell_count);
        work->cell_count = work->cell_count > 0 && work->cell[0] >= 0 ? work->cell_count : -1;
    }
    int64_t first = p, row = p, points = 1;
    if (!places->nodes && places->cell != NULL) {
        row = reach_places_row(places, p, &first);
        points = places->long_rows == 0 || row < places->long_rows ? places->points_per_row : 1;
    }
    if (points == 1 || work->row != row || work->row_serial == 0) {
        work->row = row;
        reach_begin_row(reach, x - (p - first) * reach->cells.dim, points, work);
    }
    return STATUS_OK;
}

/* Mark the candidates that are out of sight; *hidden counts them. A node checked before keeps its mark. */
static enum status mark_hidden(const struct reach *reach, double widen, const int32_t *index, int64_t count,
                               struct reach_work *work, int64_t *hidden, struct error *error)
{
    *hidden = 0;
    for (int64_t i = 0; i < count && work->cell_count < 0; i++) {
        if (widen > 1.0 || reach->opposing_ptr[index[i]] < reach->opposing_ptr[index[i] + 1]) {
            RETURN_IF_ERROR(reach_locate(reach, work->x, work, error));
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
            RETURN_IF_ERROR((by_facets ? reach_sees : reach_walk)(
                reach, work->from, work->cell, work->cell_count, node, work, &seen, error));
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
    if (*count > work->capacity) {
        free(work->image);
        work->capacity = 0;
        RETURN_IF_ERROR(NEW_ARRAY(&work->image, 2 * *count * dim, error));
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

enum status reach_filter(const struct reach *reach, double widen, int32_t *index, int64_t *count,
                         struct reach_work *work, struct error *error)
{
    work->around = 0;
    RETURN_IF_ERROR(mark_hidden(reach, widen, index, *count, work, &work->changed, error));
    if (work->changed > 0) {
        RETURN_IF_ERROR(reach_paths(reach, widen, index, *count, work, error));
        RETURN_IF_ERROR(keep(reach, widen, index, count, work, error));
    }
    return STATUS_OK;
}

void reach_free(struct reach *reach)
{
    free(reach->across);
    free(reach->star_ptr);
    free(reach->star);
    free(reach->facet);
    free(reach->opposing_ptr);
    free(reach->opposing);
    for (int a = 0; a < 8; a++) {
        free(reach->opposing_view[a]);
    }
    free(reach->corner);
    free(reach->edge_ptr);
    free(reach->edge);
    free(reach->seen_ptr);
    free(reach->seen);
    free(reach->seen_length);
    *reach = (struct reach){0};
}
