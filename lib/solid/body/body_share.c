#include "solid/body/body_share.h"

#include "base/lists.h"
#include "base/memory.h"
#include "solid/body/body.h"

#include <stdlib.h>

/* Work of each block: entries of the lists of its points, or of the vertices of its cells. */
static void measure_blocks(const struct body_input *input, const struct body *body, double *work)
{
    const int64_t *of_points = input->lists->ptr;
    int corners = body->dim + 1;
    for (int64_t b = 0; b < body->block_count; b++) {
        const struct block *block = &body->blocks[b];
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            int64_t from = body->order.points[q];
            if (!body->smoothed) {
                work[b] += (double)(of_points[from + 1] - of_points[from]);
            }
            for (int64_t k = from * corners; body->smoothed && k < (from + 1) * corners; k++) {
                const int64_t *ptr = input->node_lists->ptr + input->cells.node[k];
                work[b] += (double)(ptr[1] - ptr[0]);
            }
        }
    }
}

/* Work of each node in the body's order: in how many rows it is, or of cells, about in proportion, how many
 * nodes are in its own. */
static void measure_nodes(const struct body_input *input, const struct body *body, double *work)
{
    if (body->smoothed) {
        const int64_t *ptr = input->node_lists->ptr;
        for (int64_t n = 0; n < body->node_count; n++) {
            work[n] = (double)(ptr[body->order.nodes[n] + 1] - ptr[body->order.nodes[n]]);
        }
        return;
    }
    for (int64_t i = 0; i < input->lists->ptr[body->point_count]; i++) {
        work[body->order.places[input->lists->idx[i]]] += 1.0;
    }
}

/* The points of the blocks. */
static enum status list_points(struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    int count = ranks_count(share->ranks);
    RETURN_IF_ERROR(NEW_ARRAY(&share->point_first, count + 1, error));
    for (int r = 0; r <= count; r++) {
        int64_t b = share->block_first[r];
        share->point_first[r] = b < body->block_count ? body->blocks[b].first_point : body->point_count;
    }
    return STATUS_OK;
}

enum status body_share_cut(const struct body_input *input, struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    int rank = ranks_rank(input->ranks);
    share->ranks = input->ranks;
    NEW_SCRATCH(double, work, body->block_count, error);
    NEW_SCRATCH(double, node_work, body->node_count, error);
    if (share->ranks != NULL) {
        measure_blocks(input, body, work);
        measure_nodes(input, body, node_work);
    }
    RETURN_IF_ERROR(ranks_share(share->ranks, body->block_count, work, &share->block_first, error));
    RETURN_IF_ERROR(ranks_share(share->ranks, body->node_count, node_work, &share->node_first, error));
    RETURN_IF_ERROR(list_points(body, error));
    share->begin_block = share->block_first[rank];
    share->end_block = share->block_first[rank + 1];
    share->begin_point = share->point_first[rank];
    share->end_point = share->point_first[rank + 1];
    share->begin_node = share->node_first[rank];
    share->end_node = share->node_first[rank + 1];
    return STATUS_OK;
}

static int owner_of_point(const void *body, int64_t point)
{
    const struct body_share *share = &((const struct body *)body)->share;
    return ranks_owner(share->ranks, share->point_first, point);
}

enum status body_share_volumes(struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    const struct nodal_volumes *volumes = &body->volumes;
    int rank = ranks_rank(share->ranks), vertices = body->dim + 1;
    SCRATCH bool *wanted = NULL;
    RETURN_IF_ERROR(ranks_share(share->ranks, volumes->count, NULL, &share->volume_first, error));
    if (share->ranks != NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&wanted, body->point_count, error));
        int64_t begin = volumes->ptr[share->volume_first[rank]];
        int64_t end = volumes->ptr[share->volume_first[rank + 1]];
        for (int64_t i = begin; i < end; i++) {
            wanted[volumes->slot[i] / vertices] = true;
        }
        RETURN_IF_ERROR(halo_build(share->ranks, body->point_count, wanted, 1, owner_of_point, body,
                                   &share->strains, error));
    }
    return STATUS_OK;
}

static int owner_of_volume(const void *body, int64_t volume)
{
    const struct body_share *share = &((const struct body *)body)->share;
    return ranks_owner(share->ranks, share->volume_first, volume);
}

