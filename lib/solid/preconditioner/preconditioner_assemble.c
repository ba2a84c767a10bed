/* The stiffness along the coarse fields of a body of smoothed cells, assembled in one pass over the nodes.
 *
 * With W = P Z, whose rows W_n are what the fields move node n by, the matrix is sum_nm W_n^T K_nm W_m, with
 * the blocks of block_row.h, and sum_n E_n^T E_n / V_n for nodal pressures. A node adds to the blocks between
 * the centres near it only: some thousands of additions, however many centres there are. Nodes are summed by
 * chunks in the body's order, each of which has few centres near it. */
#include "solid/preconditioner/block_row.h"
#include "solid/preconditioner/centre_sums.h"
#include "solid/preconditioner/moved_fields.h"
#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/processor.h"

#include <stdlib.h>
#include <string.h>

enum { NODES_FOR_THREAD = 200 }; /* see chunks_of */
enum { SUMS_OF_THREAD = 4 };     /* summed before they go into the matrix */
enum { MOST_NUMBERS = 12 };      /* fields of a centre times directions */

/* What some nodes add, between the centres near them. */
struct chunk_sum {
    struct centre_sums sums;
    struct block_row row;
    int32_t *place; /* centre_count: place in `product`, or -1 */
    int64_t product_count;
    int32_t *product_centre;            /* centre_count */
    double (*product)[4][MOST_NUMBERS]; /* centre_count: K_nm W_m for these, and below it E_n */
    enum status status;
    struct error error;
};

static enum status chunk_sum_begin(const struct preconditioner *p, const struct body *body, int64_t most,
                                   struct chunk_sum *chunk, struct error *error)
{
    int64_t centres = p->coarse.centre_count;
    chunk->product_count = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&chunk->place, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&chunk->product_centre, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&chunk->product, centres, error));
    memset(chunk->place, -1, (size_t)centres * sizeof *chunk->place);
    return block_row_begin(body, most, &chunk->row, error);
}

/* All but the sums. */
static void chunk_sum_end(struct chunk_sum *chunk)
{
    block_row_free(&chunk->row);
    FREE_ALL(chunk->place, chunk->product_centre, chunk->product);
    chunk->place = chunk->product_centre = NULL;
    chunk->product = NULL;
}

/* Where a centre is in `product`, zero at first. */
static double (*product_of(struct chunk_sum *chunk, int32_t centre))[MOST_NUMBERS]
{
    if (chunk->place[centre] < 0) {
        chunk->place[centre] = (int32_t)chunk->product_count;
        chunk->product_centre[chunk->product_count] = centre;
        memset(chunk->product[chunk->product_count++], 0, sizeof *chunk->product);
    }
    return chunk->product[chunk->place[centre]];
}

static void clear_products(struct chunk_sum *chunk)
{
    for (int64_t i = 0; i < chunk->product_count; i++) {
        chunk->place[chunk->product_centre[i]] = -1;
    }
    chunk->product_count = 0;
}

/* product[rows] += block[rows][dim] W_n. The dimension is known when compiling, here and below. */
KERNEL_INLINE void add_products(const struct moved_fields *fields, int dim, int64_t node, int rows,
                                const double *block, struct chunk_sum *chunk)
{
    const struct coarse_space *coarse = &fields->p->coarse;
    int32_t near = fields->near[node];
    int numbers = (dim + 1) * dim;
    if (near < 0) {
        for (int64_t i = coarse->shares.ptr[node]; i < coarse->shares.ptr[node + 1]; i++) {
            double(*to)[MOST_NUMBERS] = product_of(chunk, coarse->shares.idx[i]), value[4];
            coarse_space_values(coarse, node, coarse->shares.idx[i], coarse->shares.value[i], value);
            for (int r = 0; r < rows; r++) {
                for (int k = 0; k < numbers; k++) {
                    to[r][k] += block[r * dim + k % dim] * value[k / dim];
                }
            }
        }
        return;
    }
    for (int64_t e = fields->ptr[near]; e < fields->ptr[near + 1]; e++) {
        const float *move = fields->move + fields->at[e] * dim * numbers;
        double(*to)[MOST_NUMBERS] = product_of(chunk, fields->centre[fields->at[e]]);
        for (int r = 0; r < rows; r++) {
            for (int a = 0; a < dim; a++) {
                for (int k = 0; k < numbers; k++) {
                    to[r][k] += block[r * dim + a] * (double)move[a * numbers + k];
                }
            }
        }
    }
}

/* The blocks between a centre and those of the products that are not above it += W_n^T product, with W_n =
 * value[dim + 1] (x) I, or after the projection W_n = move[dim][(dim + 1) * dim]; the other one is NULL. */
