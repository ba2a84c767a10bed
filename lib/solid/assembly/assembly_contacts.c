#include "solid/assembly/assembly.h"

#include "approx/cells/parts.h"
#include "base/memory.h"
#include "solid/contact/contact_between.h"
#include "solid/contact/contact_rest.h"
#include "solid/contact/friction.h"

#include <math.h>

/* Penalty modulus by the shear modulus: the P-wave modulus at Poisson's ratio .49. */
static const double penalty_factor = 50.0;

/* Factor of this modulus at quadrature points, whose multipliers take what is left, and of the springs of
 * friction, which have none; and between facets of the body, where the pressures on both sides follow each
 * other slowly if it is large. */
static const double points_share = 4.0, between_share = 0.5;

/* A curve jumps if it changes by more than half of its largest factor in this share of the scene's time. */
static const double jump_time = 1e-3;

/* Check that a surface starts at the place given by its file, and moves without jumps. */
static enum status check_curve(const struct contact_condition *condition, const char *key,
                               const struct load_curve *curve, struct error *error)
{
    double largest = curve_largest(curve), at_begin = curve_value(curve, 0.0);
    if (fabs(at_begin) > 1e-12 * largest) {
        return fail(error, STATUS_INPUT,
                    "%s: %s: begins at %g, with a jump: begin at time 0 with factor 0, where the file has "
                    "the surface",
                    condition->where, key, at_begin);
    }
    for (int64_t i = 0; i < curve->count; i++) {
        double s = curve->time[i] / curve->end;
        if (fabs(curve_value(curve, s + jump_time) - curve_value(curve, s)) > 0.5 * largest) {
            return fail(error, STATUS_INPUT,
                        "%s: %s: jumps from %g to %g at time %g: give the surface more time to move there",
                        condition->where, key, curve_value(curve, s), curve_value(curve, s + jump_time),
                        curve->time[i]);
        }
    }
    return STATUS_OK;
}

/* The points of a contact. In a relaxation and `between` facets of the body, they are quadrature points with
 * multipliers at the nodes. If the facets do not resolve the boundary, its position between the nodes is not
 * known; then the points are boundary averages, raised to their nodes. Dynamics uses boundary averages too,
 * as each point costs time in every step. */
static enum status build_points(const struct assembly *input, const struct facet_set *set, bool between,
                                struct boundary_averages *points, struct boundary_averages *averages,
                                struct error *error)
{
    const struct face_table *table = &input->face_table;
    bool at_points = between;
    RETURN_IF_ERROR(boundary_averages_build(table, set, averages, error));
    RETURN_IF_ERROR(boundary_points_build(table, set, points, error));
    for (int64_t p = 0; p < points->count; p++) { /* each point of a facet gets another corner of it */
        points->node[p] = set->facet[p / table->per_face * table->dim + p % table->dim];
    }
    if (!between && !input->in_time) {
        RETURN_IF_ERROR(contact_rest_resolved(table->dim, points, averages, table->x, &at_points, error));
    }
    if (!at_points) {
        boundary_averages_free(points);
        *points = *averages;
        *averages = (struct boundary_averages){0};
    }
    return STATUS_OK;
}

/* Contact between facets of the body. A boundary that touches itself is that of its facets. */
static enum status add_between(const struct assembly *input, const struct contact_condition *condition,
                               const struct boundary_averages *points,
                               const struct boundary_averages *averages, struct contact *contact,
                               struct error *error)
{
    FREED_BY(opposite_free) struct opposite opposite = {0};
    FREED_BY(boundary_averages_free) struct boundary_averages facing = {0}, facing_averages = {0};
    SCRATCH double *own = NULL, *other = NULL;
    const struct cells *cells = &input->cells;
    bool any, itself = condition->facets.facet == condition->opposite.facet;
    int32_t bodies;
    NEW_SCRATCH(int32_t, of_cell, cells->count, error);
    NEW_SCRATCH(int32_t, part, cells->node_count, error);
    RETURN_IF_ERROR(cells_parts(cells, of_cell, &bodies, error));
    RETURN_IF_ERROR(nodes_parts(cells, of_cell, part, error));
    if (!itself) { /* heights of the boundaries above the points of the facets, and of those that these press
                      on */
        RETURN_IF_ERROR(build_points(input, &condition->opposite, true, &facing, &facing_averages, error));
        RETURN_IF_ERROR(NEW_ARRAY(&own, points->count, error));
        RETURN_IF_ERROR(NEW_ARRAY(&other, facing.count, error));
        RETURN_IF_ERROR(contact_rest_heights(cells->dim, points, averages, cells->x, own, error));
        RETURN_IF_ERROR(contact_rest_heights(cells->dim, &facing, &facing_averages, cells->x, other, error));
    }
    RETURN_IF_ERROR(opposite_build(&input->face_table, &condition->opposite, part, itself, &opposite, error));
    RETURN_IF_ERROR(contact_between_build(points, averages, cells->dim, cells->node_count,
                                          input->face_table.per_face, &opposite, part,
                                          itself ? 0 : condition->sign, condition->stiffness, own, other,
                                          !condition->whole, contact, &any, error));
    if (!any && !condition->whole) {
        return fail(error, STATUS_INPUT,
                    "%s: no facet faces another one at rest: name groups that face each other",
                    condition->where);
    }
    return STATUS_OK;
}

