/* The transpose of constraint rows, node by node. */
#include "base/chunks.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/constraint/constraint.h"

/* Empty the rows of nodes that are not wanted, and divide the weights by the mass. */
static void weigh(struct sparse *lists, const double *mass, const bool *wanted)
{
    int64_t at = 0, begin = 0;
    for (int64_t n = 0; n < lists->row_count; n++) {
        int64_t end = lists->ptr[n + 1];
        for (int64_t i = begin; i < end && (wanted == NULL || wanted[n]); i++, at++) {
            lists->idx[at] = lists->idx[i];
            lists->value[at] = mass != NULL ? lists->value[i] / mass[n] : lists->value[i];
        }
        begin = end;
        lists->ptr[n + 1] = at;
    }
}

enum status constraint_nodes_build(const struct constraint_rows *rows, int64_t node_count, const double *mass,
                                   const bool *wanted, struct constraint_nodes *nodes, struct error *error)
{
    const struct sparse by_list = constraint_rows_lists(rows, node_count);
    *nodes = (struct constraint_nodes){.rows = rows};
    RETURN_IF_ERROR(NEW_ARRAY(&nodes->on_list, rows->list_count * rows->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&nodes->used, rows->list_count, error));
    RETURN_IF_ERROR(sparse_transpose(&by_list, &nodes->lists, error));
    weigh(&nodes->lists, mass, wanted);
    for (int64_t i = 0; i < nodes->lists.ptr[node_count]; i++) {
        nodes->used[nodes->lists.idx[i]] = true;
    }
    return STATUS_OK;
}

void constraint_nodes_free(struct constraint_nodes *nodes)
{
    sparse_free(&nodes->lists);
    FREE_ALL(nodes->on_list, nodes->used);
    *nodes = (struct constraint_nodes){0};
}

void constraint_nodes_spread(const struct constraint_nodes *nodes, const double *amount, double *u)
{
    const struct constraint_rows *rows = nodes->rows;
    int dim = rows->dim;
    struct chunks chunks = chunks_for_threads(rows->list_count, rows->list_count, LISTS_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        for (int64_t l = chunks_begin(&chunks, c); l < chunks_begin(&chunks, c + 1); l++) {
            double *total = nodes->on_list + l * dim;
            for (int a = 0; a < dim; a++) {
                total[a] = 0.0;
            }
            for (int64_t r = rows->first[l]; r < rows->first[l + 1] && nodes->used[l]; r++) {
                add_scaled(dim, amount[r], rows->direction + r * dim, total);
            }
        }
    }
    sparse_add_rows(&nodes->lists, 0, nodes->lists.row_count, dim, nodes->on_list, u);
}
