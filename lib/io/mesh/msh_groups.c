/* The groups of a mesh file, and those of each element, from the names, entities and elements that were read.
 * They are the physical groups; where cells, or faces of cells, have none, the entities of the geometry. */
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

static int dim_of(const struct msh_reader *r, int64_t e)
{
    return msh_type(r->msh->elements[e].type).dim;
}

/* Collect the groups that the file names, those of entities (MSH 4), and those of elements where
 * by_element[dimension] says that these name their groups. */
static void collect_groups(struct msh_reader *r, const bool by_element[])
{
    struct msh *msh = r->msh;
    int64_t count = 0;
    SCRATCH int64_t *keys = NULL;
    MSH_NEW(r, &keys, r->name_count + r->physical_count + msh->element_count);
    if (r->status != STATUS_OK) {
        return;
    }
    for (int64_t i = 0; i < r->name_count; i++) {
        keys[count++] = r->names[i].key;
    }
    for (int64_t i = 0; i < r->physical_count; i++) {
        keys[count++] = r->physicals[i];
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        if (by_element[dim_of(r, e)] && r->msh->elements[e].key != 0 &&
            (count == 0 || keys[count - 1] != r->msh->elements[e].key)) {
            keys[count++] = r->msh->elements[e].key;
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

static void append_tag(struct msh_reader *r, struct msh_group *group)
{
    char *numbered;
    if (r->status != STATUS_OK) {
        return;
    }
    if (asprintf(&numbered, "%s_%d", group->name, group->tag) < 0) {
        r->status = fail_memory(r->error, "the name of a group");
        return;
    }
    if (group->written == NULL) {
        group->written = group->name;
    } else {
        free(group->name);
    }
    group->name = numbered;
}

/* Append the tag to names that groups of one dimension share; returns whether there were any. A name so made
 * may be another group's, but not that of one with a tag appended: when repeated, this ends. */
static bool number_names(struct msh_reader *r, struct msh_group **order)
{
    int64_t count = r->msh->group_count;
    bool shared = false;
    qsort(order, (size_t)count, sizeof *order, compare_names);
    for (int64_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && order[end]->dim == order[i]->dim; end++) {
            if (strcmp(order[end]->name, order[i]->name) != 0) {
                break;
            }
        }
        for (int64_t k = i; k < end && end > i + 1; k++) {
            append_tag(r, order[k]);
            shared = true;
        }
    }
    return shared;
}

/* Name the groups as in the file, or "group_TAG"; tags tell those of one name apart. */
static void name_groups(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    SCRATCH struct msh_group **order = NULL;
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
    while (r->status == STATUS_OK && number_names(r, order)) {
    }
}

/* Sort the entities; each stands once. */
static void sort_entities(struct msh_reader *r)
{
    if (r->status != STATUS_OK || r->entity_count == 0) {
        return;
    }
    qsort(r->entities, (size_t)r->entity_count, sizeof *r->entities, compare_int64);
    for (int64_t i = 1; i < r->entity_count; i++) {
        int64_t key = r->entities[i].key;
        if (key == r->entities[i - 1].key) {
            r->status = fail(r->error, STATUS_INPUT, "$Entities: %s %d stands twice",
                             msh_entity_kind(key_dim(key)), key_tag(key));
            return;
        }
    }
}

/* The entity with a key; NULL if there is none. */
static const struct msh_entity *find_entity(const struct msh_reader *r, int64_t key)
{
    return r->entity_count == 0
               ? NULL
               : bsearch(&key, r->entities, (size_t)r->entity_count, sizeof *r->entities, compare_int64);
}

/* In MSH 4: the entity of each element is in $Entities, unless the file lists none. */
static void check_entities(struct msh_reader *r)
{
    const struct msh_entity *entity = NULL;
    bool listed = r->msh4 && r->entity_count > 0;
    for (int64_t e = 0; listed && r->status == STATUS_OK && e < r->msh->element_count; e++) {
        int64_t key = r->msh->elements[e].key;
        entity = entity != NULL && entity->key == key ? entity : find_entity(r, key);
        if (entity == NULL) {
            r->status =
                fail(r->error, STATUS_INPUT, "$Elements: element %lld is on %s %d, which is not in $Entities",
                     (long long)r->msh->elements[e].tag, msh_entity_kind(key_dim(key)), key_tag(key));
        }
    }
}

/* Where no physical group has the dimension of the cells, or that of their faces, the entities become groups.
 * A single entity of cells remains without group, as it tells nothing. */
static void group_by_entity(struct msh_reader *r, bool by_element[])
{
    bool grouped[4] = {false}, several = false;
    int64_t first = 0;
    int dim = -1;
    for (int64_t i = 0; r->status == STATUS_OK && i < r->name_count; i++) {
        grouped[key_dim(r->names[i].key)] = true;
    }
    for (int64_t i = 0; r->status == STATUS_OK && i < r->physical_count; i++) {
        grouped[key_dim(r->physicals[i])] = true;
    }
    for (int64_t e = 0; r->status == STATUS_OK && e < r->msh->element_count; e++) {
        int of_element = dim_of(r, e);
        grouped[of_element] = grouped[of_element] || (!r->msh4 && r->msh->elements[e].key != 0);
        first = of_element > dim ? r->msh->elements[e].entity : first;
        several =
            of_element > dim ? false : several || (of_element == dim && r->msh->elements[e].entity != first);
        dim = of_element > dim ? of_element : dim;
    }
    for (int64_t e = 0; r->status == STATUS_OK && e < r->msh->element_count; e++) {
        int of_element = dim_of(r, e);
        if (!grouped[of_element] && (of_element == dim ? several : of_element == dim - 1)) {
            by_element[of_element] = r->msh->by_entity[of_element] = true;
            r->msh->elements[e].key = r->msh->elements[e].entity;
        }
    }
}

/* Where elements name their groups, each group is an entity. */
static void make_entities(struct msh_reader *r, const bool by_element[])
{
    int64_t kept = 0;
    for (int64_t i = 0; i < r->entity_count; i++) {
        if (!by_element[key_dim(r->entities[i].key)]) {
            r->entities[kept++] = r->entities[i];
        }
    }
    r->entity_count = kept;
    MSH_GROW(r, &r->entities, kept + r->msh->group_count, &r->entity_room);
    MSH_GROW(r, &r->physicals, r->physical_count + r->msh->group_count, &r->physical_room);
    for (int64_t i = 0; r->status == STATUS_OK && i < r->msh->group_count; i++) {
        int64_t key = group_key(&r->msh->groups[i]);
        if (by_element[r->msh->groups[i].dim]) {
            r->entities[r->entity_count++] = (struct msh_entity){key, r->physical_count, 1};
            r->physicals[r->physical_count++] = key;
        }
    }
    sort_entities(r);
}

/* Turn the groups of entities into ascending indices into msh->groups. */
static void index_groups(struct msh_reader *r)
{
    for (int64_t i = 0; r->status == STATUS_OK && i < r->entity_count; i++) {
        struct msh_entity *entity = &r->entities[i];
        int64_t *list = &r->physicals[entity->first];
        entity->count = sort_distinct(entity->count, list);
        for (int64_t k = 0; k < entity->count; k++) {
            list[k] = find_group(r->msh, list[k]) - r->msh->groups;
        }
    }
}

static void join_members(struct msh_reader *r)
{
    static const struct msh_entity none = {0};
    struct msh *msh = r->msh;
    MSH_NEW(r, &msh->member_ptr, msh->element_count + 1);
    for (int pass = 0; pass < 2 && r->status == STATUS_OK; pass++) {
        const struct msh_entity *entity = &none;
        for (int64_t e = 0; e < msh->element_count; e++) {
            if (r->msh->elements[e].key != entity->key) {
                entity = find_entity(r, r->msh->elements[e].key);
                entity = entity != NULL ? entity : &none;
            }
            msh->member_ptr[e + 1] = msh->member_ptr[e] + entity->count;
            for (int64_t k = 0; pass == 1 && k < entity->count; k++) {
                int32_t group = (int32_t)r->physicals[entity->first + k];
                msh->member_idx[msh->member_ptr[e] + k] = group;
                msh->groups[group].element_count++;
            }
        }
        if (pass == 0) {
            MSH_NEW(r, &msh->member_idx, msh->member_ptr[msh->element_count]);
        }
    }
}

void msh_join_groups(struct msh_reader *r)
{
    bool old = !r->msh4, by_element[4] = {old, old, old, old};
    sort_entities(r);
    check_entities(r);
    group_by_entity(r, by_element);
    collect_groups(r, by_element);
    name_groups(r);
    make_entities(r, by_element);
    index_groups(r);
    join_members(r);
}
