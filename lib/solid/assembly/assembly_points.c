/* Displacements of measured points, anywhere in the body or on it: exact conditions on the field there, or
 * springs. */
#include "solid/assembly/assembly.h"

#include "base/memory.h"
#include "base/vector.h"
#include "solid/rigid/rigid.h"

#include <math.h>
#include <stdio.h>

/* A point is on a facet if it is no farther, by the facet's width; and a component is along the normal. */
static const double on_facet = 0.01, along_normal = 0.9;

static const char *const too_many = "too many points for the nodes there, one twice, or one on what another "
                                    "section holds: leave it out, give "
                                    "standard deviations, or refine the cloud";

/* One condition of measured points. */
struct point_condition {
    const struct assembly *input;
    const struct condition *condition;
    const struct measured *measured;
    struct solid_system *system;
    int32_t number;
    double *volume, *shear; /* of each node: volume, m3 (2D: m2), and shear modulus, Pa */
    double energy;          /* e of measured.h, J (2D: J/m) */
    double least_deviation; /* of a spring: it moves by the tolerance, m */
};

enum status condition_fail_at(const struct condition *condition, int64_t row, struct error *error,
                              const char *what)
{
    const struct measured *measured = &condition->measured;
    return fail(error, STATUS_INPUT, "%s: points %s:%lld: at %s: %s", condition->where, condition->table,
                (long long)condition->line[row], POINT_TEXT(measured->dim, measured->x + row * measured->dim),
                what);
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
        const int32_t *node = cells->node + (int64_t)cell[body->order.points[q]] * corners;
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

/* Refuse two exact points that contradict each other. */
static enum status compare_rows(const struct point_condition *p, struct error *error)
{
    struct measured_pair pair;
    char what[192];
    RETURN_IF_ERROR(measured_compare(p->measured, &pair, error));
    if (pair.second < 0) {
        return STATUS_OK;
    }
    snprintf(what, sizeof what,
             "contradicts line %lld, %.3g m away: their displacements differ by %.3g m, which turns over "
             "what is between: give standard deviations, or leave one out",
             (long long)p->condition->line[pair.first], pair.distance, pair.apart);
    return condition_fail_at(p->condition, pair.second, error, what);
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
        double deviation = fmax(p->measured->deviation[i], p->least_deviation);
        direction[a] = 1.0;
        if (isnan(target)) {
            continue;
        }
        if (!(p->measured->deviation[i] > 0.0)) {
            RETURN_IF_ERROR(constraint_rows_add(&p->system->rows, average.length, average.idx, average.phi,
                                                direction, target, p->condition->curve, p->number, node,
                                                error));
            continue;
        }
        RETURN_IF_ERROR(system_append_spring(p->system, &average, direction, target, p->condition->curve,
                                             p->number, node, p->energy / (deviation * deviation), error));
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
    p->least_deviation = sqrt(p->input->tolerance) * region.model_error;
    return STATUS_OK;
}

/* Whether a section that holds facets prescribes component a where their normal is this. */
static bool prescribes(const struct condition *condition, const double *normal, int a)
{
    return condition->kind == CONDITION_NORMAL       ? fabs(normal[a]) > along_normal
           : condition->kind == CONDITION_COMPONENTS ? !condition->is_free[a]
                                                     : true;
}

/* Refuse exact points on facets of another section that prescribes one of their components. */
static enum status check_facets(const struct point_condition *p, const struct condition *other,
                                struct error *error)
{
    int dim = p->measured->dim;
    const double *x = p->input->cells.x;
    FREED_BY(rigid_free) struct rigid_surface surface = {0};
    RETURN_IF_ERROR(rigid_of_facets(dim, x, other->facets.count, other->facets.facet, &surface, error));
    for (int64_t i = 0; i < p->measured->count; i++) {
        struct rigid_contact closest = rigid_closest(&surface, p->measured->x + i * dim, INFINITY);
        double area[3];
        face_area_vector(dim, x, other->facets.facet + closest.facet * dim, area);
        double width = pow(vector_length(dim, area), 1.0 / (dim - 1));
        bool on = !(p->measured->deviation[i] > 0.0) && closest.found && closest.distance < on_facet * width;
        for (int a = 0; a < dim && on; a++) {
            if (!isnan(p->measured->u[i * dim + a]) &&
                prescribes(other, surface.normal + closest.facet * dim, a)) {
                return condition_fail_at(p->condition, i, error, too_many);
            }
        }
    }
    return STATUS_OK;
}

/* Refuse exact rows from `first` on, one for each known component, that are nearly linearly dependent on each
 * other or on rows of earlier sections, or on facets that these hold. */
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
                return condition_fail_at(p->condition, i, error, too_many);
            }
        }
    }
    for (int64_t c = 0; c < p->input->condition_count; c++) {
        const struct condition *other = &p->input->conditions[c];
        RETURN_IF_ERROR(other->kind != CONDITION_POINTS && other->facets.count > 0
                            ? check_facets(p, other, error)
                            : STATUS_OK);
    }
    return STATUS_OK;
}

static void point_condition_free(struct point_condition *p)
{
    FREE_ALL(p->volume, p->shear);
}

enum status assembly_add_points(const struct assembly *input, struct solid_system *system,
                                struct error *error)
{
    for (int64_t i = 0; i < input->condition_count; i++) {
        if (input->conditions[i].kind == CONDITION_POINTS) {
            FREED_BY(point_condition_free)
            struct point_condition p = {.input = input,
                                        .condition = &input->conditions[i],
                                        .measured = &input->conditions[i].measured,
                                        .system = system,
                                        .number = (int32_t)i};
            int64_t first = system->rows.count;
            RETURN_IF_ERROR(compare_rows(&p, error));
            RETURN_IF_ERROR(measure_nodes(&p, error));
            RETURN_IF_ERROR(set_energy(&p, error));
            for (int64_t k = 0; k < p.measured->count; k++) {
                RETURN_IF_ERROR(add_point(&p, k, error));
            }
            RETURN_IF_ERROR(system->rows.count > first ? check_rows(&p, first, error) : STATUS_OK);
        }
    }
    return STATUS_OK;
}
