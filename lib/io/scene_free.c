/* Releasing a scene. */
#include "io/scene.h"

#include <stdlib.h>

static void free_names(struct name_list *list)
{
    for (int64_t i = 0; i < list->count; i++) {
        free(list->names[i]);
    }
    free(list->names);
}

static void free_label(struct scene_label *label)
{
    free(label->name);
    free(label->where);
}

static void free_loads(struct scene_load *loads, int64_t count)
{
    for (int64_t i = 0; i < count; i++) {
        free_label(&loads[i].label);
        free_names(&loads[i].facets);
        free_names(&loads[i].nodes);
        free(loads[i].curve.file);
    }
    free(loads);
}

void scene_free(struct scene *scene)
{
    for (int64_t i = 0; i < scene->material_count; i++) {
        free_label(&scene->materials[i].label);
        free_names(&scene->materials[i].regions);
        free(scene->materials[i].table);
    }
    for (int64_t i = 0; i < scene->displacement_count; i++) {
        struct scene_displacement *displacement = &scene->displacements[i];
        free_label(&displacement->label);
        free_names(&displacement->facets);
        free_names(&displacement->nodes);
        free(displacement->table);
        free(displacement->curve.file);
    }
    for (int64_t i = 0; i < scene->contact_count; i++) {
        free_label(&scene->contacts[i].label);
        free_names(&scene->contacts[i].facets);
        free_names(&scene->contacts[i].against);
        free(scene->contacts[i].rigid);
        free(scene->contacts[i].curve.file);
        free(scene->contacts[i].angle_curve.file);
    }
    free(scene->initial.table);
    free(scene->materials);
    free(scene->displacements);
    free(scene->contacts);
    free_loads(scene->pressures, scene->pressure_count);
    free_loads(scene->tractions, scene->traction_count);
    free_loads(scene->forces, scene->force_count);
    free(scene->path);
    free(scene->title);
    *scene = (struct scene){0};
}
