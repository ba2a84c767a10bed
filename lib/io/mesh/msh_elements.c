#include "io/mesh/msh_private.h"

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
        msh_fail(r, "type %lld is no element of first or second order: mesh with order 1 (gmsh -order 1)",
                 (long long)block->number);
    }
}

static void read_block_head(struct msh_reader *r, struct block *block, int64_t left, int64_t all)
{
    int64_t dim;
    if (r->msh4) {
        int64_t tag = msh_read_entity_tag(r, &dim);
        block->entity = msh_key(dim, tag);
        block->groups = msh_find_entity(r, block->entity, &block->group_count);
        if (block->groups == NULL && r->entity_count > 0) {
            msh_fail(r, "is on %s %lld, which is not in $Entities", msh_entity_kind((int)dim),
                     (long long)tag);
        }
        read_type(r, block);
        block->count = msh_count(r, "number of elements", 4, 16);
        if (r->status == STATUS_OK && block->type.dim != dim) {
            msh_fail(r, "a %s on an entity of dimension %lld", block->type.name, (long long)dim);
        }
        if (block->count > left) {
            msh_fail(r, "more elements than the %lld that the section's head says", (long long)all);
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
    int64_t blocks = blocked ? msh_count(r, "number of blocks", 8, 20) : INT64_MAX;
    int64_t count =
        blocked ? msh_count(r, "number of elements", 4, 8) : msh_count_line(r, "number of elements", 8);
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
        msh_fail(r, "%lld elements, not the %lld that the section's head says", (long long)found,
                 (long long)count);
    }
    if (r->status == STATUS_OK) {
        msh_check_elements(r);
    }
}
