/* Displacements of measured points, anywhere in the body or on it: exact conditions on the field there, or
 * springs. */
#include "model.h"

#include "approx/field.h"
#include "io/table.h"
#include "solid/measured.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* One section of measured points. */
struct point_section {
    const struct model_input *input;
    const struct scene_displacement *section;
    struct solid_system *system;
    int32_t number, curve;
    struct table table;
    struct measured measured;
    double *values; /* of measured: x, u and deviation */
    struct field_table field;
    double *volume, *shear; /* of the nodes: m3 and Pa */
    double energy;          /* that the springs go by, J (2D: J/m) */
};

/* "FILE:LINE: [displacement NAME]: points TABLE:LINE: ..." */
static enum status fail_at(const struct point_section *p, int64_t row, struct error *error, const char *what)
{
    char place[96];
    point_text(p->measured.dim, p->measured.x + row * p->measured.dim, place);
    return scene_fail(error, STATUS_INPUT, p->input->scene, &p->section->label, "points %s:%lld: at %s: %s",
                      p->section->table, (long long)p->table.line[row], place, what);
}

static enum status read_section(struct point_section *p, struct error *error)
{
    enum status status;
    int dim = p->input->cells.dim;
    double unit = p->section->table_unit;
    TRY(table_read_open(p->section->table, 2 * dim, 2 * dim + 1, dim, 2 * dim, &p->table, error));
    int64_t rows = p->table.rows, cols = p->table.cols;
    TRY(NEW_ARRAY(&p->values, rows * (2 * dim + 1), error));
    double *x = p->values, *u = x + rows * dim, *deviation = u + rows * dim;
    p->measured = (struct measured){dim, rows, x, u, deviation};
    for (int64_t i = 0; i < rows; i++) {
        const double *row = p->table.values + i * cols;
        int open = 0;
        for (int a = 0; a < dim; a++) {
            x[i * dim + a] = unit * row[a];
            u[i * dim + a] = unit * row[dim + a];
            open += isnan(row[dim + a]);
        }
        deviation[i] = cols > 2 * dim ? unit * row[2 * dim] : 0.0;
        if (open == dim) {
            return fail_at(p, i, error, "no component is given: leave the row out");
        }
        if (deviation[i] < 0.0) {
            return fail_at(p, i, error,
                           "its standard deviation is negative: give a length, 0 for an exact point");
        }
    }
done:
    return status;
}