enum status body_share_pressures(struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    const struct sparse *matrix = &body->volumes.pressures.matrix;
    const int64_t *first = share->volume_first + ranks_rank(share->ranks);
    int vertices = body->dim + 1;
    if (share->ranks == NULL) {
        return STATUS_OK;
    }
    NEW_SCRATCH(bool, wanted, body->volumes.count, error);
    for (int64_t i = matrix->ptr[first[0]]; i < matrix->ptr[first[1]]; i++) {
        wanted[matrix->idx[i]] = true;
    }
    for (int64_t i = share->begin_point * vertices; i < share->end_point * vertices; i++) {
        wanted[body->volumes.of_point[i]] = true;
    }
    return halo_build(share->ranks, body->volumes.count, wanted, 1, owner_of_volume, body, &share->pressures,
                      error);
}

static int64_t row_count(const struct body *body)
{
    return body->smoothed ? body->cells.averages.row_count : body->point_count * body->dim;
}

enum status body_share_values(const struct body *body, bool **wanted, struct error *error)
{
    const struct body_share *share = &body->share;
    const struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    RETURN_IF_ERROR(NEW_ARRAY(wanted, row_count(body), error));
    if (!body->smoothed) {
        for (int64_t i = share->begin_point * dim; i < share->end_point * dim; i++) {
            (*wanted)[i] = true;
        }
        return STATUS_OK;
    }
    int64_t begin[USE_KINDS], end[USE_KINDS];
    field_averages_uses(averages, dim, share->begin_point, share->end_point, begin, end);
    for (int kind = 0; kind < USE_KINDS; kind++) {
        for (int64_t i = begin[kind]; i < end[kind]; i++) {
            (*wanted)[averages->of_use[i] / VECTOR_STRIDE(dim)] = true;
        }
    }
    for (int64_t n = share->begin_node; n < share->end_node; n++) { /* nodal_offset.h */
        (*wanted)[body_node_row(body, n)] = true;
    }
    return STATUS_OK;
}

static int owner_of_part(const void *context, int64_t part)
{
    const struct body *body = context;
    const struct field_averages *averages = &body->cells.averages;
    int64_t b = first_from(averages->part_first, 0, body->block_count + 1, part + 1) - 1;
    return ranks_owner(body->share.ranks, body->share.block_first, b);
}

/* Who has the forces on a row. One without uses has none. */
static int owner_of_row(const void *context, int64_t row)
{
    const struct body *body = context;
    const struct field_averages *averages = &body->cells.averages;
    if (!body->smoothed) {
        return owner_of_point(body, row / body->dim);
    }
    int64_t at = averages->part_ptr[row];
    return at < averages->part_ptr[row + 1] ? owner_of_part(body, averages->part[at]) : 0;
}

/* The rows that are summed here, and their parts. */
static enum status share_parts(struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    const struct field_averages *averages = &body->cells.averages;
    int64_t count = averages->part_first[body->block_count];
    NEW_SCRATCH(bool, sums, averages->row_count, error);
    NEW_SCRATCH(bool, parts, count, error);
    for (int64_t r = 0; r < averages->row_count; r++) {
        sums[r] = owner_of_row(body, r) == ranks_rank(share->ranks);
        for (int64_t i = averages->part_ptr[r]; i < averages->part_ptr[r + 1] && sums[r]; i++) {
            parts[averages->part[i]] = true;
        }
    }
    RETURN_IF_ERROR(row_ranges_of(0, averages->row_count, sums, &share->sums, error));
    return halo_build(share->ranks, count, parts, body->dim, owner_of_part, body, &share->parts, error);
}

int body_share_owner(const struct body *body, int64_t row)
{
    return owner_of_row(body, row);
}

enum status body_share_rows(struct body *body, const bool *wanted, struct error *error)
{
    RETURN_IF_ERROR(body->smoothed ? share_parts(body, error) : STATUS_OK);
    return halo_build(body->share.ranks, row_count(body), wanted, VECTOR_STRIDE(body->dim), owner_of_row,
                      body, &body->share.rows, error);
}

enum status body_share_nodes(struct body *body, struct error *error)
{
    const struct sparse *matrix = &body->rows.matrix;
    NEW_SCRATCH(bool, wanted, body->node_count, error);
    for (int64_t i = 0; i < matrix->ptr[matrix->row_count]; i++) {
        wanted[matrix->idx[i]] = true;
    }
    return row_ranges_of(0, body->node_count, wanted, &body->share.placed, error);
}

void body_share_free(struct body_share *share)
{
    FREE_ALL(share->block_first, share->point_first, share->node_first, share->volume_first);
    row_ranges_free(&share->values);
    row_ranges_free(&share->placed);
    row_ranges_free(&share->sums);
    halo_free(&share->strains);
    halo_free(&share->pressures);
    halo_free(&share->parts);
    halo_free(&share->rows);
}
