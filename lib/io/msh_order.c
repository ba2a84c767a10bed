#include "io/msh.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Pieces of a second-order element at its midside nodes: places in its list of nodes, in gmsh's order. */
struct pattern {
    int type;  /* of the whole */
    int piece; /* type of the pieces */
    int count;
    int8_t node[8][8];
};

static const struct pattern patterns[] = {
    {8, 1, 2, {{0, 2}, {2, 1}}},
    {9, 2, 4, {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}},
    {16, 2, 6, {{0, 4, 7}, {4, 1, 5}, {5, 2, 6}, {6, 3, 7}, {4, 5, 6}, {4, 6, 7}}},
    {10, 3, 4, {{0, 4, 8, 7}, {4, 1, 5, 8}, {8, 5, 2, 6}, {7, 8, 6, 3}}},
    {11,
     4,
     8,
     {{0, 4, 6, 7},
      {4, 1, 5, 9},
      {6, 5, 2, 8},
      {7, 9, 8, 3},
      {4, 8, 5, 6},
      {4, 8, 6, 7},
      {4, 8, 7, 9},
      {4, 8, 9, 5}}},
    {12,
     5,
     8,
     {{0, 8, 20, 9, 10, 21, 26, 22},
      {8, 1, 11, 20, 21, 12, 23, 26},
      {20, 11, 2, 13, 26, 23, 14, 24},
      {9, 20, 13, 3, 22, 26, 24, 15},
      {10, 21, 26, 22, 4, 16, 25, 17},
      {21, 12, 23, 26, 16, 5, 18, 25},
      {26, 23, 14, 24, 25, 18, 6, 19},
      {22, 26, 24, 15, 17, 25, 19, 7}}},
};

static const struct pattern *find_pattern(int type)
{
    for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
        if (patterns[i].type == type) {
            return &patterns[i];
        }
    }
    return NULL;
}

/* The elements that take the place of those of an msh. */
struct elements {
    int64_t count;
    int64_t *tag;
    int8_t *type;
    int64_t *node_ptr;
    int32_t *node_idx;
    int64_t *member_ptr;
    int32_t *member_idx;
};

static enum status elements_new(struct elements *to, int64_t count, int64_t nodes, int64_t members,
                                struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&to->tag, count, error));
    TRY(NEW_ARRAY(&to->type, count, error));
    TRY(NEW_ARRAY(&to->node_ptr, count + 1, error));
    TRY(NEW_ARRAY(&to->node_idx, nodes, error));
    TRY(NEW_ARRAY(&to->member_ptr, count + 1, error));
    TRY(NEW_ARRAY(&to->member_idx, members, error));
done:
    return status;
}

/* Append an element of that type with the nodes whole[place[0]], ...; of the groups of element e of *msh. */
static void append(struct elements *to, struct msh *msh, int64_t e, int type, const int8_t place[])
{
    const int32_t *whole = &msh->node_idx[msh->node_ptr[e]];
    int64_t at = to->count++;
    int count = msh_type(type).node_count;
    to->tag[at] = msh->element_tag[e];
    to->type[at] = (int8_t)type;
    to->node_ptr[at + 1] = to->node_ptr[at];
    for (int k = 0; k < count; k++) {
        to->node_idx[to->node_ptr[at + 1]++] = whole[place != NULL ? place[k] : k];
    }
    to->member_ptr[at + 1] = to->member_ptr[at];
    for (int64_t k = msh->member_ptr[e]; k < msh->member_ptr[e + 1]; k++) {
        to->member_idx[to->member_ptr[at + 1]++] = msh->member_idx[k];
        msh->groups[msh->member_idx[k]].element_count++;
    }
}

