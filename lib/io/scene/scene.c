#include "io/scene/scene.h"

#include "base/memory.h"
#include "io/scene/scene_ini.h"
#include "io/scene/scene_private.h"

#include <string.h>

/* Steps of a quasi-static scene: of time, without prony; without duration, with friction, of the load. */
static const int64_t usual_time_steps = 50, usual_increments = 20;

/* Append *added, zero except for its label. */
static enum status add_item(const struct place *place, const struct scene_kind *kind, struct scene *scene,
                            void **added)
{
    /* The arrays have different types: pointers and items are copied as bytes. */
    int64_t *count = (int64_t *)(void *)((char *)scene + kind->count);
    char *place_of_items = (char *)scene + kind->items;
    void *items;
    memcpy(&items, place_of_items, sizeof items);
    items = array_grow(items, *count + 1, kind->item_size);
    if (items == NULL) {
        return fail_memory(place->error, scene->path);
    }
    memcpy(place_of_items, &items, sizeof items);
    char *item = (char *)items + (size_t)*count * kind->item_size;
    memset(item, 0, kind->item_size);
    ++*count;
    const struct ini_section *section = place->section;
    char *where;
    RETURN_IF_ERROR(place_print(place, &where, "%s:%jd: [%s %s]", scene->path, section->line, section->kind,
                                section->name));
    const struct scene_label label = {.name = section->name, .where = where};
    memcpy(item, &label, sizeof label);
    *added = item;
    return STATUS_OK;
}

static enum status read_section(const struct place *place, struct scene *scene)
{
    const struct ini_section *section = place->section;
    const struct scene_kind *kind;
    RETURN_IF_ERROR(scene_kind_find(place, &kind));
    if (kind->has_items && section->name[0] == '\0') {
        return place_fail(place, NULL, "lacks its name: write [%s NAME]", section->kind);
    }
    if (!kind->has_items && section->name[0] != '\0') {
        return place_fail(place, NULL, "takes no name: write [%s]", section->kind);
    }
    void *values = scene; /* set from the keys */
    if (kind->has_items) {
        RETURN_IF_ERROR(add_item(place, kind, scene, &values));
    }
    for (const struct scene_key *key = kind->keys; key->name != NULL; key++) {
        RETURN_IF_ERROR(place_read(place, key, scene->dim, values));
    }
    RETURN_IF_ERROR(kind->check != NULL ? kind->check(place, scene) : STATUS_OK);
    return place_check_units(place, kind->keys);
}

/* Read [scene] first: the other sections depend on its dimension and analysis. */
static enum status read_sections(const struct ini_file *file, struct scene *scene, struct error *error)
{
    for (int round = 0; round < 2; round++) {
        for (int64_t s = 0; s < file->section_count; s++) {
            struct place place = {
                .file = file, .section = &file->sections[s], .scene = scene, .error = error};
            if ((strcmp(place.section->kind, "scene") == 0) == (round == 0)) {
                RETURN_IF_ERROR(read_section(&place, scene));
            }
        }
        if (scene->dim == 0) {
            return fail(error, STATUS_INPUT, "%s: no section [scene]: begin with [scene], dim and analysis",
                        file->path);
        }
    }
    return STATUS_OK;
}

static enum status check_regions(const struct scene *scene, struct error *error)
{
    for (int64_t m = 0; m < scene->material_count; m++) {
        const struct scene_material *material = &scene->materials[m];
        for (int64_t other = 0; other < m; other++) {
            const struct name_list *regions = &scene->materials[other].regions;
            for (int64_t r = 0; r < material->regions.count * regions->count; r++) {
                const char *region = material->regions.names[r / regions->count];
                if (strcmp(region, regions->names[r % regions->count]) == 0) {
                    return fail(error, STATUS_INPUT, "%s: region: '%s' is of material %s already",
                                material->label.where, region, scene->materials[other].label.name);
                }
            }
        }
    }
    return STATUS_OK;
}

static bool has_prony(const struct scene *scene)
{
    int terms = 0;
    for (int64_t m = 0; m < scene->material_count; m++) {
        terms += scene->materials[m].prony.terms;
    }
    return terms > 0;
}

static const struct scene_contact *first_friction(const struct scene *scene)
{
    for (int64_t c = 0; c < scene->contact_count; c++) {
        if (scene->contacts[c].condition.friction > 0.0) {
            return &scene->contacts[c];
        }
    }
    return NULL;
}

/* The state of a body with memory depends on the way there, which is taken in steps. */
static enum status check_steps(struct scene *scene, struct error *error)
{
    const struct scene_contact *friction = first_friction(scene);
    if (scene->analysis == SCENE_DYNAMIC) {
        return STATUS_OK;
    }
    if (friction != NULL && scene->solver.method == SCENE_RELAXATION) {
        return fail(error, STATUS_INPUT, "%s: friction: method = relaxation has none: leave method out",
                    friction->label.where);
    }
    if (!(scene->duration > 0.0) && friction == NULL && scene->solver.time_steps > 0) {
        return fail(error, STATUS_INPUT,
                    "%s: [solver]: time_steps: not allowed: the scene has neither duration nor friction",
                    scene->path);
    }
    if (scene->duration > 0.0 ? !has_prony(scene) : friction != NULL) {
        int64_t usual = scene->duration > 0.0 ? usual_time_steps : usual_increments;
        scene->solver.time_steps = scene->solver.time_steps > 0 ? scene->solver.time_steps : usual;
    }
    return STATUS_OK;
}

static enum status check_whole(struct scene *scene, struct error *error)
{
    if (scene->duration > 0.0 && !has_prony(scene) && !scene->tabulated) {
        return fail(error, STATUS_INPUT,
                    "%s: [scene]: duration: of no use: no material has prony, and no curve a table in s",
                    scene->path);
    }
    if (scene->material_count == 0) {
        return fail(error, STATUS_INPUT, "%s: no section [material NAME]: give at least one", scene->path);
    }
    if (scene->analysis == SCENE_DYNAMIC && !(scene->solver.end_time > 0)) {
        return fail(error, STATUS_INPUT, "%s: [solver]: end_time: missing: a dynamic scene needs it, in s",
                    scene->path);
    }
    RETURN_IF_ERROR(check_steps(scene, error));
    return check_regions(scene, error);
}

static enum status read_file(struct ini_file *file, struct scene *scene, struct error *error)
{
    char *path = strdup(scene->path);
    RETURN_IF_ERROR(owned_add(&scene->owned, path, scene->path, error));
    scene->path = path;
    return ini_read(path, &scene->owned, file, error);
}

enum status scene_read(const char *path, struct scene *scene, struct error *error)
{
    FREED_BY(ini_free) struct ini_file file = {0};
    *scene = (struct scene){.path = path, .title = ""};
    scene->solver = (struct scene_solver){.tolerance = 1e-5, .time_step_margin = .9};
    RETURN_IF_ERROR(read_file(&file, scene, error));
    scene->checksum = file.checksum;
    RETURN_IF_ERROR(read_sections(&file, scene, error));
    return check_whole(scene, error);
}

void scene_free(struct scene *scene)
{
    owned_free(&scene->owned);
    FREE_ALL(scene->files.names, scene->materials, scene->displacements, scene->contacts, scene->supports,
             scene->membranes, scene->loads);
    *scene = (struct scene){0};
}
