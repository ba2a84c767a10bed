#include "model.h"

#include "io/table.h"

enum status model_initial(const struct model_input *input, double *u, double *v, struct error *error)
{
    enum status status;
    const struct scene *scene = input->scene;
    const struct scene_initial *initial = &scene->initial;
    const struct cells *cells = &input->cells;
    int dim = cells->dim;
    struct table table = {0};
    TRY(table_read(initial->table, 3 * dim, 3 * dim, &table, error));
    if (table.rows != cells->node_count) {
        TRY(fail(error, STATUS_INPUT, "%s: [initial]: table %s: %lld rows for %lld nodes: give one for each",
                 scene->path, initial->table, (long long)table.rows, (long long)cells->node_count));
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        const double *row = table.values + n * table.cols;
        if (!(model_away(input, row, initial->table_unit, cells->x + n * dim) <= MODEL_SAME_PLACE)) {
            TRY(fail(error, STATUS_INPUT,
                     "%s:%lld: not the place of node %lld: give the nodes in the order of the mesh",
                     initial->table, (long long)table.line[n], (long long)n));
        }
        for (int a = 0; a < dim; a++) {
            u[n * dim + a] = row[dim + a] * initial->table_unit;
            v[n * dim + a] = row[2 * dim + a] * initial->table_unit;
        }
    }
done:
    table_free(&table);
    return status;
}
