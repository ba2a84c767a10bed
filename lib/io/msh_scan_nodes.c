#include "base/memory.h"
#include "io/msh_scan_parts.h"

#include <math.h>

static enum status scan_point(struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    double coordinate = 0;
    for (int k = 0; k < 3; k++) {
        TRY(msh_next_real(cursor, "coordinate", &coordinate));
        if (!isfinite(coordinate)) {
            status = msh_cursor_fail(cursor, "coordinate %d is not finite", k + 1);
            goto done;
        }
    }
done:
    return status;
}

static enum status skip_parameters(struct msh_cursor *cursor, int64_t count)
{
    enum status status = STATUS_OK;
    double parameter = 0;
    for (int64_t k = 0; k < count; k++) {
        TRY(msh_next_real(cursor, "parameter", &parameter));
    }
done:
    return status;
}

static enum status scan_nodes2(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    TRY(msh_next_count_line(cursor, "number of nodes", 8, &scan->node_count));
    TRY(NEW_ARRAY(&scan->node_tag, scan->node_count, cursor->error));
    for (int64_t i = 0; i < scan->node_count; i++) {
        cursor->record = i + 1;
        TRY(msh_next_int(cursor, "tag", 1, MSH_LARGEST_TAG, &scan->node_tag[i]));
        TRY(scan_point(cursor));
    }
done:
    return status;
}

/* The nodes of one entity. 4.0 has tag and point in turn, 4.1 first all tags, then all points. */
static enum status scan_node_block(struct msh_scan *scan, struct msh_cursor *cursor, int64_t *done_count,
                                   int64_t least, int64_t most)
{
    enum status status = STATUS_OK;
    int64_t first = 0;
    int64_t dim = 0;
    int64_t entity = 0;
    int64_t parametric = 0;
    int64_t count = 0;
    bool old = scan->version == 40;
    if (old) {
        TRY(msh_next_int(cursor, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &entity));
    }
    TRY(msh_next_int(cursor, "dimension", 0, 3, &dim));
    if (!old) {
        TRY(msh_next_int(cursor, "entity", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &entity));
    }
    TRY(msh_next_int(cursor, "parametric", 0, 1, &parametric));
    TRY(msh_next_count(cursor, "number of nodes", 8, 28, &count));
    first = *done_count;
    if (count > scan->node_count - first) {
        status = msh_cursor_fail(cursor, "more nodes than the %lld that the section's head says",
                                 (long long)scan->node_count);
        goto done;
    }
    int64_t parameters = parametric == 1 ? dim : 0;
    for (int64_t i = first; i < first + count; i++) {
        cursor->record = i + 1;
        TRY(old ? msh_next_int(cursor, "tag", least, most, &scan->node_tag[i])
                : msh_next_size(cursor, "tag", least, most, &scan->node_tag[i]));
        if (old) {
            TRY(scan_point(cursor));
            TRY(skip_parameters(cursor, parameters));
        }
    }
    for (int64_t i = first; i < first + count && !old; i++) {
        cursor->record = i + 1;
        TRY(scan_point(cursor));
        TRY(skip_parameters(cursor, parameters));
    }
    *done_count = first + count;
done:
    return status;
}

static enum status scan_nodes4(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t blocks = 0;
    int64_t least = 1;
    int64_t most = MSH_LARGEST_TAG;
    int64_t found = 0;
    TRY(msh_next_count(cursor, "number of blocks", 8, 20, &blocks));
    TRY(msh_next_count(cursor, "number of nodes", 8, 28, &scan->node_count));
    if (scan->version == 41) {
        /* libgmsh sizes a table by these, and does not check the tags against it */
        int64_t lowest = scan->node_count == 0 ? 0 : 1;
        TRY(msh_next_size(cursor, "smallest tag", lowest, MSH_LARGEST_TAG, &least));
        TRY(msh_next_size(cursor, "largest tag", lowest, MSH_LARGEST_TAG, &most));
    }
    TRY(NEW_ARRAY(&scan->node_tag, scan->node_count, cursor->error));
    for (int64_t block = 0; block < blocks; block++) {
        TRY(scan_node_block(scan, cursor, &found, least, most));
    }
    if (found != scan->node_count) {
        cursor->record = 0;
        status = msh_cursor_fail(cursor, "%lld nodes, not the %lld that the section's head says",
                                 (long long)found, (long long)scan->node_count);
    }
done:
    return status;
}

enum status msh_scan_nodes(struct msh_scan *scan, struct msh_cursor *cursor)
{
    const char *from = cursor->at;
    cursor->kind = "node";
    enum status status = scan->version < 40 ? scan_nodes2(scan, cursor) : scan_nodes4(scan, cursor);
    if (status == STATUS_OK && scan->version == 10) {
        TRY(msh_rewrite_text(scan, MSH_NODES, "$Nodes\n", cursor->error));
        TRY(msh_rewrite(scan, MSH_NODES, from, (size_t)(cursor->at - from), cursor->error));
        TRY(msh_rewrite_text(scan, MSH_NODES, "\n$EndNodes", cursor->error));
    }
    TRY(status);
    TRY(msh_index_make(&scan->nodes, scan->node_count, scan->node_tag, cursor));
done:
    return status;
}
