/* The sections of a mesh of gmsh: names of physical groups, groups of entities, nodes, elements. */
#include "io/mesh/msh_private.h"

#include "base/lists.h"

#include <stdlib.h>
#include <string.h>

/* Most groups of an entity: its elements are so many times as many. */
#define MOST_GROUPS 16

/* ---- $PhysicalNames ---- */

static void read_name(struct msh_reader *r)
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
    while (text + length < r->end && strchr("\"\n", text[length]) == NULL && length <= INPUT_NAME) {
        length++;
    }
    if (text + length == r->end || text[length] != '"' || length == 0) {
        msh_fail(r, "the name is empty, unfinished or longer than %d bytes", INPUT_NAME);
        return;
    }
    if (r->status == STATUS_OK) {
        r->names[r->name_count++] = (struct msh_name){msh_key(dim, tag), text, length};
    }
    r->at = text + length + 1;
    msh_skip_line(r);
}

/* This section is text also in binary files. */
void msh_read_names(struct msh_reader *r)
{
    bool binary = r->binary;
    r->binary = false;
    r->kind = "name";
    int64_t count = msh_size(r, "number of names", 0, INT64_MAX);
    while (r->status == STATUS_OK && r->name_count < count) {
        MSH_GROW(r, &r->names, r->name_count + 1, &r->name_room);
        r->record = r->name_count + 1;
        read_name(r);
    }
    r->binary = binary;
}

/* ---- $Entities ---- */

const char *msh_entity_kind(int dim)
{
    static const char *const kinds[] = {"point", "curve", "surface", "volume"};
    return kinds[dim];
}

