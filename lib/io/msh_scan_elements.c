#include "base/memory.h"
#include "io/msh.h"
#include "io/msh_scan_parts.h"

#include <stdio.h>

/* Of an element of MSH 2: its group, its entity, and its partitions. */
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

static enum status check_type(struct msh_cursor *cursor, int64_t type)
{
    if (msh_type(type).name == NULL) {
        return msh_cursor_fail(cursor,
                               "type %lld is no element of first or second order: mesh with order 1 "
                               "(gmsh -order 1)",
                               (long long)type);
    }
    return STATUS_OK;
}

static enum status scan_element_nodes(struct msh_scan *scan, struct msh_cursor *cursor, int64_t type)
{
    enum status status = STATUS_OK;
    int64_t node = 0;
    for (int k = 0; k < msh_type(type).node_count; k++) {
        TRY(scan->version == 41 ? msh_next_size(cursor, "node", INT64_MIN, INT64_MAX, &node)
                                : msh_next_int(cursor, "node", INT64_MIN, INT64_MAX, &node));
        if (msh_index_find(&scan->nodes, node) < 0) {
            status = msh_cursor_fail(cursor, "element %lld names the node %lld, which is not in $Nodes",
                                     (long long)scan->element_tag[cursor->record - 1], (long long)node);
            goto done;
        }
    }
done:
    return status;
}

/* The tags of an element of MSH 2: physical group, entity, number of partitions and these. */
static enum status scan_element_tags(struct msh_scan *scan, struct msh_cursor *cursor, int64_t count)
{
    enum status status = STATUS_OK;
    int64_t tag = 0;
    for (int64_t k = 0; k < count; k++) {
        TRY(msh_next_int(cursor, "tag", k == 1 ? 0 : -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &tag));
        if (k == 0) { /* negative where the element's orientation is reversed */
            scan->element_group[cursor->record - 1] = (int32_t)(tag < 0 ? -tag : tag);
        }
        scan->partitioned = scan->partitioned || k >= 2;
    }
done:
    return status;
}

static enum status scan_elements2_ascii(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    for (int64_t i = 0; i < scan->element_count; i++) {
        int64_t type = 0;
        int64_t tags = 0;
        cursor->record = i + 1;
        TRY(msh_next_int(cursor, "tag", 1, MSH_LARGEST_TAG, &scan->element_tag[i]));
        TRY(msh_next_int(cursor, "type", 0, INT32_MAX, &type));
        TRY(check_type(cursor, type));
        TRY(msh_next_int(cursor, "number of tags", 0, MOST_TAGS, &tags));
        scan->element_type[i] = (int8_t)type;
        TRY(scan_element_tags(scan, cursor, tags));
        TRY(scan_element_nodes(scan, cursor, type));
    }
done:
    return status;
}

static enum status scan_elements2_binary(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t type = 0;
    int64_t count = 0;
    int64_t tags = 0;
    for (int64_t first = 0; first < scan->element_count; first += count) {
        cursor->record = first + 1;
        TRY(msh_next_int(cursor, "type", 0, INT32_MAX, &type));
        TRY(check_type(cursor, type));
        TRY(msh_next_int(cursor, "number of elements in a block", 1, scan->element_count - first, &count));
        TRY(msh_next_int(cursor, "number of tags", 0, MOST_TAGS, &tags));
        for (int64_t i = first; i < first + count; i++) {
            cursor->record = i + 1;
            TRY(msh_next_int(cursor, "tag", 1, MSH_LARGEST_TAG, &scan->element_tag[i]));
            scan->element_type[i] = (int8_t)type;
            TRY(scan_element_tags(scan, cursor, tags));
            TRY(scan_element_nodes(scan, cursor, type));
        }
    }
done:
    return status;
}

