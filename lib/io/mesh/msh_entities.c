/* Reading $PhysicalNames and $Entities: the names of physical groups, and the groups of each entity. */
#include "base/lists.h"
#include "io/mesh/msh_private.h"

#include <stdlib.h>
#include <string.h>

#define LONGEST_NAME 127

/* Most groups of an entity: its elements are so many times as many. */
#define MOST_GROUPS 16

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
    int length = 0; /* a NUL also ends the name */
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

/* This section is text also in binary files. */
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

/* ---- $Entities ---- */

const char *msh_entity_kind(int dim)
{
    static const char *const kinds[] = {"point", "curve", "surface", "volume"};
    return kinds[dim];
}

int64_t msh_read_entity_tag(struct msh_reader *r, int64_t *dim)
{
    *dim = msh_int(r, "dimension", 0, 3);
    return msh_int(r, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
}

/* Skip the tags of the entities that bound an entity, which follow its box. */
static void skip_tags(struct msh_reader *r, const char *what)
{
    int64_t count = msh_count(r, what, 2, 4);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        (void)msh_int(r, what, -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    }
}

/* Read the physical groups of an entity. A tag is negative if the group reverses the orientation. */
static void read_physicals(struct msh_reader *r, int dim, struct msh_entity entity)
{
    int64_t count = msh_count(r, "physical groups", 2, 4);
    if (count > MOST_GROUPS) {
        msh_fail(r, "%lld physical groups are more than %d", (long long)count, MOST_GROUPS);
    }
    for (int64_t i = 0; r->status == STATUS_OK && (i < count || i == 0); i++) {
        int64_t tag = count > 0 ? msh_int(r, "physical groups", -MSH_LARGEST_TAG, MSH_LARGEST_TAG) : 0;
        entity.group = count > 0 ? msh_key(dim, tag < 0 ? -tag : tag) : 0;
        MSH_GROW(r, &r->entities, r->entity_count + 1, &r->entity_room);
        if (r->status == STATUS_OK) {
            r->entities[r->entity_count++] = entity;
        }
    }
}

static void read_entity(struct msh_reader *r, int dim)
{
    int64_t tag = msh_int(r, "tag", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    for (int k = 0; k < (dim == 0 ? 3 : 6); k++) {
        (void)msh_real(r, "box");
    }
    read_physicals(r, dim, (struct msh_entity){.key = msh_key(dim, tag), .record = r->record});
    if (dim > 0) {
        skip_tags(r, "boundary");
    }
}

static int compare_entities(const void *left, const void *right)
{
    const struct msh_entity *a = left, *b = right;
    return a->key != b->key ? compare_int64(a, b) : compare_int64(&a->group, &b->group);
}

/* Sort the entities; each stands once. */
static void sort_entities(struct msh_reader *r)
{
    qsort(r->entities, (size_t)r->entity_count, sizeof *r->entities, compare_entities);
    for (int64_t i = 1; r->status == STATUS_OK && i < r->entity_count; i++) {
        if (r->entities[i].key == r->entities[i - 1].key &&
            r->entities[i].record != r->entities[i - 1].record) {
            r->kind = msh_entity_kind(msh_key_dim(r->entities[i].key));
            r->record = r->entities[i].record;
            msh_fail(r, "its tag stands twice");
        }
    }
}

const struct msh_entity *msh_find_entity(const struct msh_reader *r, int64_t key, int64_t *count)
{
    int64_t low = 0, high = r->entity_count;
    while (low < high) {
        int64_t middle = (low + high) / 2;
        *(r->entities[middle].key < key ? &low : &high) = middle + (r->entities[middle].key < key);
    }
    for (*count = 0; high < r->entity_count && r->entities[high].key == key; high++) {
        ++*count;
    }
    return *count > 0 ? &r->entities[low] : NULL;
}

void msh_read_entities(struct msh_reader *r)
{
    int64_t counts[4];
    if (!r->msh4 || r->has[MSH_ELEMENTS]) {
        msh_fail(r, r->msh4 ? "stands behind $Elements" : "has no place in MSH 2");
    }
    for (int dim = 0; dim < 4; dim++) {
        counts[dim] = msh_count(r, "number of entities", 10, 36);
    }
    for (int dim = 0; dim < 4; dim++) {
        r->kind = msh_entity_kind(dim);
        for (int64_t i = 0; r->status == STATUS_OK && i < counts[dim]; i++) {
            r->record = i + 1;
            read_entity(r, dim);
        }
    }
    if (r->entity_count > 0) {
        sort_entities(r);
    }
}
