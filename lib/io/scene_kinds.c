#include "io/scene_kinds.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#define KEYS (const char *const[])

static enum status read_scene(const struct place *place, struct scene *scene)
{
    static const char *const analyses[] = {"quasi-static", "dynamic", NULL};
    double dim = 0;
    int analysis = 0;
    RETURN_IF_ERROR(place_require(place, "dim", "give 2 or 3"));
    RETURN_IF_ERROR(place_require(place, "analysis", "give quasi-static or dynamic"));
    RETURN_IF_ERROR(place_number(place, "dim", range_any, &dim));
    if (dim != 2 && dim != 3) {
        return place_fail(place, "dim", "%g is neither 2 nor 3", dim);
    }
    scene->dim = (int)dim;
    RETURN_IF_ERROR(place_choice(place, "analysis", analyses, &analysis));
    scene->analysis = (enum scene_analysis)analysis;
    RETURN_IF_ERROR(place_vector(place, "gravity", scene->dim, scene->gravity, NULL));
    place_text(place, "title", &scene->title);
    return STATUS_OK;
}

static enum status read_elasticity(const struct place *place, struct scene_material *material)
{
    RETURN_IF_ERROR(place_require(place, "E", "give Young's modulus in Pa, or a table"));
    RETURN_IF_ERROR(place_require(place, "nu", "give Poisson's ratio, or a table"));
    RETURN_IF_ERROR(place_number(place, "E", range_positive, &material->youngs_modulus));
    RETURN_IF_ERROR(place_number(place, "nu", range_any, &material->poisson_ratio));
    double nu = material->poisson_ratio;
    if (nu >= .5) {
        return place_fail(place, "nu",
                          "%g is not below 0.5: nearly incompressible tissue needs nu < 0.5, as 0.49", nu);
    }
    if (nu <= -1) {
        return place_fail(place, "nu", "%g is not above -1", nu);
    }
    return STATUS_OK;
}

static enum status read_model(const struct place *place, struct scene_material *material)
{
    static const char *const models[] = {"neo-hookean", "neo-hookean-log",     "mooney-rivlin",
                                         "ogden",       "st-venant-kirchhoff", NULL};
    int model = SCENE_NEO_HOOKEAN;
    RETURN_IF_ERROR(place_choice(place, "model", models, &model));
    material->model = (enum scene_model)model;
    if (model == SCENE_MOONEY_RIVLIN) {
        RETURN_IF_ERROR(place_require(place, "ratio", "model mooney-rivlin needs C01/C10"));
        RETURN_IF_ERROR(place_number(place, "ratio", range_not_negative, &material->mooney_ratio));
    } else {
        RETURN_IF_ERROR(place_forbid(place, "ratio", "it belongs to model mooney-rivlin"));
    }
    if (model == SCENE_OGDEN) {
        RETURN_IF_ERROR(place_require(place, "alpha", "model ogden needs its exponent"));
        RETURN_IF_ERROR(place_number(place, "alpha", range_any, &material->ogden_alpha));
        if (fpclassify(material->ogden_alpha) == FP_ZERO) {
            return place_fail(place, "alpha", "must not be 0");
        }
    } else {
        RETURN_IF_ERROR(place_forbid(place, "alpha", "it belongs to model ogden"));
    }
    return STATUS_OK;
}

/* Without motion and weight the density has no effect. */
static const double no_matter = 1000.0; /* kg/m3, where it is not given */

static bool is_density_felt(const struct scene *scene)
{
    return scene->analysis == SCENE_DYNAMIC || fabs(scene->gravity[0]) > 0.0 ||
           fabs(scene->gravity[1]) > 0.0 || fabs(scene->gravity[2]) > 0.0;
}

static enum status read_material(const struct place *place, struct scene *scene)
{
    struct scene_material *material = &scene->materials[scene->material_count - 1];
    RETURN_IF_ERROR(place_require(place, "region", "name the regions made of it"));
    RETURN_IF_ERROR(place_names(place, "region", &material->regions));
    RETURN_IF_ERROR(read_model(place, material));
    if (is_density_felt(scene)) {
        RETURN_IF_ERROR(place_require(place, "rho", "give the density in kg/m3"));
    }
    material->density = no_matter;
    RETURN_IF_ERROR(place_number(place, "rho", range_positive, &material->density));
    RETURN_IF_ERROR(place_table(place, "table", &material->table, &material->table_unit));
    if (material->table != NULL) {
        RETURN_IF_ERROR(place_forbid_all(place, KEYS{"E", "nu", NULL}, "the table gives E and nu"));
    } else {
        RETURN_IF_ERROR(read_elasticity(place, material));
    }
    return STATUS_OK;
}

