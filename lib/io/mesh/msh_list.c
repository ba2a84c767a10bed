/* The nodes and elements of a mesh file, as they are read, and finding them by their tags. */
#include "base/lists.h"
#include "base/memory.h"
#include "io/mesh/msh_private.h"

#include <stdlib.h>
#include <string.h>

void msh_add_node(struct msh_reader *r, int64_t tag, const double x[3])
{
    struct msh *msh = r->msh;
    MSH_GROW(r, &msh->nodes, msh->node_count + 1, &r->node_room);
    if (r->status == STATUS_OK) {
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
        msh->elements[msh->element_count++] =
            (struct msh_element){.tag = tag, .first = r->corner_count, .key = key, .type = (int8_t)type};
        memcpy(&r->corners[r->corner_count], node, (size_t)count * sizeof *node);
        r->corner_count += count;
    }
}

/* ---- finding them by their tags ---- */

/* Index the tags, but MSH_NO_TAG, that begin `count` records of `size` bytes. Returns the place of one whose
 * tag stands before it, too; -1: there is none. */
static int64_t make_index(struct msh_reader *r, struct msh_index *index, int64_t count, const void *records,
                          size_t size)
{
    *index = (struct msh_index){0};
    MSH_NEW(r, &index->sorted, count);
    if (r->status != STATUS_OK) {
        return -1;
    }
    for (int64_t i = 0; i < count; i++) {
        struct msh_place *next = &index->sorted[index->count];
        memcpy(&next->tag, (const char *)records + (size_t)i * size, sizeof(int64_t));
        next->place = i;
        index->count += next->tag != MSH_NO_TAG;
    }
    count = index->count;
    qsort(index->sorted, (size_t)count, sizeof *index->sorted, compare_int64);
    for (int64_t i = 1; i < count; i++) {
        int64_t a = index->sorted[i - 1].place, b = index->sorted[i].place;
        if (index->sorted[i].tag == index->sorted[i - 1].tag) {
            return a > b ? a : b;
        }
    }
    return -1;
}

void msh_index_nodes(struct msh_reader *r)
{
    const struct msh_node *nodes = r->msh->nodes;
    if (r->status != STATUS_OK || r->nodes.sorted != NULL) {
        return;
    }
    int64_t again = make_index(r, &r->nodes, r->msh->node_count, nodes, sizeof *nodes);
    if (again >= 0) {
        r->record = nodes[again].record;
        msh_fail(r, "node tag %lld stands twice", (long long)nodes[again].tag);
    }
}

void msh_index_elements(struct msh_reader *r, struct msh_index *index)
{
    const struct msh_element *elements = r->msh->elements;
    int64_t again = make_index(r, index, r->msh->element_count, elements, sizeof *elements);
    if (again >= 0) {
        r->record = 0;
        msh_fail(r, "element tag %lld stands twice", (long long)elements[again].tag);
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
        msh_fail(r, "element %lld names the node %lld, which is not in the file", (long long)element->tag,
                 (long long)node);
    } else {
        msh_fail(r, "the set or surface '%.*s' names the node %lld, which is not in the file", length, name,
                 (long long)node);
    }
}

void msh_finish_lists(struct msh_reader *r)
{
    struct msh *msh = r->msh;
    int64_t tag = 0;
    msh_index_nodes(r);
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
