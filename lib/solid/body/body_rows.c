#include "solid/body/body_rows.h"

#include "base/memory.h"
#include "solid/body/body.h"

/* Which rows of the tables are copied, NULL: all, and of which nodes, in the body's order. */
struct copied {
    const struct body *body;
    const bool *wanted;
    int64_t first, last;
    bool lets_go; /* the memory of the first table is released step by step */
};

/* Copy number k of what list f of a table has of these nodes; idx NULL: only count. Returns how many. */
static int64_t copy_list(const struct copied *of, const struct row_table *table, int64_t f, int k,
                         int32_t *idx, double *value)
{
    int64_t count = 0;
    for (int64_t i = table->lists->ptr[f]; i < table->lists->ptr[f + 1]; i++) {
        int32_t node = of->body->order.places[table->lists->idx[i]];
        if (node >= of->first && node < of->last) {
            if (idx != NULL) {
                idx[count] = node;
                value[count] = table->phi[i * table->per + k];
            }
            count++;
        }
    }
    return count;
}

/* Set the lengths of the wanted rows of a table, which are those of the matrix from `begin` on; and copy
 * them, once the matrix has room. */
static void visit(const struct copied *of, const struct row_table *table, int64_t begin, int64_t *length,
                  struct sparse *matrix)
{
    enum { STEP = 1 << 20 };
    const struct neighbours *lists = table->lists;
    bool stores = matrix->idx != NULL;
    int64_t per = table->per, gone = 0;
    for (int64_t i = 0; i < lists->count * per; i++) {
        int64_t f = i / per, r = begin + table->place[f] * per + i % per;
        int64_t at = stores ? matrix->ptr[r] : 0;
        if (of->wanted == NULL || of->wanted[r]) {
            length[r] = copy_list(of, table, f, (int)(i % per), stores ? matrix->idx + at : NULL,
                                  stores ? matrix->value + at : NULL);
        }
        if (of->lets_go && stores && begin == 0 && lists->ptr[f + 1] - gone >= STEP) {
            memory_give_back(lists->idx + gone, STEP * sizeof *lists->idx);
            memory_give_back(table->phi + gone, STEP * sizeof *table->phi);
            gone += STEP;
        }
    }
}

static enum status copy(const struct copied *of, int count, const struct row_table *tables,
                        struct sparse *matrix, struct error *error)
{
    int64_t begin[2] = {0}, rows = 0, entries = 0;
    for (int t = 0; t < count; t++) {
        begin[t] = rows;
        rows += tables[t].lists->count * tables[t].per;
    }
    *matrix = (struct sparse){0};
    NEW_SCRATCH(int64_t, length, rows, error);
    for (int t = 0; t < count; t++) {
        visit(of, &tables[t], begin[t], length, matrix);
    }
    for (int64_t r = 0; r < rows; r++) {
        entries += length[r];
    }
    RETURN_IF_ERROR(sparse_new(rows, of->body->node_count, entries, matrix, error));
    for (int64_t r = 0; r < rows; r++) {
        matrix->ptr[r + 1] = matrix->ptr[r] + length[r];
    }
    for (int t = 0; t < count; t++) {
        visit(of, &tables[t], begin[t], length, matrix);
    }
    return STATUS_OK;
}

enum status body_rows_copy(const struct body_input *input, int count, const struct row_table *tables,
                           struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    struct row_operator *rows = &body->rows;
    bool alone = share->ranks == NULL;
    struct copied of = {.body = body, .last = body->node_count, .lets_go = alone && input->copied != NULL};
    SCRATCH bool *needed = NULL, *used = NULL;
    if (!alone) { /* the rows that own cells need, and the columns of own nodes */
        RETURN_IF_ERROR(body_share_values(body, &needed, error));
        of.wanted = needed;
    }
    RETURN_IF_ERROR(copy(&of, count, tables, &rows->matrix, error));
    RETURN_IF_ERROR(row_ranges_of(0, rows->matrix.row_count, needed, &share->values, error));
    if (!alone) {
        of = (struct copied){.body = body, .first = share->begin_node, .last = share->end_node};
        RETURN_IF_ERROR(copy(&of, count, tables, &rows->columns, error));
        RETURN_IF_ERROR(sparse_rows_used(&rows->columns, &used, error));
    } else if (input->copied != NULL) {
        input->copied(input->context);
    }
    return body_share_rows(body, used, error);
}