/* The stiffness of a layer of cells: by the P-wave modulus of the softer side, but at most penalty_factor
 * times the shear modulus of the stiffer one. */
static enum status set_stiffness(const struct assembly *input, const struct contact_condition *condition,
                                 struct contact *contact, struct error *error)
{
    double share = contact->averages == NULL ? 1.0 : contact->between != NULL ? between_share : points_share;
    double modulus, wave, least = INFINITY, largest = 0.0;
    const struct facet_set *sides[] = {&condition->facets, &condition->opposite};
    for (int i = 0; i < (condition->opposite.count > 0 ? 2 : 1); i++) {
        RETURN_IF_ERROR(assembly_penalty_modulus(input, sides[i], penalty_factor, &modulus, &wave, error));
        largest = fmax(largest, modulus);
        least = fmin(least, wave);
    }
    contact_set_stiffness(contact, share * fmin(least, largest));
    return STATUS_OK;
}

static enum status add_contact(const struct assembly *input, int32_t number, struct solid_system *system,
                               struct error *error)
{
    const struct contact_condition *condition = &input->contacts[number];
    bool between = condition->opposite.count > 0;
    FREED_BY(rigid_free) struct rigid_surface surface = {0};
    struct boundary_averages *points = &system->contact_points[number],
                             *averages = &system->contact_averages[number];
    struct contact *contact = &system->contacts[number];
    system->contact_count++;
    RETURN_IF_ERROR(build_points(input, &condition->facets, between, points, averages, error));
    if (between) {
        RETURN_IF_ERROR(add_between(input, condition, points, averages, contact, error));
    } else {
        RETURN_IF_ERROR(rigid_build(system->dim, condition->rigid_count, condition->corners, condition->flip,
                                    &surface, error));
        RETURN_IF_ERROR(fail_in(error,
                                contact_build(points, averages->count > 0 ? averages : NULL, system->X,
                                              system->dim, &surface, condition->stiffness, contact, error),
                                "%s", condition->where));
    }
    if (condition->stiffness == 0.0) {
        RETURN_IF_ERROR(set_stiffness(input, condition, contact, error));
    }
    contact->section = number;
    if (condition->friction > 0.0) {
        bool softer = condition->stiffness == 0.0 && contact->averages != NULL && between;
        RETURN_IF_ERROR(friction_build(contact, condition->friction,
                                       softer ? points_share / between_share : 1.0, input->in_time, error));
    }
    struct rigid_motion *motion = &contact->motion;
    *motion = condition->motion;
    if (!motion->moves) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(rigid_motion_check(motion, system->dim, error));
    RETURN_IF_ERROR(check_curve(condition, "curve", &system->curves[motion->translation_curve], error));
    return check_curve(condition, "angle_curve", &system->curves[motion->rotation_curve], error);
}

enum status assembly_add_contacts(const struct assembly *input, struct solid_system *system,
                                  struct error *error)
{
    int64_t sections = input->contact_count;
    if (sections == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&system->contacts, sections, error));
    RETURN_IF_ERROR(NEW_ARRAY(&system->contact_points, sections, error));
    RETURN_IF_ERROR(NEW_ARRAY(&system->contact_averages, sections, error));
    for (int64_t i = 0; i < sections; i++) {
        RETURN_IF_ERROR(add_contact(input, (int32_t)i, system, error));
    }
    return STATUS_OK;
}
