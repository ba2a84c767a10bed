/* The kinds of section of a scene: their keys, and how they fill the struct. Inside of lib/io only. */
#pragma once

#include "base/status.h"
#include "io/scene/scene.h"
#include "io/scene/scene_value.h"

/* A kind of section, and the array of the scene that its sections extend, if any. */
struct scene_kind {
    const char *name;
    const struct scene_key *keys; /* all that it may have; the last one has no name */
    /* What the keys have to be together, when all have been read; NULL: nothing. */
    enum status (*check)(const struct place *place, struct scene *scene);
    bool has_items;
    size_t items, count; /* offsets in struct scene of the array and its count */
    size_t item_size;    /* items begin with a struct scene_label */
};

/* The kind of the section; an error for another name, or a key that the kind has not. */
MUST_CHECK enum status scene_kind_find(const struct place *place, const struct scene_kind **kind);
