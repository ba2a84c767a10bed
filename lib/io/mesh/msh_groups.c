/* The physical groups of a mesh file, and those of each element, from the names, entities and elements that
 * were read. */
#include "base/lists.h"
#include "io/mesh/msh_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int key_dim(int64_t key)
{
    return (int)((key + MSH_LARGEST_TAG) >> 32) - 1;
}

static int key_tag(int64_t key)
{
    return (int)(key - msh_key(key_dim(key), 0));
}

static int64_t group_key(const struct msh_group *group)
{
    return msh_key(group->dim, group->tag);
}

static int compare_group(const void *key, const void *group)
{
    int64_t of_group = group_key(group);
    return compare_int64(key, &of_group);
}

/* By dimension and name, then tag. */
static int compare_names(const void *left, const void *right)
{
    const struct msh_group *a = *(const struct msh_group *const *)left,
                           *b = *(const struct msh_group *const *)right;
    int names = a->dim == b->dim ? strcmp(a->name, b->name) : 0;
    int64_t key = group_key(a);
    return names != 0 ? names : compare_group(&key, b);
}

/* The group with a key; it exists. */
static struct msh_group *find_group(const struct msh *msh, int64_t key)
{
    return bsearch(&key, msh->groups, (size_t)msh->group_count, sizeof *msh->groups, compare_group);
}

/* Collect the groups that the file names, and those of entities (MSH 4) or elements (MSH 1 and 2). */
static void collect_groups(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    int64_t count = 0;
    SCRATCH int64_t *keys = NULL;
    int64_t elements = r->version < 40 ? msh->element_count : 0;
    MSH_NEW(r, &keys, r->name_count + r->physical_count + elements);
    if (r->status != STATUS_OK) {
        return;
    }
    for (int64_t i = 0; i < r->name_count; i++) {
        keys[count++] = r->names[i].key;
    }
    for (int64_t i = 0; i < r->physical_count; i++) {
        keys[count++] = r->physicals[i];
    }
    for (int64_t e = 0; e < elements; e++) {
        if (r->element_key[e] != 0 && (count == 0 || keys[count - 1] != r->element_key[e])) {
            keys[count++] = r->element_key[e];
        }
    }
    count = sort_distinct(count, keys);
    MSH_NEW(r, &msh->groups, count);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        msh->groups[msh->group_count++] =
            (struct msh_group){.dim = key_dim(keys[i]), .tag = key_tag(keys[i])};
    }
}

/* A copy in which characters that cannot be in lists of names, such as blanks and commas, are underscores;
 * NULL: memory. */
static char *plain_name(const char *name)
{
    char *copy = strdup(name);
    for (char *c = copy; c != NULL && *c != '\0'; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127 || strchr(",\"=:", *c) != NULL) {
            *c = '_';
        }
    }
    return copy;
}

static void give_name(struct msh_reader *r, const struct msh_name *name)
{
    struct msh_group *group = find_group(r->msh, name->key);
    if (group->name != NULL) {
        r->status = fail(r->error, STATUS_INPUT, "$PhysicalNames: group %d of dimension %d is named twice",
                         group->tag, group->dim);
        return;
    }
    group->written = strndup(name->text, (size_t)name->length);
    group->name = group->written != NULL ? plain_name(group->written) : NULL;
    if (group->name == NULL) {
        r->status = fail_memory(r->error, "the name of a group");
    } else if (strcmp(group->name, group->written) == 0) {
        free(group->written);
        group->written = NULL;
    }
}

