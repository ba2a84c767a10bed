/* The stiffness along the coarse fields of a body of smoothed cells, assembled in one pass over the nodes.
 *
 * With W = P Z, whose rows W_n are what the fields move node n by, the matrix is sum_nm W_n^T K_nm W_m, with
 * the blocks of block_row.h, and sum_n E_n^T E_n / V_n for nodal pressures. A node adds to the blocks between
 * the centres near it only: some thousands of additions, however many centres there are. Nodes are summed by
 * chunks in the body's order, each of which has few centres near it. */
#include "solid/preconditioner/block_row.h"
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
    int32_t *local;      /* centre_count: place in `centre`, or -1 */
    int64_t count, room; /* centres */
    int32_t *centre;     /* centre_count */
    double *block;       /* of each pair of these: its rows are the fields of the higher centre */
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
    RETURN_IF_ERROR(NEW_ARRAY(&part->local, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&part->centre, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&part->slot, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&part->taken_centre, centres, error));
    RETURN_IF_ERROR(NEW_ARRAY(&part->taken, centres, error));
    memset(part->local, -1, (size_t)centres * sizeof *part->local);
    memset(part->slot, -1, (size_t)centres * sizeof *part->slot);
    return block_row_begin(body, most, &part->row, error);
}

/* All but the sums. */
static void part_end(struct part *part)
{
    block_row_free(&part->row);
    FREE_ALL(part->local, part->slot, part->taken_centre, part->taken);
    part->local = part->slot = part->taken_centre = NULL;
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

/* The place of a centre in a part's sums; there must be room (make_room). */
static int64_t place_of(struct part *part, int32_t centre)
{
    if (part->local[centre] < 0) {
        part->local[centre] = (int32_t)part->count;
        part->centre[part->count++] = centre;
    }
    return part->local[centre];
}

static int64_t pair(int64_t i, int64_t k)
{
    return i > k ? i * (i + 1) / 2 + k : k * (k + 1) / 2 + i;
}

/* Room for the pairs of `more` further centres. */
static enum status make_room(struct part *part, int64_t more, int64_t block, struct error *error)
{
    int64_t wanted = part->count + more, before = pair(part->room, 0);
    if (wanted <= part->room) {
        return STATUS_OK;
    }
    part->room = wanted + wanted / 4;
    RETURN_IF_ERROR(RESIZE_ARRAY(&part->block, pair(part->room, 0) * block, error));
    memset(part->block + before * block, 0,
           (size_t)((pair(part->room, 0) - before) * block) * sizeof *part->block);
    return STATUS_OK;
}

/* The blocks between a centre and those in `taken` that are not above it += W_n^T taken. */
KERNEL_INLINE void put_centre(int dim, int32_t centre, const double *value, const float *move,
                              struct part *part)
{
    int numbers = (dim + 1) * dim;
    int64_t place = place_of(part, centre);
    for (int64_t t = 0; t < part->taken_count; t++) {
        if (part->taken_centre[t] > centre) {
            continue;
        }
        double *block = part->block + pair(place, place_of(part, part->taken_centre[t])) * numbers * numbers;
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
        int64_t place = place_of(part, part->taken_centre[s]);
        const double *upper = part->taken[s][r];
        for (int64_t t = 0; t < part->taken_count; t++) {
            if (part->taken_centre[t] > part->taken_centre[s]) {
                continue;
            }
            const double *lower = part->taken[t][r];
            double *block =
                part->block + pair(place, place_of(part, part->taken_centre[t])) * numbers * numbers;
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
    part->status = make_room(part, part->taken_count, (dim + 1) * dim * (dim + 1) * dim, &part->error);
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
    part->status = make_room(part, part->taken_count, (dim + 1) * dim * (dim + 1) * dim, &part->error);
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
static enum status sum_chunk(const struct moved_fields *fields, const struct solid_system *system,
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
    return part->status;
}

/* Add the sums of a chunk to the matrix, in its lower triangle of blocks. */
static void add_part(const struct preconditioner *p, int64_t count, const int32_t *centre,
                     const double *block, double *matrix)
{
    int64_t numbers = (p->dim + 1) * p->dim;
    for (int64_t i = 0; i < count; i++) {
        for (int64_t k = 0; k <= i; k++, block += numbers * numbers) {
            int64_t above = centre[i] > centre[k] ? centre[i] : centre[k];
            int64_t below = centre[i] + centre[k] - above;
            double *to = matrix + above * numbers * p->size + below * numbers;
            for (int64_t j = 0; j < numbers * numbers; j++) {
                to[j / numbers * p->size + j % numbers] += block[j];
            }
        }
    }
}

static void free_part(struct part *part)
{
    FREE_ALL(part->centre, part->block);
    *part = (struct part){0};
}

/* The parts of all chunks, some of each process, into the matrix. */
static enum status join(const struct preconditioner *p, const struct ranks *ranks, int64_t chunks,
                        const int64_t *first, struct part *part, double *matrix, struct error *error)
{
    int64_t block = p->dim * (p->dim + 1) * p->dim * (p->dim + 1);
    SCRATCH int64_t *count = NULL, *at = NULL, *centre_first = NULL, *block_first = NULL;
    SCRATCH int32_t *centre = NULL;
    SCRATCH double *sums = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&count, chunks, error));
    RETURN_IF_ERROR(NEW_ARRAY(&at, 2 * (chunks + 1), error));
    RETURN_IF_ERROR(NEW_ARRAY(&centre_first, ranks_count(ranks) + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&block_first, ranks_count(ranks) + 1, error));
    for (int64_t c = 0; c < chunks; c++) {
        count[c] = part[c].count;
    }
    ranks_gather(ranks, count, sizeof *count, first);
    for (int64_t c = 0; c < chunks; c++) {
        at[2 * c + 2] = at[2 * c] + count[c];
        at[2 * c + 3] = at[2 * c + 1] + pair(count[c], 0) * block;
    }
    for (int r = 0; r <= ranks_count(ranks); r++) {
        centre_first[r] = at[2 * first[r]];
        block_first[r] = at[2 * first[r] + 1];
    }
    RETURN_IF_ERROR(NEW_ARRAY(&centre, at[2 * chunks], error));
    RETURN_IF_ERROR(NEW_ARRAY(&sums, at[2 * chunks + 1], error));
    for (int64_t c = first[ranks_rank(ranks)]; c < first[ranks_rank(ranks) + 1]; c++) {
        if (count[c] > 0) {
            memcpy(centre + at[2 * c], part[c].centre, (size_t)count[c] * sizeof *centre);
            memcpy(sums + at[2 * c + 1], part[c].block, (size_t)(pair(count[c], 0) * block) * sizeof *sums);
        }
        free_part(&part[c]);
    }
    ranks_gather(ranks, centre, sizeof *centre, centre_first);
    ranks_gather(ranks, sums, sizeof *sums, block_first);
    for (int64_t c = 0; c < chunks; c++) {
        add_part(p, count[c], centre + at[2 * c], sums + at[2 * c + 1], matrix);
    }
    return STATUS_OK;
}

/* The lower triangle of blocks is known; within the blocks on the diagonal both. */
static void mirror(const struct preconditioner *p, double *matrix)
{
    int64_t numbers = (p->dim + 1) * p->dim;
    for (int64_t i = 0; i < p->size; i++) {
        for (int64_t k = 0; k < i; k++) {
            double *here = &matrix[i * p->size + k], *across = &matrix[k * p->size + i];
            *here = i / numbers == k / numbers ? 0.5 * (*here + *across) : *here;
            *across = *here;
        }
    }
}

/* The parts of the chunks from `begin` to before `end`. */
static enum status sum_chunks(const struct moved_fields *fields, const struct solid_system *system,
                              const struct chunks *nodes, int64_t begin, int64_t end, struct part *part,
                              struct error *error)
{
    int64_t most = block_row_most(&system->body);
#pragma omp parallel for schedule(dynamic, 1) num_threads(nodes->threads)
    for (int64_t c = begin; c < end; c++) {
        (void)sum_chunk(fields, system, nodes, most, c, &part[c]);
    }
    for (int64_t c = begin; c < end; c++) {
        if (part[c].status != STATUS_OK) {
            *error = part[c].error;
            return part[c].status;
        }
    }
    return STATUS_OK;
}

/* In one process the parts go into the matrix some at a time, as each may be large. */
static enum status sum_alone(const struct moved_fields *fields, const struct solid_system *system,
                             const struct chunks *nodes, struct part *part, double *matrix,
                             struct error *error)
{
    int64_t at_once = (int64_t)PARTS_OF_THREAD * nodes->threads;
    for (int64_t begin = 0; begin < nodes->count; begin += at_once) {
        int64_t end = begin + at_once < nodes->count ? begin + at_once : nodes->count;
        RETURN_IF_ERROR(sum_chunks(fields, system, nodes, begin, end, part, error));
        for (int64_t c = begin; c < end; c++) {
            add_part(fields->p, part[c].count, part[c].centre, part[c].block, matrix);
            free_part(&part[c]);
        }
    }
    return STATUS_OK;
}

static enum status sum_all(const struct moved_fields *fields, const struct solid_system *system,
                           double *matrix, struct error *error)
{
    const struct ranks *ranks = system->body.share.ranks;
    const struct preconditioner *p = fields->p;
    struct chunks nodes = chunks_of(p->node_count, NODES_FOR_THREAD);
    struct part part[CHUNKS_MOST] = {{0}};
    SCRATCH int64_t *first = NULL;
    enum status status;
    memset(matrix, 0, (size_t)(p->size * p->size) * sizeof *matrix);
    if (ranks_count(ranks) == 1) {
        TRY(sum_alone(fields, system, &nodes, part, matrix, error));
    } else {
        TRY(ranks_share(ranks, nodes.count, NULL, &first, error));
        status = sum_chunks(fields, system, &nodes, first[ranks_rank(ranks)], first[ranks_rank(ranks) + 1],
                            part, error);
        TRY(ranks_agree(ranks, status, error));
        TRY(join(p, ranks, nodes.count, first, part, matrix, error));
    }
    mirror(p, matrix);
done:
    for (int64_t c = 0; c < nodes.count; c++) {
        free_part(&part[c]);
    }
    return status;
}

enum status preconditioner_assemble(struct preconditioner *p, struct solid_system *system,
                                    struct error *error)
{
    struct moved_fields fields = {0};
    body_share_collect(&system->body);
    enum status status = moved_fields_build(p, &fields, error);
    if (status == STATUS_OK) {
        status = sum_all(&fields, system, p->body, error);
    }
    moved_fields_free(&fields);
    return status;
}
