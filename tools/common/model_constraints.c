#include "model_claims.h"
#include "model_repeats.h"

#include "approx/scatter.h"
#include "io/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Penalty of the constraints between their averages, by the shear modulus and per size of a cell, as in
 * Nitsche's method. Results do not depend on it from .0001 to 100. */
static const double spring_factor = 10.0;

/* What one displacement section prescribes, and where it goes. */
struct prescription {
    const struct model_input *input;
    const struct scene_displacement *section;
    struct solid_system *system;
    struct claims *claims; /* of all sections */
    int32_t number, curve; /* of the section; of its load curve */
    struct table table;    /* SCENE_TABLE */
    bool springs;          /* adding springs, not exact rows */
    double modulus, layer; /* of the springs: Pa, and the size of the cells there, m */
};

/* The prescribed displacement at one place. */
static enum status table_value(const struct prescription *p, const double *x, double *value,
                               struct error *error)
{
    int dim = p->input->cells.dim;
    double distance, spacing;
    struct scatter scatter = {.dim = dim,
                              .value_count = dim,
                              .count = p->table.rows,
                              .row_size = p->table.cols,
                              .row = p->table.values,
                              .unit = p->section->table_unit};
    enum status status = scatter_evaluate(&scatter, x, value, &distance, &spacing, error);
    if (status == STATUS_OK && p->table.rows > 1 && !(distance <= fmin(8.0 * spacing, p->input->extent))) {
        char place[96];
        point_text(dim, x, place);
        return scene_fail(
            error, STATUS_INPUT, p->input->scene, &p->section->label,
            "table %s: its nearest point is %.3g m from the boundary at %s, its points are %.3g m "
            "apart: wrong unit or wrong place",
            p->section->table, distance, place, spacing);
    }
    return status;
}

/* Mean of the table over the samples of one average. */
static enum status average_of_table(const struct prescription *p, const struct boundary_averages *averages,
                                    int64_t a, double *mean, struct error *error)
{
    int dim = p->input->cells.dim;
    for (int i = 0; i < dim; i++) {
        mean[i] = 0.0;
    }
    for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
        double value[3];
        enum status status = table_value(p, averages->sample_x + s * dim, value, error);
        if (status != STATUS_OK) {
            return status;
        }
        for (int i = 0; i < dim; i++) {
            mean[i] += averages->sample_share[s] * value[i];
        }
    }
    return STATUS_OK;
}

/* A spring of about the stiffness of a layer of cells, times the area of its point of the facets. */
static enum status add_spring(const struct prescription *p, const struct boundary_averages *points, int64_t a,
                              const double *direction, double target, struct error *error)
{
    struct solid_system *system = p->system;
    int64_t at = points->ptr[a];
    enum status status =
        constraint_rows_add(&system->springs, points->ptr[a + 1] - at, points->idx + at, points->phi + at,
                            direction, target, p->curve, p->number, points->node[a], error);
    if (status != STATUS_OK) {
        return status;
    }
    double *stiffness = array_grow(system->spring_stiffness, system->springs.count, sizeof *stiffness);
    system->spring_stiffness = stiffness != NULL ? stiffness : system->spring_stiffness;
    double *pull = array_grow(system->spring_pull, system->springs.count, sizeof *pull);
    system->spring_pull = pull != NULL ? pull : system->spring_pull;
    if (stiffness == NULL || pull == NULL) {
        return fail_memory(error, "springs");
    }
    stiffness[system->springs.count - 1] = p->modulus * points->area[a] / p->layer;
    return STATUS_OK;
}

static enum status add_row(const struct prescription *p, const struct boundary_averages *averages, int64_t a,
                           const double *direction, double target, struct error *error)
{
    int64_t at = averages->ptr[a];
    static const double one = 1.0;
    struct constraint_rows *rows = &p->system->rows;
    if (p->springs) {
        return add_spring(p, averages, a, direction, target, error);
    }
    if (p->input->scene->solver.constraints == SCENE_DIRECT) {
        /* With a weight function that almost interpolates, the parameter is the value. */
        return constraint_rows_add(rows, 1, &averages->node[a], &one, direction, target, p->curve, p->number,
                                   averages->node[a], error);
    }
    return constraint_rows_add(rows, averages->ptr[a + 1] - at, averages->idx + at, averages->phi + at,
                               direction, target, p->curve, p->number, averages->node[a], error);
}

/* All rows of one average. */
static enum status add_average(const struct prescription *p, const struct boundary_averages *averages,
                               int64_t a, struct error *error)
{
    enum status status = STATUS_OK;
    int dim = p->input->cells.dim;
    double value[3] = {0.0, 0.0, 0.0};
    if (p->section->kind == SCENE_NORMAL) {
        return add_row(p, averages, a, averages->normal + a * dim, p->section->normal, error);
    }
    if (p->section->kind == SCENE_TABLE) {
        status = average_of_table(p, averages, a, value, error);
    }
    for (int i = 0; status == STATUS_OK && i < dim; i++) {
        double axis[3] = {0.0, 0.0, 0.0};
        axis[i] = 1.0;
        if (p->section->kind == SCENE_COMPONENTS) {
            value[i] = p->section->components[i];
            if (p->section->is_free[i]) {
                continue;
            }
        }
        status = add_row(p, averages, a, axis, value[i], error);
    }
    return status;
}

