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
    int64_t key;  /* of the entity, MSH 4 */
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

static void read_block_head(struct msh_reader *r, struct block *block, int64_t left)
{
    int64_t dim;
    if (r->msh4) {
        int64_t tag = msh_read_entity_tag(r, &dim);
        block->key = msh_key(dim, tag);
        read_type(r, block);
        block->count = msh_count(r, "number of elements", 4, 16);
        if (r->status == STATUS_OK && block->type.dim != dim) {
            msh_fail(r, "a %s on an entity of dimension %lld", block->type.name, (long long)dim);
        }
        if (block->count > left) {
            msh_fail(r, "more elements than the %lld that the section's head says",
                     (long long)r->msh->element_count);
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
static void read_tags(struct msh_reader *r, int64_t e, const struct block *block)
{
    for (int64_t k = 0; k < block->tags; k++) {
        int64_t tag = msh_int(r, "tag", k == 1 ? 0 : -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
        if (k == 0 && tag != 0) {
            r->element_key[e] = msh_key(block->type.dim, tag < 0 ? -tag : tag);
        } else if (k == 1) {
            r->entity_key[e] = msh_key(block->type.dim, tag);
        }
    }
}

static void read_element_nodes(struct msh_reader *r, int64_t e, const struct block *block)
{
    struct msh *msh = r->msh;
    int64_t first = msh->node_ptr[e];
    msh->node_ptr[e + 1] = first + block->type.node_count;
    MSH_GROW(r, &msh->node_idx, msh->node_ptr[e + 1], &r->node_idx_room);
    for (int64_t k = first; r->status == STATUS_OK && k < msh->node_ptr[e + 1]; k++) {
        int64_t node = msh_tag(r, "node", INT64_MIN, INT64_MAX);
        int64_t place = msh_index_find(&r->nodes, node);
        msh->node_idx[k] = (int32_t)place;
        if (place < 0) {
            msh_fail(r, "element %lld names the node %lld, which is not in $Nodes",
                     (long long)msh->element_tag[e], (long long)node);
        }
    }
}

static void read_element(struct msh_reader *r, int64_t e, struct block *block)
{
    struct msh *msh = r->msh;
    r->record = e + 1;
    msh->element_tag[e] = msh_tag(r, "tag", 1, MSH_LARGEST_TAG);
    if (!r->msh4 && !r->binary) {
        read_type(r, block);
        block->tags = msh_int(r, "number of tags", 0, MOST_TAGS);
    }
    if (!r->msh4) {
        read_tags(r, e, block);
    } else {
        r->element_key[e] = r->entity_key[e] = block->key;
    }
    msh->element_type[e] = (int8_t)block->number;
    if (r->status == STATUS_OK) {
        read_element_nodes(r, e, block);
    }
}

void msh_read_elements(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    FREED_BY(msh_index_free) struct msh_index tags = {0};
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
    msh->element_count = count;
    MSH_NEW(r, &msh->element_tag, count);
    MSH_NEW(r, &msh->element_type, count);
    MSH_NEW(r, &msh->node_ptr, count + 1);
    MSH_NEW(r, &r->element_key, count);
    MSH_NEW(r, &r->entity_key, count);
    for (int64_t b = 0; r->status == STATUS_OK && b < blocks && (blocked || found < count); b++) {
        struct block block = {0};
        r->record = found + 1;
        read_block_head(r, &block, count - found);
        for (int64_t end = found + block.count; r->status == STATUS_OK && found < end; found++) {
            read_element(r, found, &block);
        }
    }
    if (found != count) {
        r->record = 0;
        msh_fail(r, "%lld elements, not the %lld that the section's head says", (long long)found,
                 (long long)count);
    }
    if (r->status == STATUS_OK) {
        msh_index_make(r, &tags, count, msh->element_tag);
    }
}