KERNEL_INLINE void add_centre_blocks(int dim, int32_t centre, const double *value, const float *move,
                                     struct chunk_sum *chunk)
{
    int numbers = (dim + 1) * dim;
    for (int64_t t = 0; t < chunk->product_count; t++) {
        if (chunk->product_centre[t] > centre) {
            continue;
        }
        double *block = centre_sums_block(&chunk->sums, centre, chunk->product_centre[t]);
        const double(*product)[MOST_NUMBERS] = (const double(*)[MOST_NUMBERS])chunk->product[t];
        for (int i = 0; i < numbers; i++) {
            if (move == NULL) {
                for (int k = 0; k < numbers; k++) {
                    block[i * numbers + k] += value[i / dim] * product[i % dim][k];
                }
                continue;
            }
            for (int a = 0; a < dim; a++) {
                for (int k = 0; k < numbers; k++) {
                    block[i * numbers + k] += (double)move[a * numbers + i] * product[a][k];
                }
            }
        }
    }
}

/* The same for all fields of a node. */
KERNEL_INLINE void add_blocks(const struct moved_fields *fields, int dim, int64_t node,
                              struct chunk_sum *chunk)
{
    const struct coarse_space *coarse = &fields->p->coarse;
    int32_t near = fields->near[node];
    if (near < 0) {
        for (int64_t i = coarse->shares.ptr[node]; i < coarse->shares.ptr[node + 1]; i++) {
            double value[4];
            coarse_space_values(coarse, node, coarse->shares.idx[i], coarse->shares.value[i], value);
            add_centre_blocks(dim, coarse->shares.idx[i], value, NULL, chunk);
        }
        return;
    }
    for (int64_t e = fields->ptr[near]; e < fields->ptr[near + 1]; e++) {
        const float *move = fields->move + fields->at[e] * dim * (dim + 1) * dim;
        add_centre_blocks(dim, fields->centre[fields->at[e]], NULL, move, chunk);
    }
}

/* The blocks += factor row^T row, of row `r` of `product`. */
KERNEL_INLINE void add_square(int dim, int r, double factor, struct chunk_sum *chunk)
{
    int numbers = (dim + 1) * dim;
    for (int64_t s = 0; s < chunk->product_count; s++) {
        const double *upper = chunk->product[s][r];
        for (int64_t t = 0; t < chunk->product_count; t++) {
            if (chunk->product_centre[t] > chunk->product_centre[s]) {
                continue;
            }
            const double *lower = chunk->product[t][r];
            double *block =
                centre_sums_block(&chunk->sums, chunk->product_centre[s], chunk->product_centre[t]);
            for (int i = 0; i < numbers; i++) {
                double scaled = factor * upper[i];
                for (int k = 0; k < numbers; k++) {
                    block[i * numbers + k] += scaled * lower[k];
                }
            }
        }
    }
}

KERNEL_INLINE void add_node(const struct moved_fields *fields, const struct body *body, int dim, int32_t node,
                            struct chunk_sum *chunk)
{
    const struct block_row *row = &chunk->row;
    block_row_make(body, node, &chunk->row);
    clear_products(chunk);
    for (int64_t m = 0; m < row->count; m++) {
        add_products(fields, dim, body->node_order[row->node[m]], dim + 1, row->block + m * (dim + 1) * dim,
                     chunk);
    }
    chunk->status = centre_sums_make_room(&chunk->sums, chunk->product_count, &chunk->error);
    if (chunk->status == STATUS_OK) {
        add_blocks(fields, dim, body->node_order[node], chunk);
        add_square(dim, dim, 1.0 / row->volume, chunk);
    }
}

KERNEL_INLINE void add_penalty(const struct moved_fields *fields, const struct solid_system *system, int dim,
                               int64_t r, struct chunk_sum *chunk)
{
    const struct constraint_rows *penalties = &system->penalties;
    struct average average = constraint_rows_average(penalties, r);
    clear_products(chunk);
    for (int64_t i = 0; i < average.length; i++) {
        double block[3];
        for (int a = 0; a < dim; a++) {
            block[a] = average.phi[i] * penalties->direction[r * dim + a];
        }
        add_products(fields, dim, average.idx[i], 1, block, chunk);
    }
    chunk->status = centre_sums_make_room(&chunk->sums, chunk->product_count, &chunk->error);
    if (chunk->status == STATUS_OK) {
        add_square(dim, 0, system->penalty_stiffness[r], chunk);
    }
}

