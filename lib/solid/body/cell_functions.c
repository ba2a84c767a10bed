/* The shape functions on a cell and their mean gradients there; see smoothed_cells.h. */
#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/body.h"

#include <string.h>

enum status cell_functions_make(const struct body *body, struct cell_functions *functions,
                                struct error *error)
{
    const struct sparse *matrix = &body->rows.matrix;
    int64_t most = 0;
    int32_t row[SMOOTHED_MOST_ROWS];
    double gradient[SMOOTHED_MOST_ROWS * 3];
    *functions = (struct cell_functions){0};
    for (int64_t q = 0; q < body->point_count; q++) {
        int64_t sum = body->smoothed ? 0 : matrix->ptr[q * body->dim + 1] - matrix->ptr[q * body->dim];
        for (int64_t c = q; c < smoothed_cells_group_end(body, q) && body->smoothed; c++) {
            int count = smoothed_cells_rows(body, c, row, gradient);
            for (int r = 0; r < count; r++) {
                sum += matrix->ptr[row[r] + 1] - matrix->ptr[row[r]];
            }
        }
        most = sum > most ? sum : most;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&functions->slot, body->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&functions->node, most, error));
    return NEW_ARRAY(&functions->gradient, most * body->dim, error);
}

void cell_functions_free(struct cell_functions *functions)
{
    FREE_ALL(functions->slot, functions->node, functions->gradient);
    *functions = (struct cell_functions){0};
}

/* Add to the gradient of the shape function of a node. A set by two arrays that need no clearing: Briggs and
 * Torczon 1993. */
static inline void add_function(int32_t node, int dim, double factor, const double *gradient,
                                struct cell_functions *functions)
{
    int32_t at = functions->slot[node];
    if (at >= functions->count || functions->node[at] != node) {
        at = functions->slot[node] = (int32_t)functions->count++;
        functions->node[at] = node;
        memset(functions->gradient + at * dim, 0, (size_t)dim * sizeof *functions->gradient);
    }
    add_scaled(dim, factor, gradient, functions->gradient + at * dim);
}

void cell_functions_list(const struct body *body, int64_t q, struct cell_functions *functions)
{
    const struct sparse *matrix = &body->rows.matrix;
    int dim = body->dim;
    functions->count = 0;
    for (int64_t c = smoothed_cells_group(body, q); c < smoothed_cells_group_end(body, q); c++) {
        int32_t row[SMOOTHED_MOST_ROWS];
        double gradient[SMOOTHED_MOST_ROWS * 3], share = smoothed_cells_share(body, c);
        int count = smoothed_cells_rows(body, c, row, gradient);
        for (int r = 0; r < count; r++) {
            for (int64_t i = matrix->ptr[row[r]]; i < matrix->ptr[row[r] + 1]; i++) {
                add_function(matrix->idx[i], dim, share * matrix->value[i], gradient + r * dim, functions);
            }
        }
    }
}

void cell_functions_list_linear(const struct body *body, int64_t q, struct cell_functions *functions)
{
    functions->count = 0;
    for (int64_t c = smoothed_cells_group(body, q); c < smoothed_cells_group_end(body, q); c++) {
        double gradient[12];
        smoothed_cells_linear_gradients(body, c, gradient);
        for (int k = 0; k <= body->dim; k++) {
            add_function(smoothed_cells_node(body, c, k), body->dim, smoothed_cells_share(body, c),
                         gradient + k * body->dim, functions);
        }
    }
}
