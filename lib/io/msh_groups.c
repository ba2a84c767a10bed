#include "base/lists.h"
#include "io/msh_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_NAME 127

/* Of an entity. */
#define MOST_GROUPS 64

static const char *const entity_kinds[] = {"point", "curve", "surface", "volume"};

/* ---- $PhysicalNames ---- */

static void read_name(struct msh_reader *r, struct msh_name *name)
{
    int64_t dim = msh_int(r, "dimension", 0, 3);
    int64_t tag = msh_int(r, "physical tag", 1, MSH_LARGEST_TAG);
    msh_skip_space(r);
    if (r->at == r->end || *r->at != '"') {
        msh_fail(r, "no name in quotation marks");
        return;
    }
    const char *text = r->at + 1;
    int length = 0; /* a NUL ends it, too */
    while (text + length < r->end && strchr("\"\n", text[length]) == NULL && length <= LONGEST_NAME) {
        length++;
    }
    if (text + length == r->end || text[length] != '"' || length == 0) {
        msh_fail(r, "the name is empty, unfinished or longer than %d bytes", LONGEST_NAME);
        return;
    }
    *name = (struct msh_name){msh_key(dim, tag), text, length};
    r->at = text + length + 1;
    msh_skip_line(r);
}

/* Text also in binary files. */
void msh_read_names(struct msh_reader *r)
{
    bool binary = r->binary;
    r->binary = false;
    r->kind = "name";
    r->name_count = msh_count(r, "number of names", 6, 6);
    MSH_NEW(r, &r->names, r->name_count);
    for (int64_t i = 0; r->status == STATUS_OK && i < r->name_count; i++) {
        r->record = i + 1;
        read_name(r, &r->names[i]);
    }
    r->binary = binary;
}

/* ---- $Entities, $PartitionedEntities ---- */

