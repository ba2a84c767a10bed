#include "approx/adaptive/adaptive.h"

#include "approx/cells/quadrature.h"
#include "approx/field/field.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* A subcell. */
struct leaf {
    int32_t cell;
    int32_t level;
    bool measured, split;
    double change;     /* |K by the rule - K by the rule on its children|, Frobenius */
    double vertex[12]; /* (dim + 1) * dim */
};

/* The refinement, and its subcells in order of the cells, within a cell in order of the subdivision. */
struct refinement {
    const struct adaptive_options *options;
    struct visibility space;
    struct quadrature_rule rule;
    double *norm; /* |K| of each cell, by the rule on the whole cell */
    int64_t count;
    struct leaf *leaf; /* count */
};

static void refinement_free(struct refinement *refinement)
{
    visibility_free(&refinement->space);
    FREE_ALL(refinement->norm, refinement->leaf);
}

/* Number of subcells that are measured at once. It bounds the memory and does not affect the result. */
#define BATCH_LEAVES 256

/* A child by pairs of vertices of its parent: its vertices are their midpoints, or the vertex where both are
 * the same. The octahedron within a tetrahedron is cut along the edge 02-13 (Bey 1995), which keeps the
 * children of children well shaped. */
static const uint8_t triangle_children[4][3][2] = {
    {{0, 0}, {0, 1}, {0, 2}}, {{0, 1}, {1, 1}, {1, 2}}, {{0, 2}, {1, 2}, {2, 2}}, {{0, 1}, {1, 2}, {0, 2}}};
static const uint8_t tetrahedron_children[8][4][2] = {
    {{0, 0}, {0, 1}, {0, 2}, {0, 3}}, {{0, 1}, {1, 1}, {1, 2}, {1, 3}}, {{0, 2}, {1, 2}, {2, 2}, {2, 3}},
    {{0, 3}, {1, 3}, {2, 3}, {3, 3}}, {{0, 1}, {0, 2}, {0, 3}, {1, 3}}, {{0, 1}, {0, 2}, {1, 2}, {1, 3}},
    {{0, 2}, {0, 3}, {1, 3}, {2, 3}}, {{0, 2}, {1, 2}, {1, 3}, {2, 3}}};

/* The vertices of a subcell, as nodes of itself. */
static const int32_t in_order[] = {0, 1, 2, 3};

/* Children of a subcell: 4 triangles or 8 tetrahedra of equal volume. */
static int children_of(int dim)
{
    return dim == 2 ? 4 : 8;
}

/* of_child[(dim + 1) * dim]: the vertices of one child. */
static void place_child(int dim, const double *vertex, int child, double *of_child)
{
    for (int k = 0; k <= dim; k++) {
        const uint8_t *pair = dim == 2 ? triangle_children[child][k] : tetrahedron_children[child][k];
        for (int a = 0; a < dim; a++) {
            of_child[k * dim + a] = 0.5 * (vertex[pair[0] * dim + a] + vertex[pair[1] * dim + a]);
        }
    }
}

/* The shape functions at the points of each subcell's own rule, then of its children's. */
static enum status sample_leaves(const struct refinement *refinement, struct leaf *const *leaf, int64_t count,
                                 struct field_table *sample, struct error *error)
{
    const struct support_options *support = &refinement->options->support;
    const struct field_shapes shapes = {.support = *support, .shapes = support->mls};
    int dim = refinement->space.cells.dim, rules = 1 + children_of(dim);
    int64_t per_rule = refinement->rule.points, per_leaf = per_rule * rules;
    int32_t cell[BATCH_LEAVES];
    NEW_SCRATCH(double, x, count * per_leaf * dim, error);
    for (int64_t i = 0; i < count * rules; i++) {
        double vertex[12];
        int child = (int)(i % rules) - 1;
        const struct leaf *own = leaf[i / rules];
        cell[i / rules] = own->cell;
        if (child >= 0) {
            place_child(dim, own->vertex, child, vertex);
        }
        quadrature_positions(&refinement->rule, dim, child >= 0 ? vertex : own->vertex, in_order,
                             x + i * per_rule * dim);
    }
    struct visibility_places places = {.cell = cell, .points_per_row = per_leaf};
    return field_table_at(&shapes, &refinement->space, &places, count * per_leaf, x, "adaptive points", true,
                          sample, error);
}

/* matrix (n x n, lower half) += factor G G^T. Row i of G belongs to row place[i] of the matrix. */
static void add_products(int dim, const double *gradient, const int32_t *place, int64_t count, int64_t n,
                         double factor, double *matrix)
{
    for (int64_t i = 0; i < count; i++) {
        double *row = matrix + place[i] * n;
        double own[3] = {0.0, 0.0, 0.0};
        for (int a = 0; a < dim; a++) {
            own[a] = factor * gradient[i * dim + a];
        }
        for (int64_t k = 0; k <= i; k++) {
            double sum = vector_dot(dim, own, gradient + k * dim);
            row[place[k]] += sum;
        }
    }
}

