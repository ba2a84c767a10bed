#include "solid/means.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* The means in the order of the table. */
struct mean_order {
    struct pairs_rows rows;
    int32_t *corners; /* row_count: of each of the caller's rows */
    int64_t *row;     /* these two belong to rows */
    int64_t *first_row;
};

static void order_free(struct mean_order *order)
{
    free(order->corners);
    free(order->row);
    free(order->first_row);
}

/* Blocks of means. All groups but the last are full. */
static enum status order_means(const struct means_input *input, struct mean_order *order, struct error *error)
{
    enum status status;
    int64_t rows = input->row_count, blocks = (rows + PAIRS_MAX_ROWS - 1) / PAIRS_MAX_ROWS;
    TRY(NEW_ARRAY(&order->corners, rows, error));
    TRY(NEW_ARRAY(&order->row, rows, error));
    TRY(NEW_ARRAY(&order->first_row, blocks + 1, error));
    for (int64_t i = 0; i < input->corner_count; i++) {
        order->corners[input->row_of_corner[i]]++;
    }
    memcpy(order->row, input->order, (size_t)rows * sizeof *order->row);
    for (int64_t b = 0; b < blocks; b++) {
        int64_t end = (b + 1) * PAIRS_MAX_ROWS;
        order->first_row[b + 1] = end < rows ? end : rows;
    }
    order->rows = (struct pairs_rows){.node_count = input->node_count,
                                      .row_count = rows,
                                      .ptr = input->ptr,
                                      .idx = input->idx,
                                      .row = order->row,
                                      .block_count = blocks,
                                      .first_row = order->first_row,
                                      .least_sharing = 2};
done:
    return status;
}

/* Which value each corner looks at, and the corners of each group. */
static enum status list_corners(const struct means_input *input, const struct mean_order *order,
                                struct means *means, struct error *error)
{
    enum status status;
    int64_t *place_of = NULL; /* of each of the caller's rows */
    int64_t groups = means->pairs.group_count;
    int32_t *filled = order->corners; /* from here on: how many of each row have been listed */
    TRY(NEW_ARRAY(&place_of, input->row_count, error));
    TRY(NEW_ARRAY(&means->of_corner, input->corner_count, error));
    TRY(NEW_ARRAY(&means->corner_ptr, groups + 1, error));
    for (int64_t g = 0; g < groups; g++) {
        int32_t most = 0;
        for (int64_t r = g * PAIRS_GROUP; r < (g + 1) * PAIRS_GROUP && r < input->row_count; r++) {
            int32_t corners = order->corners[order->row[r]];
            most = corners > most ? corners : most;
            place_of[order->row[r]] = r;
        }
        means->corner_ptr[g + 1] = means->corner_ptr[g] + most;
    }
    TRY(NEW_ARRAY(&means->corner, means->corner_ptr[groups] * PAIRS_GROUP, error));
    for (int64_t i = 0; i < means->corner_ptr[groups] * PAIRS_GROUP; i++) {
        means->corner[i] = (int32_t)input->corner_count;
    }
    memset(filled, 0, (size_t)input->row_count * sizeof *filled);
    for (int64_t i = 0; i < input->corner_count; i++) {
        int32_t row = input->row_of_corner[i];
        int64_t group = place_of[row] / PAIRS_GROUP, lane = place_of[row] % PAIRS_GROUP;
        means->of_corner[i] = (int32_t)(place_of[row] * PAIRS_STRIDE(input->dim));
        means->corner[(means->corner_ptr[group] + filled[row]++) * PAIRS_GROUP + lane] = (int32_t)i;
    }
done:
    free(place_of);
    return status;
}

enum status means_build(const struct means_input *input, struct means *means, struct error *error)
{
    enum status status;
    struct mean_order order = {0};
    *means = (struct means){0};
    if (input->row_count > INT32_MAX / PAIRS_STRIDE(input->dim)) {
        return fail(error, STATUS_INPUT, "%lld faces or nodes: too many", (long long)input->row_count);
    }
    TRY(order_means(input, &order, error));
    struct pairs_input pairs = {.rows = order.rows,
                                .dim = input->dim,
                                .width = 1,
                                .value = input->phi,
                                .place = input->place,
                                .passes = 2};
    TRY(pairs_build(&pairs, &means->pairs, error));
    TRY(NEW_ARRAY(&means->value, means->pairs.group_count * PAIRS_GROUP * PAIRS_STRIDE(input->dim), error));
    TRY(NEW_ARRAY(&means->corner_force, (input->corner_count + 1) * PAIRS_STRIDE(input->dim), error));
    TRY(list_corners(input, &order, means, error));
done:
    order_free(&order);
    if (status != STATUS_OK) {
        means_free(means);
    }
    return status;
}

void means_free(struct means *means)
{
    pairs_free(&means->pairs);
    free(means->value);
    free(means->of_corner);
    free(means->corner_force);
    free(means->corner_ptr);
    free(means->corner);
    *means = (struct means){0};
}
