#include "approx/visibility/visibility_private.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

const char *const visibility_names[VISIBILITY_RULE_COUNT] = {"cells", "distance"};

enum status visibility_begin(const struct visibility *visibility, const struct visibility_places *places,
                             int64_t p, const double *x, struct visibility_work *work, struct error *error)
{
    RETURN_IF_ERROR(visibility_work_reserve(visibility, work, error));
    if (++work->serial >= UINT32_MAX / 2) {
        memset(work->mark, 0, (size_t)visibility->cells.node_count * sizeof *work->mark);
        work->serial = 1;
    }
    work->point = p;
    work->x = x;
    work->outside = false;
    memcpy(work->from, x, (size_t)visibility->cells.dim * sizeof *x);
    work->cell_count = work->node = -1;
    if (places->nodes) {
        work->node = places->node != NULL ? places->node[p] : p;
        work->cell = visibility->star + visibility->star_ptr[work->node];
        work->cell_count = visibility->star_ptr[work->node + 1] - visibility->star_ptr[work->node];
    } else if (places->cell != NULL) {
        work->cell = visibility_places_cells(places, p, &work->cell_count);
        work->cell_count = work->cell_count > 0 && work->cell[0] >= 0 ? work->cell_count : -1;
    }
    return STATUS_OK;
}

/* Mark the candidates that are hidden; *hidden: their number. A node that was checked keeps its mark. */
static enum status mark_hidden(const struct visibility *visibility, const struct visibility_shadows *shadows,
                               double widen, const int32_t *index, int64_t count,
                               struct visibility_work *work, int64_t *hidden, struct error *error)
{
    *hidden = 0;
    for (int64_t i = 0; i < count && work->cell_count < 0; i++) {
        if (widen > 1.0 || visibility->shadowed[index[i]]) {
            RETURN_IF_ERROR(visibility_locate(visibility, work->x, work, error));
        }
    }
    if (work->cell_count <= 0) {
        return STATUS_OK;
    }
    if (widen <= 1.0 && work->node >= 0) {
        *hidden = visibility->hidden_ptr[work->node + 1] - visibility->hidden_ptr[work->node];
        for (int64_t i = 0; i < *hidden; i++) {
            work->mark[visibility->hidden[visibility->hidden_ptr[work->node] + i]] = 2 * work->serial + 1;
        }
        return STATUS_OK;
    }
    if (widen <= 1.0 && !work->outside) {
        return visibility_mark_shadows(visibility, shadows, work->point, work, hidden, error);
    }
    for (int64_t i = 0; i < count; i++) {
        int32_t node = index[i];
        if (work->mark[node] / 2 != work->serial) {
            bool seen;
            RETURN_IF_ERROR(visibility_walk(visibility, work->from, work->cell, work->cell_count, node, work,
                                            &seen, error));
            work->mark[node] = 2 * work->serial + !seen;
        }
        *hidden += visibility_is_hidden(work, node);
    }
    return STATUS_OK;
}

/* Keep the neighbours whose paths are short enough, and set their images. */
static enum status keep(const struct visibility *visibility, double widen, int32_t *index, int64_t *count,
                        struct visibility_work *work, struct error *error)
{
    int dim = visibility->cells.dim;
    int64_t kept = 0;
    RETURN_IF_ERROR(GROW_ARRAY(&work->image, *count * dim, &work->image_room, error));
    for (int64_t i = 0; i < *count; i++) {
        int32_t node = index[i];
        double *image = work->image + kept * dim, bend[3], length;
        if (!visibility_is_hidden(work, node)) {
            vector_subtract(dim, visibility->cells.x + (int64_t)node * dim, work->x, image);
            index[kept++] = node;
            continue;
        }
        if (!(work->length[node] < INFINITY)) {
            continue;
        }
        visibility_first_bend(visibility, node, work, bend, &length);
        if (!(length < widen * visibility->grid->radius[node])) {
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

/* The connected body that the point is in; -1: several, or not known. */
static int32_t own_part(const struct visibility *visibility, const struct visibility_work *work)
{
    int corners = visibility->cells.dim + 1;
    int32_t part = -1;
    for (int64_t i = 0; i < work->cell_count * corners; i++) {
        int32_t of_node =
            visibility
                ->part[visibility->cells.node[(int64_t)work->cell[i / corners] * corners + i % corners]];
        if (of_node >= 0 && part >= 0 && of_node != part) {
            return -1;
        }
        part = of_node >= 0 ? of_node : part;
    }
    return part;
}

/* Leave the nodes of other bodies out. */
static enum status keep_body(const struct visibility *visibility, int32_t *index, int64_t *count,
                             struct visibility_work *work, struct error *error)
{
    int64_t kept = 0;
    RETURN_IF_ERROR(work->cell_count < 0 ? visibility_locate(visibility, work->x, work, error) : STATUS_OK);
    int32_t own = own_part(visibility, work);
    for (int64_t i = 0; i < *count && own >= 0; i++) {
        int32_t part = visibility->part[index[i]];
        if (part < 0 || part == own) {
            index[kept++] = index[i];
        }
    }
    *count = own >= 0 ? kept : *count;
    return STATUS_OK;
}

enum status visibility_filter(const struct visibility *visibility, const struct visibility_shadows *shadows,
                              double widen, int32_t *index, int64_t *count, struct visibility_work *work,
                              struct error *error)
{
    work->around = 0;
    if (visibility->part != NULL) {
        RETURN_IF_ERROR(keep_body(visibility, index, count, work, error));
    }
    RETURN_IF_ERROR(mark_hidden(visibility, shadows, widen, index, *count, work, &work->changed, error));
    if (work->changed > 0) {
        RETURN_IF_ERROR(visibility_paths(visibility, widen, index, *count, work, error));
        RETURN_IF_ERROR(keep(visibility, widen, index, count, work, error));
    }
    return STATUS_OK;
}

void visibility_free(struct visibility *visibility)
{
    FREE_ALL(visibility->across, visibility->part, visibility->star_ptr, visibility->star, visibility->facet,
             visibility->shadow, visibility->shadowed, visibility->corner, visibility->edge_ptr,
             visibility->edge, visibility->seen_ptr, visibility->seen, visibility->seen_length,
             visibility->hidden_ptr, visibility->hidden);
    *visibility = (struct visibility){0};
}
