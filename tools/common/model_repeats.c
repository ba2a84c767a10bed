#include "model_repeats.h"

#include <math.h>

/* Cosine of the angle between the directions of two rows. */
static double cosine(const struct constraint_rows *rows, int64_t r, int64_t s)
{
    double sum = 0.0;
    for (int a = 0; a < rows->dim; a++) {
        sum += rows->direction[r * rows->dim + a] * rows->direction[s * rows->dim + a];
    }
    return sum;
}

/* Same place, same direction or its opposite, and same pairs? */
static bool is_same(const struct constraint_rows *rows, int64_t r, int64_t s)
{
    if (rows->node[r] != rows->node[s]) {
        return false;
    }
    struct average one = constraint_rows_average(rows, r), other = constraint_rows_average(rows, s);
    double apart = 0.0;
    if (one.length != other.length) {
        return false;
    }
    for (int64_t i = 0; i < one.length; i++) {
        if (one.idx[i] != other.idx[i]) {
            return false;
        }
        apart += fabs(one.phi[i] - other.phi[i]);
    }
    return fabs(cosine(rows, r, s)) > 1.0 - 1e-9 && apart < 1e-9;
}

/* The earlier row that row r repeats, or -1. */
static int64_t repeated_row(const struct constraint_rows *rows, int64_t r)
{
    for (int64_t s = 0; s < r; s++) {
        if (is_same(rows, r, s)) {
            return s;
        }
    }
    return -1;
}

static enum status check_value(const struct model_input *input, const struct constraint_rows *rows, int64_t r,
                               int64_t earlier, struct error *error)
{
    const struct scene_displacement *sections = input->scene->displacements;
    double expected = copysign(1.0, cosine(rows, r, earlier)) * rows->target[earlier];
    char place[96];
    if (fabs(rows->target[r] - expected) <= 1e-9 * (fabs(rows->target[r]) + 1e-9)) {
        return STATUS_OK;
    }
    point_text(rows->dim, input->cells.x + (int64_t)rows->node[r] * rows->dim, place);
    return scene_fail(error, STATUS_INPUT, input->scene, &sections[rows->section[r]].label,
                      "node %d at %s is prescribed twice: %g m here, %g m in [displacement %s]",
                      rows->node[r], place, rows->target[r], rows->target[earlier],
                      sections[rows->section[earlier]].label.name);
}

enum status repeats_drop(const struct model_input *input, int64_t first, struct constraint_rows *rows,
                         struct error *error)
{
    struct constraint_rows kept;
    enum status status = STATUS_OK;
    constraint_rows_init(&kept, rows->dim);
    for (int64_t r = 0; r < rows->count; r++) {
        int64_t earlier = r < first ? -1 : repeated_row(rows, r);
        if (earlier >= 0) {
            TRY(check_value(input, rows, r, earlier, error));
            continue;
        }
        struct average average = constraint_rows_average(rows, r);
        TRY(constraint_rows_add(&kept, average.length, average.idx, average.phi,
                                rows->direction + r * rows->dim, rows->target[r], rows->curve[r],
                                rows->section[r], rows->node[r], error));
    }
    constraint_rows_free(rows);
    *rows = kept;
    constraint_rows_init(&kept, rows->dim);
done:
    constraint_rows_free(&kept);
    return status;
}
