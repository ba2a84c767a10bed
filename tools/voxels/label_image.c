#include "voxels/label_image.h"

#include "base/box.h"
#include "base/lists.h"
#include "cell_report.h"
#include "images/images.h"

#include <math.h>
#include <string.h>

/* Most labels of an image without a table. */
enum { MOST_UNNAMED = 256, MOST_VALUES = 32767 };

/* ---- values ---- */

/* The different values of an image, ascending. */
struct values {
    int32_t count;
    int64_t value[MOST_VALUES];
    int64_t voxels[MOST_VALUES];
    uint16_t label[MOST_VALUES];
};

/* The place of a value in the list, or the place where it would be inserted; often `guess`. */
static int32_t place_of(const struct values *values, int64_t value, int32_t guess)
{
    return guess < values->count && values->value[guess] == value
               ? guess
               : (int32_t)first_from(values->value, 0, values->count, value);
}

static void fail_value(const struct tool *tool, const char *name, const struct image *image, int64_t voxel)
{
    int64_t nx = (int64_t)image->size[0], ny = (int64_t)image->size[1];
    tool_fail(
        tool, STATUS_INPUT,
        "%s: voxel %jd %jd %jd is %.10g: labels are whole numbers from 0 to 2147483647: is it a scan or a "
        "probability map?",
        name, (voxel % nx), (voxel / nx % ny), (voxel / nx / ny), image->values[voxel]);
}

static void collect_values(const struct tool *tool, const struct image *image, struct values *values)
{
    int64_t count = (int64_t)image_voxels(image);
    int32_t at = 0;
    for (int64_t i = 0; i < count; i++) {
        int64_t label = (int64_t)image->values[i];
        at = place_of(values, label, at);
        if (at == values->count || values->value[at] != label) {
            if (values->count == MOST_VALUES) {
                tool_fail(tool, STATUS_INPUT, "more than %d different values: is it a scan?", MOST_VALUES);
            }
            memmove(values->value + at + 1, values->value + at,
                    (size_t)(values->count - at) * sizeof *values->value);
            memmove(values->voxels + at + 1, values->voxels + at,
                    (size_t)(values->count - at) * sizeof *values->voxels);
            values->value[at] = label;
            values->voxels[at] = 0;
            values->count++;
        }
        values->voxels[at]++;
    }
}

/* Make names for an image without a table: those of its segments, and label_1, label_2, ... */
static void name_values(const struct tool *tool, const struct image *image, const struct values *values,
                        struct label_table *table)
{
    char changed[LABEL_TABLE_NOTE];
    TOOL_TRY(tool, label_table_segments(table, image, changed, &error));
    if (changed[0] != '\0') {
        tool_note(tool, "%s", changed);
    }
    for (int32_t v = 0; v < values->count; v++) {
        struct label_range range = {.first = values->value[v], .last = values->value[v]};
        char name[32];
        if (label_table_find(table, range.first, &range.name) || range.first == 0) {
            continue;
        }
        if (values->count > MOST_UNNAMED) {
            tool_fail(tool, STATUS_INPUT,
                      "%d different labels: is it a scan? Otherwise name and merge them by -l TABLE",
                      values->count);
        }
        snprintf(name, sizeof name, "label_%jd", range.first);
        TOOL_TRY(tool, label_table_name(table, name, true, &range.name, &error));
        TOOL_TRY(tool, label_table_add(table, &range, &error));
    }
}

static void label_values(const struct tool *tool, struct values *values, struct label_image *image,
                         const char *table)
{
    bool kept = false;
    for (int32_t v = 0; v < values->count; v++) {
        int32_t name = 0;
        if (!label_table_find(&image->table, values->value[v], &name)) {
            tool_fail(tool, STATUS_INPUT,
                      "%s: no row for label %jd, of %jd voxels: name it, or write '%jd -'", table,
                      values->value[v], values->voxels[v], values->value[v]);
        }
        values->label[v] = (uint16_t)name;
        image->volume[name] += (double)values->voxels[v] * image->voxel_volume;
    }
    for (int32_t l = 1; l < image->labels.count; l++) {
        kept = kept || image->table.kept[l];
        if (image->volume[l] == 0 && image->table.kept[l]) {
            tool_fail(tool, STATUS_INPUT, "'%s' is empty: no voxel has a label of that name",
                      image->table.names.name[l]);
        }
    }
    if (!kept) {
        tool_fail(tool, STATUS_INPUT, "%s",
                  table != NULL ? "the table keeps no label" : "all voxels are 0: no label");
    }
}

