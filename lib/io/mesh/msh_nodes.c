/* Reading $Nodes. */
#include "io/mesh/msh_private.h"

#include <string.h>

enum { EACH_NODE = -1 }; /* the node tells the number of its parameters */

/* $ParametricNodes of MSH 2 give each node its entity, and the parameters on curves and surfaces. */
static int64_t parameters_of_node(struct msh_reader *r)
{
    int64_t dim = msh_int(r, "dimension of the entity", -1, 3);
    (void)msh_int(r, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    return dim == 1 || dim == 2 ? dim : 0;
}

static void read_point(struct msh_reader *r, int64_t parameters, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = msh_real(r, "coordinate");
    }
    parameters = parameters == EACH_NODE ? parameters_of_node(r) : parameters;
    for (int64_t k = 0; k < parameters; k++) {
        (void)msh_real(r, "parameter");
    }
}

/* A block of nodes: all nodes of a file of MSH 2, those of one entity in MSH 4. */
struct block {
    int64_t first, count;
    int64_t parameters;  /* number of parametric coordinates of each node, which are not used, or EACH_NODE */
    int64_t least, most; /* bounds of the tags */
};

/* In MSH 4 all tags come before all points, else each before its point. */
static void read_block(struct msh_reader *r, const struct block *block)
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

static void read_block_head(struct msh_reader *r, struct block *block, int64_t count)
{
    int64_t dim;
    (void)msh_read_entity_tag(r, &dim);
    block->parameters = msh_int(r, "parametric", 0, 1) == 1 ? dim : 0;
    block->count = msh_count(r, "number of nodes", 8, 28);
    if (block->count > count - block->first) {
        msh_fail(r, "more nodes than the %lld that the section's head says", (long long)count);
    }
}

void msh_read_nodes(struct msh_reader *r)
{
    struct block block = {.least = 1,
                          .most = MSH_LARGEST_TAG,
                          .parameters = strcmp(r->section, "$ParametricNodes") == 0 ? EACH_NODE : 0};
    r->kind = "node";
    int64_t blocks = r->msh4 ? msh_count(r, "number of blocks", 8, 20) : 1;
    int64_t count =
        r->msh4 ? msh_count(r, "number of nodes", 8, 28) : msh_count_line(r, "number of nodes", 8);
    if (r->msh4) {
        block.least = msh_size(r, "smallest tag", count > 0, MSH_LARGEST_TAG);
        block.most = msh_size(r, "largest tag", count > 0, MSH_LARGEST_TAG);
    }
    for (int64_t b = 0; r->status == STATUS_OK && b < blocks; b++) {
        block.count = count;
        if (r->msh4) {
            read_block_head(r, &block, count);
        }
        read_block(r, &block);
        block.first += block.count;
    }
    if (block.first != count) {
        r->record = 0;
        msh_fail(r, "%lld nodes, not the %lld that the section's head says", (long long)block.first,
                 (long long)count);
    }
    msh_check_nodes(r);
}
