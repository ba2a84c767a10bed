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
/* At points so many times as much. A surface that multipliers alone press on, of which the pressure is some
 * ten shear moduli, is not stable: it buckles away from what presses unless the penalty is stiffer than that.
 */
static const double points_share = 8.0;

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

/* Whether the facets are flat about each node, to a thousandth: else they are chords of a curved boundary. */
static bool is_flat(const struct boundary_averages *points, const struct boundary_averages *hats, int dim)
{
    for (int64_t a = 0; a < hats->count; a++) {
        for (int64_t s = hats->sample_ptr[a]; s < hats->sample_ptr[a + 1]; s++) {
            double away2 = 0.0;
            for (int c = 0; c < dim; c++) {
                double d = hats->normal[a * dim + c] - points->normal[hats->sample_point[s] * dim + c];
                away2 += d * d;
            }
            if (away2 > 1e-6) {
                return false;
            }
        }
    }
    return true;
}

/* What the contact acts on. In a relaxation the quadrature points of flat facets, with multipliers at the
 * nodes. Those of chords lie beneath the boundary, each by another amount: then boundary averages, which are
 * raised to their nodes; and in dynamics, where each point costs. */
static enum status build_points(const struct model_input *input, const struct facet_set *set,
                                struct boundary_averages *points, struct boundary_averages *hats,
                                struct error *error)
{
    enum status status;
    TRY(boundary_averages_build(&input->face_table, set, hats, error));
    TRY(boundary_points_build(&input->face_table, set, points, error));
    if (input->scene->analysis != SCENE_QUASI_STATIC || !is_flat(points, hats, input->face_table.dim)) {
        boundary_averages_free(points);
        *points = *hats;
        *hats = (struct boundary_averages){0};
        return STATUS_OK;
    }
    for (int64_t p = 0; p < points->count; p++) { /* each stands for another corner of its facet */
        points->node[p] =
            set->facet[p / input->face_table.per_face * input->face_table.dim + p % input->face_table.dim];
    }
done:
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
    struct boundary_averages *points = &system->contact_points[number], *hats = &system->contact_hats[number];
    struct contact *contact = &system->contacts[number];
    system->contact_count++;
    TRY(model_facets(input, &section->label, &section->facets, &set, &owned, error));
    TRY(build_points(input, &set, points, hats, error));
    TRY(read_surface(section, system->dim, &surface, error));
    TRY(contact_build(points, hats->count > 0 ? hats : NULL, system->X, system->dim, &surface,
                      section->stiffness, contact, error));
    if (section->stiffness == 0.0) {
        contact_set_stiffness(contact, (hats->count > 0 ? points_share : 1.0) *
                                           model_penalty_modulus(system, penalty_factor));
    }
    contact->section = number;
    TRY(add_motion(input, section, system, &contact->motion, error));
done:
    free(owned);
    return status;
}

enum status model_add_contacts(const struct model_input *input, struct solid_system *system,
                               struct error *error)
{
    enum status status;
    int64_t sections = input->scene->contact_count;
    TRY(NEW_ARRAY(&system->contacts, sections, error));
    TRY(NEW_ARRAY(&system->contact_points, sections, error));
    TRY(NEW_ARRAY(&system->contact_hats, sections, error));
    for (int64_t i = 0; i < sections; i++) {
        TRY(add_contact(input, (int32_t)i, system, error));
    }
done:
    return status;
}
