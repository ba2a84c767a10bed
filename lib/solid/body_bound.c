/* The bound of the diagonal of the stiffness: body_diagonal. */
#include "base/memory.h"
#include "solid/stress.h"

#include <math.h>
#include <string.h>

/* Each part of the blocks has sums of its own, so that there are few, whatever the number of threads; fewer
 * blocks than that are one part. */
enum { MOST_PARTS = 4, LEAST_BLOCKS = 50 };

enum status body_make_bounds(struct body *body, struct error *error)
{
    int64_t least = body->block_count / MOST_PARTS;
    body->bound_parts = chunks_of(body->block_count, least > LEAST_BLOCKS ? least : LEAST_BLOCKS);
    return NEW_ARRAY(&body->bound, (body->bound_parts.count - 1) * body->node_count, error);
}

/* Along the gradient g of a shape function the energy of a point has the second derivative g A g, and that of
 * the stabilisation of its smoothing, bounded by twice its stiffness. */
struct bound {
    double A[9], smoothing;
};

static struct bound bound_at(const struct body *body, int64_t q, const double *F)
{
    static const double at_rest[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const struct material *material = &body->materials[body->material[q]];
    struct bound bound = {.smoothing = 0.0};
    double C[9], I1 = 0.0;
    double J = determinant(F);
    if (!(J > 0.0 && isfinite(J))) { /* as at rest: its bounds stay positive until the run is told */
        J = 1.0;
        F = at_rest;
    }
    cofactor(F, C);
    for (int k = 0; k < 9; k++) {
        I1 += F[k] * F[k];
    }
    double shear = body->weight[q] * material->shear_modulus / cbrt(J * J);
    double bulk = material->bulk_modulus;
    if (body->averaged) {
        bulk = fmin(bulk, body->volumes.pressures.most * material->shear_modulus);
    }
    double along = body->weight[q] * bulk + 5.0 / 9.0 * I1 * shear / (J * J);
    /* along |J F^-T g|^2 - shear |g|^2 / 3 = g A g */
    for (int k = 0; k < 9; k++) {
        int a = k / 3, b = k % 3;
        bound.A[k] =
            along * (C[a] * C[b] + C[3 + a] * C[3 + b] + C[6 + a] * C[6 + b]) - (a == b ? shear / 3.0 : 0.0);
    }
    if (body->conforming) {
        bound.smoothing = 2.0 * body->weight[q] * SMOOTHING_STIFFNESS(body->dim) * material->shear_modulus;
    }
    return bound;
}

static void add_point(const struct body *body, int64_t q, const double F[9], double J, void *context)
{
    (void)J; /* of cells not det F */
    double *of_node = context;
    struct bound bound = bound_at(body, q, F);
    double sum[64];
    int64_t row = body->order[q], end = body->ptr[row + 1];
    for (int64_t i = body->ptr[row]; i < end; i += 64) {
        int64_t count = end - i < 64 ? end - i : 64;
        body->kernels->bounds(body->dphi + i * body->dim, count, bound.A, bound.smoothing, sum);
        for (int64_t k = 0; k < count; k++) {
            of_node[body->idx[i + k]] += sum[k];
        }
    }
}

/* The same for parameters that are values at the nodes, whose functions are about the hat functions of a
 * cell. */
static void add_cell(const struct body *body, int64_t q, const double F[9], double J, void *context)
{
    (void)J;
    double *of_node = context;
    struct bound bound = bound_at(body, q, F);
    double gradient[12] = {0.0}, sum[4];
    int dim = body->dim;
    for (int k = 1; k <= dim; k++) {
        for (int b = 0; b < dim; b++) {
            gradient[k * dim + b] = body->cells.hat[((k - 1) * dim + b) * body->point_count + q];
            gradient[b] -= gradient[k * dim + b];
        }
    }
    body->kernels->bounds(gradient, dim + 1, bound.A, bound.smoothing, sum);
    for (int k = 0; k <= dim; k++) {
        of_node[body->cells.cell_node[body->order[q] * (dim + 1) + k]] += sum[k];
    }
}

static void sum_bounds(struct body *body, body_visitor *add, double *stiffness)
{
    const struct chunks *parts = &body->bound_parts;
#pragma omp parallel num_threads(parts->threads)
    {
#pragma omp for schedule(static)
        for (int64_t p = 0; p < parts->count; p++) {
            double *sum = p == 0 ? stiffness : body->bound + (p - 1) * body->node_count;
            memset(sum, 0, (size_t)body->node_count * sizeof *sum);
            body_visit(body, chunks_begin(parts, p), chunks_begin(parts, p + 1), add, sum);
        }
#pragma omp for schedule(static)
        for (int64_t n = 0; n < body->node_count; n++) {
            for (int64_t p = 1; p < parts->count; p++) {
                stiffness[n] += body->bound[(p - 1) * body->node_count + n];
            }
        }
    }
}

void body_diagonal(struct body *body, double *stiffness)
{
    sum_bounds(body, add_point, stiffness);
}

void body_nodal_diagonal(struct body *body, double *stiffness)
{
    sum_bounds(body, add_cell, stiffness);
}
