#include "mtled/model.h"
#include "images/images.h"

#include "base/vector.h"
#include "io/files/table.h"

static bool has_fibres(const struct scene_material *section)
{
    return vector_dot(3, section->directions, section->directions) > 0.0;
}

/* Check that row `row` of a table belongs to point q, and contains valid moduli. */
static enum status check_row(const struct model *model, const struct scene_material *section,
                             const struct table *table, int64_t row, int64_t q, struct error *error)
{
    int dim = model->assembly.cells.dim;
    const double *x = model->assembly.x + q * dim, *values = table->values + row * table->cols;
    if (row == table->rows) {
        return fail(error, STATUS_INPUT,
                    "%s: table %s: %jd rows do not match the integration points of its regions: none is "
                    "left for point %jd",
                    section->label.where, section->table, table->rows, q);
    }
    double away = model_away(model, values, section->table_unit, x);
    if (!(away <= MODEL_SAME_PLACE)) {
        return fail(error, STATUS_INPUT,
                    "%s: %s:%jd: the rows do not match the integration points of its regions: %g m from "
                    "point %jd: wrong unit, or make the table anew from this stream",
                    section->label.where, section->table, table->line[row], away * model->assembly.extent, q);
    }
    return fail_in(error, moduli_check(values + dim, error), "%s: %s:%jd", section->label.where,
                   section->table, table->line[row]);
}

/* Read a table with one row for each integration point of the section's regions, in their order: coordinates,
 * E, nu. */
static enum status add_point_table(struct model *model, int64_t m, struct error *error)
{
    struct material_list *list = &model->assembly.materials;
    const struct scene_material *section = &model->scene->materials[m];
    int dim = model->assembly.cells.dim;
    FREED_BY(table_free) struct table table = {0};
    int64_t row = 0;
    RETURN_IF_ERROR(table_read(section->table, dim + 2, dim + 2, &table, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&list->items, list->count + table.rows, error));
    for (int64_t q = 0; q < model->assembly.point_count; q++) {
        if (list->of_point[q] != m) {
            continue;
        }
        RETURN_IF_ERROR(check_row(model, section, &table, row, q, error));
        const double *values = table.values + row++ * table.cols;
        struct material *material = &list->items[list->count];
        *material = list->items[m];
        material_set_moduli(material, values[dim], values[dim + 1]);
        list->section[list->count] = list->group[list->count] = (int32_t)m;
        list->of_point[q] = (int32_t)list->count++;
    }
    if (row != table.rows) {
        return fail(error, STATUS_INPUT, "%s: table %s: %jd rows for %jd integration points",
                    section->label.where, section->table, table.rows, row);
    }
    return STATUS_OK;
}

/* material[names->count]: the material of each region; -1: the scene names none. */
static enum status materials_of_regions(const struct scene *scene, const struct names *names,
                                        int32_t *material, struct error *error)
{
    for (int64_t r = 0; r < names->count; r++) {
        material[r] = -1;
    }
    for (int64_t m = 0; m < scene->material_count; m++) {
        const struct scene_material *section = &scene->materials[m];
        for (int64_t i = 0; i < section->regions.count; i++) {
            int64_t region;
            RETURN_IF_ERROR(fail_in(error,
                                    names_need(names, "region", section->regions.names[i], &region, error),
                                    "%s", section->label.where));
            material[region] = (int32_t)m;
        }
    }
    return STATUS_OK;
}

/* Set the material of each cell from cells.region and the scene. */
static enum status materials_of_cells(struct model *model, struct error *error)
{
    const struct cells *cells = &model->assembly.cells;
    FREED_BY(groups_free) struct groups regions = {0};
    RETURN_IF_ERROR(stream_groups(model->stream, GROUP_REGION, true, &regions, error));
    NEW_SCRATCH(int32_t, material, regions.names.count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&model->assembly.materials.of_cell, cells->count, error));
    RETURN_IF_ERROR(materials_of_regions(model->scene, &regions.names, material, error));
    for (int64_t c = 0; c < cells->count; c++) {
        int32_t region = regions.group[c];
        if (material[region] < 0) {
            return fail(
                error, STATUS_INPUT,
                "%s: region '%s' has no material: add it to a [material], or leave it out (nodes -r; voxels "
                "-l)",
                model->scene->path, regions.names.name[region]);
        }
        model->assembly.materials.of_cell[c] = material[region];
    }
    return STATUS_OK;
}

enum status model_materials(struct model *model, struct error *error)
{
    const struct scene *scene = model->scene;
    int64_t points = model->assembly.point_count;
    struct material_list *list = &model->assembly.materials;
    RETURN_IF_ERROR(materials_of_cells(model, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&list->items, scene->material_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&list->of_point, points, error));
    /* At most one for each section and for each point. */
    RETURN_IF_ERROR(NEW_ARRAY(&list->section, scene->material_count + points, error));
    RETURN_IF_ERROR(NEW_ARRAY(&list->group, scene->material_count + points, error));
    list->count = scene->material_count;
    for (int64_t m = 0; m < scene->material_count; m++) {
        list->items[m] = scene->materials[m].material;
        list->items[m].parameters = scene->materials[m].parameters;
        list->items[m].fibre = has_fibres(&scene->materials[m]) ? scene->materials[m].directions : NULL;
        list->items[m].prony = scene->materials[m].prony.values;
        list->items[m].prony_terms = scene->materials[m].prony.terms;
        list->section[m] = list->group[m] = (int32_t)m;
        if (list->items[m].active > 0.0) {
            RETURN_IF_ERROR(model_add_curve(model, &scene->materials[m].label, &scene->materials[m].curve,
                                            &list->items[m].active_curve, error));
        }
    }
    for (int64_t q = 0; q < points; q++) {
        list->of_point[q] = list->of_cell[model->assembly.point_cell[q]];
    }
    for (int64_t m = 0; m < scene->material_count; m++) {
        if (scene->materials[m].table != NULL) {
            RETURN_IF_ERROR(add_point_table(model, m, error));
        }
        if (scene->materials[m].fibres != NULL || scene->materials[m].fibres_of_stream) {
            RETURN_IF_ERROR(model_fibres(model, m, error));
        }
    }
    bool none = scene->output.fibre;
    for (int64_t q = 0; q < points && none; q++) {
        none = list->items[list->of_point[q]].fibre == NULL;
    }
    return none ? fail(error, STATUS_INPUT, "%s: [output]: fibre: no material has fibres", scene->path)
                : STATUS_OK;
}
