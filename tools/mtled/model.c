/* The model as a whole, its groups, and the materials of regions and points. */
#include "mtled/model.h"

#include "images/images.h"
#include "process.h"

#include "base/vector.h"
#include "io/files/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- groups ---- */

/* The facet groups or node sets of the stream, and (*wanted)[groups->names.count], to be freed: whether each
 * is among the names. */
static enum status choose(const struct model *model, const struct scene_label *label,
                          const struct name_list *names, enum group_kind kind, struct groups *groups,
                          bool **wanted, struct error *error)
{
    bool facets = kind == GROUP_FACETS;
    RETURN_IF_ERROR(
        fail_in(error, stream_groups(model->stream, kind, false, groups, error), "%s", label->where));
    if (groups->names.count == 0) {
        return fail(error, STATUS_INPUT,
                    facets ? "%s: no named facets: give the mesh physical groups, or run tag"
                           : "%s: no node sets: run tag -n",
                    label->where);
    }
    RETURN_IF_ERROR(NEW_ARRAY(wanted, groups->names.count, error));
    for (int64_t i = 0; i < names->count; i++) {
        int64_t group;
        RETURN_IF_ERROR(fail_in(
            error,
            names_need(&groups->names, facets ? "facet group" : "node set", names->names[i], &group, error),
            "%s", label->where));
        (*wanted)[group] = true;
    }
    return STATUS_OK;
}

bool model_is_whole(const struct name_list *names)
{
    return names->count == 1 && strcmp(names->names[0], "*") == 0;
}

enum status model_facets(struct model *model, const struct scene_label *label, const struct name_list *names,
                         struct facet_set *set, struct error *error)
{
    const struct faces *boundary = &model->assembly.boundary;
    FREED_BY(groups_free) struct groups facets = {0};
    SCRATCH bool *wanted = NULL;
    int32_t *chosen;
    int dim = model->assembly.cells.dim;
    *set = (struct facet_set){0};
    if (model_is_whole(names)) {
        *set = (struct facet_set){boundary->count, boundary->node};
        return STATUS_OK;
    }
    for (int64_t i = 0; i < names->count; i++) {
        if (strcmp(names->names[i], "*") == 0) {
            return fail(error, STATUS_INPUT, "%s: *, the whole boundary, stands alone", label->where);
        }
    }
    RETURN_IF_ERROR(choose(model, label, names, GROUP_FACETS, &facets, &wanted, error));
    RETURN_IF_ERROR(MODEL_ARRAY(model, &chosen, facets.count * dim, error));
    NEW_SCRATCH(int64_t, face, facets.count, error);
    RETURN_IF_ERROR(faces_find(boundary, facets.count, facets.node, face, error));
    NEW_SCRATCH(bool, taken, boundary->count, error);
    for (int64_t f = 0; f < facets.count; f++) {
        if (!wanted[facets.group[f]] || (face[f] >= 0 && taken[face[f]])) {
            continue;
        }
        if (face[f] >= 0) {
            taken[face[f]] = true;
        }
        memcpy(chosen + set->count++ * dim, facets.node + f * dim, (size_t)dim * sizeof *chosen);
    }
    set->facet = chosen;
    if (set->count == 0) {
        return fail(error, STATUS_INPUT, "%s: its facet groups are empty", label->where);
    }
    return STATUS_OK;
}

enum status model_nodes(struct model *model, const struct scene_label *label, const struct name_list *names,
                        const int32_t **nodes, int64_t *count, struct error *error)
{
    FREED_BY(groups_free) struct groups sets = {0};
    SCRATCH bool *wanted = NULL;
    int32_t *chosen;
    int64_t node_count = model->assembly.cells.node_count;
    *count = 0;
    RETURN_IF_ERROR(choose(model, label, names, GROUP_NODES, &sets, &wanted, error));
    NEW_SCRATCH(bool, member, node_count, error);
    for (int64_t i = 0; i < sets.count; i++) {
        member[sets.node[i]] |= wanted[sets.group[i]];
    }
    RETURN_IF_ERROR(MODEL_ARRAY(model, &chosen, node_count, error));
    *nodes = chosen;
    for (int64_t n = 0; n < node_count; n++) {
        if (member[n]) {
            chosen[(*count)++] = (int32_t)n;
        }
    }
    return STATUS_OK;
}

/* ---- materials ---- */

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

static enum status set_materials(struct model *model, struct error *error)
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
        const double *directions = scene->materials[m].directions;
        list->items[m] = scene->materials[m].material;
        list->items[m].parameters = scene->materials[m].parameters;
        list->items[m].fibre = vector_dot(3, directions, directions) > 0.0 ? directions : NULL;
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

/* ---- the whole ---- */

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
    RETURN_IF_ERROR(set_materials(model, error));
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
