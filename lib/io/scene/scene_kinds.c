#include "io/scene/scene_private.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#define KEYS (const char *const[])

/* text[size] = "a, b, c" from a NULL-terminated list. */
static void join(const char *const words[], char *text, size_t size)
{
    text[0] = '\0';
    for (int i = 0; words[i] != NULL; i++) {
        text_append(text, size, "%s%s", i > 0 ? ", " : "", words[i]);
    }
}

/* STATUS_INPUT unless exactly one of the keys is present. */
static enum status require_one(const struct place *place, const char *const keys[])
{
    int count = 0;
    for (int i = 0; keys[i] != NULL; i++) {
        count += place_has(place, keys[i]);
    }
    char list[256];
    join(keys, list, sizeof list);
    return count == 1
               ? STATUS_OK
               : place_fail(place, NULL, "%s of %s: give exactly one", count == 0 ? "none" : "several", list);
}

/* ---- checks of the keys of a section together, after all have been read ---- */

static enum status check_displacement(const struct place *place, struct scene *scene)
{
    struct scene_displacement *displacement = &scene->displacements[scene->displacement_count - 1];
    const bool *is_free = displacement->condition.is_free;
    RETURN_IF_ERROR(require_one(place, KEYS{"facets", "nodes", "points", NULL}));
    if (place_has(place, "points")) {
        displacement->condition.kind = CONDITION_POINTS;
        return STATUS_OK;
    }
    RETURN_IF_ERROR(require_one(place, KEYS{"table", "components", "normal", NULL}));
    displacement->condition.kind = place_has(place, "normal")  ? CONDITION_NORMAL
                                   : place_has(place, "table") ? CONDITION_TABLE
                                                               : displacement->condition.kind;
    return is_free[0] && is_free[1] && is_free[scene->dim - 1]
               ? place_fail(place, "components", "all are free: nothing is prescribed")
               : STATUS_OK;
}

static enum status check_contact(const struct place *place, struct scene *scene)
{
    struct scene_contact *contact = &scene->contacts[scene->contact_count - 1];
    struct rigid_motion *motion = &contact->condition.motion;
    double *axis = motion->axis;
    bool turns = place_has(place, "angle"), space = scene->dim == 3;
    if (place_has(place, "against")) {
        return place_forbid(place, "rigid", "against names facets of the body, not a rigid surface");
    }
    RETURN_IF_ERROR(place_require(
        place, "rigid",
        "name the file of the rigid surface, or, of the body itself, facet groups by 'against'"));
    RETURN_IF_ERROR(place_require(place, "side",
                                  space ? "front or back of the rigid triangles, where the body lies"
                                        : "left or right of the rigid curve, where the body lies"));
    if ((contact->side == SCENE_FRONT || contact->side == SCENE_BACK) != space) {
        return place_fail(place, "side", "is none of %s", space ? "front, back" : "left, right");
    }
    motion->moves = turns || place_has(place, "translation");
    motion->angle *= M_PI / 180.0;
    if (motion->moves) {
        RETURN_IF_ERROR(place_require(
            place, "curve", "a surface that moves needs smooth, linear, or a file of time and factor"));
    }
    if (turns) {
        RETURN_IF_ERROR(place_require(place, "axis_point", "give a point of the axis of rotation in m"));
    }
    if (!space) {
        RETURN_IF_ERROR(place_forbid(place, "axis", "in 2D a surface turns in the plane, about axis_point"));
    } else if (turns) {
        RETURN_IF_ERROR(place_require(place, "axis", "give the direction of the axis of rotation"));
    }
    if (!space || !turns) {
        axis[2] = 1.0;
    }
    if (!(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] > 0.0)) {
        return place_fail(place, "axis", "has no length: give a direction, as 0, 0, 1");
    }
    if (!place_has(place, "angle_curve")) {
        contact->angle_curve = contact->curve;
    }
    for (int i = 0; i < 2 && motion->moves; i++) {
        if ((i == 0 ? contact->curve : contact->angle_curve).kind == CURVE_STEP) {
            return place_fail(place, i == 0 ? "curve" : "angle_curve",
                              "step jumps: a rigid surface moves by smooth, linear, or a file");
        }
    }
    return STATUS_OK;
}

