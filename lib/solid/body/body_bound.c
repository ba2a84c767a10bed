/* The bound of the diagonal of the stiffness: body_diagonal. */
#include "base/memory.h"
#include "solid/body/stress.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Each part of the blocks has its own sums. The number of parts is small and independent of the number of
 * threads; with fewer blocks there is one part. */
enum { MOST_PARTS = 4, LEAST_BLOCKS = 50 };

/* Who has a block. */
static int owner_of_block(const struct body_share *share, int64_t block)
{
    return ranks_owner(share->ranks, share->block_first, block);
}

enum status body_make_bounds(struct body *body, struct error *error)
{
    int64_t least = body->block_count / MOST_PARTS;
    body->bound_parts = chunks_of(body->block_count, least > LEAST_BLOCKS ? least : LEAST_BLOCKS);
    RETURN_IF_ERROR(NEW_ARRAY(&body->bound, body->bound_parts.count * body->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->bound_work, MOST_PARTS, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->bound_first, ranks_count(body->share.ranks) + 1, error));
    for (int64_t p = 0; p < body->bound_parts.count; p++) {
        int64_t last = chunks_begin(&body->bound_parts, p + 1) - 1;
        for (int r = owner_of_block(&body->share, last); r < ranks_count(body->share.ranks); r++) {
            body->bound_first[r + 1] = p + 1;
        }
    }
    for (int64_t p = 0; p < body->bound_parts.count; p++) {
        RETURN_IF_ERROR(cell_functions_make(body, &body->bound_work[p], error));
    }
    return STATUS_OK;
}

void body_free_bounds(struct body *body)
{
    for (int p = 0; p < MOST_PARTS && body->bound_work != NULL; p++) {
        cell_functions_free(&body->bound_work[p]);
    }
    FREE_ALL(body->bound_work, body->bound_first, body->bound);
}

/* Along the gradient g of a shape function the energy of a point has the second derivative g A g, and that of
 * the variance's, bounded by twice that of the value at one vertex. */
struct bound {
    double A[9], smoothing;
};

/* The energy within a cell by mu / 2 |grad N_k|^2, per volume, where the field is one at vertex k and zero at
 * other vertices and on the edges. */
static double vertex_variance(int dim)
{
    return dim == 2 ? 1.0 : 0.6;
}

static const double at_rest[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};

static struct bound bound_at(const struct body *body, int64_t q, const double *F)
{
    const struct material *material = &body->materials[body->material[q]];
    struct bound bound = {.smoothing = 0.0};
    double C[9];
    double J = determinant(F);
    if (!(J > 0.0 &&
          isfinite(J))) { /* inverted: use F = I, so that the bounds stay positive until the run stops */
        J = 1.0;
        F = at_rest;
    }
    cofactor(F, C);
    double I1 = vector_dot(9, F, F);
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
    if (body->smoothed) {
        bound.smoothing = 2.0 * body->weight[q] * vertex_variance(body->dim) * material->shear_modulus;
    }
    return bound;
}

/* Where the bounds are summed. */
struct bound_sum {
    double *of_node;
    struct cell_functions *work;
    bool at_rest;
};

/* Add g A g, if positive, and smoothing |g|^2 of each gradient[count * dim]. */
static void add_functions(const struct body *body, const struct bound *bound, int64_t count,
                          const int32_t *node, const double *gradient, double *of_node)
{
    int dim = body->dim;
    for (int64_t i = 0; i < count; i++) {
        const double *g = gradient + i * dim;
        double along = 0.0;
        for (int a = 0; a < dim; a++) {
            along += g[a] * vector_dot(dim, bound->A + 3 * a, g);
        }
        of_node[node[i]] += fmax(along, 0.0) + bound->smoothing * vector_dot(dim, g, g);
    }
}

