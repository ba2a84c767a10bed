/* The groups of a mesh file, and that of each element, from the names, entities and elements that were read.
 * They are the physical groups; where cells, or faces of cells, have none, the entities of the geometry. */
#include "base/lists.h"
#include "io/mesh/msh_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Kinds of input_name: names of groups of a dimension. */
#define OF_DIMENSION 1000

static int compare_group(const void *key, const void *group)
{
    const struct msh_group *of = group;
    int64_t of_group = msh_key(of->dim, of->tag);
    return compare_int64(key, &of_group);
}

/* The group with a key, which exists. */
static struct msh_group *find_group(const struct msh *msh, int64_t key)
{
    return bsearch(&key, msh->groups, (size_t)msh->group_count, sizeof *msh->groups, compare_group);
}

/* Where no physical group has the dimension of the cells, or that of their faces, the entities become groups.
 * A single entity of cells remains without group, as it tells nothing. */
static void group_by_entity(struct msh_reader *r)
{
    bool grouped[4] = {false}, several = false;
    int64_t first = 0;
    int dim = -1;
    for (int64_t i = 0; i < r->name_count; i++) {
        grouped[msh_key_dim(r->names[i].key)] = true;
    }
    for (int64_t i = 0; i < r->entity_count; i++) {
        int of_entity = msh_key_dim(r->entities[i].key);
        grouped[of_entity] = grouped[of_entity] || r->entities[i].group != 0;
    }
    for (int64_t e = 0; e < r->msh->element_count; e++) {
        const struct msh_element *element = &r->msh->elements[e];
        int own = msh_type(element->type).dim;
        grouped[own] = grouped[own] || element->key != 0;
        first = own > dim ? element->entity : first;
        several = own > dim ? false : several || (own == dim && element->entity != first);
        dim = own > dim ? own : dim;
    }
    for (int64_t e = 0; e < r->msh->element_count; e++) {
        struct msh_element *element = &r->msh->elements[e];
        int own = msh_type(element->type).dim;
        if (!grouped[own] && (own == dim ? several : own == dim - 1)) {
            r->msh->by_entity[own] = true;
            element->key = element->entity;
        }
    }
}

static void collect_groups(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    int64_t count = 0;
    SCRATCH int64_t *keys = NULL;
    MSH_NEW(r, &keys, 1 + r->name_count + r->entity_count + msh->element_count);
    if (r->status != STATUS_OK) {
        return;
    }
    keys[count++] = 0; /* no group */
    for (int64_t i = 0; i < r->name_count; i++) {
        keys[count++] = r->names[i].key;
    }
    for (int64_t i = 0; i < r->entity_count; i++) {
        keys[count++] = r->entities[i].group;
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        keys[count] = msh->elements[e].key;
        count += keys[count] != keys[count - 1];
    }
    count = sort_distinct(count, keys);
    MSH_NEW(r, &msh->groups, count);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        int dim = msh_key_dim(keys[i]);
        if (keys[i] != 0) {
            msh->groups[msh->group_count++] =
                (struct msh_group){.dim = dim, .tag = (int)(keys[i] - msh_key(dim, 0))};
        }
    }
}

/* Give a group the name in the file, in which characters that cannot be in lists of names, such as blanks and
 * commas, become underscores. */
static void give_name(struct msh_reader *r, const struct msh_name *name)
{
    struct msh_group *group = find_group(r->msh, name->key);
    if (group->name != NULL) {
        r->status = fail(r->error, STATUS_INPUT, "$PhysicalNames: group %d of dimension %d is named twice",
                         group->tag, group->dim);
        return;
    }
    group->name = strndup(name->text, (size_t)name->length);
    if (group->name == NULL) {
        r->status = fail_memory(r->error, "the name of a group");
        return;
    }
    for (char *c = group->name; *c != '\0'; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127 || strchr(",\"=:", *c) != NULL) {
            *c = '_';
        }
    }
}

/* Append the tag to the name of a group, which begins with `name`. */
static void append_tag(struct msh_reader *r, struct msh_group *group, const char *name)
{
    char *numbered;
    if (asprintf(&numbered, "%s_%d", name, group->tag) < 0) {
        r->status = fail_memory(r->error, "the name of a group");
        return;
    }
    free(group->name);
    group->name = numbered;
}

/* How many groups of its dimension have the name of a group, for the caller to change. */
static int64_t *uses_of(struct msh_reader *r, const struct msh_group *group)
{
    return input_name(r, OF_DIMENSION + group->dim, group->name,
                      r->status == STATUS_OK ? strlen(group->name) : 0);
}

/* Name the groups as in the file, or "group_TAG"; tags tell those of one name apart. */
static void name_groups(struct msh_reader *r)
{
    struct msh_group *groups = r->msh->groups;
    int32_t count = r->msh->group_count;
    for (int64_t i = 0; r->status == STATUS_OK && i < r->name_count; i++) {
        give_name(r, &r->names[i]);
    }
    for (int32_t i = 0; r->status == STATUS_OK && i < count; i++) {
        if (groups[i].name == NULL) {
            append_tag(r, &groups[i], "group");
        }
        ++*uses_of(r, &groups[i]);
    }
    for (int32_t i = 0; r->status == STATUS_OK && i < count; i++) {
        while (*uses_of(r, &groups[i]) > 1 && r->status == STATUS_OK) {
            append_tag(r, &groups[i], groups[i].name);
            ++*uses_of(r, &groups[i]);
        }
    }
    for (int64_t i = 0; r->status == STATUS_OK && i < r->name_count; i++) {
        const struct msh_name *name = &r->names[i];
        const char *here = find_group(r->msh, name->key)->name;
        if (strlen(here) != (size_t)name->length || memcmp(here, name->text, strlen(here)) != 0) {
            input_note(r, "group '%.*s' is named '%s' here", name->length, name->text, here);
        }
    }
}

void msh_join_groups(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    int64_t key = 0;
    int32_t group = -1;
    if (r->status == STATUS_OK) {
        group_by_entity(r);
        collect_groups(r);
        name_groups(r);
    }
    for (int64_t e = 0; r->status == STATUS_OK && e < msh->element_count; e++) {
        if (msh->elements[e].key != key) {
            key = msh->elements[e].key;
            group = key != 0 ? (int32_t)(find_group(msh, key) - msh->groups) : -1;
        }
        msh->elements[e].group = group;
        if (group >= 0) {
            msh->groups[group].element_count++;
        }
    }
}