/* The kind of a load, by its section; a pressure is a value, or that of a fluid, which grows with the depth
 * below its level. */
static enum status check_load(const struct place *place, struct scene *scene)
{
    static const char *const names[] = {
        [LOAD_PRESSURE] = "pressure", [LOAD_TRACTION] = "traction", [LOAD_FORCE] = "force"};
    struct load *load = &scene->loads[scene->load_count - 1].load;
    while (strcmp(names[load->kind], place->section->kind) != 0) {
        load->kind++;
    }
    if (load->kind == LOAD_PRESSURE) {
        RETURN_IF_ERROR(require_one(place, KEYS{"value", "density", NULL}));
    }
    return place_has(place, "density")
               ? place_require(place, "level", "give a place at the level of the fluid, m")
               : STATUS_OK;
}

static enum status check_support(const struct place *place, struct scene *scene)
{
    const struct support_condition *support = &scene->supports[scene->support_count - 1].condition;
    return support->normal > 0.0 || support->tangential > 0.0 || support->damping > 0.0
               ? STATUS_OK
               : place_fail(place, NULL, "normal and tangential: both are 0: give a stiffness in Pa/m");
}

static enum status check_membrane(const struct place *place, struct scene *scene)
{
    double nu = scene->membranes[scene->membrane_count - 1].condition.law.poisson_ratio;
    return nu > -1.0 && nu <= .5 ? STATUS_OK
                                 : place_fail(place, "nu", "%.15g is not above -1 and at most 0.5", nu);
}

static enum status check_output(const struct place *place, struct scene *scene)
{
    (void)scene;
    return place_has(place, "frames") ? place_forbid(place, "interval", "frames is given") : STATUS_OK;
}

static enum status check_solver(const struct place *place, struct scene *scene)
{
    static const char why[] = "it goes with method = relaxation: Newton's method chooses its increments";
    if (scene->duration > 0.0 && scene->solver.method != SCENE_NEWTON) {
        return place_fail(place, "method", "a scene with duration takes newton");
    }
    return scene->analysis == SCENE_QUASI_STATIC && scene->solver.method == SCENE_NEWTON
               ? place_forbid_all(place, KEYS{"ramp_steps", "time_step_margin", NULL}, why)
               : STATUS_OK;
}

/* ---- every section and key, once: others are refused by these lists, and a test looks for each in the
 * manual
 * ---- */

#define WORDS(...)                                                                                           \
    .words = (const char *const[])                                                                           \
    {                                                                                                        \
        __VA_ARGS__, NULL                                                                                    \
    }
#define AT(owner, member) .at = offsetof(struct owner, member)
#define MOST_STEPS ((int64_t)1 << 53)

static const struct scene_key scene_keys[] = {
    {"dim", VALUE_DIM, AT(scene, dim), .missing = "give 2 or 3"},
    {"analysis", VALUE_CHOICE, AT(scene, analysis), .missing = "give quasi-static or dynamic",
     WORDS("quasi-static", "dynamic")},
    {"duration", VALUE_POSITIVE, AT(scene, duration), .not_dynamic = "a dynamic scene has end_time"},
    {"title", VALUE_TEXT, AT(scene, title)},
    {"gravity", VALUE_VECTOR, AT(scene, gravity)},
    {NULL}};

