#include "solid/lower_stiffness.h"

#include "base/memory.h"
#include "solid/scalar_stiffness.h"
#include "solid/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double least_share = 1e-6; /* of the mean diagonal entry, that nodes without stiffness have */

static enum status make_room(struct lower *lower, int64_t more, struct error *error)
{
    if (lower->count + more > lower->capacity) {
        int64_t capacity = (lower->count + more) / 4 * 5 + 4096;
        int32_t *idx = array_grow(lower->idx, capacity, sizeof *idx);
        lower->idx = idx != NULL ? idx : lower->idx;
        double *value = array_grow(lower->value, capacity, sizeof *value);
        lower->value = value != NULL ? value : lower->value;
        if (idx == NULL || value == NULL) {
            return fail_memory(error, "preconditioner");
        }
        lower->capacity = capacity;
    }
    return STATUS_OK;
}

static enum status keep_row(const struct scalar_row *row, int64_t i, struct lower *lower, struct error *error)
{
    enum status status;
    int64_t at = lower->count;
    TRY(make_room(lower, row->count, error));
    if (row->count > 0) {
        memcpy(lower->idx + at, row->node, (size_t)row->count * sizeof *row->node);
        memcpy(lower->value + at, row->value, (size_t)row->count * sizeof *row->value);
    }
    lower->begin[i] = at;
    lower->end[i] = lower->count = at + row->count;
done:
    return status;
}

enum status lower_make(const struct solid_system *system, struct lower *lower, struct error *error)
{
    enum status status;
    struct scalar_stiffness stiffness = {0};
    struct scalar_row row = {0};
    const struct body_share *share = &system->body.share;
    double sum = 0.0, *diagonal = NULL; /* in the body's order */
    int64_t nodes = system->node_count;
    TRY(scalar_stiffness_make(system, &stiffness, error));
    TRY(scalar_row_make(&stiffness, &row, error));
    TRY(NEW_ARRAY(&lower->begin, nodes, error));
    TRY(NEW_ARRAY(&lower->end, nodes, error));
    TRY(NEW_ARRAY(&diagonal, nodes, error));
    for (int64_t p = share->begin_node; p < share->end_node; p++) {
        int64_t i = system->body.node_order[p];
        scalar_stiffness_row(&stiffness, i, &row);
        diagonal[p] = row.count > 0 ? row.value[row.count - 1] : 0.0;
        TRY(keep_row(&row, i, lower, error));
    }
    ranks_gather(share->ranks, diagonal, sizeof *diagonal, share->node_first);
    for (int64_t i = 0; i < nodes; i++) {
        sum += diagonal[system->body.node_place[i]];
    }
    lower->least = least_share * sum / (double)nodes;
done:
    free(diagonal);
    scalar_row_free(&row);
    scalar_stiffness_free(&stiffness);
    return status;
}

double lower_entry(const struct lower *lower, int32_t i, int32_t j)
{
    int64_t low = lower->begin[i], high = lower->end[i];
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (lower->idx[middle] < j) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    double value = low < lower->end[i] && lower->idx[low] == j ? lower->value[low] : 0.0;
    return i == j ? fmax(value, lower->least) : value;
}

static int owner_of_node(const void *context, int64_t node)
{
    const struct body *body = context;
    return ranks_owner(body->share.ranks, body->share.node_first, body->node_place[node]);
}

enum status lower_fetch(const struct solid_system *system, const bool *wanted, struct lower *lower,
                        struct error *error)
{
    enum status status;
    const struct ranks *ranks = system->body.share.ranks;
    int64_t nodes = system->node_count;
    struct halo halo = {0};
    double *length = NULL, *value = NULL;
    int32_t *idx = NULL;
    int64_t *send_first = NULL, *receive_first = NULL, at = 0, first = lower->count;
    TRY(halo_build(ranks, nodes, wanted, 1, owner_of_node, &system->body, &halo, error));
    TRY(NEW_ARRAY(&length, nodes, error));
    TRY(NEW_ARRAY(&send_first, ranks->count + 1, error));
    TRY(NEW_ARRAY(&receive_first, ranks->count + 1, error));
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
            lower->begin[node] = first + receive_first[r + 1];
            receive_first[r + 1] += (int64_t)length[node];
            lower->end[node] = first + receive_first[r + 1];
        }
    }
    TRY(make_room(lower, receive_first[ranks->count], error));
    TRY(NEW_ARRAY(&idx, send_first[ranks->count], error));
    TRY(NEW_ARRAY(&value, send_first[ranks->count], error));
    for (int64_t i = 0; i < halo.send_first[ranks->count]; i++) {
        int64_t from = lower->begin[halo.send[i]], count = lower->end[halo.send[i]] - from;
        memcpy(idx + at, lower->idx + from, (size_t)count * sizeof *idx);
        memcpy(value + at, lower->value + from, (size_t)count * sizeof *value);
        at += count;
    }
    ranks->exchange(ranks, sizeof *idx, idx, send_first, lower->idx + first, receive_first);
    ranks->exchange(ranks, sizeof *value, value, send_first, lower->value + first, receive_first);
    lower->count += receive_first[ranks->count];
done:
    halo_free(&halo);
    free(length);
    free(send_first);
    free(receive_first);
    free(idx);
    free(value);
    return status;
}

void lower_free(struct lower *lower)
{
    free(lower->begin);
    free(lower->end);
    free(lower->idx);
    free(lower->value);
    *lower = (struct lower){0};
}
