#include "base/memory.h"
#include "io/msh_scan_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* libgmsh reads names into buffers of 256 bytes. */
#define LONGEST_NAME 127

enum status msh_scan_format(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    double version = 0;
    int64_t binary = 0;
    int64_t width = 0;
    TRY(msh_next_real(cursor, "version", &version));
    TRY(msh_next_int(cursor, "file type", 0, 1, &binary));
    TRY(msh_next_int(cursor, "size of a real number", 8, 8, &width));
    static const double versions[] = {2.0, 2.1, 2.2, 4.0, 4.1};
    for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
        if (version == versions[i]) {
            scan->version = (int)lround(10 * version);
        }
    }
    if (scan->version == 0) {
        status = msh_cursor_fail(cursor, "version %g is not read: save as MSH 4.1 or 2.2", version);
        goto done;
    }
    scan->binary = binary == 1;
    if (scan->version == 40 && scan->binary) { /* libgmsh writes and reads none */
        status = msh_cursor_fail(cursor, "version 4.0 is read as ASCII only: save as MSH 4.1");
        goto done;
    }
    TRY(msh_skip_line(cursor));
    if (scan->binary) {
        int64_t one = 0;
        cursor->binary = true;
        TRY(msh_next_int(cursor, "byte order", INT32_MIN, INT32_MAX, &one));
        if (one != 1) {
            status = msh_cursor_fail(cursor, "the file is of another byte order: save it as ASCII");
        }
    }
done:
    return status;
}

static enum status scan_name(struct msh_name *name, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t dim = 0;
    int64_t tag = 0;
    TRY(msh_next_int(cursor, "dimension", 0, 3, &dim));
    TRY(msh_next_int(cursor, "physical tag", 1, MSH_LARGEST_TAG, &tag));
    msh_skip_space(cursor);
    const char *quote = cursor->at;
    if (quote == cursor->end || *quote != '"') {
        status = msh_cursor_fail(cursor, "no name in quotation marks");
        goto done;
    }
    size_t length = 0;
    while (quote + 1 + length < cursor->end && quote[1 + length] != '"' && quote[1 + length] != '\n' &&
           length <= LONGEST_NAME) {
        length++;
    }
    if (quote + 1 + length == cursor->end || quote[1 + length] != '"' || length == 0) {
        status =
            msh_cursor_fail(cursor, "the name is empty, unfinished or longer than %d bytes", LONGEST_NAME);
        goto done;
    }
    cursor->at = quote + 1 + length + 1;
    *name = (struct msh_name){(int)dim, (int)tag, strndup(quote + 1, length)};
    if (name->name == NULL) {
        status = fail_memory(cursor->error, "the name of a group");
    }
done:
    return status;
}

/* Text also in binary files. */
enum status msh_scan_names(struct msh_scan *scan, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t count = 0;
    cursor->binary = false;
    cursor->kind = "name";
    TRY(msh_next_count(cursor, "number of names", 6, 6, &count));
    TRY(NEW_ARRAY(&scan->names, count, cursor->error));
    for (; scan->name_count < count; scan->name_count++) {
        cursor->record = scan->name_count + 1;
        TRY(scan_name(&scan->names[scan->name_count], cursor));
    }
done:
    cursor->binary = scan->binary;
    return status;
}

/* The tags that follow an entity's box: its physical groups, or the entities that bound it. */
static enum status skip_tags(struct msh_cursor *cursor, const char *what)
{
    enum status status = STATUS_OK;
    int64_t count = 0;
    int64_t tag = 0;
    TRY(msh_next_count(cursor, what, 2, 4, &count));
    for (int64_t i = 0; i < count; i++) {
        TRY(msh_next_int(cursor, what, -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &tag));
    }
done:
    return status;
}

static const char *const entity_kinds[] = {"point", "curve", "surface", "volume"};

static enum status skip_box(const struct msh_scan *scan, int dim, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    double box = 0;
    int numbers = dim == 0 && scan->version == 41 ? 3 : 6;
    for (int k = 0; k < numbers; k++) {
        TRY(msh_next_real(cursor, "box", &box));
    }
done:
    return status;
}

enum status msh_scan_entities(struct msh_scan *scan, const char *start, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t tag = 0;
    for (int dim = 0; dim < 4; dim++) {
        TRY(msh_next_count(cursor, "number of entities", 10, 36, &scan->entity_count[dim]));
    }
    for (int dim = 0; dim < 4; dim++) {
        cursor->kind = entity_kinds[dim];
        scan->entities[dim].from = (size_t)(cursor->at - start);
        for (int64_t i = 0; i < scan->entity_count[dim]; i++) {
            cursor->record = i + 1;
            TRY(msh_next_int(cursor, "tag", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &tag));
            TRY(skip_box(scan, dim, cursor));
            TRY(skip_tags(cursor, "physical groups"));
            TRY(dim > 0 ? skip_tags(cursor, "boundary") : STATUS_OK);
        }
        scan->entities[dim].to = (size_t)(cursor->at - start);
    }
done:
    return status;
}

