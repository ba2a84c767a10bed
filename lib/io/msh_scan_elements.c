#include "base/memory.h"
#include "io/msh.h"
#include "io/msh_scan_parts.h"

struct msh_type msh_type(int64_t number)
{
    static const struct msh_type types[] = {{"line", 1, 2},        {"triangle", 2, 3},   {"quadrangle", 2, 4},
                                            {"tetrahedron", 3, 4}, {"hexahedron", 3, 8}, {"prism", 3, 6},
                                            {"pyramid", 3, 5}};
    if (number >= 1 && number <= 7) {
        return types[number - 1];
    }
    return number == 15 ? (struct msh_type){"point", 0, 1} : (struct msh_type){NULL, 0, 0};
}

static enum status check_type(struct msh_cursor *cursor, int64_t type)
{
    if (msh_type(type).name == NULL) {
        return msh_cursor_fail(cursor,
                               "type %lld is not a first-order element: mesh with order 1 (gmsh -order 1)",
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
        if (k == 2 && tag != 0) {
            status = msh_cursor_fail(cursor, "the mesh is partitioned: save it whole");
            goto done;
        }
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
        TRY(msh_next_int(cursor, "number of tags", 0, 8, &tags));
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
        TRY(msh_next_int(cursor, "number of tags", 0, 8, &tags));
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
    TRY(scan->binary ? scan_elements2_binary(scan, cursor) : scan_elements2_ascii(scan, cursor));
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