/* What the section prescribes at the node of an average. */
static enum status add_claims(const struct prescription *p, const struct boundary_averages *averages,
                              int64_t a, struct error *error)
{
    int dim = p->input->cells.dim;
    const struct scene_displacement *section = p->section;
    struct claim claim = {.node = averages->node[a], .section = p->number, .value = section->normal};
    double value[3] = {section->components[0], section->components[1], section->components[2]};
    if (section->kind == SCENE_NORMAL) {
        memcpy(claim.direction, averages->normal + a * dim, (size_t)dim * sizeof *claim.direction);
        return claims_add(p->claims, &claim, error);
    }
    enum status status = STATUS_OK;
    if (section->kind == SCENE_TABLE) {
        TRY(table_value(p, p->input->cells.x + (int64_t)claim.node * dim, value, error));
    }
    for (int i = 0; i < dim; i++) {
        if (section->kind == SCENE_COMPONENTS && section->is_free[i]) {
            continue;
        }
        memset(claim.direction, 0, sizeof claim.direction);
        claim.direction[i] = 1.0;
        claim.value = value[i];
        TRY(claims_add(p->claims, &claim, error));
    }
done:
    return status;
}

/* Whether conditions act on hat averages. */
static bool are_hats(const struct model_input *input)
{
    const struct scene_solver *solver = &input->scene->solver;
    return solver->constraint_points == SCENE_HAT_AVERAGES && solver->constraints == SCENE_EBCIEM;
}

/* Averages over facets: by hats, or by node values where the scene says so. */
static enum status averages_on_facets(const struct model_input *input, const struct facet_set *set,
                                      struct boundary_averages *averages, struct error *error)
{
    if (!are_hats(input)) {
        return boundary_nodes_build(&input->face_table, set, &input->node_lists, input->node_phi, averages,
                                    error);
    }
    return boundary_averages_build(&input->face_table, set, averages, error);
}

/* Hold what the hat averages of a set leave free. */
static enum status add_springs(struct prescription *p, const struct facet_set *set, struct error *error)
{
    enum status status;
    struct boundary_averages points = {0};
    double area = 0.0;
    TRY(boundary_points_build(&p->input->face_table, set, &points, error));
    for (int64_t a = 0; a < points.count; a++) {
        area += points.area[a];
    }
    area /= (double)set->count;
    p->springs = true;
    p->layer = p->input->cells.dim == 2 ? area : sqrt(2.0 * area);
    p->modulus = spring_factor * model_largest_shear(p->system);
    for (int64_t a = 0; a < points.count; a++) {
        TRY(add_average(p, &points, a, error));
    }
done:
    p->springs = false;
    boundary_averages_free(&points);
    return status;
}

static enum status add_section(struct prescription *p, struct error *error)
{
    enum status status;
    int dim = p->input->cells.dim;
    const struct scene_displacement *section = p->section;
    struct boundary_averages averages = {0};
    struct facet_set set = {0};
    int32_t *owned = NULL;
    int64_t count;
    TRY(model_add_curve(p->input, &section->label, &section->curve, p->system, &p->curve, error));
    if (section->kind == SCENE_TABLE) {
        TRY(table_read(section->table, 2 * dim, 2 * dim, &p->table, error));
    }
    if (section->facets.count > 0) {
        TRY(model_facets(p->input, &section->label, &section->facets, &set, &owned, error));
        TRY(averages_on_facets(p->input, &set, &averages, error));
    } else {
        TRY(model_nodes(p->input, &section->label, &section->nodes, &owned, &count, error));
        TRY(boundary_list_build(dim, p->input->cells.x, owned, count, &p->input->node_lists,
                                p->input->node_phi, &averages, error));
    }
    for (int64_t a = 0; a < averages.count; a++) {
        TRY(add_average(p, &averages, a, error));
        TRY(add_claims(p, &averages, a, error));
    }
    if (section->facets.count > 0 && are_hats(p->input)) {
        TRY(add_springs(p, &set, error));
    }
done:
    free(owned);
    boundary_averages_free(&averages);
    table_free(&p->table);
    return status;
}

enum status model_add_constraints(const struct model_input *input, struct solid_system *system,
                                  struct error *error)
{
    enum status status = STATUS_OK;
    struct claims claims = {0};
    for (int64_t i = 0; i < input->scene->displacement_count; i++) {
        int64_t first = system->rows.count;
        struct prescription p = {.input = input,
                                 .section = &input->scene->displacements[i],
                                 .system = system,
                                 .claims = &claims,
                                 .number = (int32_t)i};
        TRY(add_section(&p, error));
        if (i > 0) {
            TRY(repeats_drop(input, first, &system->rows, error));
        }
    }
    TRY(claims_check(input, &claims, error));
done:
    claims_free(&claims);
    return status;
}
