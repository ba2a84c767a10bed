#include "model.h"

#include "names.h"

#include "approx/quadrature.h"
#include "base/box.h"
#include "io/table.h"

#include <math.h>
#include <stdlib.h>

/* Material of each region: -1 where the scene names none. */
static enum status materials_of_regions(const struct scene *scene, const char *names, int64_t region_count,
                                        int32_t *material, struct error *error)
{
    for (int64_t r = 0; r < region_count; r++) {
        material[r] = -1;
    }
    for (int64_t m = 0; m < scene->material_count; m++) {
        const struct scene_material *section = &scene->materials[m];
        for (int64_t i = 0; i < section->regions.count; i++) {
            int64_t region = names_index(names, section->regions.names[i]);
            if (region < 0 || region >= region_count) {
                return scene_fail(error, STATUS_INPUT, scene, &section->label,
                                  "the mesh has no region '%s'; present: %s", section->regions.names[i],
                                  names[0] != '\0' ? names : "none");
            }
            material[region] = (int32_t)m;
        }
    }
    return STATUS_OK;
}

/* cell_material[cell]: from cells.region and the scene. */
static enum status materials_of_cells(struct model_input *input, struct error *error)
{
    enum status status;
    const struct section *region;
    char *names = NULL;
    int32_t *material = NULL;
    int64_t region_count = 1;
    TRY(stream_need(input->stream, "cells.region", TYPE_I4, 1, "nodes", &region, error));
    TRY(names_of_section(region, &names, error));
    const int32_t *of_cell = region->data;
    for (const char *at = names; *at != '\0'; at++) {
        region_count += *at == ',';
    }
    TRY(NEW_ARRAY(&material, region_count, error));
    TRY(NEW_ARRAY(&input->cell_material, input->cells.count, error));
    TRY(materials_of_regions(input->scene, names, region_count, material, error));
    if (region->rows != input->cells.count) {
        status = fail(error, STATUS_INPUT, "cells.region: does not fit the cells");
        goto done;
    }
    for (int64_t c = 0; c < input->cells.count; c++) {
        if (of_cell[c] < 0 || of_cell[c] >= region_count || material[of_cell[c]] < 0) {
            status = fail(
                error, STATUS_INPUT,
                "%s: region %d of the mesh (of %s) has no material: name it, or leave it out with nodes -r",
                input->scene->path, of_cell[c], names);
            goto done;
        }
        input->cell_material[c] = material[of_cell[c]];
    }
done:
    free(names);
    free(material);
    return status;
}

/* The integration points. */
static enum status read_points(struct model_input *input, struct error *error)
{
    enum status status;
    const struct stream *stream = input->stream;
    TRY(stream_need(stream, "points.x", TYPE_F8, input->cells.dim, "ipoints", &input->points, error));
    TRY(stream_need(stream, "points.weight", TYPE_F8, 1, "ipoints", &input->weight, error));
    TRY(stream_need(stream, "points.cell", TYPE_I4, 1, "ipoints", &input->point_cell, error));
    int64_t count = input->points->rows;
    input->smoothed = points_are_smoothed(input->points);
    if (input->weight->rows != count || input->point_cell->rows != count ||
        (input->smoothed && count != input->cells.count)) {
        status =
            fail(error, STATUS_INPUT, "points.x, points.weight, points.cell: do not fit: run ipoints again");
        goto done;
    }
    const int32_t *cell = input->point_cell->data;
    for (int64_t q = 0; q < count; q++) {
        if (cell[q] < 0 || cell[q] >= input->cells.count) {
            status =
                fail(error, STATUS_INPUT,
                     "points.cell: row %lld: no cell %d: an evaluation lattice cannot be integrated over",
                     (long long)q, cell[q]);
            goto done;
        }
    }
done:
    return status;
}

/* A table of shapefn: sections PREFIX.ptr and .idx, and values or gradients on these lists. */
static enum status read_table(const struct model_input *input, const char *prefix, const char *values,
                              int cols, int64_t rows, struct neighbours *lists, const double **phi,
                              struct error *error)
{
    enum status status;
    const struct section *section;
    TRY(stream_need(input->stream, values, TYPE_F8, cols, "shapefn", &section, error));
    TRY(stream_neighbours(input->stream, prefix, rows, input->cells.node_count, lists, error));
    if (section->rows != lists->ptr[rows]) {
        status = fail(error, STATUS_INPUT, "%s: does not fit %s.idx: run shapefn again", values, prefix);
    }
    *phi = section->data;
done:
    return status;
}

