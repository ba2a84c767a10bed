#include "solid/preconditioner/lower_stiffness.h"

#include "base/memory.h"
#include "solid/preconditioner/scalar_stiffness.h"
#include "solid/system/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double least_share =
    1e-6; /* least diagonal entry by the mean one, for nodes without stiffness */

/* The least number of nodes for a thread, and for a pass over the operator. */
static const int64_t worthwhile = 1000;

static enum status make_room(struct lower_piece *piece, int64_t more, struct error *error)
{
    if (piece->count + more > piece->capacity) {
        int64_t capacity = (piece->count + more) / 4 * 5 + 4096;
        RETURN_IF_ERROR(RESIZE_ARRAY(&piece->idx, capacity, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&piece->value, capacity, error));
        piece->capacity = capacity;
    }
    return STATUS_OK;
}

static enum status keep_row(const struct scalar_row *row, int64_t i, int number, struct lower *lower,
                            struct error *error)
{
    struct lower_piece *piece = &lower->piece[number];
    int64_t at = piece->count;
    RETURN_IF_ERROR(make_room(piece, row->count, error));
    if (row->count > 0) {
        memcpy(piece->idx + at, row->node, (size_t)row->count * sizeof *row->node);
        memcpy(piece->value + at, row->value, (size_t)row->count * sizeof *row->value);
    }
    lower->piece_of[i] = (uint8_t)number;
    lower->begin[i] = at;
    lower->end[i] = piece->count = at + row->count;
    return STATUS_OK;
}

/* Make the rows of nodes as one piece. */
static enum status make_piece(const int32_t *place, int64_t count, int number, struct scalar_row *row,
                              struct lower *lower, struct error *error)
{
    const struct body *body = &lower->stiffness.system->body;
    for (int64_t k = 0; k < count; k++) {
        int64_t i = body->node_order[place[k]];
        scalar_stiffness_row(&lower->stiffness, i, row);
        lower->diagonal[place[k]] = row->count > 0 ? row->value[row->count - 1] : 0.0;
        RETURN_IF_ERROR(keep_row(row, i, number, lower, error));
    }
    return STATUS_OK;
}

/* Make some chunks of the rows of nodes as further pieces, each by one thread. */
static enum status make_some(const int32_t *place, const struct chunks *chunks, int64_t begin, int64_t end,
                             struct lower *lower, struct error *error)
{
    struct first_failure failure = {STATUS_OK};
    int64_t at = chunks_begin(chunks, begin);
    RETURN_IF_ERROR(
        scalar_stiffness_prepare(&lower->stiffness, place + at, chunks_begin(chunks, end) - at, error));
#pragma omp parallel num_threads(chunks->threads)
    {
        struct scalar_row row;
        struct error own;
        enum status made = scalar_row_make(&lower->stiffness, &row, &own);
#pragma omp for schedule(static, 1)
        for (int64_t c = begin; c < end; c++) {
            int64_t first = chunks_begin(chunks, c);
            if (made == STATUS_OK) {
                made = make_piece(place + first, chunks_begin(chunks, c + 1) - first,
                                  lower->piece_count + (int)(c - begin), &row, lower, &own);
            }
        }
        scalar_row_free(&row);
        note_failure(&failure, 0, made, &own, error);
    }
    lower->piece_count += (int)(end - begin);
    return failure.status;
}

/* Make the rows of nodes as further pieces. The nodes are prepared some chunks at a time: it takes a pass
 * over the operator, and memory. */
static enum status make_pieces(const int32_t *place, int64_t count, struct lower *lower, struct error *error)
{
    enum { CHUNKS_AT_ONCE = 16 };
    const struct chunks chunks = chunks_of(count, worthwhile);
    for (int64_t c = 0; c < chunks.count; c += CHUNKS_AT_ONCE) {
        int64_t end = chunks.count - c < CHUNKS_AT_ONCE ? chunks.count : c + CHUNKS_AT_ONCE;
        RETURN_IF_ERROR(make_some(place, &chunks, c, end, lower, error));
    }
    return STATUS_OK;
}

enum status lower_begin(const struct solid_system *system, struct lower *lower, struct error *error)
{
    int64_t nodes = system->node_count;
    *lower = (struct lower){0};
    RETURN_IF_ERROR(scalar_stiffness_make(system, &lower->stiffness, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lower->begin, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lower->end, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lower->piece_of, nodes, error));
    return NEW_ARRAY(&lower->diagonal, nodes, error);
}

static void drop_pieces(struct lower *lower)
{
    for (size_t k = 0; k < sizeof lower->piece / sizeof *lower->piece; k++) {
        FREE_ALL(lower->piece[k].idx, lower->piece[k].value);
        lower->piece[k] = (struct lower_piece){0};
    }
    lower->piece_count = 0;
}