/* MSH 1: number, type, group, entity, number of nodes and these. */
static enum status scan_elements1(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    for (int64_t i = 0; i < scan->element_count; i++) {
        int64_t type = 0;
        int64_t nodes = 0;
        cursor->record = i + 1;
        TRY(msh_next_int(cursor, "tag", 1, MSH_LARGEST_TAG, &scan->element_tag[i]));
        TRY(msh_next_int(cursor, "type", 0, INT32_MAX, &type));
        TRY(check_type(cursor, type));
        scan->element_type[i] = (int8_t)type;
        TRY(scan_element_tags(scan, cursor, 2));
        nodes = msh_type(type).node_count;
        TRY(msh_next_int(cursor, "number of nodes", nodes, nodes, &nodes));
        TRY(scan_element_nodes(scan, cursor, type));
    }
done:
    return status;
}

/* Give libgmsh the bytes from `from` to the cursor. */
static enum status pass(struct msh_scan *scan, const char *from, const struct msh_cursor *cursor)
{
    return msh_rewrite(scan, MSH_ELEMENTS, from, (size_t)(cursor->at - from), cursor->error);
}

/* Step over numbers that have been looked at before. */
static enum status step(struct msh_cursor *cursor, int64_t count)
{
    enum status status = STATUS_OK;
    int64_t number = 0;
    for (int64_t i = 0; i < count && status == STATUS_OK; i++) {
        status = msh_next_int(cursor, "number", INT64_MIN, INT64_MAX, &number);
    }
    return status;
}

/* The elements again, as libgmsh is given them: those of MSH 1 as MSH 2, and none with partitions. The cursor
 * is at the first. */
static enum status rewrite_ascii(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    for (int64_t i = 0; i < scan->element_count; i++) {
        char text[32];
        int64_t tags = 2;
        const char *from = cursor->at;
        TRY(step(cursor, 2));
        TRY(pass(scan, from, cursor));
        TRY(scan->version == 10 ? STATUS_OK : msh_next_int(cursor, "number of tags", 0, MOST_TAGS, &tags));
        snprintf(text, sizeof text, " %d", tags < 2 ? (int)tags : 2);
        TRY(msh_rewrite_text(scan, MSH_ELEMENTS, text, cursor->error));
        from = cursor->at;
        TRY(step(cursor, tags < 2 ? tags : 2));
        TRY(pass(scan, from, cursor));
        TRY(step(cursor, scan->version == 10 ? 1 : tags < 2 ? 0 : tags - 2));
        from = cursor->at;
        TRY(step(cursor, msh_type(scan->element_type[i]).node_count));
        TRY(pass(scan, from, cursor));
    }
done:
    return status;
}

static enum status rewrite_binary(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t count = 0;
    int64_t tags = 0;
    for (int64_t first = 0; first < scan->element_count; first += count) {
        const char *from = cursor->at;
        TRY(step(cursor, 1));
        TRY(msh_next_int(cursor, "number of elements in a block", 1, scan->element_count - first, &count));
        TRY(pass(scan, from, cursor));
        TRY(msh_next_int(cursor, "number of tags", 0, MOST_TAGS, &tags));
        int32_t kept = tags < 2 ? (int32_t)tags : 2;
        TRY(msh_rewrite(scan, MSH_ELEMENTS, (const char *)&kept, sizeof kept, cursor->error));
        for (int64_t i = 0; i < count; i++) {
            from = cursor->at;
            TRY(step(cursor, 1 + kept));
            TRY(pass(scan, from, cursor));
            TRY(step(cursor, tags - kept));
            from = cursor->at;
            TRY(step(cursor, msh_type(scan->element_type[first + i]).node_count));
            TRY(pass(scan, from, cursor));
        }
    }
done:
    return status;
}

static enum status rewrite_elements(struct msh_scan *scan, struct msh_cursor cursor)
{
    enum status status = STATUS_OK;
    char text[64];
    snprintf(text, sizeof text, "$Elements\n%lld\n", (long long)scan->element_count);
    TRY(msh_rewrite_text(scan, MSH_ELEMENTS, text, cursor.error));
    TRY(scan->binary ? rewrite_binary(scan, &cursor) : rewrite_ascii(scan, &cursor));
    TRY(msh_rewrite_text(scan, MSH_ELEMENTS, "\n$EndElements", cursor.error));
done:
    return status;
}

