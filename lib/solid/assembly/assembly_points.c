/* Displacements of measured points, anywhere in the body or on it: exact conditions on the field there, or
 * springs. */
#include "solid/assembly/assembly.h"

#include "approx/points/point_grid.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One condition of measured points. */
struct point_condition {
    const struct assembly *input;
    const struct condition *condition;
    const struct measured *measured;
    struct solid_system *system;
    int32_t number;
    double *volume, *shear; /* of each node: volume, m3 (2D: m2), and shear modulus, Pa */
    double energy;          /* e of measured.h, J (2D: J/m) */
};

/* "FILE:LINE: [displacement NAME]: points TABLE:LINE: ..." */
static enum status fail_at(const struct point_condition *p, int64_t row, struct error *error,
                           const char *what)
{
    char place[96];
    point_text(p->measured->dim, p->measured->x + row * p->measured->dim, place);
    return fail(error, STATUS_INPUT, "%s: points %s:%lld: at %s: %s", p->condition->where,
                p->condition->table, (long long)p->condition->line[row], place, what);
}

/* Volume and mean shear modulus of the cells at each node. */
static enum status measure_nodes(struct point_condition *p, struct error *error)
{
    const struct body *body = &p->system->body;
    const struct cells *cells = &p->input->cells;
    const int32_t *cell = p->input->point_cell;
    int corners = cells->dim + 1;
    RETURN_IF_ERROR(NEW_ARRAY(&p->volume, cells->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&p->shear, cells->node_count, error));
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
    return STATUS_OK;
}

/* Check the points for contradictions and repetitions. */
static enum status compare_rows(const struct point_condition *p, struct error *note, struct error *error)
{
    struct measured_pair exact, others, repeated;
    char what[192];
    enum status status =
        measured_compare(p->measured, 1e-9 * p->input->extent, &exact, &others, &repeated, error);
    if (status == STATUS_OK && exact.count > 0) {
        snprintf(what, sizeof what,
                 "contradicts line %lld, %.3g m away: their displacements differ by %.3g m, which turns over "
                 "what is between: give standard deviations, or leave one out",
                 (long long)p->condition->line[exact.first], exact.distance, exact.apart);
        return fail_at(p, exact.second, error, what);
    }
    if (status == STATUS_OK && repeated.count > 0) {
        snprintf(what, sizeof what, "is the point of line %lld again: leave one out",
                 (long long)p->condition->line[repeated.first]);
        return fail_at(p, repeated.second, error, what);
    }
    if (status == STATUS_OK && others.count > 0 && note->text[0] == '\0') {
        snprintf(what, sizeof what,
                 "contradicts line %lld, %.3g m away: their displacements differ by %.3g m, more than six "
                 "standard deviations (pairs like this: %lld)",
                 (long long)p->condition->line[others.first], others.distance, others.apart,
                 (long long)others.count);
        (void)fail_at(p, others.second, note, what);
    }
    return status;
}

/* The nearest of the nodes of the field at point i. */
static int32_t nearest_node(const struct point_condition *p, int64_t i)
{
    int dim = p->measured->dim;
    const int64_t *ptr = p->condition->field.ptr;
    const int32_t *idx = p->condition->field.idx;
    double least = INFINITY;
    int32_t nearest = idx[ptr[i]];
    for (int64_t k = ptr[i]; k < ptr[i + 1]; k++) {
        double distance2 =
            vector_distance2(dim, p->input->cells.x + (int64_t)idx[k] * dim, p->measured->x + i * dim);
        if (distance2 < least) {
            least = distance2;
            nearest = idx[k];
        }
    }
    return nearest;
}

