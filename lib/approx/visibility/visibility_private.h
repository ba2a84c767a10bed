/* Parts of visibility.c; private to lib/approx. */
#pragma once

#include "approx/visibility/visibility.h"
#include "base/round_off.h"
#include "base/vector.h"

/* A list of pairs (row, value), from which a CSR is made. */
struct pair_list {
    int64_t count, row_capacity, capacity;
    int32_t *row, *value;
};
/* Make room for `more` pairs; add one pair if there is room. */
MUST_CHECK enum status pair_list_reserve(struct pair_list *pairs, int64_t more, struct error *error);
static inline void pair_list_add(struct pair_list *pairs, int32_t row, int32_t value)
{
    pairs->row[pairs->count] = row;
    pairs->value[pairs->count++] = value;
}
/* Append the pairs of another list. */
MUST_CHECK enum status pair_list_append(struct pair_list *pairs, const struct pair_list *more,
                                        struct error *error);
/* (*ptr)[rows + 1], (*idx)[]: the values of each row, in the order of the list. */
MUST_CHECK enum status pair_list_file(const struct pair_list *pairs, int64_t rows, int64_t **ptr,
                                      int32_t **idx, struct error *error);
void pair_list_free(struct pair_list *pairs);

/* *arrives: whether the segment from x to a node can be followed through faces of cells, starting in one of
 * the given cells, which contain x. With node = -1, work->visited receives the cells around x that are
 * connected by faces. */
MUST_CHECK enum status visibility_walk(const struct visibility *visibility, const double *x,
                                       const int32_t *cell, int64_t cell_count, int32_t node,
                                       struct visibility_work *work, bool *arrives, struct error *error);

/* Mark the nodes nearer than their radius that are hidden from the current point p: by the facets, or, where
 * these do not decide, by following the segment through the cells. *hidden: their number. */
MUST_CHECK enum status visibility_mark_shadows(const struct visibility *visibility,
                                               const struct visibility_shadows *shadows, int64_t p,
                                               struct visibility_work *work, int64_t *hidden,
                                               struct error *error);

/* Set the cells of `work` to those that contain x, or else to the nearest one and work->from to the nearest
 * place in it. Only cells at nodes whose supports contain x are searched; without such nodes there is no
 * cell. */
MUST_CHECK enum status visibility_locate(const struct visibility *visibility, const double *x,
                                         struct visibility_work *work, struct error *error);

/* Find the paths around corners from the point of `work` to the hidden nodes of index[count]: lengths below
 * `widen` times the radius, and previous nodes. */
MUST_CHECK enum status visibility_paths(const struct visibility *visibility, double widen,
                                        const int32_t *index, int64_t count, struct visibility_work *work,
                                        struct error *error);

/* The place of the first bend of the path to a hidden node, and the length of the path, in 3D shortened by
 * sliding its bends along re-entrant edges. */
void visibility_first_bend(const struct visibility *visibility, int32_t node,
                           const struct visibility_work *work, double *bend, double *length);

/* Allocate the scratch arrays over the nodes. */
MUST_CHECK enum status visibility_work_reserve(const struct visibility *visibility,
                                               struct visibility_work *work, struct error *error);

/* How far x is above the plane of a facet, m. */
static inline double visibility_height_above(int dim, const struct visibility_facet *facet, const double *x)
{
    return vector_dot(dim, facet->normal, x) - facet->offset;
}

static inline bool visibility_is_hidden(const struct visibility_work *work, int32_t node)
{
    return work->mark[node] == 2 * work->serial + 1;
}