/* ---- partitions: entities of their own, which know what they are parts of ---- */

/* Pairs of numbers: ghosts and their partitions. */
static enum status skip_ghosts(struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t count = 0;
    int64_t tag = 0;
    TRY(msh_next_count(cursor, "number of ghosts", 4, 8, &count));
    for (int64_t i = 0; i < 2 * count; i++) {
        TRY(msh_next_int(cursor, "ghost", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &tag));
    }
done:
    return status;
}

/* The bytes from *from to the cursor, which is where the next begin. */
static enum status pass_entity(struct msh_scan *scan, const char **from, const struct msh_cursor *cursor)
{
    const char *begin = *from;
    *from = cursor->at;
    return msh_rewrite(scan, MSH_ENTITIES, begin, (size_t)(cursor->at - begin), cursor->error);
}

/* A partitioned entity without its partitions. Where parts of a volume meet there are surfaces of their own,
 * said to be parts of the volume and of its group; these are in no group. */
static enum status rewrite_entity(struct msh_scan *scan, int dim, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    const int64_t none = 0;
    const char *from = cursor->at;
    int64_t number = 0;
    int64_t whole = 0;
    TRY(msh_next_int(cursor, "tag", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &number));
    TRY(pass_entity(scan, &from, cursor));
    TRY(msh_next_int(cursor, "dimension of the whole", -1, 3, &whole));
    TRY(msh_next_int(cursor, "tag of the whole", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &number));
    TRY(skip_tags(cursor, "partitions"));
    from = cursor->at;
    TRY(skip_box(scan, dim, cursor));
    TRY(pass_entity(scan, &from, cursor));
    TRY(skip_tags(cursor, "physical groups"));
    if (whole == dim) {
        TRY(pass_entity(scan, &from, cursor));
    } else {
        TRY(scan->binary ? msh_rewrite(scan, MSH_ENTITIES, (const char *)&none, sizeof none, cursor->error)
                         : msh_rewrite_text(scan, MSH_ENTITIES, " 0", cursor->error));
    }
    from = cursor->at;
    TRY(dim > 0 ? skip_tags(cursor, "boundary") : STATUS_OK);
    TRY(pass_entity(scan, &from, cursor));
done:
    return status;
}

/* The partitioned entities of one dimension, behind those that $Entities has. */
static enum status rewrite_entities(struct msh_scan *scan, const char *start, int dim, int64_t count,
                                    struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    cursor->kind = entity_kinds[dim];
    TRY(msh_rewrite(scan, MSH_ENTITIES, start + scan->entities[dim].from,
                    scan->entities[dim].to - scan->entities[dim].from, cursor->error));
    for (int64_t i = 0; i < count; i++) {
        cursor->record = i + 1;
        TRY(scan->binary ? STATUS_OK : msh_rewrite_text(scan, MSH_ENTITIES, "\n", cursor->error));
        TRY(rewrite_entity(scan, dim, cursor));
    }
done:
    return status;
}

/* The head of the entities: how many of each dimension. */
static enum status rewrite_counts(struct msh_scan *scan, const int64_t counts[4], struct error *error)
{
    enum status status = msh_rewrite_text(scan, MSH_ENTITIES, "$Entities\n", error);
    for (int dim = 0; dim < 4 && status == STATUS_OK; dim++) {
        char text[32];
        int64_t total = counts[dim] + scan->entity_count[dim];
        snprintf(text, sizeof text, "%lld ", (long long)total);
        status = scan->binary ? msh_rewrite(scan, MSH_ENTITIES, (const char *)&total, sizeof total, error)
                              : msh_rewrite_text(scan, MSH_ENTITIES, text, error);
    }
    return status;
}

enum status msh_scan_partitions(struct msh_scan *scan, const char *start, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    int64_t counts[4];
    int64_t number = 0;
    if (scan->version < 40 || scan->part[MSH_ENTITIES].to == 0 ||
        scan->rewritten[MSH_ENTITIES].text != NULL) {
        return msh_cursor_fail(cursor, "stands in MSH 4 only, once, behind $Entities");
    }
    TRY(msh_next_size(cursor, "number of partitions", 0, MSH_LARGEST_TAG, &number));
    TRY(skip_ghosts(cursor));
    for (int dim = 0; dim < 4; dim++) {
        TRY(msh_next_count(cursor, "number of entities", 10, 36, &counts[dim]));
    }
    TRY(rewrite_counts(scan, counts, cursor->error));
    for (int dim = 0; dim < 4; dim++) {
        TRY(rewrite_entities(scan, start, dim, counts[dim], cursor));
    }
    TRY(msh_rewrite_text(scan, MSH_ENTITIES, "\n$EndEntities", cursor->error));
done:
    return status;
}
