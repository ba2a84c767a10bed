#include "model.h"

#include "approx/quadrature.h"
#include "io/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Share of the pointwise volumetric law kept beside the nodal averages, and its growth with the variance of J
 * within a hat (see body.h): nothing much where J is smooth, 10 % at a standard deviation of 5 %, where cells
 * would begin to fold. */
static const double default_pointwise_share = 0.05;
static const double share_growth = 20.0;

/* A compressible body does not lock, and averaging would only make it too soft in bending: all of the law
 * stays pointwise where the bulk modulus is no more than twice the shear modulus, little of it near
 * incompressibility. */
static double least_share(const struct material *material)
{
    double share = 2.0 * material->shear_modulus / material->bulk_modulus;
    return share > 0.0 && share < 1.0 ? share : 1.0;
}

static void set_material(const struct scene_material *section, struct material *material)
{
    static const enum material_model models[] = {[SCENE_NEO_HOOKEAN] = MATERIAL_NEO_HOOKEAN,
                                                 [SCENE_NEO_HOOKEAN_LOG] = MATERIAL_NEO_HOOKEAN_LOG,
                                                 [SCENE_MOONEY_RIVLIN] = MATERIAL_MOONEY_RIVLIN,
                                                 [SCENE_OGDEN] = MATERIAL_OGDEN,
                                                 [SCENE_ST_VENANT_KIRCHHOFF] = MATERIAL_ST_VENANT_KIRCHHOFF};
    *material = (struct material){.model = models[section->model],
                                  .density = section->density,
                                  .mooney_ratio = section->mooney_ratio,
                                  .ogden_alpha = section->ogden_alpha};
    material_set_moduli(material, section->youngs_modulus, section->poisson_ratio);
    material->least_share = least_share(material);
}

/* Materials of the scene, then one for each row of per-point tables. */
struct material_list {
    struct material *items;
    int64_t count;
    int32_t *of_point;
    int32_t *section; /* count: of the scene */
};

/* One row per integration point of the section's regions, in the order of the points: coordinates, E, nu. */
static enum status add_point_table(const struct model_input *input, int64_t m, struct material_list *list,
                                   struct error *error)
{
    enum status status;
    const struct scene_material *section = &input->scene->materials[m];
    const int32_t *cell = input->point_cell->data;
    const double *x = input->points->data;
    int dim = input->cells.dim;
    struct table table = {0};
    int64_t row = 0;
    TRY(table_read(section->table, dim + 2, dim + 2, &table, error));
    struct material *grown = array_grow(list->items, list->count + table.rows, sizeof *grown);
    if (grown == NULL) {
        status = fail_memory(error, "materials");
        goto done;
    }
    list->items = grown;
    for (int64_t q = 0; q < input->points->rows; q++) {
        if (input->cell_material[cell[q]] != m) {
            continue;
        }
        const double *values = table.values + row * table.cols;
        double away = 0.0;
        for (int a = 0; row < table.rows && a < dim; a++) {
            away = fmax(away, fabs(values[a] * section->table_unit - x[q * dim + a]));
        }
        if (row == table.rows || !(away <= 1e-6)) {
            status = scene_fail(
                error, STATUS_INPUT, input->scene, &section->label,
                "table %s: %lld rows do not match the integration points of its regions, first at "
                "point %lld (%g m away)",
                section->table, (long long)table.rows, (long long)q, row == table.rows ? 0.0 : away);
            goto done;
        }
        double modulus = values[dim], ratio = values[dim + 1];
        if (!(modulus > 0.0) || !(ratio > -1.0 && ratio < 0.5)) {
            status = scene_fail(error, STATUS_INPUT, input->scene, &section->label,
                                "%s:%lld: E = %g, nu = %g: E must be positive, nu within (-1, .5)",
                                section->table, (long long)table.line[row], modulus, ratio);
            goto done;
        }
        list->items[list->count] = list->items[m];
        material_set_moduli(&list->items[list->count], modulus, ratio);
        list->items[list->count].least_share = least_share(&list->items[list->count]);
        list->section[list->count] = (int32_t)m;
        list->of_point[q] = (int32_t)list->count++;
        row++;
    }
    if (row != table.rows) {
        status = scene_fail(error, STATUS_INPUT, input->scene, &section->label,
                            "table %s: %lld rows for %lld integration points", section->table,
                            (long long)table.rows, (long long)row);
    }
done:
    table_free(&table);
    return status;
}

