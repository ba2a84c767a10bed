#include "io/image/label_table.h"

#include "base/memory.h"
#include "base/options.h"
#include "io/files/textfile.h"

#include <stdio.h>
#include <string.h>

static const size_t size_limit = (size_t)1 << 24;
static const int64_t label_limit = INT32_MAX;
enum { NAMES_LIMIT = 1000, RANGES_LIMIT = 30000 };

enum status label_table_name(struct label_table *table, const char *text, bool kept, int32_t *name,
                             struct error *error)
{
    *name = (int32_t)names_find(&table->names, text);
    if (*name >= 0) {
        return table->kept[*name] == kept
                   ? STATUS_OK
                   : fail(error, STATUS_INPUT, "'%.60s' is kept in one row and left out in another", text);
    }
    *name = (int32_t)table->names.count;
    if (*name > NAMES_LIMIT) {
        return fail(error, STATUS_INPUT, "more than %d names", NAMES_LIMIT);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&table->kept, *name + 1, error));
    table->kept[*name] = kept;
    return names_add(&table->names, text, error);
}

enum status label_table_add(struct label_table *table, const struct label_range *range, struct error *error)
{
    for (int32_t r = 0; r < table->range_count; r++) {
        if (range->first <= table->range[r].last && table->range[r].first <= range->last) {
            return fail(error, STATUS_INPUT, "label %jd stands in another row already",
                        (range->first > table->range[r].first ? range->first : table->range[r].first));
        }
    }
    if (table->range_count == RANGES_LIMIT) {
        return fail(error, STATUS_INPUT, "more than %d labels or ranges of labels", RANGES_LIMIT);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&table->range, table->range_count + 1, error));
    table->range[table->range_count++] = *range;
    return STATUS_OK;
}

bool label_table_find(const struct label_table *table, int64_t label, int32_t *name)
{
    for (int32_t r = 0; r < table->range_count; r++) {
        if (table->range[r].first <= label && label <= table->range[r].last) {
            *name = table->range[r].name;
            return true;
        }
    }
    *name = label == 0 ? 0 : table->name_of_others;
    return label == 0 || table->others;
}

static const char not_in_names[] = ",\"=:|";

static void make_name(const struct label_table *table, char *text, size_t size)
{
    for (char *at = text; *at != '\0'; at++) {
        if ((unsigned char)*at <= ' ' || *at == 0x7f || *at == '#' || strchr(not_in_names, *at) != NULL ||
            strcmp(text, "-") == 0) {
            *at = '_';
        }
    }
    size_t length = strlen(text) < size - 8 ? strlen(text) : size - 8;
    for (int number = 2; names_find(&table->names, text) >= 0; number++) {
        snprintf(text + length, size - length, "_%d", number);
    }
}

enum status label_table_segments(struct label_table *table, const struct image *image,
                                 char note[LABEL_TABLE_NOTE], struct error *error)
{
    int32_t outside;
    note[0] = '\0';
    RETURN_IF_ERROR(label_table_name(table, "outside", false, &outside, error));
    for (size_t s = 0; s < image->segment_count; s++) {
        const struct image_segment *segment = &image->segment[s];
        struct label_range range = {.first = segment->label, .last = segment->label};
        char name[sizeof segment->name];
        if (segment->voxels == 0) {
            continue;
        }
        memcpy(name, segment->name, sizeof name);
        make_name(table, name, sizeof name);
        if (note[0] == '\0' && strcmp(name, segment->name) != 0) {
            snprintf(note, LABEL_TABLE_NOTE, "names are changed to what scenes can hold, as '%s' to %s",
                     segment->name, name);
        }
        RETURN_IF_ERROR(label_table_name(table, name, true, &range.name, error));
        RETURN_IF_ERROR(label_table_add(table, &range, error));
    }
    return STATUS_OK;
}

static enum status check_name(const char *name, struct error *error)
{
    if (strcmp(name, "outside") == 0) {
        return fail(error, STATUS_INPUT, "'outside' is what no label names: write - to leave labels out");
    }
    return strpbrk(name, not_in_names) == NULL
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "'%.60s': no commas, quotes, colons, = or | in names", name);
}

/* Add the labels "1,3-5" or "*" to a name. */
static enum status add_labels(struct label_table *table, char *labels, int32_t name, struct error *error)
{
    if (strcmp(labels, "*") == 0) {
        if (table->others) {
            return fail(error, STATUS_INPUT, "a second row for all other labels");
        }
        table->others = true;
        table->name_of_others = name;
        return STATUS_OK;
    }
    char *rest = labels;
    while (rest != NULL) {
        char *item = strsep(&rest, ",");
        char *dash = strchr(item, '-');
        struct label_range range = {.name = name};
        if (dash != NULL) {
            *dash = '\0';
        }
        RETURN_IF_ERROR(parse_integer(item, "label", 0, label_limit, &range.first, error));
        range.last = range.first;
        if (dash != NULL) {
            RETURN_IF_ERROR(parse_integer(dash + 1, "label", range.first, label_limit, &range.last, error));
        }
        RETURN_IF_ERROR(label_table_add(table, &range, error));
    }
    return STATUS_OK;
}

/* Add one line, which is modified. */
static enum status add_row(struct label_table *table, char *line, struct error *error)
{
    char *word[4], *next;
    int count = 0;
    while (count < 4 && *(next = text_word(&line)) != '\0' && *next != '#') {
        word[count++] = next;
    }
    if (count == 0) {
        return STATUS_OK;
    }
    if (count == 1 || count > 3 || (count == 3 && strcmp(word[2], "-") != 0)) {
        return fail(error, STATUS_INPUT, "a row is LABELS NAME, or LABELS NAME - to leave the cells out");
    }
    int32_t name = 0;
    RETURN_IF_ERROR(check_name(word[1], error));
    if (strcmp(word[1], "-") != 0) {
        RETURN_IF_ERROR(label_table_name(table, word[1], count == 2, &name, error));
    }
    return add_labels(table, word[0], name, error);
}

enum status label_table_read(const char *path, struct label_table *table, struct error *error)
{
    FREED_BY(textfile_free) struct textfile file = {0};
    int64_t number = 1;
    int32_t outside;
    *table = (struct label_table){0};
    RETURN_IF_ERROR(label_table_name(table, "outside", false, &outside, error));
    RETURN_IF_ERROR(textfile_read(path, size_limit, &file, error));
    for (char *rest = file.text; *rest != '\0'; number++) {
        char *line = strsep(&rest, "\n");
        RETURN_IF_ERROR(fail_in(error, add_row(table, line, error), "%s:%jd", path, number));
    }
    return table->range_count > 0 || table->others ? STATUS_OK
                                                   : fail(error, STATUS_INPUT, "%s: names no label", path);
}

void label_table_free(struct label_table *table)
{
    names_free(&table->names);
    FREE_ALL(table->kept, table->range);
    *table = (struct label_table){0};
}