/* Frobenius norm of a symmetric matrix from its lower half. */
static double norm_of(const double *matrix, int64_t n)
{
    double off = 0.0, diagonal = 0.0;
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++) {
            off += matrix[i * n + k] * matrix[i * n + k];
        }
        diagonal += matrix[i * n + i] * matrix[i * n + i];
    }
    return sqrt(2.0 * off + diagonal);
}

/* united[] = the union of the lists of the points [first, last), ascending; it has room for all of their
 * entries. */
static int64_t unite(const struct neighbours *lists, int64_t first, int64_t last, int64_t *united)
{
    int64_t count = 0;
    for (int64_t i = lists->ptr[first]; i < lists->ptr[last]; i++) {
        united[count++] = lists->idx[i];
    }
    return sort_distinct(count, united);
}

/* *norm = |K| by the rule on a subcell, *change = |K - K by the rule on its children|. */
static enum status measure(const struct refinement *refinement, const struct field_table *sample,
                           int64_t leaf, double volume, double *norm, double *change, struct error *error)
{
    const struct neighbours *lists = &sample->lists;
    int dim = refinement->space.cells.dim, per_rule = refinement->rule.points;
    int64_t per_leaf = per_rule * (1 + children_of(dim)), first = leaf * per_leaf, last = first + per_leaf;
    int64_t pairs = lists->ptr[last] - lists->ptr[first];
    NEW_SCRATCH(int64_t, united, pairs, error);
    NEW_SCRATCH(int32_t, place, pairs, error);
    int64_t n = unite(lists, first, last, united);
    NEW_SCRATCH(double, matrix, n * n, error);
    for (int64_t p = first; p < last; p++) {
        int64_t at = lists->ptr[p], count = lists->ptr[p + 1] - at;
        double weight = volume * refinement->rule.weight[(p - first) % per_rule];
        bool own = p - first < per_rule;
        if (p - first == per_rule) {
            *norm = norm_of(matrix, n);
        }
        for (int64_t i = 0; i < count; i++) {
            place[i] = (int32_t)first_from(united, 0, n, lists->idx[at + i]);
        }
        add_products(dim, sample->dphi + at * dim, place, count, n, own ? weight : -weight / children_of(dim),
                     matrix);
    }
    *change = norm_of(matrix, n);
    return STATUS_OK;
}

/* Measure one batch of subcells. */
static enum status measure_batch(struct refinement *refinement, struct leaf *const *leaf, int64_t count,
                                 struct error *error)
{
    struct first_failure failure = {STATUS_OK};
    FREED_BY(field_table_free) struct field_table sample = {0};
    RETURN_IF_ERROR(sample_leaves(refinement, leaf, count, &sample, error));
#pragma omp parallel for schedule(dynamic, 4)
    for (int64_t l = 0; l < count; l++) {
        struct error own;
        double norm = 0.0;
        double volume = ldexp(cell_volume(&refinement->space.cells, leaf[l]->cell),
                              -refinement->space.cells.dim * leaf[l]->level);
        note_failure(&failure, l, measure(refinement, &sample, l, volume, &norm, &leaf[l]->change, &own),
                     &own, error);
        if (leaf[l]->level == 0) {
            refinement->norm[leaf[l]->cell] = norm;
        }
        leaf[l]->measured = true;
    }
    return failure.status;
}

/* Measure the subcells that have not been measured; those of level 0 also set the norm of their cell. */
static enum status measure_new(struct refinement *refinement, struct error *error)
{
    struct leaf *batch[BATCH_LEAVES];
    int64_t count = 0;
    for (int64_t l = 0; l < refinement->count; l++) {
        if (!refinement->leaf[l].measured) {
            batch[count++] = &refinement->leaf[l];
        }
        if (count == BATCH_LEAVES || (count > 0 && l == refinement->count - 1)) {
            RETURN_IF_ERROR(measure_batch(refinement, batch, count, error));
            count = 0;
        }
    }
    return STATUS_OK;
}

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
    NEW_SCRATCH(struct leaf *, order, count, error);
    *unresolved = false;
    for (int64_t l = 0; l < count; l++) {
        order[l] = &leaf[l];
        sum += leaf[l].change;
    }
    if (sum <= options->tolerance * norm) {
        return STATUS_OK;
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
    return STATUS_OK;
}