/* Displacements of measured points. */
static enum status read_points(const struct place *place, struct scene_displacement *displacement)
{
    RETURN_IF_ERROR(place_only_keys(place, KEYS{"points", "unit", "reach", "model_error", "curve", NULL}));
    RETURN_IF_ERROR(place_table(place, "points", &displacement->table, &displacement->table_unit));
    RETURN_IF_ERROR(place_number(place, "reach", range_positive, &displacement->reach));
    RETURN_IF_ERROR(place_number(place, "model_error", range_positive, &displacement->model_error));
    RETURN_IF_ERROR(place_curve(place, "curve", &displacement->curve));
    displacement->kind = SCENE_POINTS;
    return STATUS_OK;
}

static enum status read_displacement(const struct place *place, struct scene *scene)
{
    struct scene_displacement *displacement = &scene->displacements[scene->displacement_count - 1];
    RETURN_IF_ERROR(place_require_one(place, KEYS{"facets", "nodes", "points", NULL}));
    if (place_has(place, "points")) {
        return read_points(place, displacement);
    }
    RETURN_IF_ERROR(place_forbid_all(place, KEYS{"reach", "model_error", NULL}, "it goes with points"));
    RETURN_IF_ERROR(place_require_one(place, KEYS{"table", "components", "normal", NULL}));
    RETURN_IF_ERROR(place_names(place, "facets", &displacement->facets));
    RETURN_IF_ERROR(place_names(place, "nodes", &displacement->nodes));
    RETURN_IF_ERROR(place_table(place, "table", &displacement->table, &displacement->table_unit));
    RETURN_IF_ERROR(
        place_vector(place, "components", scene->dim, displacement->components, displacement->is_free));
    RETURN_IF_ERROR(place_number(place, "normal", range_any, &displacement->normal));
    RETURN_IF_ERROR(place_curve(place, "curve", &displacement->curve));
    if (place_has(place, "normal")) {
        RETURN_IF_ERROR(place_forbid(place, "nodes", "only facets have a normal"));
        displacement->kind = SCENE_NORMAL;
    } else if (place_has(place, "components")) {
        displacement->kind = SCENE_COMPONENTS;
    }
    const bool *is_free = displacement->is_free;
    if (is_free[0] && is_free[1] && is_free[scene->dim - 1]) {
        return place_fail(place, "components", "all are free: nothing is prescribed");
    }
    return STATUS_OK;
}

/* The motion of a rigid surface, if it has one. */
static enum status read_motion(const struct place *place, int dim, struct scene_contact *contact)
{
    bool turns = place_has(place, "angle");
    double length2 = 0.0;
    contact->moves = turns || place_has(place, "translation");
    contact->axis[2] = dim == 2 ? 1.0 : 0.0;
    if (!turns) {
        RETURN_IF_ERROR(
            place_forbid_all(place, KEYS{"axis_point", "axis", "angle_curve", NULL}, "no angle is given"));
    }
    if (!contact->moves) {
        RETURN_IF_ERROR(place_forbid(place, "curve", "the surface has neither translation nor angle"));
        return STATUS_OK;
    }
    RETURN_IF_ERROR(place_require(place, "curve",
                                  "a surface that moves needs smooth, linear, or a file of time and factor"));
    if (turns) {
        RETURN_IF_ERROR(place_require(place, "axis_point", "give a point of the axis of rotation in m"));
    }
    if (turns && dim == 3) {
        RETURN_IF_ERROR(place_require(place, "axis", "give the direction of the axis of rotation"));
    }
    if (dim == 2) {
        RETURN_IF_ERROR(place_forbid(place, "axis", "in 2D a surface turns in the plane, about axis_point"));
    }
    RETURN_IF_ERROR(place_vector(place, "translation", dim, contact->translation, NULL));
    RETURN_IF_ERROR(place_number(place, "angle", range_any, &contact->angle));
    RETURN_IF_ERROR(place_vector(place, "axis_point", dim, contact->axis_point, NULL));
    RETURN_IF_ERROR(place_vector(place, "axis", dim, contact->axis, NULL));
    for (int i = 0; i < 3; i++) {
        length2 += contact->axis[i] * contact->axis[i];
    }
    if (turns && !(length2 > 0.0)) {
        return place_fail(place, "axis", "has no length: give a direction, as 0, 0, 1");
    }
    RETURN_IF_ERROR(place_curve(place, "curve", &contact->curve));
    RETURN_IF_ERROR(
        place_curve(place, place_has(place, "angle_curve") ? "angle_curve" : "curve", &contact->angle_curve));
    for (int i = 0; i < 2; i++) {
        if ((i == 0 ? contact->curve : contact->angle_curve).kind == SCENE_CURVE_STEP) {
            return place_fail(place, i == 0 ? "curve" : "angle_curve",
                              "step jumps: a rigid surface moves by smooth, linear, or a file");
        }
    }
    return STATUS_OK;
}

