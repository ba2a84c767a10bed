/* The kinds of sections of a scene, with their keys and the members set by these; private to lib/io. */
#pragma once

#include "base/status.h"
#include "io/scene/scene.h"
#include "io/scene/scene_value.h"

/* A kind of section, and the array of the scene that its sections extend, if any. */
struct scene_kind {
    const char *name;
    const struct scene_key *keys; /* all admitted keys; the last one has no name */
    /* Check of the keys together, after all have been read; NULL: none. */
    enum status (*check)(const struct place *place, struct scene *scene);
    bool has_items;
    size_t items, count; /* offsets in struct scene of the array and its count */
    size_t item_size;    /* items begin with a struct scene_label */
};

/* ---- scene_material.c ---- */

/* Append the keys of all laws to keys[count], up to `most`: each once. */
void scene_material_list_keys(const char **keys, int count, int most);

/* The check of a material: of its law, whose keys it reads, and of its moduli. */
MUST_CHECK enum status scene_material_check(const struct place *place, struct scene *scene);

/* The kind of the section; STATUS_INPUT for an unknown kind or key. */
MUST_CHECK enum status scene_kind_find(const struct place *place, const struct scene_kind **kind);
