#include "solid/assembly/prescription.h"

#include "approx/field/field.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum status add_row(const struct prescription *p, const struct boundary_averages *averages, int64_t a,
                           const double *direction, double target, struct error *error)
{
    int64_t at = averages->ptr[a];
    static const double one = 1.0;
    struct constraint_rows *rows = &p->system->rows;
    if (p->input->direct) {
        /* With a weight function that almost interpolates, the parameter equals the value. */
        return constraint_rows_add(rows, 1, &averages->node[a], &one, direction, target, p->condition->curve,
                                   p->number, averages->node[a], error);
    }
    return constraint_rows_add(rows, averages->ptr[a + 1] - at, averages->idx + at, averages->phi + at,
                               direction, target, p->condition->curve, p->number, averages->node[a], error);
}

/* Add the rows of one average along directions that no earlier condition holds at its node. Where the whole
 * displacement is prescribed, the directions are made orthogonal to those prescribed before. */
static enum status add_rest(const struct prescription *p, const struct boundary_averages *averages, int64_t a,
                            struct error *error)
{
    int dim = p->input->cells.dim, count = 0;
    int32_t node = averages->node[a];
    struct demand demand;
    double mine[9];
    bool full = prescription_directions(p->condition, p->input->cells.dim) == p->input->cells.dim;
    enum status status = prescription_demand(p, averages, a, false, &demand, error);
    for (int k = 0; status == STATUS_OK && k < demand.count; k++) {
        double rest[3], target = demand.value[k], *direction = demand.direction + k * dim;
        double length = held_rest(p->held, node, full ? count : 0, mine, direction, rest);
        if (!(length > HELD_LEAST)) {
            continue;
        }
        if (full) {
            target = 0.0;
            for (int i = 0; i < dim; i++) {
                direction[i] = mine[count * dim + i] = rest[i] / length;
                target += direction[i] * demand.value[i];
            }
            count++;
        }
        status = add_row(p, averages, a, direction, target, error);
    }
    return status;
}

/* Record the facets of curved sides along whose normals the condition prescribes the displacement. */
static enum status note_sliding(const struct prescription *p, const struct boundary_sides *sides,
                                struct error *error)
{
    struct sliding *sliding = &p->system->sliding;
    const struct facet_set *set = &p->condition->facets;
    int dim = p->input->cells.dim;
    int64_t first = sliding->facet_count;
    for (int64_t f = 0; f < set->count; f++) {
        int64_t side = sides->facet_group[f];
        struct sliding_facet facet = {.side = sliding->side_count + (int32_t)side, .section = p->number};
        memcpy(facet.node, set->facet + f * dim, (size_t)dim * sizeof *facet.node);
        if (!sides->flat[sides->node_average_count + side]) {
            RETURN_IF_ERROR(sliding_add_facet(sliding, &facet, error));
        }
    }
    sliding_sort(sliding, first, sides->group_count);
    return STATUS_OK;
}

/* Add the rows of the first `count` averages, and record the values that the condition prescribes at their
 * nodes. */
static enum status add_all(const struct prescription *p, const struct boundary_averages *averages,
                           const struct boundary_sides *sides, int64_t count, struct error *error)
{
    int dim = p->input->cells.dim;
    int64_t first = p->system->rows.count;
    struct nodal_constraints *nodal = p->nodal_constraints;
    bool slides = sides != NULL && p->condition->kind == CONDITION_NORMAL;
    for (int64_t a = 0; a < count; a++) {
        struct demand demand;
        int64_t before = p->system->rows.count;
        RETURN_IF_ERROR(add_rest(p, averages, a, error));
        bool curved = slides && !sides->flat[sides->node_average_count + sides->group[a]];
        for (int64_t r = before; curved && r < p->system->rows.count; r++) {
            RETURN_IF_ERROR(sliding_add_row(&p->system->sliding, r, error));
        }
        RETURN_IF_ERROR(prescription_demand(p, averages, a, true, &demand, error));
        RETURN_IF_ERROR(GROW_ARRAY(&nodal->list, nodal->count + demand.count, &nodal->room, error));
        for (int k = 0; k < demand.count; k++) {
            struct nodal_constraint *added = &nodal->list[nodal->count++];
            *added = (struct nodal_constraint){averages->node[a], p->number, {0.0}, demand.value[k]};
            memcpy(added->direction, demand.direction + k * dim, (size_t)dim * sizeof *added->direction);
        }
    }
    held_note(p->held, &p->system->rows, first, p->system->rows.count);
    return STATUS_OK;
}