/* Add the rows of point i, or its springs. */
static enum status add_point(const struct point_condition *p, int64_t i, struct error *error)
{
    int dim = p->measured->dim;
    int64_t at = p->condition->field.ptr[i];
    int32_t node = nearest_node(p, i);
    struct average average = {p->condition->field.ptr[i + 1] - at, p->condition->field.idx + at,
                              p->condition->field_phi + at};
    for (int a = 0; a < dim; a++) {
        double direction[3] = {0.0, 0.0, 0.0}, target = p->measured->u[i * dim + a];
        double deviation = p->measured->deviation[i];
        direction[a] = 1.0;
        if (isnan(target)) {
            continue;
        }
        if (!(deviation > 0.0)) {
            RETURN_IF_ERROR(constraint_rows_add(&p->system->rows, average.length, average.idx, average.phi,
                                                direction, target, p->condition->curve, p->number, node,
                                                error));
            continue;
        }
        RETURN_IF_ERROR(system_append_penalty(p->system, &average, direction, target, p->condition->curve,
                                              p->number, node, p->energy / (deviation * deviation), 0.0,
                                              error));
        p->system->spring_count++;
    }
    return STATUS_OK;
}

/* Root mean square of the measured components. */
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
static enum status set_energy(struct point_condition *p, struct error *error)
{
    const struct measured *measured = p->measured;
    struct measured_region region = {.body_size = p->input->extent, .model_error = p->condition->model_error};
    double points = 0.0;
    NEW_SCRATCH(bool, seen, p->system->node_count, error);
    for (int64_t i = 0; i < measured->count; i++) {
        int32_t node = nearest_node(p, i);
        for (int64_t k = p->condition->field.ptr[i];
             k < p->condition->field.ptr[i + 1] && measured->deviation[i] > 0.0; k++) {
            region.nodes += !seen[p->condition->field.idx[k]];
            seen[p->condition->field.idx[k]] = true;
        }
        if (measured->deviation[i] > 0.0) {
            region.shear_modulus += p->shear[node];
            region.volume += p->volume[node];
            points += 1.0;
        }
    }
    if (!(points > 0.0)) {
        return STATUS_OK;
    }
    region.shear_modulus /= points;
    region.volume /= points;
    if (!(region.model_error > 0.0)) {
        region.model_error = usual_displacement(measured);
    }
    if (!(region.model_error > 0.0)) {
        return fail(error, STATUS_INPUT,
                    "%s: points %s: all that was measured is 0: say by model_error how far off the scene "
                    "may be without them, m",
                    p->condition->where, p->condition->table);
    }
    p->energy = measured_energy(measured, &region);
    return STATUS_OK;
}

/* Refuse exact rows from `first` on, one for each known component, that are nearly linearly dependent on each
 * other or on rows of earlier sections. */
static enum status check_rows(const struct point_condition *p, int64_t first, struct error *error)
{
    const struct constraint_rows *rows = &p->system->rows;
    int dim = p->measured->dim;
    int64_t row = first;
    NEW_SCRATCH(bool, dependent, rows->count, error);
    RETURN_IF_ERROR(measured_dependent(rows, p->system->node_count, dependent, error));
    for (int64_t i = 0; i < p->measured->count; i++) {
        for (int a = 0; a < dim && !(p->measured->deviation[i] > 0.0); a++) {
            if (!isnan(p->measured->u[i * dim + a]) && dependent[row++]) {
                return fail_at(p, i, error,
                               "too many points for the nodes there, or one on what another section holds: "
                               "leave it out, give standard deviations, or refine the cloud");
            }
        }
    }
    return STATUS_OK;
}

/* The difference between the displacement measured at point i and the target of a row, along the row's
 * direction; 0 if the measured component is not known. */
static double off_row(const struct point_condition *p, int64_t i, int64_t row)
{
    const struct constraint_rows *rows = &p->system->rows;
    int dim = p->measured->dim;
    double along = 0.0;
    for (int a = 0; a < dim; a++) {
        double part = rows->direction[row * dim + a];
        along += part == 0.0 ? 0.0 : part * p->measured->u[i * dim + a];
    }
    return isnan(along) ? 0.0 : fabs(along - rows->target[row]);
}

/* A grid of the nodes of the rows. The radius of each is a bound of off_row: its target plus the largest
 * measured displacement. x, radius: to be freed, as is the grid, also on failure. */
