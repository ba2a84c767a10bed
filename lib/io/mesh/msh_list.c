/* The nodes and elements of a mesh file, as they are read, and finding them by their tags. */
#include "base/lists.h"
#include "io/mesh/msh_private.h"

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

void msh_check_nodes(struct msh_reader *r)
{
    int64_t again = find_twice(&r->nodes);
    if (again >= 0) {
        r->record = r->msh->nodes[again].record;
        msh_fail(r, "node tag %jd stands twice", r->msh->nodes[again].tag);
    }
}

void msh_check_elements(struct msh_reader *r)
{
    int64_t again = find_twice(&r->elements);
    if (again >= 0) {
        r->record = 0;
        msh_fail(r, "element tag %jd stands twice", r->msh->elements[again].tag);
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
    msh_check_nodes(r);
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
