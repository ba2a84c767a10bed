/* The stiffness along the coarse fields Z of a body of smoothed cells: sum_nm Z_n^T K_nm Z_m, with the rows
 * Z_n that say what the fields move node n by and the blocks of block_row.h, and sum_n E_n^T E_n / V_n for
 * nodal pressures. Nodes are summed by chunks in the body's order. */
#include "solid/preconditioner/block_row.h"
#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/memory.h"

#include <string.h>

enum { NODES_FOR_THREAD = 200 }; /* see chunks_of */
enum { MOST_SUMS = 4 };          /* chunks, each of which has a matrix of its own */

/* The products of a node's row of the stiffness with the coarse fields. */
static void take_node(const struct body *body, int32_t n, struct block_row *row, struct coarse_rows *rows)
{
    int dim = body->dim;
    block_row_make(body, n, row);
    coarse_rows_clear(rows);
    for (int64_t m = 0; m < row->count; m++) {
        coarse_rows_add(rows, body->order.nodes[row->node[m]], dim + 1, row->block + m * (dim + 1) * dim);
    }
}

static void add_node(const struct body *body, int32_t n, struct block_row *row, struct coarse_rows *rows,
                     const struct profile *profile, double *matrix)
{
    int dim = body->dim;
    take_node(body, n, row, rows);
    coarse_rows_multiply(rows, body->order.nodes[n], profile, matrix);
    coarse_rows_square(rows, dim, 1.0 / row->volume, profile, matrix);
}

static enum status sum_chunk(const struct preconditioner *p, const struct body *body, int64_t begin,
                             int64_t end, double *matrix, struct error *error)
{
    FREED_BY(block_row_free) struct block_row row = {0};
    FREED_BY(coarse_rows_free) struct coarse_rows rows = {0};
    RETURN_IF_ERROR(block_row_begin(body, block_row_most(body), &row, error));
    RETURN_IF_ERROR(coarse_rows_begin(&p->coarse, &rows, error));
    for (int64_t n = begin; n < end; n++) {
        add_node(body, (int32_t)n, &row, &rows, &p->profile, matrix);
    }
    return STATUS_OK;
}

/* (*sums)[chunks][profile.size]: of the process's own chunks, from first[] on. */
static enum status sum_nodes(const struct preconditioner *p, const struct body *body, struct chunks *chunks,
                             int64_t **first, double **sums, struct error *error)
{
    const struct ranks *ranks = body->share.ranks;
    int64_t entries = p->profile.size;
    struct first_failure failure = {STATUS_OK};
    RETURN_IF_ERROR(NEW_ARRAY(sums, chunks->count * entries, error));
    RETURN_IF_ERROR(ranks_share(ranks, chunks->count, NULL, first, error));
#pragma omp parallel for schedule(dynamic, 1) num_threads(chunks->threads)
    for (int64_t c = (*first)[ranks_rank(ranks)]; c < (*first)[ranks_rank(ranks) + 1]; c++) {
        struct error own;
        enum status status = sum_chunk(p, body, chunks_begin(chunks, c), chunks_begin(chunks, c + 1),
                                       *sums + c * entries, &own);
        note_failure(&failure, c, status, &own, error);
    }
    return failure.status;
}

/* What the coarse fields are along row r. */
static void take_row(struct preconditioner *p, const struct constraint_rows *rows, int64_t r)
{
    struct average average = constraint_rows_average(rows, r);
    coarse_rows_clear(&p->rows);
    coarse_rows_add_average(&p->rows, &average, 1.0, 1, rows->direction + r * p->dim);
}

/* Springs along rows, and in place of conditions, which the fields need not meet. stiffness[]: of
 * each; NULL: `usual`. */
static void add_springs(struct preconditioner *p, const struct constraint_rows *rows, const double *stiffness,
                        double usual)
{
    for (int64_t r = 0; r < rows->count; r++) {
        take_row(p, rows, r);
        coarse_rows_square(&p->rows, 0, stiffness != NULL ? stiffness[r] : usual, &p->profile, p->body);
    }
}

enum status preconditioner_assemble(struct preconditioner *p, struct solid_system *system,
                                    struct error *error)
{
    const struct ranks *ranks = system->body.share.ranks;
    struct chunks chunks = chunks_of(p->node_count, NODES_FOR_THREAD);
    int64_t entries = p->profile.size;
    double mean = 0.0;
    SCRATCH int64_t *first = NULL;
    SCRATCH double *sums = NULL;
    chunks.count = chunks.count < MOST_SUMS ? chunks.count : MOST_SUMS;
    RETURN_IF_ERROR(ranks_agree(ranks, sum_nodes(p, &system->body, &chunks, &first, &sums, error), error));
    ranks_gather(ranks, sums, (size_t)entries * sizeof *sums, first);
    memcpy(p->body, sums, (size_t)entries * sizeof *sums);
    for (int64_t c = 1; c < chunks.count; c++) {
        dense_add_row(entries, 1.0, sums + c * entries, p->body);
    }
    for (int64_t n = 0; n < p->node_count; n++) {
        mean += p->stiffness[n] / (double)p->node_count;
    }
    add_springs(p, &system->springs.rows, system->springs.stiffness, 0.0);
    add_springs(p, &system->rows, NULL, mean);
    return STATUS_OK;
}

static void widen_by_rows(struct preconditioner *p, const struct constraint_rows *rows)
{
    for (int64_t r = 0; r < rows->count; r++) {
        take_row(p, rows, r);
        coarse_rows_widen(&p->rows, &p->profile);
    }
}

enum status preconditioner_lay_out(struct preconditioner *p, const struct solid_system *system,
                                   struct error *error)
{
    const struct body *body = &system->body;
    FREED_BY(block_row_free) struct block_row row = {0};
    RETURN_IF_ERROR(profile_begin(p->coarse.group_count, (p->dim + 1) * p->dim, &p->profile, error));
    if (body->smoothed && p->size > 0) {
        RETURN_IF_ERROR(block_row_begin(body, block_row_most(body), &row, error));
        for (int64_t n = 0; n < p->node_count; n++) {
            take_node(body, (int32_t)n, &row, &p->rows);
            coarse_rows_widen(&p->rows, &p->profile);
        }
        widen_by_rows(p, &system->springs.rows);
        widen_by_rows(p, &system->rows);
        preconditioner_widen_by_contacts(p, system);
    } else {
        memset(p->profile.first, 0, (size_t)p->profile.count * sizeof *p->profile.first);
    }
    return profile_lay_out(&p->profile, error);
}
