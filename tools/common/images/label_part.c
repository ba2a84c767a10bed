#include "images/label_image.h"

#include "images/images.h"

#include <stdlib.h>
#include <string.h>

/* A ball, or the nonzero voxels of a mask. */
struct place {
    struct label_ball ball;
    struct image mask;
    double to_voxel[3][4]; /* of the mask */
};

/* World coordinates of a voxel centre, m. */
static void world_of(const struct label_image *image, int64_t voxel, double world[3])
{
    const int64_t *size = image->labels.size;
    int64_t line = voxel / size[0], slice = line / size[1];
    const double at[3] = {(double)(voxel % size[0]), (double)(line % size[1]), (double)slice};
    image_map(&image->to_world[0][0], at, world);
}

static bool is_within(const struct place *place, const struct labels *labels, const double world[3])
{
    double square = 0, index[3], value[4];
    for (int d = 0; d < labels->dim; d++) {
        double step = world[labels->dim == 3 ? d : labels->axis[d]] - place->ball.centre[d];
        square += step * step;
    }
    if (place->ball.radius > 0) {
        return square <= place->ball.radius * place->ball.radius;
    }
    image_map(&place->to_voxel[0][0], world, index);
    return image_sample(&place->mask, IMAGE_NEAREST, index, value) &&
           image_whole(&place->mask, value[0]) != 0;
}

/* Parse "X,Y,Z,RADIUS", in 2D "X,Y,RADIUS". */
static void parse_ball(const struct tool *tool, const char *text, int dim, struct place *place)
{
    double value[4] = {0};
    SCRATCH char *copy = tool_memory(tool, strdup(text));
    char *rest = copy;
    int count = 0;
    for (const char *word = strsep(&rest, ","); word != NULL; word = strsep(&rest, ",")) {
        if (count == dim + 1) {
            tool_fail(tool, STATUS_INPUT, "--part: ball:%s: %d lengths are wanted", text, dim + 1);
        }
        TOOL_TRY(tool, parse_coordinate(word, "--part", &value[count++], &error));
    }
    if (count != dim + 1 || !(value[dim] > 0)) {
        tool_fail(tool, STATUS_INPUT, "--part: ball:%s: %d lengths are wanted, the radius above 0", text,
                  dim + 1);
    }
    memcpy(place->ball.centre, value, sizeof place->ball.centre);
    place->ball.radius = value[dim];
}

static void check_name(const struct tool *tool, const struct label_image *image, const char *name)
{
    bool taken = strcmp(name, "outside") == 0 || label_image_find(image, name) >= 0;
    for (int32_t p = 0; p < image->part_count; p++) {
        taken = taken || strcmp(image->part[p], name) == 0;
    }
    if (name[0] == '\0' || strpbrk(name, "|,:\" \t") != NULL) {
        tool_fail(tool, STATUS_INPUT,
                  "--part: '%.60s': a name without commas, colons, bars and blanks is wanted", name);
    }
    if (taken) {
        tool_fail(tool, STATUS_INPUT, "--part: '%.60s' is the name of a label or of another part", name);
    }
}

/* The label of voxels of a region in the last part, which is added if it is new. */
static int32_t part_label(const struct tool *tool, const struct label_ball *ball, struct label_image *image,
                          int32_t region)
{
    int32_t count = image->labels.count;
    for (int32_t l = image->table.name_count + 1; l < count; l++) {
        if (image->part_of[l] == image->part_count - 1 && image->region[l] == region) {
            return l;
        }
    }
    TOOL_TRY(tool, count < UINT16_MAX ? STATUS_OK : fail_memory(&error, "labels"));
    TOOL_TRY(tool, RESIZE_ARRAY(&image->region, count + 1, &error));
    TOOL_TRY(tool, RESIZE_ARRAY(&image->part_of, count + 1, &error));
    TOOL_TRY(tool, RESIZE_ARRAY(&image->keep, count + 1, &error));
    TOOL_TRY(tool, RESIZE_ARRAY(&image->volume, count + 1, &error));
    TOOL_TRY(tool, RESIZE_ARRAY(&image->ball, count + 1, &error));
    image->labels.ball = image->ball;
    image->ball[count] = *ball;
    image->keep[count] = true;
    image->volume[count] = 0;
    image->region[count] = region;
    image->part_of[count] = image->part_count - 1;
    image->labels.count++;
    return count;
}

static void make_part(const struct tool *tool, const struct place *place, struct label_image *image)
{
    const int64_t *size = image->labels.size;
    int64_t voxels = 0;
    for (int64_t v = 0; v < size[0] * size[1] * size[2]; v++) {
        double world[3];
        world_of(image, v, world);
        if (image->keep[image->voxel[v]] && is_within(place, &image->labels, world)) {
            int32_t label = part_label(tool, &place->ball, image, image->region[image->voxel[v]]);
            image->volume[image->voxel[v]] -= image->voxel_volume;
            image->volume[label] += image->voxel_volume;
            image->voxel[v] = (uint16_t)label;
            voxels++;
        }
    }
    if (voxels == 0) {
        tool_fail(tool, STATUS_INPUT, "--part %s: no voxel of a label that is kept lies in it",
                  image->part[image->part_count - 1]);
    }
}

static void add_part(const struct tool *tool, const char *text, struct label_image *image)
{
    struct place place = {0};
    size_t length = strcspn(text, "=");
    if (text[length] == '\0') {
        tool_fail(tool, STATUS_INPUT, "--part: '%.60s' is not NAME=ball:X,Y,Z,RADIUS or NAME=IMAGE", text);
    }
    const char *expression = text + length + 1;
    char *name = tool_memory(tool, strndup(text, length));
    TOOL_TRY(tool, RESIZE_ARRAY(&image->part, image->part_count + 1, &error));
    check_name(tool, image, name);
    image->part[image->part_count++] = name;
    if (strncmp(expression, "ball:", 5) == 0) {
        parse_ball(tool, expression + 5, image->labels.dim, &place);
    } else {
        tool_read_image(tool, expression, &place.mask);
        if (place.mask.components > 1) {
            tool_fail(tool, STATUS_INPUT, "--part %s: %zu values at each voxel: not a mask", name,
                      place.mask.components);
        }
        image_to_voxel(&place.mask, place.to_voxel);
    }
    make_part(tool, &place, image);
    image_free(&place.mask);
}

void label_parts_make(const struct tool *tool, struct label_image *image)
{
    const char *part[OPTIONS_MOST_USES];
    int count = tool_values(tool, "part", part);
    for (int i = 0; i < count; i++) {
        add_part(tool, part[i], image);
    }
}
