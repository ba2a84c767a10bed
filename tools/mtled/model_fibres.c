#include "mtled/model.h"

#include "approx/field/scattered_fit.h"
#include "base/eigen.h"
#include "base/vector.h"
#include "io/files/table.h"
#include "stages/views.h"

#include <math.h>
#include <string.h>

/* The fibres of a section: a fit to the rows of its table, or else the stream's axis of each point. */
struct source {
    const struct scene_material *section;
    struct scattered_fit fit;
    const double *axes; /* NULL: the fit */
};

/* The axis of the fibres at point q, by the fit. */
static enum status interpolate(const struct model *model, const struct source *source, int64_t q,
                               double axis[3], struct error *error)
{
    const struct scene_material *section = source->section;
    int dim = model->assembly.cells.dim;
    const double *x = model->assembly.x + q * dim;
    double values[AXIS_MOST_ENTRIES], distance, spacing;
    double size = pow(model->assembly.weight[q], 1.0 / dim);
    const char *place = POINT_TEXT(dim, x);
    RETURN_IF_ERROR(fail_in(error,
                            scattered_fit_evaluate(&source->fit, 0, x, values, &distance, &spacing, error),
                            "%s: fibres: %s: at %s", section->label.where, section->fibres, place));
    if (!(distance <= SCATTERED_FIT_REACH * fmax(spacing, size))) {
        return fail(
            error, STATUS_INPUT,
            "%s: fibres: %s: its nearest point is %.3g m from %s in the body, its points are %.3g m apart: "
            "wrong unit or wrong place, else give rows there",
            section->label.where, section->fibres, distance, place, spacing);
    }
    axis_principal(dim, values, axis);
    return STATUS_OK;
}

/* The directions at point q. */
static enum status directions_at(const struct model *model, const struct source *source, int64_t q,
                                 double directions[6], struct error *error)
{
    const struct scene_material *section = source->section;
    int dim = model->assembly.cells.dim;
    const double *plane = section->fibre_plane;
    double axis[3] = {0.0}, frame[6];
    const char *place = POINT_TEXT(dim, model->assembly.x + q * dim);
    if (source->axes == NULL) {
        RETURN_IF_ERROR(interpolate(model, source, q, axis, error));
    } else {
        memcpy(axis, source->axes + q * dim, (size_t)dim * sizeof *axis);
        if (!fibre_frame(dim, axis, NULL, frame)) {
            return fail(error, STATUS_INPUT,
                        "%s: points.fibre: row %jd, at %s m, has no length: the stream has no fibres there",
                        section->label.where, q, place);
        }
    }
    bool two = vector_dot(3, plane, plane) > 0.0;
    return fibre_frame(dim, axis, two ? plane : NULL, directions)
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "%s: fibre_plane: the fibres have this direction at %s",
                      section->label.where, place);
}

/* Fit a (x) a to the section's table; rows[] stays the caller's. */
static enum status fit_table(const struct model *model, struct source *source, double **rows,
                             struct error *error)
{
    int dim = model->assembly.cells.dim, count = dim * (dim + 1) / 2;
    FREED_BY(table_free) struct table table = {0};
    RETURN_IF_ERROR(table_read(source->section->fibres, 2 * dim, 2 * dim, &table, error));
    RETURN_IF_ERROR(NEW_ARRAY(rows, table.rows * (dim + count), error));
    for (int64_t r = 0; r < table.rows;
         r++) { /* each point, and a (x) a of its direction, in which the sign is lost */
        const double *from = table.values + r * table.cols;
        double *to = *rows + r * (dim + count);
        memcpy(to, from, (size_t)dim * sizeof *to);
        if (!axis_square(dim, from + dim, to + dim)) {
            return fail(error, STATUS_INPUT, "%s: fibres: %s:%jd: the direction has no length",
                        source->section->label.where, source->section->fibres, table.line[r]);
        }
    }
    source->fit = (struct scattered_fit){.dim = dim,
                                         .value_count = count,
                                         .count = table.rows,
                                         .row_size = dim + count,
                                         .row = *rows,
                                         .unit = source->section->table_unit};
    return fail_in(error, scattered_fit_build(&source->fit, error), "%s", source->section->label.where);
}

/* The section points.fibre of the stream. */
static enum status stream_axes(const struct model *model, struct source *source, struct error *error)
{
    const struct section *section;
    if (stream_find(model->stream, "points.fibre") == NULL) {
        return fail(
            error, STATUS_INPUT,
            "%s: fibre: missing, and the stream has no section points.fibre: give the direction of the "
            "fibres at rest, as 1, 0, 0, a table by fibres, or run fibres or sample --vector",
            source->section->label.where);
    }
    RETURN_IF_ERROR(stream_view(model->stream, "points.fibre", &section, error));
    source->axes = section->data;
    return STATUS_OK;
}

static enum status set_points(struct model *model, int64_t m, const struct source *source,
                              struct error *error)
{
    struct material_list *list = &model->assembly.materials;
    int64_t points = 0;
    double *directions;
    for (int64_t q = 0; q < model->assembly.point_count; q++) {
        points += list->section[list->of_point[q]] == m;
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&list->items, list->count + points, error));
    RETURN_IF_ERROR(MODEL_ARRAY(model, &directions, 6 * points, error));
    for (int64_t q = 0; q < model->assembly.point_count; q++) {
        if (list->section[list->of_point[q]] == m) {
            RETURN_IF_ERROR(directions_at(model, source, q, directions, error));
            if (list->of_point[q] == m) { /* else a table of moduli has made a material of its own already */
                list->items[list->count] = list->items[m];
                list->section[list->count] = list->group[list->count] = (int32_t)m;
                list->of_point[q] = (int32_t)list->count++;
            }
            list->items[list->of_point[q]].fibre = directions;
            directions += 6;
        }
    }
    return STATUS_OK;
}

enum status model_fibres(struct model *model, int64_t m, struct error *error)
{
    struct source source = {.section = &model->scene->materials[m]};
    SCRATCH double *rows = NULL;
    enum status status = source.section->fibres != NULL ? fit_table(model, &source, &rows, error)
                                                        : stream_axes(model, &source, error);
    if (status == STATUS_OK) {
        status = set_points(model, m, &source, error);
    }
    scattered_fit_free(&source.fit);
    return status;
}
