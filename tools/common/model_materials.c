#include "model.h"

#include "io/table.h"

#include <stdlib.h>

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
}

/* Row `row` of a table is that of point q, and holds moduli. */
static enum status check_row(const struct model_input *input, const struct scene_material *section,
                             const struct table *table, int64_t row, int64_t q, struct error *error)
{
    int dim = input->cells.dim;
    const double *x = (const double *)input->points->data + q * dim,
                 *values = table->values + row * table->cols;
    if (row == table->rows) {
        return scene_fail(error, STATUS_INPUT, input->scene, &section->label,
                          "table %s: %lld rows do not match the integration points of its regions: none is "
                          "left for point %lld",
                          section->table, (long long)table->rows, (long long)q);
    }
    double away = model_away(input, values, section->table_unit, x);
    if (!(away <= MODEL_SAME_PLACE)) {
        return scene_fail(error, STATUS_INPUT, input->scene, &section->label,
                          "%s:%lld: the rows do not match the integration points of its regions: %g m from "
                          "point %lld",
                          section->table, (long long)table->line[row], away * input->extent, (long long)q);
    }
    double modulus = values[dim], ratio = values[dim + 1];
    if (!(modulus > 0.0) || !(ratio > -1.0 && ratio < 0.5)) {
        return scene_fail(error, STATUS_INPUT, input->scene, &section->label,
                          "%s:%lld: E = %g, nu = %g: E must be positive, nu within (-1, .5)", section->table,
                          (long long)table->line[row], modulus, ratio);
    }
    return STATUS_OK;
}

/* One row per integration point of the section's regions, in the order of the points: coordinates, E, nu. */
static enum status add_point_table(const struct model_input *input, int64_t m, struct material_list *list,
                                   struct error *error)
{
    enum status status;
    const struct scene_material *section = &input->scene->materials[m];
    const int32_t *cell = input->point_cell->data;
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
        TRY(check_row(input, section, &table, row, q, error));
        const double *values = table.values + row++ * table.cols;
        struct material *material = &list->items[list->count];
        *material = list->items[m];
        material_set_moduli(material, values[dim], values[dim + 1]);
        list->section[list->count] = (int32_t)m;
        list->of_point[q] = (int32_t)list->count++;
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

enum status model_materials(const struct model_input *input, struct material_list *list, struct error *error)
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

void material_list_free(struct material_list *list)
{
    free(list->items);
    free(list->of_point);
    free(list->section);
    *list = (struct material_list){0};
}
