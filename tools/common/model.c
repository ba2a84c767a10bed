#include "model.h"

#include "process.h"

#include "approx/quadrature.h"
#include "base/box.h"

#include <math.h>
#include <stdlib.h>

static const double farthest_moments = 1e6; /* of the body's size */

/* The integration points. */
static enum status read_points(const struct stream *stream, struct assembly *input, struct error *error)
{
    enum status status;
    const struct section *points, *weight, *cell;
    TRY(stream_need(stream, "points.x", TYPE_F8, input->cells.dim, "ipoints", &points, error));
    TRY(stream_need(stream, "points.weight", TYPE_F8, 1, "ipoints", &weight, error));
    TRY(stream_need(stream, "points.cell", TYPE_I4, 1, "ipoints", &cell, error));
    input->smoothed = points_are_smoothed(points);
    input->point_count = points->rows;
    input->x = points->data;
    input->weight = weight->data;
    input->point_cell = cell->data;
    if (weight->rows != points->rows || cell->rows != points->rows ||
        (input->smoothed && points->rows != input->cells.count)) {
        status =
            fail(error, STATUS_INPUT, "points.x, points.weight, points.cell: do not fit: run ipoints again");
        goto done;
    }
    for (int64_t q = 0; q < input->point_count; q++) {
        int32_t of_point = input->point_cell[q];
        if (of_point < 0 || of_point >= input->cells.count) {
            status =
                fail(error, STATUS_INPUT,
                     "points.cell: row %lld: no cell %d: an evaluation lattice cannot be integrated over",
                     (long long)q, of_point);
            goto done;
        }
    }
done:
    return status;
}

/* A table of shapefn: sections PREFIX.ptr and .idx, and values or gradients on these lists. */
static enum status read_table(const struct stream *stream, const char *prefix, const char *values, int cols,
                              int64_t rows, int64_t node_count, struct neighbours *lists, const double **phi,
                              struct error *error)
{
    enum status status;
    const struct section *section;
    TRY(stream_need(stream, values, TYPE_F8, cols, "shapefn", &section, error));
    TRY(stream_neighbours(stream, prefix, rows, node_count, lists, error));
    if (section->rows != lists->ptr[rows]) {
        status = fail(error, STATUS_INPUT, "%s: does not fit %s.idx: run shapefn again", values, prefix);
    }
    *phi = section->data;
done:
    return status;
}

/* The tables over points or faces, over the boundary, and over the nodes. */
static enum status read_tables(const struct stream *stream, struct assembly *input, struct error *error)
{
    enum status status;
    int dim = input->cells.dim, per_face = OWN_POINTS(dim);
    int64_t nodes = input->cells.node_count, points = input->point_count;
    TRY(stream_faces(stream, &input->cells, &input->faces, error));
    if (input->smoothed) {
        TRY(read_table(stream, "face", "face.phi", 1, input->faces.row_count, nodes, &input->lists,
                       &input->phi, error));
    } else {
        TRY(read_table(stream, "nbr", "shape.phi", 1, points, nodes, &input->lists, &input->phi, error));
        TRY(read_table(stream, "nbr", "shape.dphi", dim, points, nodes, &input->lists, &input->dphi, error));
    }
    TRY(read_table(stream, "boundary", "boundary.phi", 1, input->faces.boundary_count * per_face, nodes,
                   &input->boundary_lists, &input->boundary_phi, error));
    TRY(read_table(stream, "node", "node.phi", 1, nodes, nodes, &input->node_lists, &input->node_phi, error));
done:
    return status;
}

/* Moments about a point that far away are differences of huge numbers: a unit or a sign is wrong. */
static enum status check_moments(const struct model *model, struct error *error)
{
    const struct scene_output *output = &model->scene->output;
    const struct cells *cells = &model->assembly.cells;
    struct box box = box_of(cells->dim, cells->node_count, cells->x);
    for (int a = 0; a < cells->dim && output->moments; a++) {
        double away = fmax(box.low[a] - output->about[a], output->about[a] - box.high[a]);
        if (!(away <= farthest_moments * model->assembly.extent)) {
            return fail(
                error, STATUS_INPUT,
                "%s: [output]: moments_about: %.3g m from the body of %.3g m: give a point near it, in m",
                model->scene->path, away, model->assembly.extent);
        }
    }
    return STATUS_OK;
}

static void drop_copied(void *stream)
{
    static const char *const names[] = {"face.ptr", "face.idx", "face.phi"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        stream_remove(stream, names[i]);
    }
}

enum status model_build(struct stream *stream, const struct scene *scene, struct model *model,
                        struct error *error)
{
    enum status status;
    struct assembly *input = &model->assembly;
    *model = (struct model){.stream = stream, .scene = scene};
    TRY(stream_cells(stream, true, &input->cells, error));
    if (scene->dim != input->cells.dim) {
        status = fail(error, STATUS_INPUT, "%s: dim = %d, but the nodes have %d coordinates", scene->path,
                      scene->dim, input->cells.dim);
        goto done;
    }
    TRY(read_points(stream, input, error));
    TRY(read_tables(stream, input, error));
    TRY(stage_sides(stream, "support", &input->cell_side, error));
    assembly_complete(input);
    TRY(model_materials(model, error));
    TRY(model_interfaces(model, error));
    TRY(check_moments(model, error));
    TRY(model_conditions(model, error));
    input->ranks = process_ranks();
    input->copied = drop_copied;
    input->context = stream;
    TRY(assembly_build(input, &model->system, &model->note, error));
    TRY(NEW_ARRAY(&model->row_force, model->system.rows.count, error));
done:
    if (status != STATUS_OK) {
        model_free(model);
    }
    return status;
}

void model_free(struct model *model)
{
    for (int64_t i = 0; i < model->assembly.curve_count; i++) {
        curve_free(&model->assembly.curves[i]);
    }
    free(model->assembly.curves);
    for (int64_t i = 0; i < model->owned_count; i++) {
        free(model->owned[i]);
    }
    free(model->owned);
    material_list_free(&model->assembly.materials);
    system_free(&model->system);
    free(model->row_force);
    *model = (struct model){0};
}

enum status model_own(struct model *model, void *array, struct error *error)
{
    void **grown = array_grow(model->owned, model->owned_count + 1, sizeof *grown);
    if (grown == NULL) {
        free(array);
        return fail_memory(error, "conditions");
    }
    model->owned = grown;
    model->owned[model->owned_count++] = array;
    return STATUS_OK;
}

double model_away(const struct model *model, const double *row, double unit, const double *x)
{
    double away = 0.0;
    for (int a = 0; a < model->assembly.cells.dim; a++) {
        away = fmax(away, fabs(row[a] * unit - x[a]));
    }
    return away / model->assembly.extent;
}
