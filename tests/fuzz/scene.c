/* Fuzz target: the reader of scenes. What is accepted keeps the promises of struct scene. */
#include "fuzz.h"

#include "io/scene/scene.h"

#include <math.h>

static void require_names(const struct name_list *list)
{
    for (int64_t i = 0; i < list->count; i++) {
        REQUIRE(list->names[i][0] != '\0');
    }
}

static void require_loads(const struct scene_load *loads, int64_t count)
{
    for (int64_t i = 0; i < count; i++) {
        require_names(&loads[i].facets);
        require_names(&loads[i].nodes);
        REQUIRE(loads[i].facets.count + loads[i].nodes.count > 0);
        REQUIRE(isfinite(loads[i].load.pressure));
        for (int k = 0; k < 3; k++) {
            REQUIRE(isfinite(loads[i].load.components[k]));
        }
        REQUIRE((loads[i].curve.file != NULL) == (loads[i].curve.kind == CURVE_TABLE));
    }
}

static void require_materials(const struct scene *scene)
{
    REQUIRE(scene->material_count >= 1);
    for (int64_t i = 0; i < scene->material_count; i++) {
        const struct scene_material *material = &scene->materials[i];
        require_names(&material->regions);
        REQUIRE(material->regions.count >= 1);
        const struct material *law = &material->material;
        REQUIRE(law->model >= 0 && law->model < law_count);
        for (int k = 0; k < LAW_NUMBERS; k++) {
            REQUIRE(isfinite(material->parameters[k]) && isfinite(material->directions[k % 6]));
        }
        REQUIRE(law->density > 0.0 && law->density < INFINITY);
        REQUIRE(material->table != NULL || (law->shear_modulus > 0.0 && law->shear_modulus < INFINITY &&
                                            law->bulk_modulus > 0.0 && law->bulk_modulus < INFINITY));
    }
}

static void require_scene(const struct scene *scene)
{
    REQUIRE(scene->dim == 2 || scene->dim == 3);
    require_materials(scene);
    for (int64_t i = 0; i < scene->displacement_count; i++) {
        const struct scene_displacement *displacement = &scene->displacements[i];
        require_names(&displacement->facets);
        require_names(&displacement->nodes);
        REQUIRE((displacement->facets.count > 0) != (displacement->nodes.count > 0));
        REQUIRE((displacement->condition.kind == CONDITION_TABLE) == (displacement->condition.table != NULL));
        REQUIRE(isfinite(displacement->condition.normal));
    }
    for (int64_t i = 0; i < scene->contact_count; i++) {
        require_names(&scene->contacts[i].facets);
        require_names(&scene->contacts[i].against);
        REQUIRE((scene->contacts[i].against.count > 0) == (scene->contacts[i].rigid == NULL));
        if (scene->contacts[i].rigid != NULL) {
            REQUIRE(scene->contacts[i].rigid_unit > 0.0);
            REQUIRE((scene->contacts[i].side <= SCENE_RIGHT) == (scene->dim == 2));
        }
    }
    require_loads(scene->loads, scene->load_count);
    REQUIRE(scene->solver.time_step_margin > 0.0 && scene->solver.tolerance > 0.0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct scene scene;
    struct error error = {""};
    char path[32];
    int file = file_of_bytes(data, size, path);
    if (is_accepted(scene_read(path, &scene, &error), &error)) {
        require_scene(&scene);
    }
    scene_free(&scene);
    close(file);
    return 0;
}
