#include "solid/field_averages.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* The averages in the order of the table. */
struct mean_order {
    struct operator_rows rows;
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

/* Blocks of averages. All slices but the last are full. */
static enum status order_averages(const struct field_averages_input *input, struct mean_order *order,
                                  struct error *error)
{
    enum status status;
    int64_t rows = input->row_count, blocks = (rows + OPERATOR_MAX_ROWS - 1) / OPERATOR_MAX_ROWS;
    TRY(NEW_ARRAY(&order->corners, rows, error));
    TRY(NEW_ARRAY(&order->row, rows, error));
    TRY(NEW_ARRAY(&order->first_row, blocks + 1, error));
    for (int64_t i = 0; i < input->corner_count; i++) {
        order->corners[input->row_of_corner[i]]++;
    }
    memcpy(order->row, input->order, (size_t)rows * sizeof *order->row);
    for (int64_t b = 0; b < blocks; b++) {
        int64_t end = (b + 1) * OPERATOR_MAX_ROWS;
        order->first_row[b + 1] = end < rows ? end : rows;
    }
    order->rows = (struct operator_rows){.node_count = input->node_count,
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

/* Which value each corner looks at, and the corners of each slice. */
static enum status list_corners(const struct field_averages_input *input, const struct mean_order *order,
                                struct field_averages *averages, struct error *error)
{
    enum status status;
    int64_t *place_of = NULL; /* of each of the caller's rows */
    int64_t slices = averages->op.slice_count;
    int32_t *filled = order->corners; /* from here on: how many of each row have been listed */
    TRY(NEW_ARRAY(&place_of, input->row_count, error));
    TRY(NEW_ARRAY(&averages->of_corner, input->corner_count, error));
    TRY(NEW_ARRAY(&averages->corner_ptr, slices + 1, error));
    for (int64_t g = 0; g < slices; g++) {
        int32_t most = 0;
        for (int64_t r = g * OPERATOR_SLICE; r < (g + 1) * OPERATOR_SLICE && r < input->row_count; r++) {
            int32_t corners = order->corners[order->row[r]];
            most = corners > most ? corners : most;
            place_of[order->row[r]] = r;
        }
        averages->corner_ptr[g + 1] = averages->corner_ptr[g] + most;
    }
    TRY(NEW_ARRAY(&averages->corner, averages->corner_ptr[slices] * OPERATOR_SLICE, error));
    for (int64_t i = 0; i < averages->corner_ptr[slices] * OPERATOR_SLICE; i++) {
        averages->corner[i] = (int32_t)input->corner_count;
    }
    memset(filled, 0, (size_t)input->row_count * sizeof *filled);
    for (int64_t i = 0; i < input->corner_count; i++) {
        int32_t row = input->row_of_corner[i];
        int64_t slice = place_of[row] / OPERATOR_SLICE, lane = place_of[row] % OPERATOR_SLICE;
        averages->of_corner[i] = (int32_t)(place_of[row] * OPERATOR_STRIDE(input->dim));
        averages->corner[(averages->corner_ptr[slice] + filled[row]++) * OPERATOR_SLICE + lane] = (int32_t)i;
    }
done:
    free(place_of);
    return status;
}

enum status field_averages_build(const struct field_averages_input *input, struct field_averages *averages,
                                 struct error *error)
{
    enum status status;
    struct mean_order order = {0};
    *averages = (struct field_averages){0};
    if (input->row_count > INT32_MAX / OPERATOR_STRIDE(input->dim)) {
        return fail(error, STATUS_INPUT, "%lld faces or nodes: too many", (long long)input->row_count);
    }
    TRY(order_averages(input, &order, error));
    struct operator_input op = {.rows = order.rows,
                                .dim = input->dim,
                                .width = 1,
                                .value = input->phi,
                                .place = input->place,
                                .passes = 2};
    TRY(sparse_operator_build(&op, &averages->op, error));
    TRY(NEW_ARRAY(&averages->value, averages->op.slice_count * OPERATOR_SLICE * OPERATOR_STRIDE(input->dim),
                  error));
    TRY(NEW_ARRAY(&averages->corner_force, (input->corner_count + 1) * OPERATOR_STRIDE(input->dim), error));
    TRY(list_corners(input, &order, averages, error));
done:
    order_free(&order);
    if (status != STATUS_OK) {
        field_averages_free(averages);
    }
    return status;
}

void field_averages_free(struct field_averages *averages)
{
    sparse_operator_free(&averages->op);
    free(averages->value);
    free(averages->of_corner);
    free(averages->corner_force);
    free(averages->corner_ptr);
    free(averages->corner);
    *averages = (struct field_averages){0};
}
