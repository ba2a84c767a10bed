#include "io/scene/scene_private.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Steps of a quasi-static scene: of time, without prony; without duration, with friction, of the load. */
static const int64_t usual_time_steps = 50, usual_increments = 20;

/* ---- the lines of the file ---- */

enum { FILE_LIMIT = 64 << 10 };

/* A file that is being read. */
struct reading {
    struct scene *scene;
    struct ini_section *sections; /* count; kind and name together differ */
    int64_t count, line;          /* line: number of that at hand, from 1 */
    struct error *error;
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

void ini_trim(char *text)
{
    size_t length = strlen(text);
    while (length > 0 && is_blank(text[length - 1])) {
        text[--length] = '\0';
    }
}

static enum status fail_line(struct reading *reading, const char *what)
{
    return fail(reading->error, STATUS_INPUT, "%s:%jd: %s", reading->scene->path, reading->line, what);
}

static char *content(char *line)
{
    for (size_t i = 0; line[i] != '\0'; i++) {
        if ((line[i] == '#' || line[i] == ';') && (i == 0 || is_blank(line[i - 1]))) {
            line[i] = '\0';
            break;
        }
    }
    ini_trim(line);
    return line + strspn(line, " \t");
}

const struct ini_entry *ini_find(const struct ini_section *section, const char *key)
{
    for (int64_t e = 0; e < section->entry_count; e++) {
        if (strcmp(section->entries[e].key, key) == 0) {
            return &section->entries[e];
        }
    }
    return NULL;
}

static bool is_word(const char *text)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return text[0] != '\0' && text[strspn(text, allowed)] == '\0';
}

/* Append the section of a header line `[kind NAME]`. */
static enum status add_section(struct reading *reading, char *header)
{
    char *end = header + strlen(header) - 1, *kind = header + 1, *name = kind + strcspn(kind, " \t]");
    if (*end != ']') {
        return fail_line(reading, "section header is not [kind] or [kind NAME]");
    }
    *end = '\0';
    while (is_blank(*name)) {
        *name++ = '\0';
    }
    if (!is_word(kind) || (*name != '\0' && !is_word(name))) {
        return fail_line(reading,
                         "section header is not [kind] or [kind NAME] of letters, digits, '_', '.', '-'");
    }
    for (int64_t s = 0; s < reading->count; s++) {
        const struct ini_section *other = &reading->sections[s];
        if (strcmp(other->kind, kind) == 0 && strcmp(other->name, name) == 0) {
            return fail(reading->error, STATUS_INPUT, "%s:%jd: [%s%s%s]: already in line %jd: join the two",
                        reading->scene->path, reading->line, kind, *name != '\0' ? " " : "", name,
                        other->line);
        }
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&reading->sections, reading->count + 1, reading->error));
    reading->sections[reading->count++] =
        (struct ini_section){.kind = kind, .name = name, .line = reading->line};
    return STATUS_OK;
}

static enum status add_entry(struct reading *reading, char *key)
{
    char *value = strchr(key, '='), what[64] = "has no value";
    if (value == NULL) {
        return fail_line(reading, "neither [kind NAME], nor key = value, nor a comment");
    }
    *value++ = '\0';
    ini_trim(key);
    value += strspn(value, " \t");
    if (!is_word(key)) {
        return fail_line(reading, "key before '=' is not one word of letters, digits, '_', '.', '-'");
    }
    if (reading->count == 0) {
        return fail_line(reading, "stands before the first [section]");
    }
    struct ini_section *section = &reading->sections[reading->count - 1];
    const struct ini_entry *other = ini_find(section, key);
    if (other != NULL) {
        snprintf(what, sizeof what, "already in line %jd", other->line);
    }
    if (other != NULL || *value == '\0') {
        return fail(reading->error, STATUS_INPUT, "%s:%jd: [%s%s%s]: %s: %s", reading->scene->path,
                    reading->line, section->kind, *section->name ? " " : "", section->name, key, what);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&section->entries, section->entry_count + 1, reading->error));
    section->entries[section->entry_count++] = (struct ini_entry){key, value, reading->line};
    return STATUS_OK;
}

/* Read the lines of the file. Errors, as `FILE:LINE: ...`: those of textfile_read; STATUS_INPUT for headers
 * that are not `[kind]` or `[kind NAME]`, keys without value or outside of a section, and repeated ones. */
static enum status read_lines(struct reading *reading)
{
    struct scene *scene = reading->scene;
    FREED_BY(textfile_free) struct textfile text = {0};
    char *path = strdup(scene->path);
    RETURN_IF_ERROR(owned_add(&scene->owned, path, scene->path, reading->error));
    scene->path = path;
    RETURN_IF_ERROR(textfile_read(path, FILE_LIMIT, &text, reading->error));
    scene->checksum = (uint32_t)crc32(0, (const unsigned char *)text.text, (unsigned)text.size);
    char *rest = text.text;
    RETURN_IF_ERROR(owned_add(&scene->owned, array_take(&text.text), path, reading->error));
    for (char *line; (line = strsep(&rest, "\n")) != NULL;) {
        reading->line++;
        line = content(line);
        if (*line != '\0') {
            RETURN_IF_ERROR(*line == '[' ? add_section(reading, line) : add_entry(reading, line));
        }
    }
    return STATUS_OK;
}

static void reading_free(struct reading *reading)
{
    for (int64_t s = 0; s < reading->count; s++) {
        free(reading->sections[s].entries);
    }
    free(reading->sections);
}

/* ---- the sections ---- */

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
static enum status read_sections(const struct reading *reading)
{
    struct scene *scene = reading->scene;
    for (int round = 0; round < 2; round++) {
        for (int64_t s = 0; s < reading->count; s++) {
            struct place place = {.section = &reading->sections[s], .scene = scene, .error = reading->error};
            if ((strcmp(place.section->kind, "scene") == 0) == (round == 0)) {
                RETURN_IF_ERROR(read_section(&place, scene));
            }
        }
        if (scene->dim == 0) {
            return fail(reading->error, STATUS_INPUT,
                        "%s: no section [scene]: begin with [scene], dim and analysis", scene->path);
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
    if (!(scene->solver.time_step_margin > 0.0)) { /* dynamic steps must be accurate, not only stable */
        scene->solver.time_step_margin = scene->analysis == SCENE_DYNAMIC ? .75 : .9;
    }
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

enum status scene_read(const char *path, struct scene *scene, struct error *error)
{
    FREED_BY(reading_free) struct reading reading = {.scene = scene, .error = error};
    *scene = (struct scene){.path = path, .title = ""};
    scene->solver = (struct scene_solver){.tolerance = 1e-5};
    RETURN_IF_ERROR(read_lines(&reading));
    RETURN_IF_ERROR(read_sections(&reading));
    return check_whole(scene, error);
}

void scene_free(struct scene *scene)
{
    owned_free(&scene->owned);
    FREE_ALL(scene->files.names, scene->materials, scene->displacements, scene->contacts, scene->supports,
             scene->membranes, scene->loads);
    *scene = (struct scene){0};
}
