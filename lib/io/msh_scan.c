#include "io/msh_scan.h"

#include "base/memory.h"
#include "io/msh.h"
#include "io/msh_cursor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* libgmsh keeps many tags as int. */
#define LARGEST_TAG INT32_MAX

/* libgmsh reads names into buffers of 256 bytes. */
#define LONGEST_NAME 127

static const char *const part_names[MSH_PART_COUNT] = {"$MeshFormat", "$PhysicalNames", "$Entities", "$Nodes",
                                                       "$Elements"};

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

bool msh_is_mesh(const char *bytes, size_t size)
{
    return size >= MSH_MAGIC_SIZE && memcmp(bytes, "$MeshFormat", 11) == 0 &&
           (bytes[11] == '\n' || bytes[11] == '\r');
}

/* ---- tags ---- */

struct tag_place {
    int64_t tag, place;
};

static int compare_tags(const void *left, const void *right)
{
    const struct tag_place *a = left;
    const struct tag_place *b = right;
    return (a->tag > b->tag) - (a->tag < b->tag);
}

static enum status index_sort(struct msh_index *index, const int64_t tags[], struct error *error)
{
    enum status status = STATUS_OK;
    struct tag_place *pairs = NULL;
    TRY(NEW_ARRAY(&pairs, index->count, error));
    TRY(NEW_ARRAY(&index->place, index->count, error));
    for (int64_t i = 0; i < index->count; i++) {
        pairs[i] = (struct tag_place){tags[i], i};
    }
    qsort(pairs, (size_t)index->count, sizeof *pairs, compare_tags);
    for (int64_t i = 0; i < index->count; i++) {
        index->tag[i] = pairs[i].tag;
        index->place[i] = pairs[i].place;
    }
done:
    free(pairs);
    return status;
}

/* Index the tags; one that stands twice is an error. */
static enum status index_make(struct msh_index *index, int64_t count, const int64_t tags[],
                              struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    bool ascending = true;
    index->count = count;
    TRY(NEW_ARRAY(&index->tag, count, cursor->error));
    for (int64_t i = 0; i < count; i++) {
        index->tag[i] = tags[i];
        ascending = ascending && (i == 0 || tags[i] > tags[i - 1]);
    }
    if (!ascending) {
        TRY(index_sort(index, tags, cursor->error));
    }
    for (int64_t i = 1; i < count; i++) {
        if (index->tag[i] == index->tag[i - 1]) {
            cursor->record = 0;
            status =
                msh_cursor_fail(cursor, "%s tag %lld stands twice", cursor->kind, (long long)index->tag[i]);
            goto done;
        }
    }
done:
    return status;
}

int64_t msh_index_find(const struct msh_index *index, int64_t tag)
{
    int64_t low = 0;
    int64_t high = index->count - 1;
    if (high < 0 || tag < index->tag[0] || tag > index->tag[high]) {
        return -1;
    }
    if (index->tag[high] - index->tag[0] == high) { /* no gaps */
        low = high = tag - index->tag[0];
    }
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (index->tag[middle] < tag) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    if (index->tag[low] != tag) {
        return -1;
    }
    return index->place != NULL ? index->place[low] : low;
}

/* ---- $MeshFormat, $PhysicalNames, $Entities ---- */

static enum status scan_format(struct msh_scan *scan, struct msh_cursor *cursor)
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
    TRY(msh_next_int(cursor, "physical tag", 1, LARGEST_TAG, &tag));
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
static enum status scan_names(struct msh_scan *scan, struct msh_cursor *cursor)
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
        TRY(msh_next_int(cursor, what, -LARGEST_TAG, LARGEST_TAG, &tag));
    }
done:
    return status;
}

static enum status scan_entities(struct msh_scan *scan, struct msh_cursor *cursor)
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
            TRY(msh_next_int(cursor, "tag", -LARGEST_TAG, LARGEST_TAG, &tag));
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