/* Replace the marked subcells by their children. */
static enum status split(struct refinement *refinement, int64_t marked, struct error *error)
{
    int dim = refinement->space.cells.dim, children = children_of(dim);
    int64_t count = refinement->count + marked * (children - 1);
    struct leaf *next;
    RETURN_IF_ERROR(NEW_ARRAY(&next, count, error));
    struct leaf *at = next;
    for (int64_t l = 0; l < refinement->count; l++) {
        const struct leaf *leaf = &refinement->leaf[l];
        if (!leaf->split) {
            *at++ = *leaf;
            continue;
        }
        for (int child = 0; child < children; child++, at++) {
            *at = (struct leaf){.cell = leaf->cell, .level = leaf->level + 1};
            place_child(dim, leaf->vertex, child, at->vertex);
        }
    }
    free(refinement->leaf);
    refinement->leaf = next;
    refinement->count = count;
    return STATUS_OK;
}

/* One subcell for each cell. */
static enum status start(const struct cells *cells, struct refinement *refinement, struct error *error)
{
    int dim = cells->dim, vertices = dim + 1;
    RETURN_IF_ERROR(NEW_ARRAY(&refinement->leaf, cells->count, error));
    refinement->count = cells->count;
    for (int64_t c = 0; c < cells->count; c++) {
        struct leaf *leaf = &refinement->leaf[c];
        leaf->cell = (int32_t)c;
        for (int i = 0; i < vertices * dim; i++) {
            leaf->vertex[i] = cells->x[(int64_t)cells->node[c * vertices + i / dim] * dim + i % dim];
        }
    }
    return STATUS_OK;
}

/* Mark the subcells to be split in all cells. */
static enum status mark(const struct refinement *refinement, int64_t *marked, int64_t *unresolved,
                        struct error *error)
{
    *marked = *unresolved = 0;
    for (int64_t begin = 0, end = 0; begin < refinement->count; begin = end) {
        bool stuck;
        int32_t cell = refinement->leaf[begin].cell;
        while (end < refinement->count && refinement->leaf[end].cell == cell) {
            end++;
        }
        RETURN_IF_ERROR(mark_cell(refinement->options, refinement->leaf + begin, end - begin,
                                  refinement->norm[cell], marked, &stuck, error));
        *unresolved += stuck;
    }
    return STATUS_OK;
}

/* Place the rule's points in all subcells. */
static enum status place_points(const struct refinement *refinement, struct adaptive_points *points,
                                struct error *error)
{
    const struct quadrature_rule *rule = &refinement->rule;
    int dim = refinement->space.cells.dim;
    points->count = refinement->count * rule->points;
    if (points->count > INT32_MAX) {
        return fail(error, STATUS_INPUT,
                    "%lld adaptive points: more than 2^31 - 1: a larger tolerance or fewer "
                    "levels are needed",
                    (long long)points->count);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&points->x, points->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->weight, points->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->cell, points->count, error));
    for (int64_t l = 0; l < refinement->count; l++) {
        const struct leaf *leaf = &refinement->leaf[l];
        int64_t first = l * rule->points;
        double volume = ldexp(cell_volume(&refinement->space.cells, leaf->cell), -dim * leaf->level);
        quadrature_positions(rule, dim, leaf->vertex, in_order, points->x + first * dim);
        for (int q = 0; q < rule->points; q++) {
            points->weight[first + q] = rule->weight[q] * volume;
            points->cell[first + q] = leaf->cell;
        }
    }
    return STATUS_OK;
}

enum status adaptive_points_build(const struct adaptive_options *options, const struct cells *cells,
                                  struct supports supports, struct adaptive_points *points,
                                  struct error *error)
{
    FREED_BY(refinement_free) struct refinement refinement = {.options = options};
    int64_t marked;
    *points = (struct adaptive_points){0};
    RETURN_IF_ERROR(quadrature_cell_rule(cells->dim, options->rule_points, &refinement.rule, error));
    RETURN_IF_ERROR(visibility_build(cells, supports, options->support.visibility, options->support.side,
                                     &refinement.space, error));
    RETURN_IF_ERROR(NEW_ARRAY(&refinement.norm, cells->count, error));
    RETURN_IF_ERROR(start(cells, &refinement, error));
    do {
        RETURN_IF_ERROR(measure_new(&refinement, error));
        RETURN_IF_ERROR(mark(&refinement, &marked, &points->unresolved, error));
        RETURN_IF_ERROR(split(&refinement, marked, error));
    } while (marked > 0);
    return place_points(&refinement, points, error);
}

void adaptive_points_free(struct adaptive_points *points)
{
    FREE_ALL(points->x, points->weight, points->cell);
    *points = (struct adaptive_points){0};
}
