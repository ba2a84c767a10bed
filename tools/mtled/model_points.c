/* Measured points of a section: their table, and the field there. */
#include "mtled/model.h"

#include "approx/field/field.h"
#include "io/files/landmarks.h"

#include <math.h>
#include <string.h>

/* One section of measured points. */
struct point_section {
    struct model *model;
    const struct scene_displacement *section;
    struct condition *condition;
    struct table *table;
};

/* "FILE:LINE: [displacement NAME]: moved TABLE: ..." */
static enum status fail_moved(const struct point_section *p, struct error *error, const char *what)
{
    return fail(error, STATUS_INPUT, "%s: moved %s: %s", p->section->label.where, p->section->moved, what);
}

/* Refuse pairs whose names are those of other pairs: the two tables have another order. */
static enum status check_pairs(const struct point_section *p, const struct table *moved, struct error *error)
{
    const struct table *table = p->table;
    if (moved->rows != table->rows) {
        return fail_moved(p, error, "another number of points than that of points");
    }
    for (int64_t i = 0; i < table->rows && table->label != NULL && moved->label != NULL; i++) {
        for (int64_t k = 0; k < table->rows; k++) {
            if (strcmp(moved->label[i], table->label[k]) == 0 &&
                strcmp(moved->label[i], table->label[i]) != 0) {
                return fail_moved(p, error, "its points have another order than those of points");
            }
        }
    }
    return STATUS_OK;
}

/* Read places and moved places into rows of places and displacements, m. */
static enum status read_pairs(struct point_section *p, int dim, struct error *error)
{
    FREED_BY(table_free) struct table moved = {0};
    struct table *table = p->table;
    double unit = table_unit(p->section->condition.table, p->section->condition.unit);
    double moved_unit = table_unit(p->section->moved, p->section->condition.unit);
    RETURN_IF_ERROR(table_read(p->section->condition.table, dim, dim, table, error));
    RETURN_IF_ERROR(table_read(p->section->moved, dim, dim, &moved, error));
    RETURN_IF_ERROR(check_pairs(p, &moved, error));
    SCRATCH double *x = table->values;
    table->values = NULL;
    table->cols = 2 * dim;
    RETURN_IF_ERROR(NEW_ARRAY(&table->values, table->rows * table->cols, error));
    for (int64_t i = 0; i < table->rows * dim; i++) {
        double *row = table->values + i / dim * 2 * dim + i % dim;
        row[0] = unit * x[i];
        row[dim] = moved_unit * moved.values[i] - row[0];
    }
    return STATUS_OK;
}

/* Read rows of places and displacements. */
static enum status read_rows(struct point_section *p, int dim, struct error *error)
{
    if (landmarks_named(p->section->condition.table)) {
        return fail(error, STATUS_INPUT,
                    "%s: points %s: landmarks are places: give those that they move to, as moved",
                    p->section->label.where, p->section->condition.table);
    }
    RETURN_IF_ERROR(
        table_read_open(p->section->condition.table, 2 * dim, 2 * dim + 1, dim, 2 * dim, p->table, error));
    for (int64_t i = 0; i < p->table->rows * p->table->cols; i++) {
        p->table->values[i] *= p->section->condition.unit;
    }
    return STATUS_OK;
}

static enum status read_section(struct point_section *p, struct error *error)
{
    int dim = p->model->assembly.cells.dim;
    double *values;
    RETURN_IF_ERROR(p->section->moved != NULL ? read_pairs(p, dim, error) : read_rows(p, dim, error));
    int64_t rows = p->table->rows, cols = p->table->cols;
    RETURN_IF_ERROR(MODEL_ARRAY(p->model, &values, rows * (2 * dim + 1), error));
    double *x = values, *u = x + rows * dim, *deviation = u + rows * dim;
    p->condition->measured = (struct measured){dim, rows, x, u, deviation};
    p->condition->line = p->table->line;
    for (int64_t i = 0; i < rows; i++) {
        const double *row = p->table->values + i * cols;
        int open = 0;
        for (int a = 0; a < dim; a++) {
            x[i * dim + a] = row[a];
            u[i * dim + a] = row[dim + a];
            open += isnan(row[dim + a]);
        }
        deviation[i] = cols > 2 * dim ? row[2 * dim] : 0.0;
        if (open == dim) {
            return condition_fail_at(p->condition, i, error, "no component is given: leave the row out");
        }
        if (deviation[i] < 0.0) {
            return condition_fail_at(
                p->condition, i, error,
                "its standard deviation is negative: give a length, 0 for an exact point");
        }
    }
    return STATUS_OK;
}

/* Refuse points that are too far from the body, and set the field at the others: the model owns it. */
static enum status find_field(struct point_section *p, struct error *error)
{
    const struct cells *cells = &p->model->assembly.cells;
    const struct measured *measured = &p->condition->measured;
    struct field_shapes recorded;
    SCRATCH double *reach = NULL;
    double given = p->section->reach;
    FREED_BY(field_table_free) struct field_table field = {0};
    RETURN_IF_ERROR(NEW_ARRAY(&reach, cells->node_count, error));
    NEW_SCRATCH(bool, outside, measured->count, error);
    RETURN_IF_ERROR(field_spacing(cells, reach, error));
    for (int64_t n = 0; n < cells->node_count && given > 0.0; n++) {
        reach[n] = given;
    }
    RETURN_IF_ERROR(field_outside(cells, reach, FIELD_MARGIN, measured->count, measured->x, outside, error));
    for (int64_t i = 0; i < measured->count; i++) {
        if (outside[i]) {
            return condition_fail_at(
                p->condition, i, error,
                given > 0.0 ? "farther from the body than its reach: wrong unit or wrong place?"
                            : "farther from the body than the spacing of its nodes: wrong unit or "
                              "wrong place?");
        }
    }
    RETURN_IF_ERROR(stage_recorded(p->model->stream, "support", &recorded, error));
    if (recorded.supports.radius == NULL) {
        return fail(error, STATUS_INPUT, "no section support.radius: run support");
    }
    RETURN_IF_ERROR(field_table_build(&recorded, cells, NULL, measured->count, measured->x,
                                      p->section->condition.table, &field, error));
    p->condition->field =
        (struct neighbours){.count = field.lists.count, .ptr = field.lists.ptr, .idx = field.lists.idx};
    p->condition->field_phi = field.phi;
    RETURN_IF_ERROR(model_own(p->model, array_take(&field.lists.ptr), error));
    RETURN_IF_ERROR(model_own(p->model, array_take(&field.lists.idx), error));
    return model_own(p->model, array_take(&field.phi), error);
}

enum status model_points(struct model *model, const struct scene_displacement *section,
                         struct condition *condition, struct error *error)
{
    FREED_BY(table_free) struct table table = {0};
    struct point_section p = {model, section, condition, &table};
    RETURN_IF_ERROR(read_section(&p, error));
    RETURN_IF_ERROR(find_field(&p, error));
    return model_own(model, array_take(&table.line), error);
}
