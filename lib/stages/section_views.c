/* Any section, by its entry in the table of sections. */
#include "stages/views.h"

#include "base/eigen.h"
#include "base/round_off.h"

#include <math.h>
#include <stdio.h>

const char *section_producer(const struct section_kind *kind)
{
    static const char *const of_stages[] = {"nodes", "ipoints", "support", "shapefn", "mtled"};
    return of_stages[kind->stage];
}

int stream_dimension(const struct stream *stream)
{
    const struct section *nodes = stream_find(stream, "nodes.x"), *points = stream_find(stream, "points.x");
    const struct section *x = nodes != NULL ? nodes : points;
    return x != NULL && (x->cols == 2 || x->cols == 3) ? (int)x->cols : 0;
}

/* Type, columns and rows. */
static enum status check_shape(const struct stream *stream, const struct section *section,
                               const struct section_kind *kind, struct error *error)
{
    int dim = stream_dimension(stream);
    int64_t cols = kind->cols == COLS_DIM           ? dim
                   : kind->cols == COLS_DIM_PLUS_1  ? dim + 1
                   : kind->cols == COLS_DIM_SQUARED ? dim * dim
                   : kind->cols == COLS_SIDES       ? SIDE_COLUMNS(dim)
                   : kind->cols == COLS_ANY         ? section->cols
                                                    : kind->cols;
    const struct section *other = kind->rows_of != NULL ? stream_find(stream, kind->rows_of) : NULL;
    int64_t rows = other != NULL ? other->rows + (kind->content == LIST) : section->rows;
    if (section->type != kind->type) {
        return fail(error, STATUS_INPUT, "%s: type %s instead of %s", section->name,
                    element_type_name(section->type), element_type_name(kind->type));
    }
    if (kind->cols == COLS_DIM && section->cols != 2 && section->cols != 3) {
        return fail(error, STATUS_INPUT, "%s: %jd columns instead of 2 or 3", section->name, section->cols);
    }
    if ((kind->cols > 0 || dim > 0) && section->cols != cols) {
        return fail(error, STATUS_INPUT, "%s: %jd columns instead of %jd", section->name, section->cols,
                    cols);
    }
    if (section->rows != rows) {
        return fail(error, STATUS_INPUT, "%s: does not fit %s: %jd rows instead of %jd: run %s again",
                    section->name, other->name, section->rows, rows, section_producer(kind));
    }
    return STATUS_OK;
}

enum status section_check_numbers(const struct section *section, enum content content, struct error *error)
{
    static const char *const required[] = {
        [FINITE] = "finite", [POSITIVE] = "finite and positive", [AT_LEAST_ONE] = "finite and at least 1"};
    const double *values = section->data;
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        double value = values[i];
        if (!isfinite(value) || (content == POSITIVE && !(value > 0.0)) ||
            (content == AT_LEAST_ONE && !(value >= 1.0))) {
            return fail(error, STATUS_INPUT, "%s: row %jd: %.17g is not %s", section->name,
                        (i / section->cols), value, required[content]);
        }
    }
    return STATUS_OK;
}

/* Of matrices in the last columns. */
static enum status check_stretch(const struct section *section, struct error *error)
{
    int dim = section->cols == 4 || section->cols == SIDE_COLUMNS(2) ? 2 : 3;
    if (section->cols < dim * dim) {
        return fail(error, STATUS_INPUT, "%s: %jd columns are no matrix", section->name, section->cols);
    }
    const double *A = (const double *)section->data + section->cols - dim * dim;
    RETURN_IF_ERROR(section_check_numbers(section, FINITE, error));
    for (int64_t row = 0; row < section->rows; row++, A += section->cols) {
        double value[3], V[9], least = INFINITY, most = 0.0, off = 0.0;
        eigen_symmetric(dim, A, value, V);
        for (int k = 0; k < dim * dim; k++) {
            off = fmax(off, fabs(A[k] - A[k % dim * dim + k / dim]));
            least = fmin(least, value[k % dim]);
            most = fmax(most, value[k % dim]);
        }
        if (!(least >= 1.0 - COARSE_ROUND_OFF && off <= COARSE_ROUND_OFF * most)) {
            return fail(error, STATUS_INPUT,
                        "%s: row %jd: not a symmetric matrix without eigenvalues below 1", section->name,
                        row);
        }
    }
    return STATUS_OK;
}

enum status section_check_indices(const struct section *section, int64_t least, int64_t bound,
                                  const char *what, const char *why, struct error *error)
{
    const int32_t *number = section->data;
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        if (number[i] < least || number[i] >= bound) {
            return fail(error, STATUS_INPUT, "%s: row %jd: no %s %d%s", section->name, (i / section->cols),
                        what, number[i], why);
        }
    }
    return STATUS_OK;
}

enum status section_check(const struct stream *stream, const struct section *section,
                          const struct section_kind *kind, struct error *error)
{
    char of[64];
    const struct section *other = kind->index_of != NULL ? stream_find(stream, kind->index_of) : NULL;
    RETURN_IF_ERROR(check_shape(stream, section, kind, error));
    if (kind->index_of != NULL) {
        snprintf(of, sizeof of, " of %s", kind->index_of);
        return section_check_indices(section, kind->content == INDEX_OR_NONE ? -1 : 0,
                                     other != NULL ? other->rows : INT32_MAX, "row", of, error);
    }
    if (kind->content == STRETCH) {
        return check_stretch(section, error);
    }
    return (kind->content >= FINITE && kind->content <= AT_LEAST_ONE) || kind->content == UNITY
               ? section_check_numbers(section, kind->content, error)
               : STATUS_OK;
}

enum status stream_view(const struct stream *stream, const char *name, const struct section **section,
                        struct error *error)
{
    const struct section_kind *kind = section_kind_of(name);
    *section = stream_find(stream, name);
    return *section == NULL ? fail(error, STATUS_INPUT, "no section %s: run %s", name, section_producer(kind))
                            : section_check(stream, *section, kind, error);
}