/* ---- $Nodes ---- */

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
    cursor->binary = false;
    status = msh_next_count(cursor, "number of nodes", 8, 28, &scan->node_count);
    cursor->binary = scan->binary;
    if (status != STATUS_OK) {
        return status;
    }
    TRY(msh_skip_line(cursor));
    TRY(NEW_ARRAY(&scan->node_tag, scan->node_count, cursor->error));
    for (int64_t i = 0; i < scan->node_count; i++) {
        cursor->record = i + 1;
        TRY(msh_next_int(cursor, "tag", 1, LARGEST_TAG, &scan->node_tag[i]));
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
        TRY(msh_next_int(cursor, "entity", -LARGEST_TAG, LARGEST_TAG, &entity));
    }
    TRY(msh_next_int(cursor, "dimension", 0, 3, &dim));
    if (!old) {
        TRY(msh_next_int(cursor, "entity", -LARGEST_TAG, LARGEST_TAG, &entity));
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
    int64_t most = LARGEST_TAG;
    int64_t found = 0;
    TRY(msh_next_count(cursor, "number of blocks", 8, 20, &blocks));
    TRY(msh_next_count(cursor, "number of nodes", 8, 28, &scan->node_count));
    if (scan->version == 41) {
        /* libgmsh sizes a table by these, and does not check the tags against it */
        int64_t lowest = scan->node_count == 0 ? 0 : 1;
        TRY(msh_next_size(cursor, "smallest tag", lowest, LARGEST_TAG, &least));
        TRY(msh_next_size(cursor, "largest tag", lowest, LARGEST_TAG, &most));
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

static enum status scan_nodes(struct msh_scan *scan, struct msh_cursor *cursor)
{
    cursor->kind = "node";
    enum status status = scan->version < 40 ? scan_nodes2(scan, cursor) : scan_nodes4(scan, cursor);
    return status == STATUS_OK ? index_make(&scan->nodes, scan->node_count, scan->node_tag, cursor) : status;
}

/* ---- $Elements ---- */

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
        TRY(msh_next_int(cursor, "tag", k == 1 ? 0 : -LARGEST_TAG, LARGEST_TAG, &tag));
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
        TRY(msh_next_int(cursor, "tag", 1, LARGEST_TAG, &scan->element_tag[i]));
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
            TRY(msh_next_int(cursor, "tag", 1, LARGEST_TAG, &scan->element_tag[i]));
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
    cursor->binary = false;
    status = msh_next_count(cursor, "number of elements", 8, 8, &scan->element_count);
    cursor->binary = scan->binary;
    if (status != STATUS_OK) {
        return status;
    }
    TRY(msh_skip_line(cursor));
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
        TRY(msh_next_int(cursor, "entity", -LARGEST_TAG, LARGEST_TAG, &entity));
    }
    TRY(msh_next_int(cursor, "dimension", 0, 3, &dim));
    if (!old) {
        TRY(msh_next_int(cursor, "entity", -LARGEST_TAG, LARGEST_TAG, &entity));
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
        TRY(old ? msh_next_int(cursor, "tag", 1, LARGEST_TAG, &scan->element_tag[i])
                : msh_next_size(cursor, "tag", 1, LARGEST_TAG, &scan->element_tag[i]));
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
        TRY(msh_next_size(cursor, "range of tags", 0, LARGEST_TAG, &bound));
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

static enum status scan_elements(struct msh_scan *scan, struct msh_cursor *cursor)
{
    cursor->kind = "element";
    if (scan->part[MSH_NODES].to == 0) {
        return msh_cursor_fail(cursor, "stands before $Nodes");
    }
    enum status status = scan->version < 40 ? scan_elements2(scan, cursor) : scan_elements4(scan, cursor);
    return status == STATUS_OK ? index_make(&scan->elements, scan->element_count, scan->element_tag, cursor)
                               : status;
}

/* ---- the file ---- */

/* "$Name" at the cursor, into name[]. */
static enum status scan_heading(struct msh_cursor *cursor, char name[], size_t size)
{
    size_t length = 0;
    const char *at = cursor->at;
    while (at + length < cursor->end && length + 1 < size &&
           (length == 0 ? at[0] == '$' : at[length] > ' ' && at[length] < 127)) {
        name[length] = at[length];
        length++;
    }
    name[length] = '\0';
    if (length < 2) {
        return msh_cursor_fail(cursor, "followed by something that is not a section");
    }
    if (at + length == cursor->end) {
        return msh_cursor_fail(cursor, "followed by an unfinished section: the file is truncated");
    }
    cursor->at += length;
    return STATUS_OK;
}

/* "$EndName", and then white space or the end of the file. */
static enum status scan_ending(struct msh_cursor *cursor, const char *name)
{
    cursor->record = 0;
    msh_skip_space(cursor);
    size_t length = strlen(name) - 1;
    const char *at = cursor->at;
    if ((size_t)(cursor->end - at) < length + 4) {
        return msh_cursor_fail(cursor, "no $End%s: the file is truncated", name + 1);
    }
    if (memcmp(at, "$End", 4) != 0 || memcmp(at + 4, name + 1, length) != 0 ||
        (at + 4 + length < cursor->end && at[4 + length] > ' ')) {
        return msh_cursor_fail(cursor, "more in the section than its head says: no $End%s where it should be",
                               name + 1);
    }
    cursor->at += length + 4;
    return STATUS_OK;
}

/* A section that is not needed: step over it. */
static enum status skip_section(struct msh_cursor *cursor, const char *name)
{
    char ending[80] = "$End";
    strncat(ending, name + 1, sizeof ending - 5);
    const char *found = memmem(cursor->at, (size_t)(cursor->end - cursor->at), ending, strlen(ending));
    if (found == NULL) {
        return msh_cursor_fail(cursor, "no %s: the file is truncated", ending);
    }
    cursor->at = found;
    return scan_ending(cursor, name);
}

static enum status scan_part(struct msh_scan *scan, enum msh_part part, struct msh_cursor *cursor)
{
    switch (part) {
    case MSH_FORMAT:
        return scan_format(scan, cursor);
    case MSH_NAMES:
        return scan_names(scan, cursor);
    case MSH_ENTITIES:
        return scan->version < 40 ? msh_cursor_fail(cursor, "has no place in MSH 2")
                                  : scan_entities(scan, cursor);
    case MSH_NODES:
        return scan_nodes(scan, cursor);
    default:
        return scan_elements(scan, cursor);
    }
}

static enum status scan_section(struct msh_scan *scan, const char *start, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    char name[64];
    int part = MSH_PART_COUNT;
    size_t from = (size_t)(cursor->at - start);
    TRY(scan_heading(cursor, name, sizeof name));
    cursor->section = name;
    part = 0;
    while (part < MSH_PART_COUNT && strcmp(name, part_names[part]) != 0) {
        part++;
    }
    if (strcmp(name, "$PartitionedEntities") == 0) {
        status = msh_cursor_fail(cursor, "the mesh is partitioned: save it whole");
        goto done;
    }
    if (part == MSH_PART_COUNT) {
        TRY(skip_section(cursor, name));
        goto done;
    }
    if (scan->part[part].to != 0) {
        status = msh_cursor_fail(cursor, "stands twice in the file");
        goto done;
    }
    TRY(msh_skip_line(cursor));
    TRY(scan_part(scan, (enum msh_part)part, cursor));
    TRY(scan_ending(cursor, name));
    scan->part[part].from = from;
    scan->part[part].to = (size_t)(cursor->at - start);
done:
    cursor->section = part < MSH_PART_COUNT ? part_names[part] : "a section";
    return status;
}

enum status msh_scan(struct msh_scan *scan, const char *bytes, size_t size, struct error *error)
{
    enum status status = STATUS_OK;
    struct msh_cursor cursor = {.at = bytes, .end = bytes + size, .section = "$MeshFormat", .error = error};
    *scan = (struct msh_scan){0};
    if (!msh_is_mesh(bytes, size)) {
        status = fail(error, STATUS_INPUT, "%s",
                      size == 0 ? "empty" : "not a gmsh mesh: the first line is not $MeshFormat");
        goto done;
    }
    while (cursor.at < cursor.end) {
        TRY(scan_section(scan, bytes, &cursor));
        msh_skip_space(&cursor);
    }
    if (scan->part[MSH_ELEMENTS].to == 0) {
        status = fail(error, STATUS_INPUT, "no section %s: the file is truncated, or no mesh was made",
                      scan->part[MSH_NODES].to == 0 ? "$Nodes" : "$Elements");
    }
done:
    if (status != STATUS_OK) {
        msh_scan_free(scan);
    }
    return status;
}

void msh_scan_free(struct msh_scan *scan)
{
    free(scan->node_tag);
    free(scan->nodes.tag);
    free(scan->nodes.place);
    free(scan->element_tag);
    free(scan->element_type);
    free(scan->element_group);
    free(scan->elements.tag);
    free(scan->elements.place);
    for (int64_t i = 0; i < scan->name_count; i++) {
        free(scan->names[i].name);
    }
    free(scan->names);
    *scan = (struct msh_scan){0};
}