/* Prescribe the values that smoothed cells take from a facet: the mean of what its quadrature points from
 * `first` on have, and values at edges and nodes; along normals those of flat sides only, as a node of a
 * curved one has no normal of its own. */
static enum status prescribe_facet(const struct prescription *p, const struct boundary_averages *points,
                                   int64_t first, const struct face_rows *rows, bool flat,
                                   struct error *error)
{
    int dim = p->input->cells.dim, per_face = p->input->face_table.per_face;
    double area = 0.0;
    for (int64_t a = first; a < first + per_face; a++) {
        area += points->area[a];
    }
    for (int r = 0; r < rows->count && (flat || r == 0); r++) {
        double mean[3] = {0.0, 0.0, 0.0};
        struct demand demand;
        if (r > 0 && prescribed_values_full(&p->system->body, rows, r)) {
            continue; /* by a facet beside this one */
        }
        for (int64_t a = first; r == 0 && a < first + per_face; a++) {
            RETURN_IF_ERROR(prescription_demand(p, points, a, false, &demand, error));
            add_scaled(demand.count, points->area[a] / area, demand.value, mean);
        }
        if (r > 0) {
            RETURN_IF_ERROR(prescription_demand_at(p, points->node[first], rows->place + r * dim,
                                                   points->normal + first * dim, &demand, error));
            memcpy(mean, demand.value, sizeof mean);
        }
        for (int k = 0; k < demand.count; k++) {
            RETURN_IF_ERROR(prescribed_values_add(&p->system->body, rows, r, demand.direction + k * dim,
                                                  mean[k], p->condition->curve, p->number, error));
        }
    }
    return STATUS_OK;
}

/* Prescribe those of all facets of the set. */
static enum status prescribe_values(const struct prescription *p, const struct boundary_sides *sides,
                                    struct error *error)
{
    const struct facet_set *set = &p->condition->facets;
    struct body *body = &p->system->body;
    FREED_BY(boundary_averages_free) struct boundary_averages points = {0};
    NEW_SCRATCH(int64_t, found, set->count, error);
    if (body->cells.prescribed.of_row == NULL) {
        RETURN_IF_ERROR(prescribed_values_begin(body, &p->input->cells, &p->input->boundary, error));
    }
    RETURN_IF_ERROR(faces_find(&p->input->boundary, set->count, set->facet, found, error));
    RETURN_IF_ERROR(boundary_points_build(&p->input->face_table, set, &points, error));
    for (int64_t f = 0; f < set->count; f++) {
        struct face_rows rows;
        bool flat = p->condition->kind != CONDITION_NORMAL ||
                    sides->flat[sides->node_average_count + sides->facet_group[f]];
        if (found[f] >= 0) {
            prescribed_values_face(body, &p->input->cells, found[f], &rows);
            RETURN_IF_ERROR(
                prescribe_facet(p, &points, f * p->input->face_table.per_face, &rows, flat, error));
        }
    }
    return STATUS_OK;
}

/* Add constraint rows on boundary averages. */
static enum status add_averages(struct prescription *p, struct error *error)
{
    FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
    FREED_BY(boundary_sides_free) struct boundary_sides sides = {0};
    bool normal = p->condition->kind == CONDITION_NORMAL; /* a node on an edge has one for each side */
    RETURN_IF_ERROR(
        boundary_sides_build(&p->input->face_table, &p->condition->facets, normal, &averages, &sides, error));
    RETURN_IF_ERROR(add_all(p, &averages, &sides, sides.node_average_count, error));
    RETURN_IF_ERROR(normal ? note_sliding(p, &sides, error) : STATUS_OK);
    return p->input->smoothed ? prescribe_values(p, &sides, error) : STATUS_OK;
}