static enum status list_materials(const struct model_input *input, struct material_list *list,
                                  struct error *error)
{
    enum status status = STATUS_OK;
    const int32_t *cell = input->point_cell->data;
    const struct scene *scene = input->scene;
    list->items = array_grow(NULL, scene->material_count, sizeof *list->items);
    if (list->items == NULL) {
        return fail_memory(error, "materials");
    }
    TRY(NEW_ARRAY(&list->of_point, input->points->rows, error));
    /* At most one for each section and for each point. */
    TRY(NEW_ARRAY(&list->section, scene->material_count + input->points->rows, error));
    list->count = scene->material_count;
    for (int64_t m = 0; m < scene->material_count; m++) {
        set_material(&scene->materials[m], &list->items[m]);
        list->section[m] = (int32_t)m;
    }
    for (int64_t q = 0; q < input->points->rows; q++) {
        list->of_point[q] = input->cell_material[cell[q]];
    }
    for (int64_t m = 0; m < scene->material_count; m++) {
        if (scene->materials[m].table != NULL) {
            TRY(add_point_table(input, m, list, error));
        }
    }
done:
    return status;
}

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

/* One point per cell, in the order of the cells. */
static bool has_conforming_cells(const struct model_input *input)
{
    char rule[32];
    return section_attribute(input->points, "rule", rule, sizeof rule) && strcmp(rule, "conforming") == 0 &&
           input->points->rows == input->cells.count;
}

static enum status build_body(const struct model_input *input, bool single, struct solid_system *system,
                              struct error *error)
{
    enum status status;
    struct material_list materials = {0};
    int32_t *hat_node = NULL;
    double *hat_value = NULL;
    const struct scene_solver *solver = &input->scene->solver;
    const int32_t *cell = input->point_cell->data;
    int dim = input->cells.dim, corners = dim + 1;
    int64_t count = input->points->rows;
    TRY(list_materials(input, &materials, error));
    if (solver->volume == SCENE_NODAL_VOLUME) {
        TRY(NEW_ARRAY(&hat_node, count * corners, error));
        TRY(NEW_ARRAY(&hat_value, count * corners, error));
        for (int64_t q = 0; q < count; q++) {
            for (int k = 0; k < corners; k++) {
                hat_node[q * corners + k] = input->cells.node[(int64_t)cell[q] * corners + k];
            }
            barycentric(&input->cells, cell[q], (const double *)input->points->data + q * dim,
                        hat_value + q * corners);
        }
    }
    struct quadrature_rule rule = quadrature_face_rule(dim);
    struct conforming_input conforming = {.x = input->cells.x,
                                          .cell_node = input->cells.node,
                                          .face_count = input->faces.count,
                                          .face_node = input->faces.node,
                                          .face_cell = input->faces.cell,
                                          .per_face = rule.points,
                                          .face_weight = rule.weight,
                                          .face_ptr = input->face_lists.ptr,
                                          .face_idx = input->face_lists.idx,
                                          .face_phi = input->face_phi};
    struct body_input body = {.dim = dim,
                              .node_x = input->cells.x,
                              .node_count = input->cells.node_count,
                              .point_count = count,
                              .x = input->points->data,
                              .weight = input->weight->data,
                              .ptr = input->point_lists.ptr,
                              .idx = input->point_lists.idx,
                              .dphi = input->dphi->data,
                              .materials = materials.items,
                              .material = materials.of_point,
                              .material_count = materials.count,
                              .group = materials.section,
                              .hat_node = hat_node,
                              .hat_value = hat_value,
                              .pointwise_share = solver->pointwise_share >= 0.0 ? solver->pointwise_share
                                                                                : default_pointwise_share,
                              .share_growth = share_growth,
                              .conforming = has_conforming_cells(input) ? &conforming : NULL,
                              .single = single};
    TRY(body_build(&body, &system->body, error));
    if (has_conforming_cells(input)) {
        struct compatibility_input compatibility = {.cell_node = input->cells.node,
                                                    .node_ptr = input->node_lists.ptr,
                                                    .node_idx = input->node_lists.idx,
                                                    .node_phi = input->node_phi};
        TRY(compatibility_build(&system->body, &compatibility, &system->compatibility, error));
        system->body.compatibility = &system->compatibility;
    }
done:
    free(materials.items);
    free(materials.of_point);
    free(materials.section);
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

enum status model_build(const struct stream *stream, const struct scene *scene, bool single,
                        struct model *model, struct error *error)
{
    enum status status;
    struct solid_system *system = &model->system;
    *model = (struct model){0};
    TRY(model_input_read(stream, scene, &model->input, error));
    system->dim = scene->dim;
    system->node_count = model->input.cells.node_count;
    system->X = model->input.cells.x;
    constraint_rows_init(&system->rows, scene->dim);
    constraint_rows_init(&system->springs, scene->dim);
    TRY(build_body(&model->input, single, system, error));
    TRY(lump_mass(&model->input, system, error));
    TRY(model_add_constraints(&model->input, system, error));
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
    free(model->row_force);
    model->row_force = NULL;
}