ALL_SETS static void add(const struct moved_fields *fields, const struct solid_system *system, bool penalty,
                         int64_t item, struct chunk_sum *chunk)
{
    if (penalty && system->dim == 2) {
        add_penalty(fields, system, 2, item, chunk);
    } else if (penalty) {
        add_penalty(fields, system, 3, item, chunk);
    } else if (system->dim == 2) {
        add_node(fields, &system->body, 2, (int32_t)item, chunk);
    } else {
        add_node(fields, &system->body, 3, (int32_t)item, chunk);
    }
}

/* The sums of the nodes and penalties of a chunk. */
static void sum_chunk(const struct moved_fields *fields, const struct solid_system *system,
                      const struct chunks *nodes, int64_t most, int64_t c, struct chunk_sum *chunk)
{
    struct chunks penalties = *nodes;
    penalties.items = system->penalties.count;
    chunk->status = chunk_sum_begin(fields->p, &system->body, most, chunk, &chunk->error);
    for (int way = 0; way < 2; way++) {
        const struct chunks *items = way == 0 ? nodes : &penalties;
        int64_t end = chunks_begin(items, c + 1);
        for (int64_t i = chunks_begin(items, c); i < end && chunk->status == STATUS_OK; i++) {
            add(fields, system, way == 1, i, chunk);
        }
    }
    chunk_sum_end(chunk);
}

/* Sum some chunks, each process its share of them, and add them to the matrix in their order. */
static enum status add_chunks(const struct moved_fields *fields, const struct solid_system *system,
                              const struct chunks *nodes, int64_t begin, int64_t end,
                              struct chunk_sum *chunk_sums, double *matrix, struct error *error)
{
    const struct ranks *ranks = system->body.share.ranks;
    int64_t most = block_row_most(&system->body);
    SCRATCH int64_t *first = NULL;
    enum status status = ranks_share(ranks, end - begin, NULL, &first, error);
    for (int64_t i = 0; i < end - begin && status == STATUS_OK; i++) {
        status = centre_sums_begin(fields->p->coarse.centre_count, (system->dim + 1) * system->dim,
                                   &chunk_sums[i].sums, error);
    }
    RETURN_IF_ERROR(ranks_agree(ranks, status, error));
    int64_t own = first[ranks_rank(ranks)], own_end = first[ranks_rank(ranks) + 1];
#pragma omp parallel for schedule(dynamic, 1) num_threads(nodes->threads)
    for (int64_t i = own; i < own_end; i++) {
        sum_chunk(fields, system, nodes, most, begin + i, &chunk_sums[i]);
    }
    for (int64_t i = own; i < own_end && status == STATUS_OK; i++) {
        *error = chunk_sums[i].error;
        status = chunk_sums[i].status;
    }
    RETURN_IF_ERROR(ranks_agree(ranks, status, error));
    for (int64_t i = 0; i < end - begin; i++) {
        RETURN_IF_ERROR(centre_sums_send(ranks, ranks_owner(ranks, first, i), &chunk_sums[i].sums, error));
        centre_sums_add(&chunk_sums[i].sums, matrix);
        centre_sums_free(&chunk_sums[i].sums);
    }
    return STATUS_OK;
}

static enum status sum_all(const struct moved_fields *fields, const struct solid_system *system,
                           double *matrix, struct error *error)
{
    const struct preconditioner *p = fields->p;
    struct chunks nodes = chunks_of(p->node_count, NODES_FOR_THREAD);
    const struct ranks *ranks = system->body.share.ranks;
    int64_t at_once = SUMS_OF_THREAD * ranks_most(ranks, nodes.threads) * ranks_count(ranks);
    struct chunk_sum chunk_sums[CHUNKS_MOST];
    enum status status = STATUS_OK;
    memset(chunk_sums, 0, sizeof chunk_sums);
    memset(matrix, 0, (size_t)(p->size * p->size) * sizeof *matrix);
    for (int64_t begin = 0; begin < nodes.count; begin += at_once) {
        int64_t end = begin + at_once < nodes.count ? begin + at_once : nodes.count;
        TRY(add_chunks(fields, system, &nodes, begin, end, chunk_sums, matrix, error));
    }
    centre_sums_mirror(p->coarse.centre_count, (p->dim + 1) * p->dim, matrix);
done:
    for (int64_t i = 0; i < CHUNKS_MOST; i++) {
        centre_sums_free(&chunk_sums[i].sums);
    }
    return status;
}

enum status preconditioner_assemble(struct preconditioner *p, struct solid_system *system,
                                    struct error *error)
{
    struct moved_fields fields = {0};
    body_share_collect(&system->body);
    enum status status = ranks_agree(system->body.share.ranks, moved_fields_build(p, &fields, error), error);
    if (status == STATUS_OK) {
        status = sum_all(&fields, system, p->body, error);
    }
    moved_fields_free(&fields);
    return status;
}