/* Add constraint rows on values at the nodes of facets or of sets. */
static enum status add_nodes(struct prescription *p, struct error *error)
{
    const struct assembly *input = p->input;
    const struct condition *condition = p->condition;
    FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
    if (condition->facets.count > 0) {
        RETURN_IF_ERROR(boundary_nodes_build(&input->face_table, &condition->facets, &input->node_lists,
                                             input->node_phi, &averages, error));
    } else {
        RETURN_IF_ERROR(boundary_list_build(input->cells.dim, input->cells.x, condition->nodes,
                                            condition->node_count, &input->node_lists, input->node_phi,
                                            &averages, error));
    }
    return add_all(p, &averages, NULL, averages.count, error);
}

static enum status add_condition(struct prescription *p, struct error *note, struct error *error)
{
    int dim = p->input->cells.dim;
    const struct condition *condition = p->condition;
    FREED_BY(edge_paths_free) struct edge_paths paths = {0};
    if (condition->kind == CONDITION_TABLE) {
        RETURN_IF_ERROR(edge_paths_build(&p->input->cells, condition->row_count, 2 * dim, condition->rows,
                                         condition->unit, &paths, error));
        p->fit = (struct scattered_fit){.dim = dim,
                                        .value_count = dim,
                                        .count = condition->row_count,
                                        .row_size = 2 * dim,
                                        .row = condition->rows,
                                        .unit = condition->unit,
                                        .paths = &paths};
        RETURN_IF_ERROR(scattered_fit_build(&p->fit, error));
        RETURN_IF_ERROR(prescription_check_table(p, error));
        RETURN_IF_ERROR(NEW_ARRAY(&p->spacing, p->input->cells.node_count, error));
        RETURN_IF_ERROR(field_spacing(&p->input->cells, p->spacing, error));
    }
    if (condition->facets.count > 0 && assembly_holds_averages(p->input)) {
        RETURN_IF_ERROR(add_averages(p, error));
    } else {
        RETURN_IF_ERROR(add_nodes(p, error));
    }
    return condition->kind == CONDITION_TABLE ? prescription_check_fit(p, note, error) : STATUS_OK;
}

static void prescription_free(struct prescription *p)
{
    scattered_fit_free(&p->fit);
    free(p->spacing);
}

enum status assembly_add_conditions(const struct assembly *input, struct solid_system *system,
                                    struct error *note, struct error *error)
{
    FREED_BY(nodal_constraints_free) struct nodal_constraints nodal_constraints = {0};
    FREED_BY(held_free) struct held_directions held = {0};
    note->text[0] = '\0';
    RETURN_IF_ERROR(held_build(input->cells.dim, input->cells.node_count, &held, error));
    /* Conditions that prescribe few directions come first, so that a side that slides along a plane stays on
     * it up to its rim. */
    for (int directions = 1; directions <= input->cells.dim; directions++) {
        for (int64_t i = 0; i < input->condition_count; i++) {
            FREED_BY(prescription_free)
            struct prescription p = {.input = input,
                                     .condition = &input->conditions[i],
                                     .system = system,
                                     .nodal_constraints = &nodal_constraints,
                                     .held = &held,
                                     .number = (int32_t)i};
            if (p.condition->kind != CONDITION_POINTS &&
                prescription_directions(p.condition, input->cells.dim) == directions) {
                RETURN_IF_ERROR(add_condition(&p, note, error));
            }
        }
    }
    if (input->smoothed) {
        RETURN_IF_ERROR(prescribed_values_complete(&system->body, &input->cells, error));
    }
    return nodal_constraints_check(input, &nodal_constraints, note, error);
}
