/* The section [material NAME]: its law, the parameters of this, and the moduli at rest. */
#include "io/scene/scene_private.h"

#include <math.h>
#include <string.h>

void scene_material_list_keys(const char **keys, int count, int most)
{
    for (int l = 0; l < law_count; l++) {
        for (const struct law_key *key = material_laws[l]->keys; key->name != NULL && count < most; key++) {
            int at = 0;
            while (at < count && strcmp(keys[at], key->name) != 0) {
                at++;
            }
            keys[at] = key->name;
            count += at == count;
        }
    }
}

static bool law_has(const struct law *law, const char *name)
{
    const struct law_key *key = law->keys;
    while (key->name != NULL && strcmp(key->name, name) != 0) {
        key++;
    }
    return key->name != NULL;
}

static enum status check_foreign(const struct place *place, const struct law *law)
{
    for (int l = 0; l < law_count; l++) {
        for (const struct law_key *key = material_laws[l]->keys; key->name != NULL; key++) {
            if (place_has(place, key->name) && !law_has(law, key->name)) {
                return place_fail(place, key->name, "not allowed: it belongs to model %s, not to %s",
                                  material_laws[l]->name, law->name);
            }
        }
    }
    return STATUS_OK;
}

static enum status find_law(const struct place *place, struct scene_material *section)
{
    char list[256] = "";
    section->material.model = section->model != NULL ? law_find(section->model) : 0;
    for (int l = 0; l < law_count; l++) {
        text_append(list, sizeof list, "%s%s", l > 0 ? ", " : "", material_laws[l]->name);
    }
    return section->material.model >= 0
               ? STATUS_OK
               : place_fail(place, "model", "'%s' is none of %s", section->model, list);
}

/* Whether the stiffness comes from E or a table: where one is given, or the law allows it and none of the
 * keys that take its place is given. */
static bool is_by_e(const struct place *place, const struct law *law)
{
    bool others = !law->by_e;
    for (const struct law_key *key = law->keys; key->name != NULL; key++) {
        others = others || (key->form == LAW_WITHOUT_E && place_has(place, key->name));
    }
    return !others || place_has(place, "E") || place_has(place, "table");
}

/* Read the numbers of the law's keys, and refuse those that E, or its absence, excludes. */
static enum status read_numbers(const struct place *place, const struct law *law, struct law_input *input)
{
    double *number = input->number;
    for (int k = 0; law->keys[k].name != NULL; k++) {
        const struct law_key *key = &law->keys[k];
        if (key->form == (input->by_e ? LAW_WITHOUT_E : LAW_WITH_E)) {
            RETURN_IF_ERROR(place_forbid(
                place, key->name, input->by_e ? "the stiffness is given by E or a table" : "it goes with E"));
        } else if (place_has(place, key->name)) {
            RETURN_IF_ERROR(place_numbers(place, key, number, &input->given[k]));
        } else if (key->remedy != NULL) {
            return place_require(place, key->name, key->remedy);
        }
        number += key->count;
    }
    return STATUS_OK;
}

/* kappa from the one of nu, kappa and D that is given. */
static enum status set_bulk(const struct place *place, struct scene_material *section)
{
    static const char *const keys[] = {"nu", "kappa", "D", NULL};
    struct material *material = &section->material;
    double nu = section->poisson_ratio, shear = material->shear_modulus;
    const char *given = NULL;
    for (int i = 0; keys[i] != NULL; i++) {
        if (given != NULL && place_has(place, keys[i])) {
            return place_fail(place, keys[i], "not allowed: %s gives the volume: give one of nu, kappa, D",
                              given);
        }
        given = place_has(place, keys[i]) ? keys[i] : given;
    }
    if (given == NULL) {
        return place_require(place, "nu", "give Poisson's ratio, or kappa in Pa, or D = 2 / kappa");
    }
    if (nu >= .5) {
        return place_fail(place, "nu",
                          "%.15g is not below 0.5: nearly incompressible tissue needs nu < 0.5, as 0.49", nu);
    }
    if (nu <= -1) {
        return place_fail(place, "nu", "%.15g is not above -1", nu);
    }
    material->bulk_modulus = given == keys[0]   ? 2.0 / 3.0 * shear * (1.0 + nu) / (1.0 - 2.0 * nu)
                             : given == keys[1] ? section->bulk_modulus
                                                : 2.0 / section->compressibility;
    return STATUS_OK;
}