static enum status grid_of_rows(const struct point_condition *p, struct point_grid *grid, double **x,
                                double **radius, struct error *error)
{
    const struct constraint_rows *rows = &p->system->rows;
    const struct cells *cells = &p->input->cells;
    int dim = cells->dim;
    double most = 0.0;
    RETURN_IF_ERROR(NEW_ARRAY(x, rows->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(radius, rows->count, error));
    for (int64_t i = 0; i < p->measured->count * dim; i++) {
        most = fmax(most, dim * fabs(p->measured->u[i])); /* fmax ignores NAN, an unknown component */
    }
    for (int64_t r = 0; r < rows->count; r++) {
        memcpy(*x + r * dim, cells->x + (int64_t)rows->node[r] * dim, (size_t)dim * sizeof **x);
        (*radius)[r] = fabs(rows->target[r]) + most + 1e-9 * p->input->extent;
    }
    return point_grid_build(grid, dim, rows->count, *x, *radius, error);
}

/* Check exact point i against rows of other sections near it (`near`): their displacements must not differ by
 * more than their distance. */
static enum status compare_near(const struct point_condition *p, int64_t i, const struct index_list *near,
                                struct error *error)
{
    const struct constraint_rows *rows = &p->system->rows;
    int dim = p->measured->dim;
    char what[256];
    for (int64_t k = 0; k < near->count; k++) {
        int32_t r = near->index[k];
        const struct condition *other = &p->input->conditions[rows->section[r]];
        double off = off_row(p, i, r),
               distance = vector_distance(dim, p->measured->x + i * dim,
                                          p->input->cells.x + (int64_t)rows->node[r] * dim);
        if (other->kind == CONDITION_POINTS || !(off > distance + 1e-9 * p->input->extent)) {
            continue;
        }
        snprintf(what, sizeof what,
                 "contradicts [displacement %s], which holds a node %.3g m away: their displacements differ "
                 "by %.3g m, which turns over what is between: give a standard deviation, or leave it out",
                 other->name, distance, off);
        return fail_at(p, i, error, what);
    }
    return STATUS_OK;
}

static enum status compare_held(const struct point_condition *p, struct error *error)
{
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(index_list_free) struct index_list near = {0};
    SCRATCH double *x = NULL, *radius = NULL;
    RETURN_IF_ERROR(grid_of_rows(p, &grid, &x, &radius, error));
    for (int64_t i = 0; i < p->measured->count; i++) {
        near.count = 0;
        if (!(p->measured->deviation[i] > 0.0)) {
            RETURN_IF_ERROR(
                point_grid_query(&grid, p->measured->x + i * p->measured->dim, 1.0, &near, error));
            RETURN_IF_ERROR(compare_near(p, i, &near, error));
        }
    }
    return STATUS_OK;
}

static enum status add_condition(struct point_condition *p, struct error *note, struct error *error)
{
    enum status status;
    int64_t first = p->system->rows.count;
    TRY(compare_rows(p, note, error));
    TRY(compare_held(p, error));
    TRY(measure_nodes(p, error));
    TRY(set_energy(p, error));
    for (int64_t i = 0; i < p->measured->count; i++) {
        TRY(add_point(p, i, error));
    }
    if (p->system->rows.count > first) {
        TRY(check_rows(p, first, error));
    }
done:
    FREE_ALL(p->volume, p->shear);
    return status;
}

enum status assembly_add_points(const struct assembly *input, struct solid_system *system, struct error *note,
                                struct error *error)
{
    for (int64_t i = 0; i < input->condition_count; i++) {
        if (input->conditions[i].kind == CONDITION_POINTS) {
            struct point_condition p = {.input = input,
                                        .condition = &input->conditions[i],
                                        .measured = &input->conditions[i].measured,
                                        .system = system,
                                        .number = (int32_t)i};
            RETURN_IF_ERROR(add_condition(&p, note, error));
        }
    }
    return STATUS_OK;
}
