#include "mtled/model.h"

#include "process.h"

#include <math.h>
#include <stdlib.h>

static void drop_copied(void *stream)
{
    stream_remove(stream, "edge.ptr");
    stream_remove(stream, "edge.idx");
    stream_remove(stream, "edge.phi");
}

enum status model_build(struct stream *stream, const struct scene *scene, struct model *model,
                        struct error *error)
{
    struct assembly *input = &model->assembly;
    bool renewed;
    *model = (struct model){.stream = stream, .scene = scene};
    RETURN_IF_ERROR(stream_cells(stream, true, &input->cells, error));
    if (scene->dim != input->cells.dim) {
        return fail(error, STATUS_INPUT, "%s: dim = %d, but the nodes have %d coordinates", scene->path,
                    scene->dim, input->cells.dim);
    }
    RETURN_IF_ERROR(stage_tables(stream, input, error));
    RETURN_IF_ERROR(model_materials(model, error));
    RETURN_IF_ERROR(model_interfaces(model, stream, &renewed, error));
    if (renewed) {
        RETURN_IF_ERROR(stage_tables(stream, input, error));
    }
    RETURN_IF_ERROR(model_conditions(model, error));
    input->ranks = process_ranks();
    input->copied = drop_copied;
    input->context = stream;
    RETURN_IF_ERROR(assembly_build(input, &model->system, &model->note, error));
    return NEW_ARRAY(&model->row_force, model->system.rows.count, error);
}

void model_free(struct model *model)
{
    for (int64_t i = 0; i < model->assembly.curve_count; i++) {
        curve_free(&model->assembly.curves[i]);
    }
    free(model->assembly.curves);
    owned_free(&model->owned);
    material_list_free(&model->assembly.materials);
    system_free(&model->system);
    free(model->row_force);
    *model = (struct model){0};
}

double model_away(const struct model *model, const double *row, double unit, const double *x)
{
    double away = 0.0;
    for (int a = 0; a < model->assembly.cells.dim; a++) {
        away = fmax(away, fabs(row[a] * unit - x[a]));
    }
    return away / model->assembly.extent;
}