static void set_labels(const struct tool *tool, const struct image *source, struct label_image *image,
                       const char *table)
{
    int64_t count = (int64_t)image_voxels(source);
    TOOL_SCRATCH(tool, struct values, values, 1);
    collect_values(tool, source, values);
    if (table == NULL) {
        name_values(tool, source, values, &image->table);
    }
    image->labels.count = (int32_t)image->table.names.count;
    TOOL_TRY(tool, NEW_ARRAY(&image->volume, image->labels.count, &error));
    TOOL_TRY(tool, NEW_ARRAY(&image->labels.label, count, &error));
    label_values(tool, values, image, table);
    int32_t at = 0;
    for (int64_t i = 0; i < count; i++) {
        at = place_of(values, (int64_t)source->values[i], at);
        image->labels.label[i] = values->label[at];
    }
}

/* ---- space ---- */

/* The axis of the grid whose slices are perpendicular to a world axis. Exits if there is none. */
static int grid_axis(const struct tool *tool, const struct image *image, int world)
{
    for (int e = 0; e < 3; e++) {
        if (image_axis_across(image, e) == world) {
            return e;
        }
    }
    tool_fail(tool, STATUS_INPUT, "-s: the image's slices are oblique to the axis %c: resample it first",
              'x' + world);
}

static void take_slice(struct image *image, int axis, size_t slice)
{
    size_t nx = image->size[0], ny = image->size[1], count = 0;
    for (size_t i = 0; i < image_voxels(image); i++) {
        const size_t at[3] = {i % nx, i / nx % ny, i / nx / ny};
        if (at[axis] == slice) {
            image->values[count++] = image->values[i];
        }
    }
    for (int d = 0; d < 3; d++) {
        image->to_world[d][3] += (double)slice * image->to_world[d][axis];
    }
    image->size[axis] = 1;
}

static void parse_slice(const struct tool *tool, const char *text, int *axis, double *place)
{
    *axis = text[0] - 'x';
    if (*axis < 0 || *axis > 2 || text[1] != '=' || text[2] == '\0') {
        tool_fail(tool, STATUS_INPUT, "-s: '%s' is not a place on an axis, as z=12mm", text);
    }
    TOOL_TRY(tool, parse_length(text + 2, "-s", -1e12, place, &error));
}

static void choose_slice(const struct tool *tool, struct image *image, const char *slice)
{
    int world;
    double place;
    parse_slice(tool, slice, &world, &place);
    int axis = grid_axis(tool, image, world);
    double index = (place - image->to_world[world][3]) / image->to_world[world][axis];
    if (!(index > -0.5 && index < (double)image->size[axis] - 0.5)) {
        double first = image->to_world[world][3];
        double last = first + (double)(image->size[axis] - 1) * image->to_world[world][axis];
        tool_fail(tool, STATUS_INPUT, "-s %s: the slices lie from %g to %g m", slice, fmin(first, last),
                  fmax(first, last));
    }
    take_slice(image, axis, (size_t)fmax(0, floor(index + 0.5)));
}

/* Set the space of the labels. The axes of an image of one slice are brought into the order of a body in it.
 */
static void set_space(const struct tool *tool, struct image *image, struct label_image *result)
{
    struct labels *labels = &result->labels;
    struct image_axes axes;
    int flats = (image->size[0] == 1) + (image->size[1] == 1) + (image->size[2] == 1);
    if (flats > 1) {
        tool_fail(tool, STATUS_INPUT, "the image is one line of voxels");
    }
    labels->dim = flats == 1 ? 2 : 3;
    image_to_body(tool, image, labels->dim, &axes);
    labels->across = image->to_world[2][3];
    for (int d = 0; d < 3; d++) {
        labels->size[d] = (int64_t)image->size[d];
    }
    image_to_voxel(image, labels->to_voxel);
    result->voxel_volume = labels_voxel_volume(labels);
}

static void check_size(const struct tool *tool, const struct label_image *image, bool unit_given)
{
    struct box box = {.dim = image->labels.dim};
    labels_box(&image->labels, box.low, box.high);
    double diagonal = box_diagonal(&box);
    if (!(diagonal < CELL_REPORT_LARGEST && diagonal > CELL_REPORT_SMALLEST) && !unit_given) {
        tool_fail(tool, STATUS_INPUT,
                  "the labels are %.3g m across: give the unit of the file's lengths, as -u mm", diagonal);
    }
}