static const struct scene_key material_keys[] = {
    {"region", VALUE_NAMES, AT(scene_material, regions), .missing = "name the regions made of it"},
    {"model", VALUE_TEXT, AT(scene_material, model)},
    {"E", VALUE_POSITIVE, AT(scene_material, youngs_modulus)},
    {"nu", VALUE_NUMBER, AT(scene_material, poisson_ratio)},
    {"kappa", VALUE_POSITIVE, AT(scene_material, bulk_modulus)},
    {"D", VALUE_POSITIVE, AT(scene_material, compressibility)},
    {"rho", VALUE_POSITIVE, AT(scene_material, material.density)},
    {"fibre", VALUE_VECTOR, AT(scene_material, fibre)},
    {"active", VALUE_NOT_NEGATIVE, AT(scene_material, material.active)},
    {"curve", VALUE_CURVE, AT(scene_material, curve), .with = {"active"}},
    {"prony", VALUE_PRONY, AT(scene_material, prony)},
    {"fibres", VALUE_TABLE, AT(scene_material, fibres)},
    {"fibre_plane", VALUE_VECTOR, AT(scene_material, fibre_plane)},
    {"table", VALUE_TABLE, AT(scene_material, table)},
    {"unit", VALUE_UNIT, AT(scene_material, table_unit)},
    {NULL}};

static const struct scene_key displacement_keys[] = {
    {"facets", VALUE_NAMES, AT(scene_displacement, facets)},
    {"nodes", VALUE_NAMES, AT(scene_displacement, nodes)},
    {"points", VALUE_TABLE, AT(scene_displacement, condition.table)},
    {"moved", VALUE_TABLE, AT(scene_displacement, moved), .with = {"points"}},
    {"table", VALUE_TABLE, AT(scene_displacement, condition.table), .with = {"facets", "nodes"}},
    {"unit", VALUE_UNIT, AT(scene_displacement, condition.unit)},
    {"components", VALUE_VECTOR, AT(scene_displacement, condition.components),
     .free = offsetof(struct scene_displacement, condition.is_free), .with = {"facets", "nodes"}},
    {"normal", VALUE_NUMBER, AT(scene_displacement, condition.normal), .with = {"facets"}},
    {"reach", VALUE_POSITIVE, AT(scene_displacement, reach), .with = {"points"}},
    {"model_error", VALUE_POSITIVE, AT(scene_displacement, condition.model_error), .with = {"points"}},
    {"curve", VALUE_CURVE, AT(scene_displacement, curve)},
    {NULL}};

static const struct scene_key contact_keys[] = {
    {"facets", VALUE_NAMES, AT(scene_contact, facets), .missing = "name the facet groups that may touch"},
    {"against", VALUE_NAMES, AT(scene_contact, against)},
    {"rigid", VALUE_TABLE, AT(scene_contact, rigid)},
    {"unit", VALUE_UNIT, AT(scene_contact, rigid_unit)},
    {"side", VALUE_CHOICE, AT(scene_contact, side), WORDS("left", "right", "front", "back"),
     .with = {"rigid"}},
    {"stiffness", VALUE_POSITIVE, AT(scene_contact, condition.stiffness)},
    {"friction", VALUE_NOT_NEGATIVE, AT(scene_contact, condition.friction)},
    {"translation", VALUE_VECTOR, AT(scene_contact, condition.motion.translation), .with = {"rigid"}},
    {"angle", VALUE_NUMBER, AT(scene_contact, condition.motion.angle), .with = {"rigid"}},
    {"axis_point", VALUE_VECTOR, AT(scene_contact, condition.motion.point), .with = {"angle"}},
    {"axis", VALUE_VECTOR, AT(scene_contact, condition.motion.axis), .with = {"angle"}},
    {"curve", VALUE_CURVE, AT(scene_contact, curve), .with = {"translation", "angle"}},
    {"angle_curve", VALUE_CURVE, AT(scene_contact, angle_curve), .with = {"angle"}},
    {NULL}};

static const struct scene_key pressure_keys[] = {
    {"facets", VALUE_NAMES, AT(scene_load, facets), .missing = "name the facet groups pressed"},
    {"value", VALUE_NUMBER, AT(scene_load, load.pressure)},
    {"density", VALUE_POSITIVE, AT(scene_load, density)},
    {"level", VALUE_VECTOR, AT(scene_load, load.level), .with = {"density"}},
    {"side", VALUE_CHOICE, AT(scene_load, load.part), WORDS("below", "above", "both"), .with = {"density"}},
    {"gravity", VALUE_VECTOR, AT(scene_load, gravity), .with = {"density"}},
    {"curve", VALUE_CURVE, AT(scene_load, curve)},
    {NULL}};

