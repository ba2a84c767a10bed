#include "solid/operators/row_operator.h"

#include "base/memory.h"

#include <stdlib.h>

/* Divide the columns into stripes with about the same number of entries. */
static enum status cut_columns(struct row_operator *rows, const int32_t *count, int64_t begin, int64_t end,
                               int threads, struct error *error)
{
    int64_t entries = 0, sum = 0;
    for (int64_t c = begin; c < end; c++) {
        entries += count[c];
    }
    RETURN_IF_ERROR(NEW_ARRAY(&rows->stripes, threads, error));
    rows->stripe_count = threads;
    for (int s = 0; s < threads; s++) {
        struct row_stripe *stripe = &rows->stripes[s];
        stripe->begin = begin;
        while (begin < end && (s == threads - 1 || sum < entries / threads * (s + 1))) {
            sum += count[begin++];
        }
        stripe->end = begin;
    }
    return STATUS_OK;
}

/* Whether row r has an entry in the columns of a stripe. */
static bool has_entry(const struct sparse *table, int64_t r, const struct row_stripe *stripe)
{
    bool has = false;
    for (int64_t i = table->ptr[r]; i < table->ptr[r + 1] && !has; i++) {
        has = table->idx[i] >= stripe->begin && table->idx[i] < stripe->end;
    }
    return has;
}

/* List the rows of a stripe; range: as find_ranges sets it. */
static enum status list_rows(const struct sparse *table, const int32_t *range, struct row_stripe *stripe,
                             struct error *error)
{
    int64_t room = 0;
    for (int64_t r = 0; r < table->row_count; r++) {
        room += range[2 * r] < stripe->end && range[2 * r + 1] >= stripe->begin;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&stripe->row, room, error));
    for (int64_t r = 0; r < table->row_count; r++) {
        if (range[2 * r] >= stripe->begin && range[2 * r + 1] < stripe->end && range[2 * r + 1] >= 0) {
            stripe->row[stripe->row_count++] = (int32_t)r;
        } else if (range[2 * r] < stripe->end && range[2 * r + 1] >= stripe->begin &&
                   has_entry(table, r, stripe)) {
            stripe->row[stripe->row_count++] = (int32_t)(-1 - r);
        }
    }
    return STATUS_OK;
}

/* (*range)[2 * rows]: the first and the last column of each row. In an empty row, the last one is less than
 * the first. */
static enum status find_ranges(const struct row_operator *rows, int32_t **range, struct error *error)
{
    const struct sparse *table = &rows->matrix;
    enum status status = NEW_ARRAY(range, 2 * table->row_count, error);
    for (int64_t r = 0; r < table->row_count && status == STATUS_OK; r++) {
        int32_t low = INT32_MAX, high = -1;
        for (int64_t i = table->ptr[r]; i < table->ptr[r + 1]; i++) {
            int32_t column = table->idx[i];
            low = column < low ? column : low;
            high = column > high ? column : high;
        }
        (*range)[2 * r] = low;
        (*range)[2 * r + 1] = high;
    }
    return status;
}

enum status row_operator_finish(struct row_operator *rows, int64_t begin, int64_t end, int threads,
                                struct error *error)
{
    const struct sparse *table = &rows->matrix;
    SCRATCH int32_t *range = NULL;
    if (table->column_count > INT32_MAX) {
        return fail(error, STATUS_INPUT, "%lld nodes: too many", (long long)table->column_count);
    }
    NEW_SCRATCH(int32_t, count, table->column_count, error);
    for (int64_t i = 0; i < table->ptr[table->row_count]; i++) {
        count[table->idx[i]]++;
    }
    RETURN_IF_ERROR(cut_columns(rows, count, begin, end, threads, error));
    RETURN_IF_ERROR(find_ranges(rows, &range, error));
    for (int s = 0; s < threads; s++) {
        RETURN_IF_ERROR(list_rows(table, range, &rows->stripes[s], error));
    }
    return STATUS_OK;
}

void row_operator_free(struct row_operator *rows)
{
    for (int s = 0; s < rows->stripe_count; s++) {
        free(rows->stripes[s].row);
    }
    free(rows->stripes);
    sparse_free(&rows->matrix);
    *rows = (struct row_operator){0};
}