/* Name the groups as in the file, or "group_TAG"; two groups with one name and dimension are a failure. */
static void name_groups(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    const struct msh_group **order = NULL;
    for (int64_t i = 0; r->status == STATUS_OK && i < r->name_count; i++) {
        give_name(r, &r->names[i]);
    }
    MSH_NEW(r, &order, msh->group_count);
    for (int32_t i = 0; r->status == STATUS_OK && i < msh->group_count; i++) {
        order[i] = &msh->groups[i];
        if (msh->groups[i].name == NULL &&
            asprintf(&msh->groups[i].name, "group_%d", msh->groups[i].tag) < 0) {
            msh->groups[i].name = NULL;
            r->status = fail_memory(r->error, "the name of a group");
        }
    }
    if (r->status == STATUS_OK) {
        qsort(order, (size_t)msh->group_count, sizeof *order, compare_names);
    }
    for (int32_t i = 1; r->status == STATUS_OK && i < msh->group_count; i++) {
        const struct msh_group *a = order[i - 1];
        const struct msh_group *b = order[i];
        if (a->dim == b->dim && strcmp(a->name, b->name) == 0) {
            r->status =
                fail(r->error, STATUS_INPUT, "physical groups %d and %d of dimension %d are both named '%s'",
                     a->tag, b->tag, a->dim, a->name);
        }
    }
    free(order);
}

/* In MSH 1 and 2 each group is an entity. */
static void make_entities(struct msh_reader *r)
{
    int64_t count = r->msh->group_count;
    MSH_GROW(r, &r->entities, count, &r->entity_room);
    MSH_GROW(r, &r->physicals, count, &r->physical_room);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        r->physicals[i] = group_key(&r->msh->groups[i]);
        r->entities[r->entity_count++] = (struct msh_entity){r->physicals[i], i, 1};
    }
}

/* Sort the entities, and turn their groups into ascending indices into msh->groups. */
static void sort_entities(struct msh_reader *r)
{
    if (r->status != STATUS_OK || r->entity_count == 0) {
        return;
    }
    qsort(r->entities, (size_t)r->entity_count, sizeof *r->entities, compare_int64);
    for (int64_t i = 0; i < r->entity_count; i++) {
        struct msh_entity *entity = &r->entities[i];
        int64_t *list = &r->physicals[entity->first];
        if (i > 0 && entity->key == entity[-1].key) {
            r->status = fail(r->error, STATUS_INPUT, "$Entities: %s %d stands twice",
                             msh_entity_kind(key_dim(entity->key)), key_tag(entity->key));
            return;
        }
        entity->count = sort_distinct(entity->count, list);
        for (int64_t k = 0; k < entity->count; k++) {
            list[k] = find_group(r->msh, list[k]) - r->msh->groups;
        }
    }
}

/* The entity of an element; one without groups if the file lists none, and for elements without group. */
static const struct msh_entity *entity_of(struct msh_reader *r, int64_t e, const struct msh_entity *last)
{
    static const struct msh_entity none = {0, 0, 0};
    const int64_t *key = &r->element_key[e];
    if (*key == last->key) {
        return last;
    }
    const struct msh_entity *found =
        r->entity_count == 0 ? NULL
                             : bsearch(key, r->entities, (size_t)r->entity_count, sizeof none, compare_int64);
    if (found == NULL && r->version >= 40 && r->entity_count > 0) {
        r->status =
            fail(r->error, STATUS_INPUT, "$Elements: element %lld is on %s %d, which is not in $Entities",
                 (long long)r->msh->element_tag[e], msh_entity_kind(key_dim(*key)), key_tag(*key));
    }
    return found != NULL ? found : &none;
}

static void join_members(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    const struct msh_entity none = {0, 0, 0}, *entity = &none;
    MSH_NEW(r, &msh->member_ptr, msh->element_count + 1);
    for (int64_t e = 0; r->status == STATUS_OK && e < msh->element_count; e++) {
        entity = entity_of(r, e, entity);
        msh->member_ptr[e + 1] = msh->member_ptr[e] + entity->count;
    }
    if (r->status == STATUS_OK) {
        MSH_NEW(r, &msh->member_idx, msh->member_ptr[msh->element_count]);
    }
    for (int64_t e = 0; r->status == STATUS_OK && e < msh->element_count; e++) {
        entity = entity_of(r, e, entity);
        for (int64_t k = 0; k < entity->count; k++) {
            int32_t group = (int32_t)r->physicals[entity->first + k];
            msh->member_idx[msh->member_ptr[e] + k] = group;
            msh->groups[group].element_count++;
        }
    }
}

void msh_join_groups(struct msh_reader *r)
{
    collect_groups(r);
    name_groups(r);
    if (r->version < 40) {
        make_entities(r);
    }
    sort_entities(r);
    join_members(r);
}
