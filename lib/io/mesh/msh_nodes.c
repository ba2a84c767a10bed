#include "base/lists.h"
#include "base/memory.h"
#include "io/mesh/msh_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- finding nodes and elements by their tags ---- */

void msh_index_make(struct msh_reader *r, struct msh_index *index, int64_t count, const int64_t tags[])
{
    *index = (struct msh_index){.count = count};
    MSH_NEW(r, &index->sorted, count);
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        index->sorted[i] = (struct msh_place){tags[i], i};
    }
    if (r->status == STATUS_OK) {
        qsort(index->sorted, (size_t)count, sizeof *index->sorted, compare_int64);
    }
    for (int64_t i = 1; r->status == STATUS_OK && i < count; i++) {
        if (index->sorted[i].tag == index->sorted[i - 1].tag) {
            const char *kind = r->kind;
            int64_t a = index->sorted[i - 1].place, b = index->sorted[i].place;
            r->kind = "line";
            r->record = r->line != NULL ? r->line[a > b ? a : b] : 0;
            msh_fail(r, "%s tag %lld stands twice", kind, (long long)index->sorted[i].tag);
        }
    }
}

int64_t msh_index_find(const struct msh_index *index, int64_t tag)
{
    int64_t near = index->count > 0 ? tag - index->sorted[0].tag : -1;
    if (near >= 0 && near < index->count && index->sorted[near].tag == tag) { /* as if there were no gap */
        return index->sorted[near].place;
    }
    struct msh_place key = {.tag = tag};
    const struct msh_place *found =
        bsearch(&key, index->sorted, (size_t)index->count, sizeof key, compare_int64);
    return found != NULL ? found->place : -1;
}

void msh_index_free(struct msh_index *index)
{
    free(index->sorted);
    *index = (struct msh_index){0};
}

/* ---- $Nodes ---- */

enum { EACH_NODE = -1 }; /* the node tells the number of its parameters */

/* $ParametricNodes of MSH 2 give each node its entity, and the parameters on curves and surfaces. */
static int64_t parameters_of_node(struct msh_reader *r)
{
    int64_t dim = msh_int(r, "dimension of the entity", -1, 3);
    (void)msh_int(r, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG);
    return dim == 1 || dim == 2 ? dim : 0;
}

static void read_point(struct msh_reader *r, int64_t node, int64_t parameters)
{
    r->record = node + 1;
    for (int k = 0; k < 3; k++) {
        double x = msh_real(r, "coordinate");
        if (!isfinite(x)) {
            msh_fail(r, "coordinate %d is not finite", k + 1);
        }
        r->msh->x[3 * node + k] = x;
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
    bool apart = r->msh4;
    int64_t end = block->first + block->count;
    for (int64_t n = block->first; r->status == STATUS_OK && n < end; n++) {
        r->record = n + 1;
        r->msh->node_tag[n] = msh_tag(r, "tag", block->least, block->most);
        if (!apart) {
            read_point(r, n, block->parameters);
        }
    }
    for (int64_t n = block->first; apart && r->status == STATUS_OK && n < end; n++) {
        read_point(r, n, block->parameters);
    }
}

static void read_block_head(struct msh_reader *r, struct block *block)
{
    int64_t dim;
    (void)msh_read_entity_tag(r, &dim);
    block->parameters = msh_int(r, "parametric", 0, 1) == 1 ? dim : 0;
    block->count = msh_count(r, "number of nodes", 8, 28);
    if (block->count > r->msh->node_count - block->first) {
        msh_fail(r, "more nodes than the %lld that the section's head says", (long long)r->msh->node_count);
    }
}

void msh_read_nodes(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    bool blocked = r->msh4;
    struct block block = {.least = 1,
                          .most = MSH_LARGEST_TAG,
                          .parameters = strcmp(r->section, "$ParametricNodes") == 0 ? EACH_NODE : 0};
    r->kind = "node";
    int64_t blocks = blocked ? msh_count(r, "number of blocks", 8, 20) : 1;
    int64_t count =
        blocked ? msh_count(r, "number of nodes", 8, 28) : msh_count_line(r, "number of nodes", 8);
    if (blocked) {
        block.least = msh_size(r, "smallest tag", count > 0, MSH_LARGEST_TAG);
        block.most = msh_size(r, "largest tag", count > 0, MSH_LARGEST_TAG);
    }
    msh->node_count = count;
    MSH_NEW(r, &msh->x, 3 * count);
    MSH_NEW(r, &msh->node_tag, count);
    for (int64_t b = 0; r->status == STATUS_OK && b < blocks; b++) {
        block.count = count;
        if (blocked) {
            read_block_head(r, &block);
        }
        read_block(r, &block);
        block.first += block.count;
    }
    if (block.first != count) {
        r->record = 0;
        msh_fail(r, "%lld nodes, not the %lld that the section's head says", (long long)block.first,
                 (long long)count);
    }
    if (r->status == STATUS_OK) {
        msh_index_make(r, &r->nodes, count, msh->node_tag);
    }
}
