#include "approx/adaptive/adaptive_measure.h"

#include "approx/shape/shape.h"
#include "approx/points/sorted.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

int adaptive_children(int dim)
{
    return dim == 2 ? 4 : 8;
}

void adaptive_child(int dim, const double *vertex, int child, double *of_child)
{
    for (int k = 0; k <= dim; k++) {
        const uint8_t *pair = dim == 2 ? triangle_children[child][k] : tetrahedron_children[child][k];
        for (int a = 0; a < dim; a++) {
            of_child[k * dim + a] = 0.5 * (vertex[pair[0] * dim + a] + vertex[pair[1] * dim + a]);
        }
    }
}

void adaptive_positions(const struct quadrature_rule *rule, int dim, const double *vertex, double *x)
{
    static const int32_t corner[] = {0, 1, 2, 3};
    quadrature_positions(rule, dim, vertex, corner, x);
}

/* Points of a subcell's own rule and of its children's, with their signs in the difference. */
struct sample {
    int64_t per_leaf;
    int32_t cell[BATCH_LEAVES];
    double *x;
    struct support_lists lists;
    double *phi, *dphi;
};

static void sample_free(struct sample *sample)
{
    free(sample->x);
    support_free(&sample->lists);
    FREE_ALL(sample->phi, sample->dphi);
}

static enum status sample_leaves(const struct refinement *refinement, struct leaf *const *leaf, int64_t count,
                                 struct sample *sample, struct error *error)
{
    const struct cells *cells = refinement->cells;
    const struct mls *mls = &refinement->options->support.mls;
    int dim = cells->dim, per_rule = refinement->rule.points;
    sample->per_leaf = per_rule * (1 + adaptive_children(dim));
    int64_t points = count * sample->per_leaf;
    RETURN_IF_ERROR(NEW_ARRAY(&sample->x, points * dim, error));
    double *x = sample->x;
    for (int64_t l = 0; l < count; l++) {
        sample->cell[l] = leaf[l]->cell;
        adaptive_positions(&refinement->rule, dim, leaf[l]->vertex, x);
        x += per_rule * dim;
        for (int child = 0; child < adaptive_children(dim); child++) {
            double vertex[12];
            adaptive_child(dim, leaf[l]->vertex, child, vertex);
            adaptive_positions(&refinement->rule, dim, vertex, x);
            x += per_rule * dim;
        }
    }
    struct visibility_places places = {.cell = sample->cell, .points_per_row = sample->per_leaf};
    RETURN_IF_ERROR(support_build(&refinement->options->support, &refinement->space, &places, points,
                                  sample->x, "adaptive points", &sample->lists, error));
    int64_t pairs = sample->lists.ptr[points];
    RETURN_IF_ERROR(NEW_ARRAY(&sample->phi, pairs, error));
    RETURN_IF_ERROR(NEW_ARRAY(&sample->dphi, pairs * dim, error));
    struct neighbours lists = support_view(&sample->lists);
    return shape_table(mls, cells->x, refinement->radius, &lists, sample->x, "adaptive points", sample->phi,
                       sample->dphi, error);
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

/* united[] = the union of the lists of the points [first, last); it has room for all of their entries. */
static int64_t unite(const struct support_lists *lists, int64_t first, int64_t last, int32_t *united,
                     int32_t *scratch)
{
    int64_t count = 0;
    for (int64_t p = first; p < last; p++) {
        memcpy(scratch, united, (size_t)count * sizeof *united);
        count = sorted_union(scratch, count, lists->idx + lists->ptr[p], lists->ptr[p + 1] - lists->ptr[p],
                             united);
    }
    return count;
}

/* *norm = |K| by the rule on a subcell, *change = |K - K by the rule on its children|. */
static enum status measure(const struct refinement *refinement, const struct sample *sample, int64_t leaf,
                           double volume, double *norm, double *change, struct error *error)
{
    const struct support_lists *lists = &sample->lists;
    int dim = refinement->cells->dim, per_rule = refinement->rule.points;
    int64_t first = leaf * sample->per_leaf, last = first + sample->per_leaf;
    int64_t pairs = lists->ptr[last] - lists->ptr[first];
    NEW_SCRATCH(int32_t, united, pairs, error);
    NEW_SCRATCH(int32_t, place, pairs, error);
    int64_t n = unite(lists, first, last, united, place);
    NEW_SCRATCH(double, matrix, n * n, error);
    for (int64_t p = first; p < last; p++) {
        int64_t at = lists->ptr[p], count = lists->ptr[p + 1] - at;
        double weight = volume * refinement->rule.weight[(p - first) % per_rule];
        bool own = p - first < per_rule;
        if (p - first == per_rule) {
            *norm = norm_of(matrix, n);
        }
        sorted_places(lists->idx + at, count, united, place);
        add_products(dim, sample->dphi + at * dim, place, count, n,
                     own ? weight : -weight / adaptive_children(dim), matrix);
    }
    *change = norm_of(matrix, n);
    return STATUS_OK;
}

/* Measure one batch of subcells. */
static enum status measure_batch(struct refinement *refinement, struct leaf *const *leaf, int64_t count,
                                 struct error *error)
{
    struct first_failure failure = {STATUS_OK};
    FREED_BY(sample_free) struct sample sample = {0};
    RETURN_IF_ERROR(sample_leaves(refinement, leaf, count, &sample, error));
#pragma omp parallel for schedule(dynamic, 4)
    for (int64_t l = 0; l < count; l++) {
        struct error own;
        double norm = 0.0;
        double volume =
            ldexp(cell_volume(refinement->cells, leaf[l]->cell), -refinement->cells->dim * leaf[l]->level);
        note_failure(&failure, l, measure(refinement, &sample, l, volume, &norm, &leaf[l]->change, &own),
                     &own, error);
        if (leaf[l]->level == 0) {
            refinement->norm[leaf[l]->cell] = norm;
        }
        leaf[l]->measured = true;
    }
    return failure.status;
}

enum status adaptive_measure(struct refinement *refinement, struct leaves *leaves, struct error *error)
{
    struct leaf *batch[BATCH_LEAVES];
    int64_t count = 0;
    for (int64_t l = 0; l < leaves->count; l++) {
        if (!leaves->leaf[l].measured) {
            batch[count++] = &leaves->leaf[l];
        }
        if (count == BATCH_LEAVES || (count > 0 && l == leaves->count - 1)) {
            RETURN_IF_ERROR(measure_batch(refinement, batch, count, error));
            count = 0;
        }
    }
    return STATUS_OK;
}