/* Note the kept labels that reach the border of the image, where the body is cut off. */
static void note_border(const struct tool *tool, const struct label_image *image)
{
    const int64_t *size = image->labels.size;
    int32_t label = 0;
    for (int64_t v = 0; v < size[0] * size[1] * size[2] && label == 0; v++) {
        const int64_t at[3] = {v % size[0], v / size[0] % size[1], v / size[0] / size[1]};
        bool border = false;
        for (int d = 0; d < 3; d++) {
            border = border || (size[d] > 1 && (at[d] == 0 || at[d] == size[d] - 1));
        }
        label = border && image->table.kept[image->labels.label[v]] ? image->labels.label[v] : 0;
    }
    if (label != 0) {
        tool_note(tool, "%s reaches the border of the image: the body ends there",
                  image->table.names.name[label]);
    }
}

/* Read "FILE" or "LABEL=FILE", with whole values. */
static void read_layer(const struct tool *tool, const char *text, struct image *image)
{
    int64_t label = 0;
    size_t digits = strspn(text, "0123456789");
    bool mask = digits > 0 && text[digits] == '=';
    if (mask) {
        SCRATCH char *number = tool_memory(tool, strndup(text, digits));
        TOOL_TRY(tool, parse_integer(number, text, 1, INT32_MAX, &label, &error));
    }
    tool_read_image(tool, mask ? text + digits + 1 : text, image);
    if (image->components > 1) {
        tool_fail(tool, STATUS_INPUT, "%s: %zu values at each voxel: not a label image", text,
                  image->components);
    }
    for (size_t v = 0; v < image_voxels(image); v++) {
        double value = image_whole(image, image->values[v]);
        if (!(value >= 0 && value <= INT32_MAX)) {
            fail_value(tool, text, image, (int64_t)v);
        }
        image->values[v] = mask && value > 0 ? (double)label : value;
    }
    image->slope = 1;
    image->inter = 0;
    image->segment_count = mask ? 0 : image->segment_count;
}

/* Exit unless the voxels of two images have the same places, to a hundredth of a voxel. */
static void check_grid(const struct tool *tool, const struct image *first, const struct image *image,
                       const char *name)
{
    if (memcmp(first->size, image->size, sizeof first->size) != 0 ||
        image_distance(first, image) > 0.01 * image_step(first, 0)) {
        tool_fail(tool, STATUS_INPUT, "%s: another grid than that of the first image: resample it", name);
    }
}

static void read_layers(const struct tool *tool, char *const *files, struct image *image)
{
    read_layer(tool, files[0] == NULL ? "-" : files[0], image);
    for (int f = 1; files[0] != NULL && files[f] != NULL; f++) {
        FREED_BY(image_free) struct image layer = {0};
        read_layer(tool, files[f], &layer);
        check_grid(tool, image, &layer, files[f]);
        if (layer.segment_count > 0) {
            tool_fail(tool, STATUS_INPUT, "%s: a segmentation on top of others: give it first", files[f]);
        }
        bool empty = true;
        for (size_t v = 0; v < image_voxels(image); v++) {
            empty = empty && layer.values[v] == 0;
            image->values[v] = layer.values[v] > 0 ? layer.values[v] : image->values[v];
        }
        if (empty) {
            tool_note(tool, "%s: all voxels are 0: nothing of it lies on top", files[f]);
        }
    }
}

void label_image_read(const struct tool *tool, struct label_image *image)
{
    FREED_BY(image_free) struct image source = {0};
    const char *table = tool_value(tool, "labels"), *slice = tool_value(tool, "slice");
    double unit = tool_length_unit(tool, "unit", 0);
    *image = (struct label_image){0};
    if (table != NULL) {
        TOOL_TRY(tool, label_table_read(table, &image->table, &error));
    }
    read_layers(tool, tool->operands, &source);
    for (int i = 0; i < 12 && unit > 0; i++) {
        source.to_world[i / 4][i % 4] *= unit / source.unit;
    }
    if (slice != NULL) {
        choose_slice(tool, &source, slice);
    }
    set_space(tool, &source, image);
    set_labels(tool, &source, image, table);
    check_size(tool, image, unit > 0);
    note_border(tool, image);
}

void label_image_free(struct label_image *image)
{
    FREE_ALL(image->labels.label, image->volume);
    label_table_free(&image->table);
    *image = (struct label_image){0};
}