/* Contact with other facets of the body. */
static enum status read_against(const struct place *place, struct scene_contact *contact)
{
    static const char *const rigid[] = {"rigid",      "unit", "side",  "translation", "angle",
                                        "axis_point", "axis", "curve", "angle_curve", NULL};
    RETURN_IF_ERROR(place_forbid_all(place, rigid, "against names facets of the body, not a rigid surface"));
    RETURN_IF_ERROR(place_names(place, "against", &contact->against));
    return place_number(place, "stiffness", range_positive, &contact->stiffness);
}

static enum status read_contact(const struct place *place, struct scene *scene)
{
    static const char *const sides[2][3] = {{"left", "right", NULL}, {"front", "back", NULL}};
    struct scene_contact *contact = &scene->contacts[scene->contact_count - 1];
    int side = 0;
    RETURN_IF_ERROR(place_require(place, "facets", "name the facet groups that may touch"));
    RETURN_IF_ERROR(place_names(place, "facets", &contact->facets));
    if (place_has(place, "against")) {
        return read_against(place, contact);
    }
    RETURN_IF_ERROR(place_require(
        place, "rigid",
        "name the file of the rigid surface, or, of the body itself, facet groups by 'against'"));
    RETURN_IF_ERROR(place_require(place, "side",
                                  scene->dim == 2
                                      ? "left or right of the rigid curve, where the body lies"
                                      : "front or back of the rigid triangles, where the body lies"));
    RETURN_IF_ERROR(place_table(place, "rigid", &contact->rigid, &contact->rigid_unit));
    RETURN_IF_ERROR(place_choice(place, "side", sides[scene->dim - 2], &side));
    RETURN_IF_ERROR(place_number(place, "stiffness", range_positive, &contact->stiffness));
    contact->side = (enum scene_side)(side + 2 * (scene->dim - 2));
    return read_motion(place, scene->dim, contact);
}

/* A pressure that grows with the depth below the level of a fluid. */
static enum status read_fluid(const struct place *place, const struct scene *scene, struct scene_load *load)
{
    static const char *const sides[] = {"below", "above", "both", NULL};
    int side = SCENE_BELOW;
    RETURN_IF_ERROR(place_require(place, "level", "give a place at the level of the fluid, m"));
    RETURN_IF_ERROR(place_number(place, "density", range_positive, &load->density));
    RETURN_IF_ERROR(place_vector(place, "level", scene->dim, load->level, NULL));
    RETURN_IF_ERROR(place_choice(place, "side", sides, &side));
    RETURN_IF_ERROR(place_vector(place, "gravity", scene->dim, load->gravity, NULL));
    load->level_side = (enum scene_level_side)side;
    return STATUS_OK;
}

static enum status read_pressure(const struct place *place, struct scene *scene)
{
    struct scene_load *load = &scene->pressures[scene->pressure_count - 1];
    RETURN_IF_ERROR(place_require(place, "facets", "name the facet groups pressed"));
    RETURN_IF_ERROR(place_require_one(place, KEYS{"value", "density", NULL}));
    RETURN_IF_ERROR(place_names(place, "facets", &load->facets));
    RETURN_IF_ERROR(place_number(place, "value", range_any, &load->pressure));
    if (place_has(place, "density")) {
        RETURN_IF_ERROR(read_fluid(place, scene, load));
    } else {
        RETURN_IF_ERROR(
            place_forbid_all(place, KEYS{"level", "side", "gravity", NULL}, "it goes with density"));
    }
    return place_curve(place, "curve", &load->curve);
}

