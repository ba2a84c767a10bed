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
enum { PARTS_OF_THREAD = 4 };    /* summed before they go into the matrix */
enum { MOST_NUMBERS = 12 };      /* fields of a centre times directions */

/* What some nodes add, between the centres near them. */
struct part {
    struct centre_sums sums;
    struct block_row row;
    int32_t *slot; /* centre_count: place in `taken`, or -1 */
    int64_t taken_count;
    int32_t *taken_centre;            /* centre_count */
    double (*taken)[4][MOST_NUMBERS]; /* centre_count: K_nm W_m for these, and below it E_n */
    enum status status;
    struct error error;
};

static enum status part_begin(const struct preconditioner *p, const struct body *body, int64_t most,
                              struct part *part, struct error *error)
{
    int64_t centres = p->coarse.centre_count;
    part->taken_count = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&part->slot, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&part->taken_centre, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&part->taken, centres, error));
    memset(part->slot, -1, (size_t)centres * sizeof *part->slot);
    return block_row_begin(body, most, &part->row, error);
}

/* All but the sums. */
static void part_end(struct part *part)
{
    block_row_free(&part->row);
    FREE_ALL(part->slot, part->taken_centre, part->taken);
    part->slot = part->taken_centre = NULL;
    part->taken = NULL;
}

/* Where a centre is in `taken`, zero at first. */
static double (*slot_of(struct part *part, int32_t centre))[MOST_NUMBERS]
{
    if (part->slot[centre] < 0) {
        part->slot[centre] = (int32_t)part->taken_count;
        part->taken_centre[part->taken_count] = centre;
        memset(part->taken[part->taken_count++], 0, sizeof *part->taken);
    }
    return part->taken[part->slot[centre]];
}

static void forget(struct part *part)
{
    for (int64_t i = 0; i < part->taken_count; i++) {
        part->slot[part->taken_centre[i]] = -1;
    }
    part->taken_count = 0;
}

/* taken[rows] += block[rows][dim] W_n. The dimension is known when compiling, here and below. */
KERNEL_INLINE void take(const struct moved_fields *fields, int dim, int64_t node, int rows,
                        const double *block, struct part *part)
{
    const struct coarse_space *coarse = &fields->p->coarse;
    int32_t near = fields->near[node];
    int numbers = (dim + 1) * dim;
    for (int64_t i = coarse->shares.ptr[node]; i < coarse->shares.ptr[node + 1] && near < 0; i++) {
        double(*to)[MOST_NUMBERS] = slot_of(part, coarse->shares.idx[i]), value[4];
        coarse_space_values(coarse, node, coarse->shares.idx[i], coarse->shares.value[i], value);
        for (int r = 0; r < rows; r++) {
            for (int k = 0; k < numbers; k++) {
                to[r][k] += block[r * dim + k % dim] * value[k / dim];
            }
        }
    }
    for (int64_t e = near < 0 ? 0 : fields->ptr[near]; near >= 0 && e < fields->ptr[near + 1]; e++) {
        const float *move = fields->move + fields->at[e] * dim * numbers;
        double(*to)[MOST_NUMBERS] = slot_of(part, fields->centre[fields->at[e]]);
        for (int r = 0; r < rows; r++) {
            for (int a = 0; a < dim; a++) {
                for (int k = 0; k < numbers; k++) {
                    to[r][k] += block[r * dim + a] * (double)move[a * numbers + k];
                }
            }
        }
    }
}

/* The blocks between a centre and those in `taken` that are not above it += W_n^T taken. */
KERNEL_INLINE void put_centre(int dim, int32_t centre, const double *value, const float *move,
                              struct part *part)
{
    int numbers = (dim + 1) * dim;
    for (int64_t t = 0; t < part->taken_count; t++) {
        if (part->taken_centre[t] > centre) {
            continue;
        }
        double *block = centre_sums_block(&part->sums, centre, part->taken_centre[t]);
        const double(*taken)[MOST_NUMBERS] = (const double(*)[MOST_NUMBERS])part->taken[t];
        for (int i = 0; i < numbers; i++) {
            if (move == NULL) {
                for (int k = 0; k < numbers; k++) {
                    block[i * numbers + k] += value[i / dim] * taken[i % dim][k];
                }
                continue;
            }
            for (int a = 0; a < dim; a++) {
                for (int k = 0; k < numbers; k++) {
                    block[i * numbers + k] += (double)move[a * numbers + i] * taken[a][k];
                }
            }
        }
    }
}

KERNEL_INLINE void put(const struct moved_fields *fields, int dim, int64_t node, struct part *part)
{
    const struct coarse_space *coarse = &fields->p->coarse;
    int32_t near = fields->near[node];
    for (int64_t i = coarse->shares.ptr[node]; i < coarse->shares.ptr[node + 1] && near < 0; i++) {
        double value[4];
        coarse_space_values(coarse, node, coarse->shares.idx[i], coarse->shares.value[i], value);
        put_centre(dim, coarse->shares.idx[i], value, NULL, part);
    }
    for (int64_t e = near < 0 ? 0 : fields->ptr[near]; near >= 0 && e < fields->ptr[near + 1]; e++) {
        const float *move = fields->move + fields->at[e] * dim * (dim + 1) * dim;
        put_centre(dim, fields->centre[fields->at[e]], NULL, move, part);
    }
}