static const struct scene_key traction_keys[] = {
    {"facets", VALUE_NAMES, AT(scene_load, facets), .missing = "name the groups loaded"},
    {"components", VALUE_VECTOR, AT(scene_load, load.components), .missing = "give the traction in Pa"},
    {"curve", VALUE_CURVE, AT(scene_load, curve)},
    {NULL}};

static const struct scene_key force_keys[] = {
    {"nodes", VALUE_NAMES, AT(scene_load, nodes), .missing = "name the groups loaded"},
    {"components", VALUE_VECTOR, AT(scene_load, load.components),
     .missing = "give the force on each node in N"},
    {"curve", VALUE_CURVE, AT(scene_load, curve)},
    {NULL}};

static const struct scene_key support_keys[] = {
    {"facets", VALUE_NAMES, AT(scene_support, facets), .missing = "name the facet groups supported"},
    {"normal", VALUE_NOT_NEGATIVE, AT(scene_support, condition.normal)},
    {"tangential", VALUE_NOT_NEGATIVE, AT(scene_support, condition.tangential)},
    {"damping", VALUE_NOT_NEGATIVE, AT(scene_support, condition.damping),
     .not_static = "a quasi-static scene has no velocities"},
    {NULL}};

static const struct scene_key membrane_keys[] = {
    {"facets", VALUE_NAMES, AT(scene_membrane, facets), .missing = "name the facet groups coated"},
    {"thickness", VALUE_POSITIVE, AT(scene_membrane, condition.law.thickness), .missing = "give it in m"},
    {"E", VALUE_POSITIVE, AT(scene_membrane, condition.law.youngs_modulus),
     .missing = "give Young's modulus in Pa"},
    {"nu", VALUE_NUMBER, AT(scene_membrane, condition.law.poisson_ratio), .missing = "give Poisson's ratio"},
    {"prestress", VALUE_NOT_NEGATIVE, AT(scene_membrane, condition.law.prestress)},
    {"curve", VALUE_CURVE, AT(scene_membrane, curve), .with = {"prestress"}},
    {NULL}};

static const struct scene_key initial_keys[] = {
    {"table", VALUE_TABLE, AT(scene, initial.table),
     .not_static = "a quasi-static scene has no time: only dynamic scenes begin somewhere",
     .missing = "name the file of displacements and velocities at the nodes"},
    {"unit", VALUE_UNIT, AT(scene, initial.table_unit)},
    {NULL}};

static const struct scene_key output_keys[] = {
    {"frames", VALUE_COUNT, AT(scene, output.frames), .most = 1000000},
    {"interval", VALUE_POSITIVE, AT(scene, output.interval),
     .not_static = "a quasi-static scene has no time: use frames"},
    {"stress", VALUE_YES, AT(scene, output.stress)},
    {"strain", VALUE_YES, AT(scene, output.strain)},
    {"pressure", VALUE_YES, AT(scene, output.pressure)},
    {"volume_ratio", VALUE_YES, AT(scene, output.volume_ratio)},
    {"fibre", VALUE_YES, AT(scene, output.fibre)},
    {"energy", VALUE_YES, AT(scene, output.energy)},
    {"reactions", VALUE_YES, AT(scene, output.reactions)},
    {"moments", VALUE_YES, AT(scene, output.moments)},
    {"moments_about", VALUE_VECTOR, AT(scene, output.about), .with = {"moments"}},
    {"gaps", VALUE_YES, AT(scene, output.gaps)},
    {"folds", VALUE_YES, AT(scene, output.folds_allowed), WORDS("refused", "allowed")},
    {NULL}};