static enum status new_elements(struct msh_scan *scan, struct error *error)
{
    enum status status = STATUS_OK;
    TRY(NEW_ARRAY(&scan->element_tag, scan->element_count, error));
    TRY(NEW_ARRAY(&scan->element_type, scan->element_count, error));
    if (scan->version < 40) {
        TRY(NEW_ARRAY(&scan->element_group, scan->element_count, error));
    }
done:
    return status;
}

static enum status scan_elements2(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    TRY(msh_next_count_line(cursor, "number of elements", 8, &scan->element_count));
    TRY(new_elements(scan, cursor->error));
    struct msh_cursor first = *cursor;
    TRY(scan->version == 10 ? scan_elements1(scan, cursor)
        : scan->binary      ? scan_elements2_binary(scan, cursor)
                            : scan_elements2_ascii(scan, cursor));
    if (scan->version == 10 || scan->partitioned) {
        TRY(rewrite_elements(scan, first));
    }
done:
    return status;
}

static enum status scan_element_block(struct msh_scan *scan, struct msh_cursor *cursor, int64_t *done_count)
{
    enum status status = STATUS_OK;
    int64_t dim = 0;
    int64_t entity = 0;
    int64_t type = 0;
    int64_t count = 0;
    int64_t first = *done_count;
    bool old = scan->version == 40;
    cursor->record = first + 1;
    if (old) {
        TRY(msh_next_int(cursor, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &entity));
    }
    TRY(msh_next_int(cursor, "dimension", 0, 3, &dim));
    if (!old) {
        TRY(msh_next_int(cursor, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &entity));
    }
    TRY(msh_next_int(cursor, "type", 0, INT32_MAX, &type));
    TRY(check_type(cursor, type));
    TRY(msh_next_count(cursor, "number of elements", 4, old ? 8 : 16, &count));
    if (msh_type(type).dim != dim) {
        status = msh_cursor_fail(cursor, "a %s on an entity of dimension %lld", msh_type(type).name,
                                 (long long)dim);
        goto done;
    }
    if (count > scan->element_count - first) {
        status = msh_cursor_fail(cursor, "more elements than the %lld that the section's head says",
                                 (long long)scan->element_count);
        goto done;
    }
    for (int64_t i = first; i < first + count; i++) {
        cursor->record = i + 1;
        TRY(old ? msh_next_int(cursor, "tag", 1, MSH_LARGEST_TAG, &scan->element_tag[i])
                : msh_next_size(cursor, "tag", 1, MSH_LARGEST_TAG, &scan->element_tag[i]));
        scan->element_type[i] = (int8_t)type;
        TRY(scan_element_nodes(scan, cursor, type));
    }
    *done_count = first + count;
done:
    return status;
}

static enum status scan_elements4(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t blocks = 0;
    int64_t found = 0;
    int64_t bound = 0;
    TRY(msh_next_count(cursor, "number of blocks", 8, 20, &blocks));
    TRY(msh_next_count(cursor, "number of elements", 4, 8, &scan->element_count));
    for (int k = 0; k < 2 && scan->version == 41; k++) {
        TRY(msh_next_size(cursor, "range of tags", 0, MSH_LARGEST_TAG, &bound));
    }
    TRY(new_elements(scan, cursor->error));
    for (int64_t block = 0; block < blocks; block++) {
        TRY(scan_element_block(scan, cursor, &found));
    }
    if (found != scan->element_count) {
        cursor->record = 0;
        status = msh_cursor_fail(cursor, "%lld elements, not the %lld that the section's head says",
                                 (long long)found, (long long)scan->element_count);
    }
done:
    return status;
}

enum status msh_scan_elements(struct msh_scan *scan, struct msh_cursor *cursor)
{
    cursor->kind = "element";
    if (scan->part[MSH_NODES].to == 0) {
        return msh_cursor_fail(cursor, "stands before $Nodes");
    }
    enum status status = scan->version < 40 ? scan_elements2(scan, cursor) : scan_elements4(scan, cursor);
    return status == STATUS_OK
               ? msh_index_make(&scan->elements, scan->element_count, scan->element_tag, cursor)
               : status;
}