/* A traction on facets or a force on nodes. */
static enum status read_vector_load(const struct place *place, const char *where, const char *unit, int dim,
                                    struct name_list *groups, struct scene_load *load)
{
    RETURN_IF_ERROR(place_require(place, where, "name the groups loaded"));
    RETURN_IF_ERROR(place_require(place, "components", unit));
    RETURN_IF_ERROR(place_names(place, where, groups));
    RETURN_IF_ERROR(place_vector(place, "components", dim, load->components, NULL));
    return place_curve(place, "curve", &load->curve);
}

static enum status read_traction(const struct place *place, struct scene *scene)
{
    struct scene_load *load = &scene->tractions[scene->traction_count - 1];
    return read_vector_load(place, "facets", "give the traction in Pa", scene->dim, &load->facets, load);
}

static enum status read_force(const struct place *place, struct scene *scene)
{
    struct scene_load *load = &scene->forces[scene->force_count - 1];
    return read_vector_load(place, "nodes", "give the force on each node in N", scene->dim, &load->nodes,
                            load);
}

static enum status read_initial(const struct place *place, struct scene *scene)
{
    if (scene->analysis == SCENE_QUASI_STATIC) {
        return place_fail(place, NULL,
                          "a quasi-static scene has no time: only dynamic scenes begin somewhere");
    }
    RETURN_IF_ERROR(
        place_require(place, "table", "name the file of displacements and velocities at the nodes"));
    return place_table(place, "table", &scene->initial.table, &scene->initial.table_unit);
}

static enum status read_output(const struct place *place, struct scene *scene)
{
    static const char *const folds[] = {"refused", "allowed", NULL};
    struct scene_output *output = &scene->output;
    int allowed = 0;
    RETURN_IF_ERROR(place_count(place, "frames", 1000000, &output->frames));
    RETURN_IF_ERROR(place_number(place, "interval", range_positive, &output->interval));
    if (place_has(place, "frames")) {
        RETURN_IF_ERROR(place_forbid(place, "interval", "frames is given"));
    }
    if (scene->analysis == SCENE_QUASI_STATIC) {
        RETURN_IF_ERROR(place_forbid(place, "interval", "a quasi-static scene has no time: use frames"));
    }
    RETURN_IF_ERROR(place_yes(place, "stress", &output->stress));
    RETURN_IF_ERROR(place_yes(place, "strain", &output->strain));
    RETURN_IF_ERROR(place_yes(place, "pressure", &output->pressure));
    RETURN_IF_ERROR(place_yes(place, "volume_ratio", &output->volume_ratio));
    RETURN_IF_ERROR(place_yes(place, "energy", &output->energy));
    RETURN_IF_ERROR(place_yes(place, "reactions", &output->reactions));
    RETURN_IF_ERROR(place_yes(place, "moments", &output->moments));
    RETURN_IF_ERROR(place_vector(place, "moments_about", scene->dim, output->about, NULL));
    if (!output->moments) {
        RETURN_IF_ERROR(place_forbid(place, "moments_about", "it goes with moments = yes"));
    }
    RETURN_IF_ERROR(place_yes(place, "gaps", &output->gaps));
    RETURN_IF_ERROR(place_choice(place, "folds", folds, &allowed));
    output->folds_allowed = allowed == 1;
    return STATUS_OK;
}