static const struct scene_key solver_keys[] = {
    {"method", VALUE_CHOICE, AT(scene, solver.method), WORDS("newton", "relaxation"),
     .not_dynamic = "a dynamic scene is stepped in time"},
    {"constraints", VALUE_YES, AT(scene, solver.direct), WORDS("ebciem", "direct")},
    {"constraint_points", VALUE_YES, AT(scene, solver.node_values), WORDS("hat", "node")},
    {"volume", VALUE_YES, AT(scene, solver.pointwise_volume), WORDS("nodal", "pointwise")},
    {"tolerance", VALUE_SHARE, AT(scene, solver.tolerance),
     .not_dynamic = "a dynamic scene ends at end_time"},
    {"max_steps", VALUE_COUNT, AT(scene, solver.max_steps), .most = MOST_STEPS},
    {"ramp_steps", VALUE_COUNT, AT(scene, solver.ramp_steps), .most = MOST_STEPS,
     .not_dynamic = "a dynamic scene has end_time"},
    {"time_steps", VALUE_COUNT, AT(scene, solver.time_steps), .most = 1000000,
     .not_dynamic = "a dynamic scene chooses its own (time_step_margin)"},
    {"end_time", VALUE_POSITIVE, AT(scene, solver.end_time),
     .not_static = "a quasi-static scene has duration, in [scene]"},
    {"time_step_margin", VALUE_SHARE, AT(scene, solver.time_step_margin)},
    {"damping", VALUE_NOT_NEGATIVE, AT(scene, solver.damping),
     .not_static = "a quasi-static scene chooses its own"},
    {NULL}};

#define ITEMS(items, count)                                                                                  \
    true, offsetof(struct scene, items), offsetof(struct scene, count), sizeof *((struct scene *)0)->items

static const struct scene_kind kinds[] = {
    {"scene", scene_keys, NULL, false, 0, 0, 0},
    {"material", material_keys, scene_material_check, ITEMS(materials, material_count)},
    {"displacement", displacement_keys, check_displacement, ITEMS(displacements, displacement_count)},
    {"contact", contact_keys, check_contact, ITEMS(contacts, contact_count)},
    {"support", support_keys, check_support, ITEMS(supports, support_count)},
    {"membrane", membrane_keys, check_membrane, ITEMS(membranes, membrane_count)},
    {"pressure", pressure_keys, check_load, ITEMS(loads, load_count)},
    {"traction", traction_keys, check_load, ITEMS(loads, load_count)},
    {"force", force_keys, check_load, ITEMS(loads, load_count)},
    {"initial", initial_keys, NULL, false, 0, 0, 0},
    {"output", output_keys, check_output, false, 0, 0, 0},
    {"solver", solver_keys, check_solver, false, 0, 0, 0},
};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0], MOST_KEYS = 64 };

enum status scene_kind_find(const struct place *place, const struct scene_kind **kind)
{
    const char *keys[MOST_KEYS] = {NULL};
    char list[320];
    const struct ini_section *section = place->section;
    int k = 0, count = 0;
    for (; k < KIND_COUNT && strcmp(kinds[k].name, section->kind) != 0; k++) {
        keys[k] = kinds[k].name;
    }
    if (k == KIND_COUNT) {
        join(keys, list, sizeof list);
        return place_fail(place, NULL, "unknown section: allowed are %s", list);
    }
    *kind = &kinds[k];
    for (; kinds[k].keys[count].name != NULL; count++) {
        keys[count] = kinds[k].keys[count].name;
    }
    keys[count] = NULL;
    if (kinds[k].keys == material_keys) {
        scene_material_list_keys(keys, count, MOST_KEYS - 1);
    }
    join(keys, list, sizeof list);
    for (int64_t e = 0; e < section->entry_count; e++) {
        int i = 0;
        while (keys[i] != NULL && strcmp(keys[i], section->entries[e].key) != 0) {
            i++;
        }
        if (keys[i] == NULL) {
            return place_fail(place, section->entries[e].key, "unknown key: allowed are %s", list);
        }
    }
    return STATUS_OK;
}