/* What decides how stiff the body is at its nodes. */
static enum status look_at_nodes(struct point_section *p, struct error *error)
{
    enum status status;
    const struct body *body = &p->system->body;
    const struct cells *cells = &p->input->cells;
    const int32_t *cell = p->input->point_cell->data;
    int corners = cells->dim + 1;
    TRY(NEW_ARRAY(&p->volume, cells->node_count, error));
    TRY(NEW_ARRAY(&p->shear, cells->node_count, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        const int32_t *node = cells->node + (int64_t)cell[body->order[q]] * corners;
        for (int k = 0; k < corners; k++) {
            p->volume[node[k]] += body->weight[q] / corners;
            p->shear[node[k]] += body->weight[q] / corners * body->materials[body->material[q]].shear_modulus;
        }
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        p->shear[n] /= p->volume[n];
    }
done:
    return status;
}

/* Points that are too far from the body, and the field at the others. */
static enum status find_field(struct point_section *p, struct error *error)
{
    enum status status;
    const struct cells *cells = &p->input->cells;
    const struct measured *measured = &p->measured;
    const struct section *radius;
    struct recorded recorded;
    double *reach = NULL, given = p->section->reach;
    bool *outside = NULL;
    TRY(NEW_ARRAY(&reach, cells->node_count, error));
    TRY(NEW_ARRAY(&outside, measured->count, error));
    TRY(field_spacing(cells, reach, error));
    for (int64_t n = 0; n < cells->node_count && given > 0.0; n++) {
        reach[n] = given;
    }
    TRY(field_outside(cells, reach, FIELD_MARGIN, measured->count, measured->x, outside, error));
    for (int64_t i = 0; i < measured->count; i++) {
        if (outside[i]) {
            status =
                fail_at(p, i, error,
                        given > 0.0 ? "farther from the body than its reach: wrong unit or wrong place?"
                                    : "farther from the body than the spacing of its nodes: wrong unit or "
                                      "wrong place?");
            goto done;
        }
    }
    TRY(stream_need(p->input->stream, "support.radius", TYPE_F8, 1, "support", &radius, error));
    TRY(stage_recorded(radius, cells->dim, &recorded, error));
    if (radius->rows != cells->node_count) {
        status = fail(error, STATUS_INPUT, "support.radius: does not fit the nodes: run support again");
        goto done;
    }
    TRY(field_table_build(&recorded.support, &recorded.shapes, cells, radius->data, measured->count,
                          measured->x, p->section->table, &p->field, error));
done:
    free(reach);
    free(outside);
    return status;
}

/* What two rows say of each other. */
static enum status compare_rows(const struct point_section *p, struct error *note, struct error *error)
{
    struct measured_pair exact, others, repeated;
    char what[192];
    enum status status =
        measured_compare(&p->measured, 1e-9 * p->input->extent, &exact, &others, &repeated, error);
    if (status == STATUS_OK && exact.count > 0) {
        snprintf(what, sizeof what,
                 "contradicts line %lld, %.3g m away: their displacements differ by %.3g m, which turns over "
                 "what is between: give standard deviations, or leave one out",
                 (long long)p->table.line[exact.first], exact.distance, exact.apart);
        return fail_at(p, exact.second, error, what);
    }
    if (status == STATUS_OK && repeated.count > 0) {
        snprintf(what, sizeof what, "is the point of line %lld again: leave one out",
                 (long long)p->table.line[repeated.first]);
        return fail_at(p, repeated.second, error, what);
    }
    if (status == STATUS_OK && others.count > 0 && note->text[0] == '\0') {
        snprintf(what, sizeof what,
                 "contradicts line %lld, %.3g m away: their displacements differ by %.3g m, more than six "
                 "standard deviations (pairs like this: %lld)",
                 (long long)p->table.line[others.first], others.distance, others.apart,
                 (long long)others.count);
        (void)fail_at(p, others.second, note, what);
    }
    return status;
}

/* The nearest of the nodes that a point's field is made of. */
static int32_t nearest_node(const struct point_section *p, int64_t i)
{
    int dim = p->measured.dim;
    const int64_t *ptr = p->field.lists.ptr;
    const int32_t *idx = p->field.lists.idx;
    double least = INFINITY;
    int32_t nearest = idx[ptr[i]];
    for (int64_t k = ptr[i]; k < ptr[i + 1]; k++) {
        double sum = 0.0;
        for (int a = 0; a < dim; a++) {
            double way = p->input->cells.x[(int64_t)idx[k] * dim + a] - p->measured.x[i * dim + a];
            sum += way * way;
        }
        if (sum < least) {
            least = sum;
            nearest = idx[k];
        }
    }
    return nearest;
}

/* The rows of one point, or its springs. */
static enum status add_point(const struct point_section *p, int64_t i, struct error *error)
{
    enum status status = STATUS_OK;
    int dim = p->measured.dim;
    int64_t at = p->field.lists.ptr[i];
    int32_t node = nearest_node(p, i);
    struct average average = {p->field.lists.ptr[i + 1] - at, p->field.lists.idx + at, p->field.phi + at};
    for (int a = 0; a < dim; a++) {
        double direction[3] = {0.0, 0.0, 0.0}, target = p->measured.u[i * dim + a];
        double deviation = p->measured.deviation[i];
        direction[a] = 1.0;
        if (isnan(target)) {
            continue;
        }
        if (!(deviation > 0.0)) {
            TRY(constraint_rows_add(&p->system->rows, average.length, average.idx, average.phi, direction,
                                    target, p->curve, p->number, node, error));
            continue;
        }
        TRY(system_append_penalty(p->system, &average, direction, target, p->curve, p->number, node,
                                  p->energy / (deviation * deviation), error));
        p->system->spring_count++;
    }
done:
    return status;
}

/* Root mean square of what was measured, by components. */
static double usual_displacement(const struct measured *measured)
{
    double sum = 0.0;
    int64_t count = 0;
    for (int64_t i = 0; i < measured->count * measured->dim; i++) {
        if (!isnan(measured->u[i])) {
            sum += measured->u[i] * measured->u[i];
            count++;
        }
    }
    return sqrt(sum / (double)count);
}

/* The energy scale of the springs, if there are any. */
static enum status set_energy(struct point_section *p, struct error *error)
{
    enum status status = STATUS_OK;
    const struct measured *measured = &p->measured;
    struct measured_region region = {.body_size = p->input->extent, .model_error = p->section->model_error};
    bool *seen = NULL;
    double points = 0.0;
    TRY(NEW_ARRAY(&seen, p->system->node_count, error));
    for (int64_t i = 0; i < measured->count; i++) {
        int32_t node = nearest_node(p, i);
        for (int64_t k = p->field.lists.ptr[i]; k < p->field.lists.ptr[i + 1] && measured->deviation[i] > 0.0;
             k++) {
            region.nodes += !seen[p->field.lists.idx[k]];
            seen[p->field.lists.idx[k]] = true;
        }
        if (measured->deviation[i] > 0.0) {
            region.shear_modulus += p->shear[node];
            region.volume += p->volume[node];
            points += 1.0;
        }
    }
    if (!(points > 0.0)) {
        goto done;
    }
    region.shear_modulus /= points;
    region.volume /= points;
    if (!(region.model_error > 0.0)) {
        region.model_error = usual_displacement(measured);
    }
    if (!(region.model_error > 0.0)) {
        status = scene_fail(error, STATUS_INPUT, p->input->scene, &p->section->label,
                            "points %s: all that was measured is 0: say by model_error how far off the scene "
                            "may be without them, m",
                            p->section->table);
        goto done;
    }
    p->energy = measured_energy(measured, &region);
done:
    free(seen);
    return status;
}

/* Exact rows from `first` on, one for each component that is known, that leave each other or the sections
 * before too little. */
static enum status check_rows(const struct point_section *p, int64_t first, struct error *error)
{
    enum status status;
    const struct constraint_rows *rows = &p->system->rows;
    int dim = p->measured.dim;
    int64_t row = first;
    bool *dependent = NULL;
    TRY(NEW_ARRAY(&dependent, rows->count, error));
    TRY(measured_dependent(rows, p->system->node_count, dependent, error));
    for (int64_t i = 0; i < p->measured.count; i++) {
        for (int a = 0; a < dim && !(p->measured.deviation[i] > 0.0); a++) {
            if (!isnan(p->measured.u[i * dim + a]) && dependent[row++]) {
                status = fail_at(p, i, error,
                                 "too many points for the nodes there, or one on what another section holds: "
                                 "leave it out, give standard deviations, or refine the cloud");
                goto done;
            }
        }
    }
done:
    free(dependent);
    return status;
}

static enum status add_section(struct point_section *p, struct error *note, struct error *error)
{
    enum status status;
    int64_t first = p->system->rows.count;
    TRY(read_section(p, error));
    TRY(compare_rows(p, note, error));
    TRY(look_at_nodes(p, error));
    TRY(find_field(p, error));
    TRY(model_add_curve(p->input, &p->section->label, &p->section->curve, p->system, &p->curve, error));
    TRY(set_energy(p, error));
    for (int64_t i = 0; i < p->measured.count; i++) {
        TRY(add_point(p, i, error));
    }
    if (p->system->rows.count > first) {
        TRY(check_rows(p, first, error));
    }
done:
    table_free(&p->table);
    field_table_free(&p->field);
    free(p->values);
    free(p->volume);
    free(p->shear);
    return status;
}

enum status model_add_points(const struct model_input *input, struct solid_system *system, struct error *note,
                             struct error *error)
{
    enum status status = STATUS_OK;
    for (int64_t i = 0; i < input->scene->displacement_count; i++) {
        if (input->scene->displacements[i].kind == SCENE_POINTS) {
            struct point_section p = {.input = input,
                                      .section = &input->scene->displacements[i],
                                      .system = system,
                                      .number = (int32_t)i};
            TRY(add_section(&p, note, error));
        }
    }
done:
    return status;
}
