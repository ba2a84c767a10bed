#include "solid/body/body_rows.h"

#include "base/memory.h"
#include "solid/body/body.h"

/* The rows of a table are those of the matrix from `begin` on. Mark in used[] those with own nodes. */
static void mark_used(const struct body *body, const struct row_table *table, int64_t begin, bool *used)
{
    const struct neighbours *lists = table->lists;
    for (int64_t f = 0; f < lists->count; f++) {
        bool *of_list = used + begin + table->place[f] * table->per;
        for (int64_t i = lists->ptr[f]; i < lists->ptr[f + 1] && !of_list[0]; i++) {
            int32_t node = body->order.places[lists->idx[i]];
            for (int k = 0; k < table->per; k++) {
                of_list[k] = node >= body->share.begin_node && node < body->share.end_node;
            }
        }
    }
}

/* Copy the rows of a table that have room. lets_go: release the memory of the table step by step. */
static void copy(const struct body *body, const struct row_table *table, int64_t begin, bool lets_go,
                 struct sparse *matrix)
{
    enum { STEP = 1 << 20 };
    const struct neighbours *lists = table->lists;
    int64_t per = table->per, gone = 0;
    for (int64_t l = 0; l < lists->count * per; l++) {
        int64_t f = l / per, r = begin + table->place[f] * per + l % per, at = matrix->ptr[r];
        for (int64_t i = lists->ptr[f]; i < lists->ptr[f + 1] && matrix->ptr[r + 1] > at; i++) {
            matrix->idx[at + i - lists->ptr[f]] = body->order.places[lists->idx[i]];
            matrix->value[at + i - lists->ptr[f]] = table->phi[i * per + l % per];
        }
        if (lets_go && lists->ptr[f + 1] - gone >= STEP) {
            memory_give_back(lists->idx + gone, STEP * sizeof *lists->idx);
            memory_give_back(table->phi + gone, STEP * sizeof *table->phi);
            gone += STEP;
        }
    }
}

enum status body_rows_copy(const struct body_input *input, int count, const struct row_table *tables,
                           struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    struct sparse *matrix = &body->rows.matrix;
    bool alone = share->ranks == NULL;
    int64_t begin[2] = {0}, rows = 0, entries = 0;
    SCRATCH bool *needed = NULL, *used = NULL; /* by own cells; with own nodes */
    for (int t = 0; t < count; t++) {
        begin[t] = rows;
        rows += tables[t].lists->count * tables[t].per;
    }
    if (!alone) {
        RETURN_IF_ERROR(body_share_values(body, &needed, error));
        RETURN_IF_ERROR(NEW_ARRAY(&used, rows, error));
    }
    NEW_SCRATCH(int64_t, length, rows, error);
    for (int t = 0; t < count; t++) {
        const struct row_table *table = &tables[t];
        if (!alone) {
            mark_used(body, table, begin[t], used);
        }
        for (int64_t l = 0; l < table->lists->count * table->per; l++) {
            int64_t f = l / table->per, r = begin[t] + table->place[f] * table->per + l % table->per;
            length[r] = alone || needed[r] || used[r] ? table->lists->ptr[f + 1] - table->lists->ptr[f] : 0;
            entries += length[r];
        }
    }
    RETURN_IF_ERROR(sparse_new(rows, body->node_count, entries, matrix, error));
    for (int64_t r = 0; r < rows; r++) {
        matrix->ptr[r + 1] = matrix->ptr[r] + length[r];
    }
    for (int t = 0; t < count; t++) {
        copy(body, &tables[t], begin[t], alone && input->copied != NULL && t == 0, matrix);
    }
    if (alone && input->copied != NULL) {
        input->copied(input->context);
    }
    RETURN_IF_ERROR(row_ranges_of(0, rows, needed, &share->values, error));
    return body_share_rows(body, used, error);
}