enum status lower_make(int64_t first, int64_t last, struct lower *lower, struct error *error)
{
    size_t nodes = (size_t)lower->stiffness.system->node_count;
    drop_pieces(lower);
    memset(lower->begin, 0, nodes * sizeof *lower->begin);
    memset(lower->end, 0, nodes * sizeof *lower->end);
    NEW_SCRATCH(int32_t, place, last - first, error);
    for (int64_t p = first; p < last; p++) {
        place[p - first] = (int32_t)p;
    }
    return make_pieces(place, last - first, lower, error);
}

enum status lower_add(const bool *wanted, struct lower *lower, struct error *error)
{
    const struct solid_system *system = lower->stiffness.system;
    int64_t count = 0;
    NEW_SCRATCH(int32_t, place, system->node_count, error);
    for (int64_t p = 0; p < system->node_count; p++) {
        int64_t i = system->body.node_order[p];
        if (wanted[i] && lower->begin[i] == lower->end[i]) {
            place[count++] = (int32_t)p;
        }
    }
    if (count > 0) {
        RETURN_IF_ERROR(make_pieces(place, count, lower, error));
    }
    return STATUS_OK;
}

bool lower_set_least(struct lower *lower)
{
    const struct solid_system *system = lower->stiffness.system;
    const struct body_share *share = &system->body.share;
    bool above = false;
    double sum = 0.0;
    ranks_gather(share->ranks, lower->diagonal, sizeof *lower->diagonal, share->node_first);
    for (int64_t i = 0; i < system->node_count; i++) {
        sum += lower->diagonal[system->body.node_place[i]];
    }
    lower->least = least_share * sum / (double)system->node_count;
    for (int64_t p = 0; p < system->node_count; p++) {
        above = above || !(lower->diagonal[p] >= lower->least);
    }
    return !above;
}

double lower_entry(const struct lower *lower, int32_t i, int32_t j)
{
    struct lower_row row = lower_row(lower, i);
    int64_t low = 0, high = row.count;
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (row.idx[middle] < j) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    double value = low < row.count && row.idx[low] == j ? row.value[low] : 0.0;
    return i == j ? fmax(value, lower->least) : value;
}

enum status lower_fetch(const bool *wanted, struct lower *lower, struct error *error)
{
    const struct solid_system *system = lower->stiffness.system;
    const struct ranks *ranks = system->body.share.ranks;
    int64_t nodes = system->node_count;
    FREED_BY(halo_free) struct halo halo = {0};
    int64_t at = 0;
    struct lower_piece *fetched = &lower->piece[lower->piece_count++];
    RETURN_IF_ERROR(halo_build(ranks, nodes, wanted, 1, body_share_owner, &system->body, &halo, error));
    NEW_SCRATCH(double, length, nodes, error);
    NEW_SCRATCH(int64_t, send_first, ranks->count + 1, error);
    NEW_SCRATCH(int64_t, receive_first, ranks->count + 1, error);
    for (int64_t i = 0; i < nodes; i++) {
        length[i] = (double)(lower->end[i] - lower->begin[i]);
    }
    halo_exchange(&halo, 1, length);
    for (int r = 0; r < ranks->count; r++) {
        send_first[r + 1] = send_first[r];
        for (int64_t i = halo.send_first[r]; i < halo.send_first[r + 1]; i++) {
            send_first[r + 1] += lower->end[halo.send[i]] - lower->begin[halo.send[i]];
        }
        receive_first[r + 1] = receive_first[r];
        for (int64_t i = halo.receive_first[r]; i < halo.receive_first[r + 1]; i++) {
            int64_t node = halo.receive[i];
            lower->piece_of[node] = (uint8_t)(lower->piece_count - 1);
            lower->begin[node] = receive_first[r + 1];
            receive_first[r + 1] += (int64_t)length[node];
            lower->end[node] = receive_first[r + 1];
        }
    }
    RETURN_IF_ERROR(make_room(fetched, receive_first[ranks->count], error));
    NEW_SCRATCH(int32_t, idx, send_first[ranks->count], error);
    NEW_SCRATCH(double, value, send_first[ranks->count], error);
    for (int64_t i = 0; i < halo.send_first[ranks->count]; i++) {
        struct lower_row row = lower_row(lower, halo.send[i]);
        memcpy(idx + at, row.idx, (size_t)row.count * sizeof *idx);
        memcpy(value + at, row.value, (size_t)row.count * sizeof *value);
        at += row.count;
    }
    ranks->exchange(ranks, sizeof *idx, idx, send_first, fetched->idx, receive_first);
    ranks->exchange(ranks, sizeof *value, value, send_first, fetched->value, receive_first);
    fetched->count = receive_first[ranks->count];
    return STATUS_OK;
}

void lower_free(struct lower *lower)
{
    scalar_stiffness_free(&lower->stiffness);
    FREE_ALL(lower->begin, lower->end, lower->piece_of, lower->diagonal);
    drop_pieces(lower);
    *lower = (struct lower){0};
}
