#include "approx/adaptive/adaptive.h"

#include "approx/adaptive/adaptive_measure.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Share of the tolerance for the changes of the subcells that are kept; the rest is for those that are
 * split. */
static const double kept_share = 0.5;

struct adaptive_options adaptive_defaults(int dim)
{
    return (struct adaptive_options){.tolerance = 1e-2,
                                     .levels = dim == 2 ? 4 : 3,
                                     .rule_points = dim == 2 ? 3 : 4,
                                     .support = support_defaults(dim)};
}

static int by_change(const void *a, const void *b)
{
    const struct leaf *x = *(struct leaf *const *)a, *y = *(struct leaf *const *)b;
    if (x->change != y->change) {
        return x->change < y->change ? -1 : 1;
    }
    return (x > y) - (x < y);
}

/* Mark the subcells of one cell to be split: none if the sum of their changes is within the tolerance; else
 * all but those of least change. *unresolved: the sum is too large, but all subcells are at the last
 * level. */
static enum status mark_cell(const struct adaptive_options *options, struct leaf *leaf, int64_t count,
                             double norm, int64_t *marked, bool *unresolved, struct error *error)
{
    double sum = 0.0;
    struct leaf **order = NULL;
    enum status status = NEW_ARRAY(&order, count, error);
    *unresolved = false;
    for (int64_t l = 0; status == STATUS_OK && l < count; l++) {
        order[l] = &leaf[l];
        sum += leaf[l].change;
    }
    if (status != STATUS_OK || sum <= options->tolerance * norm) {
        free(order);
        return status;
    }
    qsort(order, (size_t)count, sizeof *order, by_change);
    sum = 0.0;
    *unresolved = true;
    for (int64_t l = 0; l < count; l++) {
        if (order[l]->level < options->levels) {
            sum += order[l]->change;
            order[l]->split = sum > kept_share * options->tolerance * norm;
            *marked += order[l]->split;
            *unresolved = *unresolved && !order[l]->split;
        }
    }
    free(order);
    return status;
}

/* Replace the marked subcells by their children. */
static enum status split(int dim, int64_t marked, struct leaves *leaves, struct error *error)
{
    if (marked == 0) {
        return STATUS_OK;
    }
    int children = adaptive_children(dim);
    int64_t count = leaves->count + marked * (children - 1);
    struct leaf *next = array_new(count, sizeof *next);
    if (next == NULL) {
        return fail_memory(error, "subcells");
    }
    struct leaf *at = next;
    for (int64_t l = 0; l < leaves->count; l++) {
        const struct leaf *leaf = &leaves->leaf[l];
        if (!leaf->split) {
            *at++ = *leaf;
            continue;
        }
        for (int child = 0; child < children; child++, at++) {
            *at = (struct leaf){.cell = leaf->cell, .level = leaf->level + 1};
            adaptive_child(dim, leaf->vertex, child, at->vertex);
        }
    }
    free(leaves->leaf);
    leaves->leaf = next;
    leaves->count = count;
    return STATUS_OK;
}

/* One subcell for each cell. */
static enum status start(const struct cells *cells, struct leaves *leaves, struct error *error)
{
    int dim = cells->dim, vertices = dim + 1;
    enum status status = NEW_ARRAY(&leaves->leaf, cells->count, error);
    leaves->count = cells->count;
    for (int64_t c = 0; status == STATUS_OK && c < cells->count; c++) {
        struct leaf *leaf = &leaves->leaf[c];
        leaf->cell = (int32_t)c;
        for (int i = 0; i < vertices * dim; i++) {
            leaf->vertex[i] = cells->x[(int64_t)cells->node[c * vertices + i / dim] * dim + i % dim];
        }
    }
    return status;
}

/* Mark the subcells to be split in all cells. */
static enum status mark(const struct refinement *refinement, const struct leaves *leaves, int64_t *marked,
                        int64_t *unresolved, struct error *error)
{
    *marked = *unresolved = 0;
    for (int64_t begin = 0, end = 0; begin < leaves->count; begin = end) {
        bool stuck;
        int32_t cell = leaves->leaf[begin].cell;
        while (end < leaves->count && leaves->leaf[end].cell == cell) {
            end++;
        }
        RETURN_IF_ERROR(mark_cell(refinement->options, leaves->leaf + begin, end - begin,
                                  refinement->norm[cell], marked, &stuck, error));
        *unresolved += stuck;
    }
    return STATUS_OK;
}

/* Place the rule's points in all subcells. */
static enum status place_points(const struct refinement *refinement, const struct leaves *leaves,
                                struct adaptive_points *points, struct error *error)
{
    const struct quadrature_rule *rule = &refinement->rule;
    int dim = refinement->cells->dim;
    points->count = leaves->count * rule->points;
    if (points->count > INT32_MAX) {
        return fail(error, STATUS_INPUT,
                    "%lld adaptive points: more than 2^31 - 1: a larger tolerance or fewer "
                    "levels are needed",
                    (long long)points->count);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&points->x, points->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->weight, points->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->cell, points->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->level, points->count, error));
    for (int64_t l = 0; l < leaves->count; l++) {
        const struct leaf *leaf = &leaves->leaf[l];
        int64_t first = l * rule->points;
        double volume = ldexp(cell_volume(refinement->cells, leaf->cell), -dim * leaf->level);
        adaptive_positions(rule, dim, leaf->vertex, points->x + first * dim);
        for (int q = 0; q < rule->points; q++) {
            points->weight[first + q] = rule->weight[q] * volume;
            points->cell[first + q] = leaf->cell;
            points->level[first + q] = leaf->level;
        }
    }
    return STATUS_OK;
}

enum status adaptive_points_build(const struct adaptive_options *options, const struct cells *cells,
                                  const double *radius, struct adaptive_points *points, struct error *error)
{
    enum status status;
    struct refinement refinement = {.options = options, .cells = cells, .radius = radius};
    struct leaves leaves = {0};
    int64_t marked;
    *points = (struct adaptive_points){0};
    TRY(quadrature_cell_rule(cells->dim, options->rule_points, &refinement.rule, error));
    TRY(support_space_build(&options->support, cells, radius, &refinement.space, error));
    TRY(NEW_ARRAY(&refinement.norm, cells->count, error));
    TRY(start(cells, &leaves, error));
    do {
        TRY(adaptive_measure(&refinement, &leaves, error));
        TRY(mark(&refinement, &leaves, &marked, &points->unresolved, error));
        TRY(split(cells->dim, marked, &leaves, error));
    } while (marked > 0);
    TRY(place_points(&refinement, &leaves, points, error));
done:
    support_space_free(&refinement.space);
    FREE_ALL(refinement.norm, leaves.leaf);
    return status;
}

void adaptive_points_free(struct adaptive_points *points)
{
    FREE_ALL(points->x, points->weight, points->cell, points->level);
    *points = (struct adaptive_points){0};
}
