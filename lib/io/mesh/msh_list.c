/* The nodes and elements of a mesh file, as they are read, and finding them by their tags; and its groups,
 * and that of each element, from the names, entities and elements that were read. They are the physical
 * groups; where cells, or faces of cells, have none, the entities of the geometry. */
#include "base/lists.h"
#include "io/mesh/msh_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- finding them by their tags ---- */

static void index_add(struct msh_reader *r, struct msh_index *index, int64_t tag, int64_t place)
{
    struct msh_run *last = index->count > 0 ? &index->run[index->count - 1] : NULL;
    if (last != NULL && tag == last->tag + last->count && place == last->place + last->count) {
        last->count++;
        return;
    }
    index->unsorted = index->unsorted || (last != NULL && tag < last->tag + last->count);
    MSH_GROW(r, &index->run, index->count + 1, &index->room);
    if (r->status == STATUS_OK) {
        index->run[index->count++] = (struct msh_run){tag, place, 1};
    }
}

static void index_sort(struct msh_index *index)
{
    if (index->unsorted) {
        qsort(index->run, (size_t)index->count, sizeof *index->run, compare_int64);
        index->unsorted = false;
    }
}

int64_t msh_index_from(struct msh_index *index, int64_t tag)
{
    int64_t low = 0, high = index->count;
    index_sort(index);
    while (low < high) {
        int64_t middle = (low + high) / 2;
        bool before = index->run[middle].tag + index->run[middle].count <= tag;
        *(before ? &low : &high) = middle + before;
    }
    return low;
}

int64_t msh_index_find(struct msh_index *index, int64_t tag)
{
    int64_t at = msh_index_from(index, tag);
    const struct msh_run *run = &index->run[at];
    return at < index->count && tag >= run->tag ? run->place + tag - run->tag : -1;
}

/* The place of something whose tag stands before it, too; -1: there is none. */
static int64_t find_twice(struct msh_index *index)
{
    index_sort(index);
    for (int64_t i = 1; i < index->count; i++) {
        const struct msh_run *a = &index->run[i - 1], *b = &index->run[i];
        if (b->tag < a->tag + a->count) {
            int64_t other = a->place + b->tag - a->tag;
            return other > b->place ? other : b->place;
        }
    }
    return -1;
}

void msh_check_tags(struct msh_reader *r, struct msh_index *index)
{
    int64_t again = find_twice(index);
    bool is_node = index == &r->nodes;
    if (again >= 0) {
        r->record = is_node ? r->msh->nodes[again].record : 0;
        msh_fail(r, "%s tag %jd stands twice", is_node ? "node" : "element",
                 is_node ? r->msh->nodes[again].tag : r->msh->elements[again].tag);
    }
}

/* ---- adding them ---- */

void msh_add_node(struct msh_reader *r, int64_t tag, const double x[3])
{
    struct msh *msh = r->msh;
    MSH_GROW(r, &msh->nodes, msh->node_count + 1, &r->node_room);
    if (r->status == STATUS_OK) {
        index_add(r, &r->nodes, tag, msh->node_count);
        msh->nodes[msh->node_count++] = (struct msh_node){tag, {x[0], x[1], x[2]}, r->record};
    }
}

void msh_add_element(struct msh_reader *r, int64_t tag, int type, const int64_t node[], int64_t key)
{
    struct msh *msh = r->msh;
    int64_t count = msh_type(type).node_count;
    MSH_GROW(r, &msh->elements, msh->element_count + 1, &r->element_room);
    MSH_GROW(r, &r->corners, r->corner_count + count, &r->corner_room);
    if (r->status == STATUS_OK) {
        if (tag != MSH_NO_TAG) {
            index_add(r, &r->elements, tag, msh->element_count);
        }
        msh->elements[msh->element_count++] =
            (struct msh_element){.tag = tag, .first = r->corner_count, .key = key, .type = (int8_t)type};
        memcpy(&r->corners[r->corner_count], node, (size_t)count * sizeof *node);
        r->corner_count += count;
    }
}

/* ---- when all are there ---- */

/* Say that an element, a set or a surface names a node that there is not. */
static void fail_corner(struct msh_reader *r, const struct msh_element *element, int64_t node)
{
    int length = 0;
    const char *name = "";
    for (int64_t i = 0; i < r->name_count; i++) {
        if (r->names[i].key == element->key) {
            name = r->names[i].text;
            length = r->names[i].length;
        }
    }
    if (element->tag != MSH_NO_TAG) {
        msh_fail(r, "element %jd names the node %jd, which is not in the file", element->tag, node);
    } else {
        msh_fail(r, "the set or surface '%.*s' names the node %jd, which is not in the file", length, name,
                 node);
    }
}

void msh_finish_lists(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    int64_t tag = 0;
    msh_check_tags(r, &r->nodes);
    r->section = "elements";
    r->record = 0;
    MSH_NEW(r, &msh->node_idx, r->corner_count);
    for (int64_t e = 0; r->status == STATUS_OK && e < msh->element_count; e++) {
        const struct msh_element *element = &msh->elements[e];
        tag = element->tag > tag ? element->tag : tag;
        for (int64_t k = element->first, end = k + msh_type(element->type).node_count; k < end; k++) {
            msh->node_idx[k] = (int32_t)msh_index_find(&r->nodes, r->corners[k]);
            if (msh->node_idx[k] < 0) {
                fail_corner(r, element, r->corners[k]);
            }
        }
    }
    for (int64_t e = 0; r->status == STATUS_OK && e < msh->element_count; e++) {
        msh->elements[e].tag = msh->elements[e].tag != MSH_NO_TAG ? msh->elements[e].tag : ++tag;
    }
}

/* ---- groups ---- */

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