int64_t msh_read_entity_tag(struct msh_reader *r, int64_t *dim)
{
    int64_t tag = 0;
    if (r->version == 40) {
        tag = msh_int(r, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    }
    *dim = msh_int(r, "dimension", 0, 3);
    if (r->version == 41) {
        tag = msh_int(r, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    }
    return tag;
}

/* Tags that follow an entity's box: the entities that bound it. */
static void skip_tags(struct msh_reader *r, const char *what)
{
    int64_t count = msh_count(r, what, 2, 4);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        (void)msh_int(r, what, -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    }
}

/* The partitions that an entity is in: of the parts of the mesh's highest dimension they are kept. */
static void read_partitions_of(struct msh_reader *r, int dim, bool is_part)
{
    int64_t count = msh_count(r, "partitions", 2, 4);
    if (is_part && dim > r->partition_dim) {
        r->partition_dim = dim;
        r->partition_count = 0;
    }
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        int64_t tag = msh_int(r, "partitions", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
        if (!is_part) {
            continue;
        }
        MSH_GROW(r, &r->partitions, r->partition_count + 1, &r->partition_room);
        if (r->status == STATUS_OK) {
            r->partitions[r->partition_count++] = tag;
        }
    }
}

/* The physical groups of an entity; negative where its orientation is reversed. */
static void read_physicals(struct msh_reader *r, int dim, struct msh_entity *entity)
{
    int64_t count = msh_count(r, "physical groups", 2, 4);
    if (count > MOST_GROUPS) {
        msh_fail(r, "%lld physical groups are more than %d", (long long)count, MOST_GROUPS);
    }
    entity->first = r->physical_count;
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        int64_t tag = msh_int(r, "physical groups", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
        MSH_GROW(r, &r->physicals, r->physical_count + 1, &r->physical_room);
        if (r->status == STATUS_OK) {
            r->physicals[r->physical_count++] = msh_key(dim, tag < 0 ? -tag : tag);
        }
    }
    entity->count = r->physical_count - entity->first;
}

/* Where parts of a volume meet there are surfaces of their own, said to be parts of the volume and of its
 * group: these are in no group. */
static void read_entity(struct msh_reader *r, int dim, bool partitioned, struct msh_entity *entity)
{
    bool is_part = true;
    *entity = (struct msh_entity){.key = msh_key(dim, msh_int(r, "tag", -MSH_LARGEST_TAG, MSH_LARGEST_TAG))};
    if (partitioned) {
        is_part = msh_int(r, "dimension of the whole", -1, 3) == dim;
        (void)msh_int(r, "tag of the whole", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
        read_partitions_of(r, dim, is_part);
    }
    for (int k = 0; k < (dim == 0 && r->version == 41 ? 3 : 6); k++) {
        (void)msh_real(r, "box");
    }
    read_physicals(r, dim, entity);
    if (!is_part) {
        r->physical_count = entity->first;
        entity->count = 0;
    }
    if (dim > 0) {
        skip_tags(r, "boundary");
    }
}

static void read_entities(struct msh_reader *r, bool partitioned)
{
    int64_t counts[4];
    int64_t total = 0;
    for (int dim = 0; dim < 4; dim++) {
        counts[dim] = msh_count(r, "number of entities", 10, 36);
        total += counts[dim];
    }
    if (total > (r->end - r->at) / 10) {
        msh_fail(r, "%lld entities cannot be in what is left of the file", (long long)total);
    }
    MSH_GROW(r, &r->entities, r->entity_count + total, &r->entity_room);
    for (int dim = 0; dim < 4; dim++) {
        r->kind = entity_kinds[dim];
        for (int64_t i = 0; r->status == STATUS_OK && i < counts[dim]; i++) {
            r->record = i + 1;
            read_entity(r, dim, partitioned, &r->entities[r->entity_count++]);
        }
    }
}

void msh_read_entities(struct msh_reader *r)
{
    if (r->version < 40) {
        msh_fail(r, "has no place in MSH 2");
    }
    read_entities(r, false);
}

void msh_read_partitions(struct msh_reader *r)
{
    if (r->version < 40 || !r->has[MSH_ENTITIES]) {
        msh_fail(r, "stands in MSH 4 only, behind $Entities");
    }
    r->msh->partitions = msh_size(r, "number of partitions", 0, MSH_LARGEST_TAG);
    int64_t ghosts = msh_count(r, "number of ghosts", 4, 8);
    for (int64_t i = 0; r->status == STATUS_OK && i < 2 * ghosts; i++) {
        (void)msh_int(r, "ghost", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    }
    read_entities(r, true);
    if (r->status == STATUS_OK && r->partition_count > 0) {
        qsort(r->partitions, (size_t)r->partition_count, sizeof *r->partitions, compare_int64);
        for (int64_t i = 0; i < r->partition_count; i++) {
            r->msh->partitions_here += i == 0 || r->partitions[i] != r->partitions[i - 1];
        }
    }
}

/* ---- joining them ---- */

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

/* The group, which is there. */
static struct msh_group *find_group(const struct msh *msh, int64_t key)
{
    return bsearch(&key, msh->groups, (size_t)msh->group_count, sizeof *msh->groups, compare_group);
}

/* Sort keys, each once; returns how many are left. */
static int64_t sort_keys(int64_t keys[], int64_t count)
{
    int64_t kept = 0;
    qsort(keys, (size_t)count, sizeof *keys, compare_int64);
    for (int64_t i = 0; i < count; i++) {
        if (i == 0 || keys[i] != keys[i - 1]) {
            keys[kept++] = keys[i];
        }
    }
    return kept;
}

/* The groups that the file names, and those that entities (MSH 4) or elements (MSH 1 and 2) are in. */
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
    count = sort_keys(keys, count);
    MSH_NEW(r, &msh->groups, count);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        msh->groups[msh->group_count++] =
            (struct msh_group){.dim = key_dim(keys[i]), .tag = key_tag(keys[i])};
    }
}

/* A copy in which blanks, commas and the like, which cannot stand in lists of names, are underscores; or
 * NULL. */
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

/* Names as in the file, "group_TAG" for groups without; two of one name and dimension are a failure. */
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

/* In MSH 1 and 2 each group is an entity in itself. */
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

/* Entities in ascending order; their groups become indices into msh->groups, ascending. */
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
                             entity_kinds[key_dim(entity->key)], key_tag(entity->key));
            return;
        }
        entity->count = sort_keys(list, entity->count);
        for (int64_t k = 0; k < entity->count; k++) {
            list[k] = find_group(r->msh, list[k]) - r->msh->groups;
        }
    }
}

/* The entity of an element; of a file that lists none, and of elements of no group, a list of no groups. */
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
                 (long long)r->msh->element_tag[e], entity_kinds[key_dim(*key)], key_tag(*key));
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