/* The blocks += factor row^T row, of row `r` of `taken`. */
KERNEL_INLINE void put_square(int dim, int r, double factor, struct part *part)
{
    int numbers = (dim + 1) * dim;
    for (int64_t s = 0; s < part->taken_count; s++) {
        const double *upper = part->taken[s][r];
        for (int64_t t = 0; t < part->taken_count; t++) {
            if (part->taken_centre[t] > part->taken_centre[s]) {
                continue;
            }
            const double *lower = part->taken[t][r];
            double *block = centre_sums_block(&part->sums, part->taken_centre[s], part->taken_centre[t]);
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
                            struct part *part)
{
    const struct block_row *row = &part->row;
    block_row_make(body, node, &part->row);
    forget(part);
    for (int64_t m = 0; m < row->count; m++) {
        take(fields, dim, body->node_order[row->node[m]], dim + 1, row->block + m * (dim + 1) * dim, part);
    }
    part->status = centre_sums_make_room(&part->sums, part->taken_count, &part->error);
    if (part->status == STATUS_OK) {
        put(fields, dim, body->node_order[node], part);
        put_square(dim, dim, 1.0 / row->volume, part);
    }
}

KERNEL_INLINE void add_penalty(const struct moved_fields *fields, const struct solid_system *system, int dim,
                               int64_t r, struct part *part)
{
    const struct constraint_rows *penalties = &system->penalties;
    struct average average = constraint_rows_average(penalties, r);
    forget(part);
    for (int64_t i = 0; i < average.length; i++) {
        double block[3];
        for (int a = 0; a < dim; a++) {
            block[a] = average.phi[i] * penalties->direction[r * dim + a];
        }
        take(fields, dim, average.idx[i], 1, block, part);
    }
    part->status = centre_sums_make_room(&part->sums, part->taken_count, &part->error);
    if (part->status == STATUS_OK) {
        put_square(dim, 0, system->penalty_stiffness[r], part);
    }
}

ALL_SETS static void add(const struct moved_fields *fields, const struct solid_system *system, bool penalty,
                         int64_t item, struct part *part)
{
    if (penalty && system->dim == 2) {
        add_penalty(fields, system, 2, item, part);
    } else if (penalty) {
        add_penalty(fields, system, 3, item, part);
    } else if (system->dim == 2) {
        add_node(fields, &system->body, 2, (int32_t)item, part);
    } else {
        add_node(fields, &system->body, 3, (int32_t)item, part);
    }
}

/* The sums of the nodes and penalties of a chunk. */
static void sum_chunk(const struct moved_fields *fields, const struct solid_system *system,
                      const struct chunks *nodes, int64_t most, int64_t c, struct part *part)
{
    struct chunks penalties = *nodes;
    penalties.items = system->penalties.count;
    part->status = part_begin(fields->p, &system->body, most, part, &part->error);
    for (int way = 0; way < 2; way++) {
        const struct chunks *items = way == 0 ? nodes : &penalties;
        int64_t end = chunks_begin(items, c + 1);
        for (int64_t i = chunks_begin(items, c); i < end && part->status == STATUS_OK; i++) {
            add(fields, system, way == 1, i, part);
        }
    }
    part_end(part);
}

/* Sum some chunks, each process its share of them, and add them to the matrix in their order. */
static enum status add_chunks(const struct moved_fields *fields, const struct solid_system *system,
                              const struct chunks *nodes, int64_t begin, int64_t end, struct part *parts,
                              double *matrix, struct error *error)
{
    const struct ranks *ranks = system->body.share.ranks;
    int64_t most = block_row_most(&system->body);
    SCRATCH int64_t *first = NULL;
    enum status status = ranks_share(ranks, end - begin, NULL, &first, error);
    for (int64_t i = 0; i < end - begin && status == STATUS_OK; i++) {
        status = centre_sums_begin(fields->p->coarse.centre_count, (system->dim + 1) * system->dim,
                                   &parts[i].sums, error);
    }
    RETURN_IF_ERROR(ranks_agree(ranks, status, error));
    int64_t own = first[ranks_rank(ranks)], own_end = first[ranks_rank(ranks) + 1];
#pragma omp parallel for schedule(dynamic, 1) num_threads(nodes->threads)
    for (int64_t i = own; i < own_end; i++) {
        sum_chunk(fields, system, nodes, most, begin + i, &parts[i]);
    }
    for (int64_t i = own; i < own_end && status == STATUS_OK; i++) {
        *error = parts[i].error;
        status = parts[i].status;
    }
    RETURN_IF_ERROR(ranks_agree(ranks, status, error));
    for (int64_t i = 0; i < end - begin; i++) {
        RETURN_IF_ERROR(centre_sums_send(ranks, ranks_owner(ranks, first, i), &parts[i].sums, error));
        centre_sums_add(&parts[i].sums, matrix);
        centre_sums_free(&parts[i].sums);
    }
    return STATUS_OK;
}

static enum status sum_all(const struct moved_fields *fields, const struct solid_system *system,
                           double *matrix, struct error *error)
{
    const struct preconditioner *p = fields->p;
    struct chunks nodes = chunks_of(p->node_count, NODES_FOR_THREAD);
    const struct ranks *ranks = system->body.share.ranks;
    int64_t at_once = PARTS_OF_THREAD * ranks_most(ranks, nodes.threads) * ranks_count(ranks);
    struct part parts[CHUNKS_MOST];
    enum status status = STATUS_OK;
    memset(parts, 0, sizeof parts);
    memset(matrix, 0, (size_t)(p->size * p->size) * sizeof *matrix);
    for (int64_t begin = 0; begin < nodes.count; begin += at_once) {
        int64_t end = begin + at_once < nodes.count ? begin + at_once : nodes.count;
        TRY(add_chunks(fields, system, &nodes, begin, end, parts, matrix, error));
    }
    centre_sums_mirror(p->coarse.centre_count, (p->dim + 1) * p->dim, matrix);
done:
    for (int64_t i = 0; i < CHUNKS_MOST; i++) {
        centre_sums_free(&parts[i].sums);
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