/* mu and kappa from E and one of nu, kappa and D. */
static enum status set_by_e(const struct place *place, struct scene_material *section)
{
    double E = section->youngs_modulus;
    RETURN_IF_ERROR(place_require(place, "E", "give Young's modulus in Pa, or a table"));
    RETURN_IF_ERROR(set_bulk(place, section));
    if (place_has(place, "nu")) {
        material_set_moduli(&section->material, E, section->poisson_ratio);
        return STATUS_OK;
    }
    double ratio = E / section->material.bulk_modulus;
    section->material.shear_modulus = 3.0 * E / (9.0 - ratio);
    return ratio < 9.0 ? STATUS_OK : place_fail(place, "E", "is not below 9 kappa");
}

static enum status set_moduli(const struct place *place, double shear, struct scene_material *section)
{
    struct material *material = &section->material;
    material->shear_modulus = shear;
    RETURN_IF_ERROR(shear > 0.0 ? set_bulk(place, section) : set_by_e(place, section));
    bool good = material->shear_modulus > 0.0 && material_wave_modulus(material) < INFINITY;
    for (int i = 0; i < LAW_NUMBERS; i++) {
        good = good && isfinite(section->parameters[i]);
    }
    return good ? STATUS_OK
                : place_fail(place, NULL, "the moduli are too small or too large for floating-point numbers");
}

static enum status set_law(const struct place *place, struct scene_material *section)
{
    const struct law *law = material_laws[section->material.model];
    struct law_input input = {.by_e = is_by_e(place, law)};
    struct law_fault fault;
    if (!law->by_e) {
        RETURN_IF_ERROR(place_forbid(place, "E", "the law has its own moduli"));
        RETURN_IF_ERROR(place_forbid(place, "table", "the law has its own moduli"));
    }
    RETURN_IF_ERROR(read_numbers(place, law, &input));
    double shear = law_prepare(law, &input, section->parameters, &fault);
    if (shear < 0.0) {
        return place_fail(place, fault.key, "%s", fault.what);
    }
    return section->table != NULL ? STATUS_OK : set_moduli(place, shear, section);
}

/* The directions of the fibres, where the law has some: for the region, in a table, or of the stream. */
static enum status set_fibres(const struct place *place, const struct law *law, int dim,
                              struct scene_material *section)
{
    bool given = place_has(place, "fibre_plane");
    const double *fibre = section->fibre, *plane = section->fibre_plane;
    if (place_has(place, "fibres")) {
        RETURN_IF_ERROR(place_forbid(place, "fibre", "the table fibres gives the directions"));
    } else if (place_has(place, "fibre") && !fibre_frame(dim, fibre, NULL, section->directions)) {
        return place_fail(place, "fibre", "has no length: give a direction, as 1, 0, 0");
    }
    bool by_point = !place_has(place, "fibre");
    section->fibres_of_stream = by_point && section->fibres == NULL;
    if (dim == 2 || law->plane == NULL) {
        return place_forbid(place, "fibre_plane",
                            dim == 2 ? "in 2D it is the plane of the body"
                                     : "the law has one family of fibres");
    }
    if (!given && place_has(place, law->plane)) {
        return place_require(place, "fibre_plane",
                             "give a direction that spans the plane of both families with fibre");
    }
    bool good =
        !given || fibre_frame(dim, by_point ? plane : fibre, by_point ? NULL : plane, section->directions);
    return good ? STATUS_OK : place_fail(place, "fibre_plane", "has no direction other than fibre");
}

enum status scene_material_check(const struct place *place, struct scene *scene)
{
    static const char *const moduli[] = {"E", "nu", "kappa", "D", NULL}, *const fibres[] = {"fibre", "fibres",
                                                                                            "fibre_plane",
                                                                                            NULL};
    const double *gravity = scene->gravity;
    struct scene_material *section = &scene->materials[scene->material_count - 1];
    RETURN_IF_ERROR(find_law(place, section));
    RETURN_IF_ERROR(check_foreign(place, material_laws[section->material.model]));
    /* Without motion and weight the density has no effect, and need not be given. */
    if (scene->analysis == SCENE_DYNAMIC || fabs(gravity[0]) + fabs(gravity[1]) + fabs(gravity[2]) > 0.0) {
        RETURN_IF_ERROR(place_require(place, "rho", "give the density in kg/m3"));
    }
    if (!place_has(place, "rho")) {
        section->material.density = 1.0;
    }
    const struct law *law = material_laws[section->material.model];
    if (scene->analysis == SCENE_QUASI_STATIC && section->prony.terms > 0 && !(scene->duration > 0.0)) {
        return place_fail(place, "prony", "the scene has no time: give duration in [scene], s");
    }
    RETURN_IF_ERROR(
        law->has_fibres || place_has(place, "active")
            ? set_fibres(place, law, scene->dim, section)
            : place_forbid_all(place, fibres, "the law has no fibres, and no active stress is given"));
    if (section->table != NULL) {
        RETURN_IF_ERROR(place_forbid_all(place, moduli, "the table gives E and nu"));
    }
    return set_law(place, section);
}