/* Room for the pieces; an error for elements that cannot be split. */
static enum status count_pieces(const struct msh *msh, bool use, int64_t *count, int64_t *nodes,
                                int64_t *members, struct error *error)
{
    for (int64_t e = 0; e < msh->element_count; e++) {
        struct msh_type type = msh_type(msh->element_type[e]);
        const struct pattern *pattern = use ? find_pattern(msh->element_type[e]) : NULL;
        int pieces = pattern != NULL ? pattern->count : 1;
        if (use && pattern == NULL && type.linear != msh->element_type[e]) {
            return fail(error, STATUS_INPUT,
                        "element %lld, a %s, cannot be split at its midside nodes: leave --midside away",
                        (long long)msh->element_tag[e], type.name);
        }
        *count += pieces;
        *nodes += pieces * msh_type(pattern != NULL ? pattern->piece : type.linear).node_count;
        *members += pieces * (msh->member_ptr[e + 1] - msh->member_ptr[e]);
    }
    return STATUS_OK;
}

static void swap_elements(struct msh *msh, struct elements *from)
{
    struct elements old = {msh->element_count, msh->element_tag, msh->element_type, msh->node_ptr,
                           msh->node_idx,      msh->member_ptr,  msh->member_idx};
    msh->element_count = from->count;
    msh->element_tag = from->tag;
    msh->element_type = from->type;
    msh->node_ptr = from->node_ptr;
    msh->node_idx = from->node_idx;
    msh->member_ptr = from->member_ptr;
    msh->member_idx = from->member_idx;
    *from = old;
}

/* Count the midside nodes that are no corner of another element; with `drop`, take them out. */
static enum status midside_nodes(struct msh *msh, bool drop, int64_t *midside, struct error *error)
{
    enum status status;
    enum { FREE, MIDSIDE, CORNER };
    int8_t *role = NULL;
    int32_t *number = NULL;
    int64_t kept = 0;
    TRY(NEW_ARRAY(&role, msh->node_count, error));
    TRY(NEW_ARRAY(&number, msh->node_count, error));
    for (int64_t e = 0; e < msh->element_count; e++) {
        int corners = msh_type(msh_type(msh->element_type[e]).linear).node_count;
        for (int64_t k = msh->node_ptr[e]; k < msh->node_ptr[e + 1]; k++) {
            int8_t *of_node = &role[msh->node_idx[k]];
            if (k < msh->node_ptr[e] + corners) {
                *of_node = CORNER;
            } else if (*of_node == FREE) {
                *of_node = MIDSIDE;
            }
        }
    }
    for (int64_t n = 0; n < msh->node_count; n++) {
        *midside += role[n] == MIDSIDE;
        number[n] = (int32_t)kept;
        if (drop && role[n] != MIDSIDE) {
            memmove(&msh->x[3 * kept], &msh->x[3 * n], 3 * sizeof *msh->x);
            msh->node_tag[kept] = msh->node_tag[n];
            kept++;
        }
    }
    if (drop) {
        msh->node_count = kept;
        for (int64_t k = 0; k < msh->node_ptr[msh->element_count]; k++) {
            msh->node_idx[k] = number[msh->node_idx[k]];
        }
    }
done:
    free(role);
    free(number);
    return status;
}

enum status msh_make_linear(struct msh *msh, bool use, int64_t *midside, struct error *error)
{
    enum status status = STATUS_OK;
    struct elements to = {0};
    int64_t count = 0;
    int64_t nodes = 0;
    int64_t members = 0;
    bool linear = true;
    *midside = 0;
    for (int64_t e = 0; e < msh->element_count; e++) {
        linear = linear && msh_type(msh->element_type[e]).linear == msh->element_type[e];
    }
    if (linear) {
        return STATUS_OK;
    }
    TRY(count_pieces(msh, use, &count, &nodes, &members, error));
    TRY(midside_nodes(msh, !use, midside, error));
    TRY(elements_new(&to, count, nodes, members, error));
    for (int32_t g = 0; g < msh->group_count; g++) {
        msh->groups[g].element_count = 0;
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        const struct pattern *pattern = use ? find_pattern(msh->element_type[e]) : NULL;
        for (int p = 0; pattern != NULL && p < pattern->count; p++) {
            append(&to, msh, e, pattern->piece, pattern->node[p]);
        }
        if (pattern == NULL) {
            append(&to, msh, e, msh_type(msh->element_type[e]).linear, NULL);
        }
    }
    swap_elements(msh, &to);
done:
    free(to.tag);
    free(to.type);
    free(to.node_ptr);
    free(to.node_idx);
    free(to.member_ptr);
    free(to.member_idx);
    return status;
}
