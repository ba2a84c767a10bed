#include "base/memory.h"
#include "io/msh_scan_parts.h"

#include <math.h>
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

enum status msh_scan_entities(struct msh_scan *scan, struct msh_cursor *cursor)
{
    static const char *const kinds[] = {"point", "curve", "surface", "volume"};
    enum status status = STATUS_OK;
    int64_t counts[4];
    int64_t tag = 0;
    double box = 0;
    for (int dim = 0; dim < 4; dim++) {
        TRY(msh_next_count(cursor, "number of entities", 10, 36, &counts[dim]));
    }
    for (int dim = 0; dim < 4; dim++) {
        cursor->kind = kinds[dim];
        int numbers = dim == 0 && scan->version == 41 ? 3 : 6;
        for (int64_t i = 0; i < counts[dim]; i++) {
            cursor->record = i + 1;
            TRY(msh_next_int(cursor, "tag", -MSH_LARGEST_TAG, MSH_LARGEST_TAG, &tag));
            for (int k = 0; k < numbers; k++) {
                TRY(msh_next_real(cursor, "box", &box));
            }
            TRY(skip_tags(cursor, "physical groups"));
            if (dim > 0) {
                TRY(skip_tags(cursor, "boundary"));
            }
        }
    }
done:
    return status;
}