/* The tables over points or faces, over the boundary, and over the nodes. */
static enum status read_tables(struct model_input *input, struct error *error)
{
    enum status status;
    int dim = input->cells.dim, per_face = quadrature_face_rule(dim).points;
    struct neighbours *lists = &input->lists;
    TRY(stream_faces(input->stream, &input->cells, &input->faces, error));
    if (input->smoothed) {
        TRY(read_table(input, "face", "face.phi", 1, input->faces.count, lists, &input->phi, error));
    } else {
        TRY(read_table(input, "nbr", "shape.phi", 1, input->points->rows, lists, &input->phi, error));
        TRY(read_table(input, "nbr", "shape.dphi", dim, input->points->rows, lists, &input->dphi, error));
    }
    input->boundary = input->faces;
    input->boundary.count = input->faces.boundary_count;
    TRY(read_table(input, "boundary", "boundary.phi", 1, input->boundary.count * per_face,
                   &input->boundary_lists, &input->boundary_phi, error));
    TRY(read_table(input, "node", "node.phi", 1, input->cells.node_count, &input->node_lists,
                   &input->node_phi, error));
    input->face_table = (struct face_table){.dim = dim,
                                            .node_count = input->cells.node_count,
                                            .x = input->cells.x,
                                            .faces = &input->boundary,
                                            .per_face = per_face,
                                            .lists = &input->boundary_lists,
                                            .phi = input->boundary_phi};
done:
    return status;
}

enum status model_input_read(const struct stream *stream, const struct scene *scene,
                             struct model_input *input, struct error *error)
{
    enum status status;
    *input = (struct model_input){.stream = stream, .scene = scene};
    TRY(stream_cells(stream, true, &input->cells, error));
    if (scene->dim != input->cells.dim) {
        status = fail(error, STATUS_INPUT, "%s: dim = %d, but the nodes have %d coordinates", scene->path,
                      scene->dim, input->cells.dim);
        goto done;
    }
    struct box box = box_of(scene->dim, input->cells.node_count, input->cells.x);
    input->extent = box_diagonal(&box);
    TRY(materials_of_cells(input, error));
    TRY(read_points(input, error));
    TRY(read_tables(input, error));
done:
    if (status != STATUS_OK) {
        model_input_free(input);
    }
    return status;
}

void model_input_free(struct model_input *input)
{
    free(input->cell_material);
    input->cell_material = NULL;
}

enum status model_add_curve(const struct model_input *input, const struct scene_label *label,
                            const struct scene_curve *curve, struct solid_system *system, int32_t *index,
                            struct error *error)
{
    static const enum curve_kind kinds[] = {[SCENE_CURVE_SMOOTH] = CURVE_SMOOTH,
                                            [SCENE_CURVE_LINEAR] = CURVE_LINEAR,
                                            [SCENE_CURVE_STEP] = CURVE_STEP,
                                            [SCENE_CURVE_FILE] = CURVE_TABLE};
    enum status status = STATUS_OK;
    struct table table = {0};
    struct load_curve *grown = array_grow(system->curves, system->curve_count + 1, sizeof *system->curves);
    if (grown == NULL) {
        return fail_memory(error, "load curves");
    }
    system->curves = grown;
    double *factor = array_grow(system->factor, system->curve_count + 1, sizeof *factor);
    if (factor == NULL) {
        return fail_memory(error, "load curves");
    }
    system->factor = factor;
    if (curve->kind != SCENE_CURVE_FILE) {
        system->curves[system->curve_count] = curve_of_kind(kinds[curve->kind]);
    } else {
        double end = input->scene->analysis == SCENE_DYNAMIC ? input->scene->solver.end_time : 1.0;
        TRY(table_read(curve->file, 2, 2, &table, error));
        status = curve_tabulate(&system->curves[system->curve_count], table.rows, table.values, end, error);
        if (status != STATUS_OK) {
            struct error inner = *error;
            status = scene_fail(error, status, input->scene, label, "curve %s: %s", curve->file, inner.text);
            goto done;
        }
    }
    *index = (int32_t)system->curve_count++;
done:
    table_free(&table);
    return status;
}

double model_penalty_modulus(const struct solid_system *system, double factor)
{
    double modulus = 0.0;
    for (int64_t m = 0; m < system->body.material_count; m++) {
        const struct material *material = &system->body.materials[m];
        modulus = fmax(modulus, fmin(factor * material->shear_modulus, material_wave_modulus(material)));
    }
    return modulus;
}

double model_away(const struct model_input *input, const double *row, double unit, const double *x)
{
    double away = 0.0;
    for (int a = 0; a < input->cells.dim; a++) {
        away = fmax(away, fabs(row[a] * unit - x[a]));
    }
    return away / input->extent;
}

void model_nodal_field(const struct model_input *input, const double *u, double *field)
{
    int dim = input->cells.dim;
    const struct neighbours *lists = &input->node_lists;
    for (int64_t n = 0; n < lists->count; n++) {
        for (int a = 0; a < dim; a++) {
            double sum = 0.0;
            for (int64_t i = lists->ptr[n]; i < lists->ptr[n + 1]; i++) {
                sum += input->node_phi[i] * u[(int64_t)lists->idx[i] * dim + a];
            }
            field[n * dim + a] = sum;
        }
    }
}
