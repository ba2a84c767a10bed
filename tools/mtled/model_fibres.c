#include "mtled/model.h"

#include "approx/field/scattered_fit.h"
#include "base/eigen.h"
#include "base/vector.h"
#include "io/files/table.h"

#include <math.h>

/* The dim (dim + 1) / 2 entries of a symmetric matrix. */
enum { MOST_ENTRIES = 6 };
static const int entries[2][MOST_ENTRIES] = {{0, 1, 3}, {0, 1, 2, 4, 5, 8}};

static int entry_row(int dim, int v)
{
    return entries[dim - 2][v] / dim;
}

static int entry_column(int dim, int v)
{
    return entries[dim - 2][v] % dim;
}

/* rows[table->rows * (dim + entries)]: each point, and a (x) a of its unit direction a, in which the sign is
 * lost. */
static enum status square_directions(const struct scene_material *section, const struct table *table, int dim,
                                     double *rows, struct error *error)
{
    int count = dim * (dim + 1) / 2;
    for (int64_t r = 0; r < table->rows; r++) {
        const double *from = table->values + r * table->cols;
        double *to = rows + r * (dim + count), along[3] = {0.0}, frame[6];
        for (int a = 0; a < dim; a++) {
            to[a] = from[a];
            along[a] = from[dim + a];
        }
        if (!fibre_frame(dim, along, NULL, frame)) {
            return fail(error, STATUS_INPUT, "%s: fibres: %s:%lld: the direction has no length",
                        section->label.where, section->fibres, (long long)table->line[r]);
        }
        for (int v = 0; v < count; v++) {
            to[dim + v] = frame[entry_row(dim, v)] * frame[entry_column(dim, v)];
        }
    }
    return STATUS_OK;
}

/* The axis of the interpolated a (x) a: the eigenvector of the largest eigenvalue. */
static void principal_axis(int dim, const double *values, double axis[3])
{
    double A[9], eigenvalue[3], V[9];
    int first = 0;
    for (int v = 0; v < dim * (dim + 1) / 2; v++) {
        int r = entry_row(dim, v), c = entry_column(dim, v);
        A[dim * r + c] = A[dim * c + r] = values[v];
    }
    eigen_symmetric(dim, A, eigenvalue, V);
    for (int i = 1; i < dim; i++) {
        first = eigenvalue[i] > eigenvalue[first] ? i : first;
    }
    for (int a = 0; a < dim; a++) {
        axis[a] = V[dim * a + first];
    }
}

/* The directions at point q. */
static enum status directions_at(const struct model *model, const struct scene_material *section,
                                 const struct scattered_fit *fit, int64_t q, double directions[6],
                                 struct error *error)
{
    int dim = model->assembly.cells.dim;
    const double *x = model->assembly.x + q * dim, *plane = section->fibre_plane;
    double values[MOST_ENTRIES], distance, spacing, axis[3] = {0.0};
    double size = pow(model->assembly.weight[q], 1.0 / dim);
    char place[96];
    point_text(dim, x, place);
    RETURN_IF_ERROR(fail_in(error, scattered_fit_evaluate(fit, 0, x, values, &distance, &spacing, error),
                            "%s: fibres: %s: at %s", section->label.where, section->fibres, place));
    if (!(distance <= SCATTERED_FIT_REACH * fmax(spacing, size))) {
        return fail(
            error, STATUS_INPUT,
            "%s: fibres: %s: its nearest point is %.3g m from %s in the body, its points are %.3g m apart: "
            "wrong unit or wrong place, else give rows there",
            section->label.where, section->fibres, distance, place, spacing);
    }
    principal_axis(dim, values, axis);
    bool two = vector_dot(3, plane, plane) > 0.0;
    return fibre_frame(dim, axis, two ? plane : NULL, directions)
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "%s: fibre_plane: the fibres have this direction at %s",
                      section->label.where, place);
}

/* The material of point q with these directions: its own copy, unless a table of moduli has made one already.
 */
static void set_directions(struct material_list *list, int64_t m, int64_t q, const double *directions)
{
    if (list->of_point[q] == m) {
        list->items[list->count] = list->items[m];
        list->section[list->count] = (int32_t)m;
        list->of_point[q] = (int32_t)list->count++;
    }
    list->items[list->of_point[q]].fibre = directions;
}

enum status model_fibres(struct model *model, int64_t m, struct error *error)
{
    struct material_list *list = &model->assembly.materials;
    const struct scene_material *section = &model->scene->materials[m];
    int dim = model->assembly.cells.dim, count = dim * (dim + 1) / 2;
    int64_t points = 0;
    double *directions;
    FREED_BY(table_free) struct table table = {0};
    FREED_BY(scattered_fit_free) struct scattered_fit fit = {0};
    SCRATCH double *rows = NULL;
    RETURN_IF_ERROR(table_read(section->fibres, 2 * dim, 2 * dim, &table, error));
    RETURN_IF_ERROR(NEW_ARRAY(&rows, table.rows * (dim + count), error));
    RETURN_IF_ERROR(square_directions(section, &table, dim, rows, error));
    fit = (struct scattered_fit){.dim = dim,
                                 .value_count = count,
                                 .count = table.rows,
                                 .row_size = dim + count,
                                 .row = rows,
                                 .unit = section->table_unit};
    RETURN_IF_ERROR(fail_in(error, scattered_fit_build(&fit, error), "%s", section->label.where));
    for (int64_t q = 0; q < model->assembly.point_count; q++) {
        points += list->section[list->of_point[q]] == m;
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&list->items, list->count + points, error));
    RETURN_IF_ERROR(MODEL_ARRAY(model, &directions, 6 * points, error));
    for (int64_t q = 0; q < model->assembly.point_count; q++) {
        if (list->section[list->of_point[q]] == m) {
            RETURN_IF_ERROR(directions_at(model, section, &fit, q, directions, error));
            set_directions(list, m, q, directions);
            directions += 6;
        }
    }
    return STATUS_OK;
}
