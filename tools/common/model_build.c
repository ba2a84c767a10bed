#include "model.h"

#include "base/box.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double farthest_moments = 1e6; /* of the body's size */

/* Barycentric coordinates of a point in a cell. */
static void barycentric(const struct cells *cells, int64_t cell, const double *x, double *value)
{
    int dim = cells->dim;
    double moved_x[12];
    const int32_t *v = cells->node + cell * (dim + 1);
    static const int32_t in_order[4] = {0, 1, 2, 3};
    struct cells one = {.dim = dim, .node_count = dim + 1, .x = moved_x, .count = 1, .node = in_order};
    double volume = cell_volume(cells, cell);
    for (int k = 0; k <= dim; k++) {
        for (int i = 0; i <= dim; i++) {
            for (int a = 0; a < dim; a++) {
                moved_x[i * dim + a] = i == k ? x[a] : cells->x[(int64_t)v[i] * dim + a];
            }
        }
        value[k] = cell_volume(&one, 0) / volume;
    }
}

/* node, value[point_count * (dim + 1)]: the vertices of the cell of each point, and their hat functions
 * there. */
static enum status list_hats(const struct model_input *input, int32_t **node, double **value,
                             struct error *error)
{
    enum status status;
    const struct cells *cells = &input->cells;
    const int32_t *cell = input->point_cell->data;
    const double *x = input->points->data;
    int corners = cells->dim + 1;
    TRY(NEW_ARRAY(node, input->points->rows * corners, error));
    TRY(NEW_ARRAY(value, input->points->rows * corners, error));
    for (int64_t q = 0; q < input->points->rows; q++) {
        memcpy(*node + q * corners, cells->node + (int64_t)cell[q] * corners,
               (size_t)corners * sizeof **node);
        barycentric(cells, cell[q], x + q * cells->dim, *value + q * corners);
    }
done:
    return status;
}

static enum status build_body(const struct model_input *input, struct solid_system *system,
                              struct error *error)
{
    enum status status;
    struct material_list materials = {0};
    int32_t *hat_node = NULL;
    double *hat_value = NULL;
    const struct scene_solver *solver = &input->scene->solver;
    int dim = input->cells.dim;
    TRY(model_materials(input, &materials, error));
    if (input->smoothed && model_holds_averages(input)) {
        TRY(model_soften_ends(input, &materials, error));
    }
    if (solver->volume == SCENE_NODAL_VOLUME) {
        TRY(list_hats(input, &hat_node, &hat_value, error));
    }
    struct smoothed_cells_input smoothed = {.x = input->cells.x,
                                            .cell_node = input->cells.node,
                                            .face_count = input->faces.count,
                                            .face_node = input->faces.node,
                                            .face_cell = input->faces.cell,
                                            .face_ptr = input->lists.ptr,
                                            .face_idx = input->lists.idx,
                                            .face_phi = input->phi,
                                            .node_ptr = input->node_lists.ptr,
                                            .node_idx = input->node_lists.idx,
                                            .node_phi = input->node_phi};
    struct body_input body = {.dim = dim,
                              .node_x = input->cells.x,
                              .node_count = input->cells.node_count,
                              .point_count = input->points->rows,
                              .x = input->points->data,
                              .weight = input->weight->data,
                              .ptr = input->smoothed ? NULL : input->lists.ptr,
                              .idx = input->smoothed ? NULL : input->lists.idx,
                              .dphi = input->dphi,
                              .materials = materials.items,
                              .material = materials.of_point,
                              .material_count = materials.count,
                              .group = materials.section,
                              .hat_node = hat_node,
                              .hat_value = hat_value,
                              .smoothed = input->smoothed ? &smoothed : NULL};
    TRY(body_build(&body, &system->body, error));
done:
    material_list_free(&materials);
    free(hat_node);
    free(hat_value);
    return status;
}

/* Each cell shares its mass equally among its nodes: positive, and of the right total and centre. */
static enum status lump_mass(const struct model_input *input, struct solid_system *system,
                             struct error *error)
{
    enum status status;
    int corners = input->cells.dim + 1;
    TRY(NEW_ARRAY(&system->lumped_mass, input->cells.node_count, error));
    for (int64_t c = 0; c < input->cells.count; c++) {
        double density = input->scene->materials[input->cell_material[c]].density;
        for (int k = 0; k < corners; k++) {
            system->lumped_mass[input->cells.node[c * corners + k]] +=
                density * cell_volume(&input->cells, c) / corners;
        }
    }
    for (int64_t n = 0; n < input->cells.node_count; n++) {
        if (!(system->lumped_mass[n] > 0.0)) {
            status = fail(error, STATUS_INPUT, "nodes.x: row %lld: the node is in no cell: it has no mass",
                          (long long)n);
            goto done;
        }
    }
done:
    return status;
}

/* Moments about a point that far away are differences of huge numbers: a unit or a sign is wrong. */
static enum status check_moments(const struct model_input *input, struct error *error)
{
    const double *about = input->scene->output.about;
    struct box box = box_of(input->cells.dim, input->cells.node_count, input->cells.x);
    for (int a = 0; a < input->cells.dim && input->scene->output.moments; a++) {
        double away = fmax(box.low[a] - about[a], about[a] - box.high[a]);
        if (!(away <= farthest_moments * input->extent)) {
            return fail(
                error, STATUS_INPUT,
                "%s: [output]: moments_about: %.3g m from the body of %.3g m: give a point near it, in m",
                input->scene->path, away, input->extent);
        }
    }
    return STATUS_OK;
}

enum status model_build(const struct stream *stream, const struct scene *scene, struct model *model,
                        struct error *error)
{
    enum status status;
    struct solid_system *system = &model->system;
    *model = (struct model){0};
    TRY(model_input_read(stream, scene, &model->input, error));
    TRY(check_moments(&model->input, error));
    system->dim = scene->dim;
    system->node_count = model->input.cells.node_count;
    system->X = model->input.cells.x;
    constraint_rows_init(&system->rows, scene->dim);
    constraint_rows_init(&system->penalties, scene->dim);
    TRY(build_body(&model->input, system, error));
    system->node_lists = &model->input.node_lists;
    system->node_phi = model->input.node_phi;
    TRY(lump_mass(&model->input, system, error));
    TRY(model_add_constraints(&model->input, system, &model->note, error));
    TRY(model_add_points(&model->input, system, &model->note, error));
    TRY(NEW_ARRAY(&model->condition_names, scene->displacement_count, error));
    for (int64_t i = 0; i < scene->displacement_count; i++) {
        model->condition_names[i] = scene->displacements[i].label.name;
    }
    system->condition_names = model->condition_names;
    TRY(NEW_ARRAY(&model->row_force, system->rows.count, error));
    TRY(model_add_loads(&model->input, system, error));
    TRY(model_add_contacts(&model->input, system, error));
done:
    if (status != STATUS_OK) {
        model_free(model);
    }
    return status;
}

void model_free(struct model *model)
{
    model_input_free(&model->input);
    system_free(&model->system);
    free(model->condition_names);
    free(model->row_force);
    model->condition_names = NULL;
    model->row_force = NULL;
}
