#include "solid/assembly.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* By the shear modulus: that of pressure waves at Poisson's ratio .49. */
static const double penalty_factor = 50.0;

/* Penalty of about the stiffness of a layer of cells: as stiff as the critical step allows without loss. */
static double default_stiffness(const struct solid_system *system, const struct boundary_averages *averages)
{
    double modulus = assembly_penalty_modulus(system, penalty_factor), area = 0.0;
    for (int64_t a = 0; a < averages->count; a++) {
        area += averages->area[a];
    }
    area /= (double)averages->count;
    return modulus / (system->dim == 2 ? area : sqrt(area));
}

/* A curve that takes more than half of its largest factor in this share of the scene's time jumps. */
static const double jump_time = 1e-3;

/* The surface moves from where its file has it, and without jumps. */
static enum status check_curve(const struct contact_condition *condition, const char *key,
                               const struct load_curve *curve, struct error *error)
{
    double largest = 0.0, at_begin = curve_value(curve, 0.0);
    for (int64_t i = 0; i < curve->count; i++) {
        largest = fmax(largest, fabs(curve->factor[i]));
    }
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

static enum status add_motion(const struct contact_condition *condition, const struct solid_system *system,
                              struct rigid_motion *motion, struct error *error)
{
    enum status status = STATUS_OK;
    *motion = condition->motion;
    if (motion->moves) {
        TRY(rigid_motion_check(motion, system->dim, error));
        TRY(check_curve(condition, "curve", &system->curves[motion->translation_curve], error));
        TRY(check_curve(condition, "angle_curve", &system->curves[motion->rotation_curve], error));
    }
done:
    return status;
}

/* Where a surface presses, it is kept out at the quadrature points, too, by a penalty of so much of the
 * boundary averages'. From 4 to 16 the force on a block that is pressed to 30 % between plates changes by 0.3
 * %. */
static const double points_share = 8.0;

/* The contact of the points of the facets, which moves as that of the boundary averages does. */
static enum status add_points(const struct assembly *input, const struct contact_condition *condition,
                              struct solid_system *system, struct contact *averaged, struct error *error)
{
    enum status status;
    const struct facet_set *set = &condition->facets;
    struct rigid_surface surface = {0};
    struct boundary_averages *points = &system->contact_averages[system->contact_count];
    struct contact *contact = &system->contacts[system->contact_count];
    TRY(boundary_points_build(&input->face_table, set, points, error));
    TRY(rigid_build(system->dim, condition->rigid_count, condition->corners, condition->flip, &surface,
                    error));
    for (int64_t a = 0; a < points->count; a++) { /* each stands for another corner of its facet */
        points->node[a] = set->facet[a / input->face_table.per_face * system->dim + a % system->dim];
    }
    TRY(contact_build_points(points, system->dim, &surface, points_share * averaged->stiffness, contact,
                             error));
    contact->section = averaged->section;
    contact->motion = averaged->motion;
    averaged->points = contact;
    system->contact_count++;
    points = NULL;
done:
    if (points != NULL) {
        boundary_averages_free(points);
    }
    return status;
}

static enum status add_contact(const struct assembly *input, int32_t number, struct solid_system *system,
                               struct error *error)
{
    enum status status;
    const struct contact_condition *condition = &input->contacts[number];
    struct rigid_surface surface = {0};
    struct boundary_averages *averages = &system->contact_averages[system->contact_count];
    struct contact *contact = &system->contacts[system->contact_count];
    TRY(boundary_averages_build(&input->face_table, &condition->facets, averages, error));
    TRY(rigid_build(system->dim, condition->rigid_count, condition->corners, condition->flip, &surface,
                    error));
    double stiffness =
        condition->stiffness > 0.0 ? condition->stiffness : default_stiffness(system, averages);
    TRY(contact_build(averages, system->X, system->dim, &surface, stiffness, contact, error));
    system->contact_count++;
    averages = NULL;
    contact->section = number;
    TRY(add_motion(condition, system, &contact->motion, error));
    if (condition->motion.moves && !input->in_time) {
        TRY(add_points(input, condition, system, contact, error));
    }
done:
    if (averages != NULL) {
        boundary_averages_free(averages);
    }
    return status;
}

enum status assembly_add_contacts(const struct assembly *input, struct solid_system *system,
                                  struct error *error)
{
    enum status status;
    int64_t sections = input->contact_count;
    TRY(NEW_ARRAY(&system->contacts, 2 * sections, error));
    TRY(NEW_ARRAY(&system->contact_averages, 2 * sections, error));
    for (int64_t i = 0; i < sections; i++) {
        TRY(add_contact(input, (int32_t)i, system, error));
    }
done:
    return status;
}
