#include "model.h"

#include "io/surface.h"

#include <math.h>
#include <stdlib.h>

/* Corner coordinates, m, of a rigid surface's facets: consecutive points of each polyline, or triangles. */
static enum status rigid_corners(const struct scene_contact *section, const struct table *table, int dim,
                                 double **corners, int64_t *count, struct error *error)
{
    enum status status;
    *count = 0;
    TRY(NEW_ARRAY(corners, table->rows * (dim == 2 ? 4 : 9), error));
    if (dim == 3) {
        for (int64_t i = 0; i < table->rows * 9; i++) {
            (*corners)[i] = table->values[i] * section->rigid_unit;
        }
        *count = table->rows;
        return STATUS_OK;
    }
    for (int64_t b = 0; b < table->block_count; b++) {
        for (int64_t r = table->block_ptr[b]; r + 1 < table->block_ptr[b + 1]; r++) {
            for (int i = 0; i < 4; i++) {
                (*corners)[*count * 4 + i] = table->values[r * 2 + i] * section->rigid_unit;
            }
            ++*count;
        }
    }
done:
    return status;
}

/* By the shear modulus: that of pressure waves at Poisson's ratio .49. */
static const double penalty_factor = 50.0;

/* Penalty of about the stiffness of a layer of cells: as stiff as the critical step allows without loss. */
static double default_stiffness(const struct solid_system *system, const struct boundary_averages *averages)
{
    double modulus = model_penalty_modulus(system, penalty_factor), area = 0.0;
    for (int64_t a = 0; a < averages->count; a++) {
        area += averages->area[a];
    }
    area /= (double)averages->count;
    return modulus / (system->dim == 2 ? area : sqrt(area));
}

/* A curve that takes more than half of its largest factor in this share of the scene's time jumps. */
static const double jump_time = 1e-3;

/* The surface moves from where its file has it, and without jumps. */
static enum status check_curve(const struct model_input *input, const struct scene_contact *section,
                               const char *key, const struct load_curve *curve, struct error *error)
{
    const struct scene_label *label = &section->label;
    double largest = 0.0, at_begin = curve_value(curve, 0.0);
    for (int64_t i = 0; i < curve->count; i++) {
        largest = fmax(largest, fabs(curve->factor[i]));
    }
    if (fabs(at_begin) > 1e-12 * largest) {
        return scene_fail(
            error, STATUS_INPUT, input->scene, label,
            "%s: begins at %g, with a jump: begin at time 0 with factor 0, where the file has the "
            "surface",
            key, at_begin);
    }
    for (int64_t i = 0; i < curve->count; i++) {
        double s = curve->time[i] / curve->end;
        if (fabs(curve_value(curve, s + jump_time) - curve_value(curve, s)) > 0.5 * largest) {
            return scene_fail(error, STATUS_INPUT, input->scene, label,
                              "%s: jumps from %g to %g at time %g: give the surface more time to move there",
                              key, curve_value(curve, s), curve_value(curve, s + jump_time), curve->time[i]);
        }
    }
    return STATUS_OK;
}

/* The motion of the section's surface, with its curves. */
static enum status add_motion(const struct model_input *input, const struct scene_contact *section,
                              struct solid_system *system, struct rigid_motion *motion, struct error *error)
{
    enum status status = STATUS_OK;
    *motion = (struct rigid_motion){.moves = section->moves, .angle = section->angle * (M_PI / 180.0)};
    if (!section->moves) {
        return STATUS_OK;
    }
    for (int i = 0; i < 3; i++) {
        motion->translation[i] = section->translation[i];
        motion->point[i] = section->axis_point[i];
        motion->axis[i] = section->angle != 0.0 ? section->axis[i] : (double)(i == 2);
    }
    TRY(rigid_motion_check(motion, system->dim, error));
    TRY(model_add_curve(input, &section->label, &section->curve, system, &motion->translation_curve, error));
    TRY(check_curve(input, section, "curve", &system->curves[motion->translation_curve], error));
    TRY(model_add_curve(input, &section->label, &section->angle_curve, system, &motion->rotation_curve,
                        error));
    TRY(check_curve(input, section, "angle_curve", &system->curves[motion->rotation_curve], error));
done:
    return status;
}

/* The surface of a section. */
static enum status read_surface(const struct scene_contact *section, int dim, struct rigid_surface *surface,
                                struct error *error)
{
    enum status status;
    struct table table = {0};
    double *corners = NULL;
    int64_t count;
    bool flip = section->side == SCENE_LEFT || section->side == SCENE_BACK;
    TRY(surface_read(section->rigid, dim, &table, error));
    TRY(rigid_corners(section, &table, dim, &corners, &count, error));
    TRY(rigid_build(dim, count, corners, flip, surface, error));
done:
    free(corners);
    table_free(&table);
    return status;
}

/* Where a surface presses, it is kept out at the quadrature points, too, by a penalty of so much of the
 * boundary averages'. From 4 to 16 the force on a block that is pressed to 30 % between plates changes by 0.3
 * %. */
static const double points_share = 8.0;

/* The contact of the points of a section's facets, which moves as that of the boundary averages does. */
static enum status add_points(const struct model_input *input, const struct scene_contact *section,
                              const struct facet_set *set, struct solid_system *system,
                              struct contact *averaged, struct error *error)
{
    enum status status;
    struct rigid_surface surface = {0};
    struct boundary_averages *points = &system->contact_averages[system->contact_count];
    struct contact *contact = &system->contacts[system->contact_count];
    TRY(boundary_points_build(&input->face_table, set, points, error));
    TRY(read_surface(section, system->dim, &surface, error));
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

static enum status add_contact(const struct model_input *input, int32_t number, struct solid_system *system,
                               struct error *error)
{
    enum status status;
    const struct scene_contact *section = &input->scene->contacts[number];
    struct facet_set set;
    struct rigid_surface surface = {0};
    int32_t *owned = NULL;
    struct boundary_averages *averages = &system->contact_averages[system->contact_count];
    struct contact *contact = &system->contacts[system->contact_count];
    TRY(model_facets(input, &section->label, &section->facets, &set, &owned, error));
    TRY(boundary_averages_build(&input->face_table, &set, averages, error));
    TRY(read_surface(section, system->dim, &surface, error));
    double stiffness = section->stiffness > 0.0 ? section->stiffness : default_stiffness(system, averages);
    TRY(contact_build(averages, system->X, system->dim, &surface, stiffness, contact, error));
    system->contact_count++;
    averages = NULL;
    contact->section = number;
    TRY(add_motion(input, section, system, &contact->motion, error));
    if (section->moves && input->scene->analysis == SCENE_QUASI_STATIC) {
        TRY(add_points(input, section, &set, system, contact, error));
    }
done:
    if (averages != NULL) {
        boundary_averages_free(averages);
    }
    free(owned);
    return status;
}

enum status model_add_contacts(const struct model_input *input, struct solid_system *system,
                               struct error *error)
{
    enum status status;
    int64_t sections = input->scene->contact_count;
    TRY(NEW_ARRAY(&system->contacts, 2 * sections, error));
    TRY(NEW_ARRAY(&system->contact_averages, 2 * sections, error));
    for (int64_t i = 0; i < sections; i++) {
        TRY(add_contact(input, (int32_t)i, system, error));
    }
done:
    return status;
}