static enum status read_solver(const struct place *place, struct scene *scene)
{
    static const char *const constraints[] = {"ebciem", "direct", NULL};
    static const char *const points[] = {"hat", "node", NULL};
    static const char *const volumes[] = {"nodal", "pointwise", NULL};
    static const int64_t most_steps = (int64_t)1 << 53;
    struct scene_solver *solver = &scene->solver;
    int constraint = (int)solver->constraints;
    int point = (int)solver->constraint_points;
    int volume = (int)solver->volume;
    RETURN_IF_ERROR(place_choice(place, "constraints", constraints, &constraint));
    RETURN_IF_ERROR(place_choice(place, "constraint_points", points, &point));
    RETURN_IF_ERROR(place_choice(place, "volume", volumes, &volume));
    solver->constraints = (enum scene_constraints)constraint;
    solver->constraint_points = (enum scene_constraint_points)point;
    solver->volume = (enum scene_volume)volume;
    if (scene->analysis == SCENE_DYNAMIC) { /* steps are to be accurate, not stable only */
        solver->time_step_margin = 0.75;
    }
    RETURN_IF_ERROR(place_number(place, "time_step_margin", range_open_share, &solver->time_step_margin));
    RETURN_IF_ERROR(place_count(place, "max_steps", most_steps, &solver->max_steps));
    if (scene->analysis == SCENE_DYNAMIC) {
        RETURN_IF_ERROR(place_forbid(place, "ramp_steps", "a dynamic scene has end_time"));
        RETURN_IF_ERROR(place_forbid(place, "tolerance", "a dynamic scene ends at end_time"));
        RETURN_IF_ERROR(place_number(place, "end_time", range_positive, &solver->end_time));
        RETURN_IF_ERROR(place_number(place, "damping", range_not_negative, &solver->damping));
    } else {
        RETURN_IF_ERROR(place_forbid(place, "end_time", "a quasi-static scene has no time"));
        RETURN_IF_ERROR(place_forbid(place, "damping", "a quasi-static scene chooses its own"));
        RETURN_IF_ERROR(place_number(place, "tolerance", range_open_share, &solver->tolerance));
        RETURN_IF_ERROR(place_count(place, "ramp_steps", most_steps, &solver->ramp_steps));
    }
    return STATUS_OK;
}

#define ITEMS(items, count)                                                                                  \
    true, offsetof(struct scene, items), offsetof(struct scene, count), sizeof *((struct scene *)0)->items

/* Every section and key stands here once: others are refused with these lists, and a test looks for each in
 * the manual. */
static const struct scene_kind kinds[] = {
    {"scene", KEYS{"dim", "analysis", "title", "gravity", NULL}, read_scene, false, 0, 0, 0},
    {"material", KEYS{"region", "model", "E", "nu", "rho", "ratio", "alpha", "table", "unit", NULL},
     read_material, ITEMS(materials, material_count)},
    {"displacement",
     KEYS{"facets", "nodes", "points", "table", "unit", "components", "normal", "reach", "model_error",
          "curve", NULL},
     read_displacement, ITEMS(displacements, displacement_count)},
    {"contact",
     KEYS{"facets", "against", "rigid", "unit", "side", "stiffness", "translation", "angle", "axis_point",
          "axis", "curve", "angle_curve", NULL},
     read_contact, ITEMS(contacts, contact_count)},
    {"pressure", KEYS{"facets", "value", "density", "level", "side", "gravity", "curve", NULL}, read_pressure,
     ITEMS(pressures, pressure_count)},
    {"traction", KEYS{"facets", "components", "curve", NULL}, read_traction,
     ITEMS(tractions, traction_count)},
    {"force", KEYS{"nodes", "components", "curve", NULL}, read_force, ITEMS(forces, force_count)},
    {"initial", KEYS{"table", "unit", NULL}, read_initial, false, 0, 0, 0},
    {"output",
     KEYS{"frames", "interval", "stress", "strain", "pressure", "volume_ratio", "energy", "reactions",
          "moments", "moments_about", "gaps", "folds", NULL},
     read_output, false, 0, 0, 0},
    {"solver",
     KEYS{"constraints", "constraint_points", "volume", "tolerance", "max_steps", "ramp_steps", "end_time",
          "time_step_margin", "damping", NULL},
     read_solver, false, 0, 0, 0},
};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

enum status scene_kind_find(const struct place *place, const struct scene_kind **kind)
{
    const char *names[KIND_COUNT + 1] = {NULL};
    for (int k = 0; k < KIND_COUNT; k++) {
        names[k] = kinds[k].name;
        if (strcmp(kinds[k].name, place->section->kind) == 0) {
            *kind = &kinds[k];
            return place_only_keys(place, kinds[k].keys);
        }
    }
    return place_unknown(place, NULL, "section", names);
}