/* Dimension and tag of the entity at the head of a block of nodes or elements in MSH 4. */
static int64_t read_entity_tag(struct msh_reader *r, int64_t *dim)
{
    *dim = msh_int(r, "dimension", 0, 3);
    return msh_int(r, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
}

/* Skip the tags of the entities that bound an entity, which follow its box. */
static void skip_tags(struct msh_reader *r, const char *what)
{
    int64_t count = msh_size(r, what, 0, INT64_MAX);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        (void)msh_int(r, what, -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    }
}

/* Read the physical groups of an entity. A tag is negative if the group reverses the orientation. */
static void read_physicals(struct msh_reader *r, int dim, struct msh_entity entity)
{
    int64_t count = msh_size(r, "physical groups", 0, INT64_MAX);
    if (count > MOST_GROUPS) {
        msh_fail(r, "%jd physical groups are more than %d", count, MOST_GROUPS);
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

/* The groups of an entity, *count of them; NULL: it is not in the file. */
static const struct msh_entity *find_entity(const struct msh_reader *r, int64_t key, int64_t *count)
{
    const struct msh_entity first = {.key = key, .group = INT64_MIN};
    int64_t low = lower_bound(&first, r->entities, r->entity_count, sizeof first, compare_entities);
    int64_t high = low;
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
        counts[dim] = msh_size(r, "number of entities", 0, INT64_MAX);
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

/* ---- $Nodes ---- */

enum { EACH_NODE = -1 }; /* the node tells the number of its parameters */

static void read_point(struct msh_reader *r, int64_t parameters, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = msh_real(r, "coordinate");
    }
    if (parameters == EACH_NODE) { /* $ParametricNodes of MSH 2: on curves and surfaces */
        parameters = msh_int(r, "dimension of the entity", -1, 3);
        parameters = parameters == 1 || parameters == 2 ? parameters : 0;
        (void)msh_int(r, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    }
    for (int64_t k = 0; k < parameters; k++) {
        (void)msh_real(r, "parameter");
    }
}

/* A block of nodes: all nodes of a file of MSH 2, those of one entity in MSH 4. */
struct node_block {
    int64_t first, count;
    int64_t parameters;  /* number of parametric coordinates of each node, which are not used, or EACH_NODE */
    int64_t least, most; /* bounds of the tags */
};

/* In MSH 4 all tags come before all points, else each before its point. */
static void read_node_block(struct msh_reader *r, const struct node_block *block)
{
    double x[3] = {0};
    int64_t end = block->first + block->count;
    for (int64_t n = block->first; r->status == STATUS_OK && n < end; n++) {
        r->record = n + 1;
        int64_t tag = msh_tag(r, "tag", block->least, block->most);
        if (!r->msh4) {
            read_point(r, block->parameters, x);
        }
        msh_add_node(r, tag, x);
    }
    for (int64_t n = block->first; r->msh4 && r->status == STATUS_OK && n < end; n++) {
        r->record = n + 1;
        read_point(r, block->parameters, r->msh->nodes[n].x);
    }
}

static void read_node_head(struct msh_reader *r, struct node_block *block, int64_t count)
{
    int64_t dim;
    (void)read_entity_tag(r, &dim);
    block->parameters = msh_int(r, "parametric", 0, 1) == 1 ? dim : 0;
    block->count = msh_size(r, "number of nodes", 0, INT64_MAX);
    if (block->count > count - block->first) {
        msh_fail(r, "more nodes than the %jd that the section's head says", count);
    }
}

void msh_read_nodes(struct msh_reader *r)
{
    struct node_block block = {.least = 1,
                               .most = MSH_LARGEST_TAG,
                               .parameters = strcmp(r->section, "$ParametricNodes") == 0 ? EACH_NODE : 0};
    r->kind = "node";
    int64_t blocks = r->msh4 ? msh_size(r, "number of blocks", 0, INT64_MAX) : 1;
    int64_t count =
        r->msh4 ? msh_size(r, "number of nodes", 0, INT64_MAX) : msh_count_line(r, "number of nodes");
    if (r->msh4) {
        block.least = msh_size(r, "smallest tag", count > 0, MSH_LARGEST_TAG);
        block.most = msh_size(r, "largest tag", count > 0, MSH_LARGEST_TAG);
    }
    for (int64_t b = 0; r->status == STATUS_OK && b < blocks; b++) {
        block.count = count;
        if (r->msh4) {
            read_node_head(r, &block, count);
        }
        read_node_block(r, &block);
        block.first += block.count;
    }
    if (block.first != count) {
        r->record = 0;
        msh_fail(r, "%jd nodes, not the %jd that the section's head says", block.first, count);
    }
    msh_check_tags(r, &r->nodes);
}

/* ---- $Elements ---- */

/* Most tags of an element of MSH 2: group, entity, and partitions. */
#define MOST_TAGS 256

struct msh_type msh_type(int64_t number)
{
    static const struct msh_type types[] = {
        {NULL, 0, 0, 0},
        {"line", 1, 2, 1},
        {"triangle", 2, 3, 2},
        {"quadrangle", 2, 4, 3},
        {"tetrahedron", 3, 4, 4},
        {"hexahedron", 3, 8, 5},
        {"prism", 3, 6, 6},
        {"pyramid", 3, 5, 7},
        {"line of 3 nodes", 1, 3, 1},
        {"triangle of 6 nodes", 2, 6, 2},
        {"quadrangle of 9 nodes", 2, 9, 3},
        {"tetrahedron of 10 nodes", 3, 10, 4},
        {"hexahedron of 27 nodes", 3, 27, 5},
        {"prism of 18 nodes", 3, 18, 6},
        {"pyramid of 14 nodes", 3, 14, 7},
        {"point", 0, 1, 15},
        {"quadrangle of 8 nodes", 2, 8, 3},
        {"hexahedron of 20 nodes", 3, 20, 5},
        {"prism of 15 nodes", 3, 15, 6},
        {"pyramid of 13 nodes", 3, 13, 7},
    };
    return types[number >= 1 && number < (int64_t)(sizeof types / sizeof *types) ? number : 0];
}

/* Consecutive elements with common data: those of one entity in MSH 4, a block in binary files of MSH 2; else
 * a single element, whose type and number of tags follow its own tag. */
struct block {
    int64_t count;
    int64_t number; /* of the type */
    struct msh_type type;
    int64_t entity; /* MSH 4: its key, and its groups */
    int64_t group_count;
    const struct msh_entity *groups;
    int64_t tags; /* MSH 2: number of tags that follow: group, entity, partitions */
};

static void read_type(struct msh_reader *r, struct block *block)
{
    block->number = msh_int(r, "type", 0, INT32_MAX);
    block->type = msh_type(block->number);
    if (block->type.name == NULL) {
        msh_fail(r, "type %jd is no element of first or second order: mesh with order 1 (gmsh -order 1)",
                 block->number);
    }
}

static void read_block_head(struct msh_reader *r, struct block *block, int64_t left, int64_t all)
{
    int64_t dim;
    if (r->msh4) {
        int64_t tag = read_entity_tag(r, &dim);
        block->entity = msh_key(dim, tag);
        block->groups = find_entity(r, block->entity, &block->group_count);
        if (block->groups == NULL && r->entity_count > 0) {
            msh_fail(r, "is on %s %jd, which is not in $Entities", msh_entity_kind((int)dim), tag);
        }
        read_type(r, block);
        block->count = msh_size(r, "number of elements", 0, INT64_MAX);
        if (r->status == STATUS_OK && block->type.dim != dim) {
            msh_fail(r, "a %s on an entity of dimension %jd", block->type.name, dim);
        }
        if (block->count > left) {
            msh_fail(r, "more elements than the %jd that the section's head says", all);
        }
    } else if (r->binary) {
        read_type(r, block);
        block->count = msh_int(r, "number of elements in a block", 1, left);
        block->tags = msh_int(r, "number of tags", 0, MOST_TAGS);
    } else {
        block->count = 1;
    }
}

/* The tags of an element of MSH 2: the first is its physical group, negative if that reverses it; the
 * second its entity. Both are of the dimension of its type. */
static void read_tags(struct msh_reader *r, const struct block *block, int64_t *key, int64_t *entity)
{
    for (int64_t k = 0; k < block->tags; k++) {
        int64_t tag = msh_int(r, "tag", k == 1 ? 0 : -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
        if (k == 0 && tag != 0) {
            *key = msh_key(block->type.dim, tag < 0 ? -tag : tag);
        } else if (k == 1) {
            *entity = msh_key(block->type.dim, tag);
        }
    }
}

static void read_element(struct msh_reader *r, struct block *block)
{
    int64_t node[MSH_MOST_NODES] = {0}, key = 0, entity = block->entity;
    int64_t tag = msh_tag(r, "tag", 1, MSH_LARGEST_TAG);
    if (!r->msh4 && !r->binary) {
        read_type(r, block);
        block->tags = msh_int(r, "number of tags", 0, MOST_TAGS);
    }
    read_tags(r, block, &key, &entity);
    for (int k = 0; k < block->type.node_count; k++) {
        node[k] = msh_tag(r, "node", INT64_MIN, INT64_MAX);
    }
    for (int64_t g = 0; g == 0 || g < block->group_count; g++) {
        key = block->group_count > 0 ? block->groups[g].group : key;
        msh_add_element(r, g == 0 ? tag : MSH_NO_TAG, (int)block->number, node, key);
        if (r->status == STATUS_OK) {
            r->msh->elements[r->msh->element_count - 1].entity = entity;
        }
    }
}

void msh_read_elements(struct msh_reader *r)
{
    bool blocked = r->msh4;
    int64_t found = 0;
    r->kind = "element";
    if (!r->has[MSH_NODES]) {
        msh_fail(r, "stands before $Nodes");
    }
    int64_t blocks = blocked ? msh_size(r, "number of blocks", 0, INT64_MAX) : INT64_MAX;
    int64_t count =
        blocked ? msh_size(r, "number of elements", 0, INT64_MAX) : msh_count_line(r, "number of elements");
    for (int k = 0; k < 2 && blocked; k++) {
        (void)msh_size(r, "range of tags", 0, MSH_LARGEST_TAG);
    }
    for (int64_t b = 0; r->status == STATUS_OK && b < blocks && (blocked || found < count); b++) {
        struct block block = {0};
        r->record = found + 1;
        read_block_head(r, &block, count - found, count);
        for (int64_t end = found + block.count; r->status == STATUS_OK && found < end;) {
            r->record = ++found;
            read_element(r, &block);
        }
    }
    if (found != count) {
        r->record = 0;
        msh_fail(r, "%jd elements, not the %jd that the section's head says", found, count);
    }
    if (r->status == STATUS_OK) {
        msh_check_tags(r, &r->elements);
    }
}