static void add_point(const struct body *body, int64_t q, const double F[9], double J, void *context)
{
    (void)J; /* of cells not det F */
    const struct bound_sum *to = context;
    struct cell_functions *work = to->work;
    struct bound bound = bound_at(body, q, F);
    if (body->smoothed) {
        cell_functions_list(body, q, work);
        add_functions(body, &bound, work->count, work->node, work->gradient, to->of_node);
        return;
    }
    const struct sparse *matrix = &body->rows.matrix; /* the rows of a point have the same nodes */
    int dim = body->dim;
    int64_t at = matrix->ptr[q * dim], count = matrix->ptr[q * dim + 1] - at;
    for (int64_t i = 0; i < count * dim; i++) {
        work->gradient[i] = matrix->value[at + i % dim * count + i / dim];
    }
    for (int64_t i = 0; i < count; i++) {
        work->node[i] = matrix->idx[at + i];
    }
    add_functions(body, &bound, count, work->node, work->gradient, to->of_node);
}

/* The same with the linear shape functions of the cell. */
static void add_cell(const struct body *body, int64_t q, const double F[9], double J, void *context)
{
    (void)J;
    const struct bound_sum *to = context;
    struct bound bound = bound_at(body, q, to->at_rest ? at_rest : F);
    cell_functions_list_linear(body, q, to->work);
    add_functions(body, &bound, to->work->count, to->work->node, to->work->gradient, to->of_node);
}

/* Add what the blocks of part p add that are this process's. */
static void add_part(struct body *body, int64_t p, body_visitor *add, bool rest)
{
    const struct body_share *share = &body->share;
    int64_t begin = chunks_begin(&body->bound_parts, p), end = chunks_begin(&body->bound_parts, p + 1);
    struct bound_sum to = {body->bound + p * body->node_count, &body->bound_work[p], rest};
    begin = begin > share->begin_block ? begin : share->begin_block;
    end = end < share->end_block ? end : share->end_block;
    body_visit(body, begin, end, add, &to);
}

/* The part that a block is in. */
static int64_t part_of(const struct chunks *parts, int64_t block)
{
    int64_t p = 0;
    while (chunks_begin(parts, p + 1) <= block) {
        p++;
    }
    return p;
}

/* A part whose blocks belong to several processes is passed from one to the next, so that it is summed in the
 * order of the blocks. Then all processes receive all parts. */
static void sum_parts_of_ranks(struct body *body, int64_t taken, body_visitor *add, bool rest)
{
    const struct body_share *share = &body->share;
    const struct chunks *parts = &body->bound_parts;
    int64_t nodes = body->node_count;
    if (taken >= 0) {
        share->ranks->receive(share->ranks, owner_of_block(share, share->begin_block - 1),
                              body->bound + taken * nodes, nodes);
        add_part(body, taken, add, rest);
    }
    int64_t last = share->begin_block < share->end_block ? part_of(parts, share->end_block - 1) : -1;
    if (last >= 0 && chunks_begin(parts, last + 1) > share->end_block) {
        share->ranks->send(share->ranks, owner_of_block(share, share->end_block), body->bound + last * nodes,
                           nodes);
    }
    ranks_gather(share->ranks, body->bound, (size_t)nodes * sizeof *body->bound, body->bound_first);
}

static void sum_bounds(struct body *body, body_visitor *add, bool rest, double *stiffness)
{
    const struct body_share *share = &body->share;
    const struct chunks *parts = &body->bound_parts;
    int64_t first = share->begin_block < share->end_block ? part_of(parts, share->begin_block) : -1;
    int64_t taken = first >= 0 && chunks_begin(parts, first) < share->begin_block ? first : -1;
#pragma omp parallel for schedule(static) num_threads(parts->threads)
    for (int64_t p = 0; p < parts->count; p++) {
        if (p != taken) {
            memset(body->bound + p * body->node_count, 0, (size_t)body->node_count * sizeof *body->bound);
            add_part(body, p, add, rest);
        }
    }
    if (share->ranks != NULL) {
        sum_parts_of_ranks(body, taken, add, rest);
    }
#pragma omp parallel for schedule(static) num_threads(parts->threads)
    for (int64_t n = 0; n < body->node_count; n++) {
        double sum = body->bound[n];
        for (int64_t p = 1; p < parts->count; p++) {
            sum += body->bound[p * body->node_count + n];
        }
        stiffness[body->node_order[n]] = sum;
    }
}

void body_diagonal(struct body *body, double *stiffness)
{
    sum_bounds(body, add_point, false, stiffness);
}

void body_nodal_diagonal(struct body *body, bool rest, double *stiffness)
{
    sum_bounds(body, add_cell, rest, stiffness);
}
