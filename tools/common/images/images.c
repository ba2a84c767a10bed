#include "images/images.h"

#include "approx/cells/cells.h"
#include "base/box.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/vector.h"
#include "io/files/textfile.h"
#include "output.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void tool_read_image(const struct tool *tool, const char *file, struct image *image)
{
    const char *name;
    FREED_BY(descriptor_close) int descriptor = tool_open(tool, file, &name);
    TOOL_TRY(tool, image_read_from(image, descriptor, name, &error));
    if (image->note[0] != '\0') {
        tool_note(tool, "%s: %s", name, image->note);
    }
}

enum image_method tool_image_method(const struct tool *tool)
{
    return (enum image_method)tool_choice(tool, "interpolation", image_method_names, IMAGE_METHOD_COUNT,
                                          IMAGE_LINEAR);
}

/* The format that the end of a file's name asks for, or `other`. */
static int format_of(const char *name, int other)
{
    static const char *const ends[IMAGE_FORMATS] = {[IMAGE_NIFTI_GZIP] = ".nii.gz",
                                                    [IMAGE_NIFTI] = ".nii",
                                                    [IMAGE_NRRD] = ".nrrd",
                                                    [IMAGE_METAIMAGE] = ".mha"};
    for (int f = 0; f < IMAGE_FORMATS; f++) {
        if (text_ends(name, ends[f])) {
            return f;
        }
    }
    return text_ends(name, ".nhdr") ? IMAGE_NRRD : text_ends(name, ".mhd") ? IMAGE_METAIMAGE : other;
}

/* The file of the values of an image written as NAME.nhdr or NAME.mhd, NAME.raw; NULL: it is one file. */
static char *data_file(const struct tool *tool)
{
    const char *name = tool->output;
    int end = name == NULL ? 0 : text_ends(name, ".nhdr") ? 5 : text_ends(name, ".mhd") ? 4 : 0;
    return end > 0 ? tool_text(tool, "%.*s.raw", (int)strlen(name) - end, name) : NULL;
}

static const char *within_folder(const char *path)
{
    return strrchr(path, '/') != NULL ? strrchr(path, '/') + 1 : path;
}

/* A header names its data in the rest of a line, without patterns; data of another header are not replaced.
 */
static void check_data_file(const struct tool *tool)
{
    SCRATCH char *data = data_file(tool);
    const char *within = data != NULL ? within_folder(data) : "";
    if (strpbrk(within, "%\n\r") != NULL || within[0] == ' ' || within[0] == '\t' ||
        strncmp(within, "LIST", 4) == 0) {
        tool_fail(tool, STATUS_INPUT, "-o %s: a header cannot name data of such a name", tool->output);
    }
    if (data != NULL && access(data, F_OK) == 0 && access(tool->output, F_OK) != 0) {
        tool_fail(tool, STATUS_INPUT, "-o %s: replaces %s, which may be of another image: name another file",
                  tool->output, data);
    }
}

void tool_check_image_output(const struct tool *tool)
{
    if (tool->output == NULL && isatty(STDOUT_FILENO)) {
        tool_fail(tool, STATUS_INPUT, "no image to a terminal: redirect it, or name a file with -o");
    }
    const char *name = tool->output;
    if (name != NULL && format_of(name, IMAGE_FORMATS) == IMAGE_FORMATS && strchr(name, '.') != NULL &&
        strncmp(name, "/dev/", 5) != 0) {
        tool_fail(tool, STATUS_INPUT,
                  "-o %s: images are written as .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd", name);
    }
    check_data_file(tool);
}

static enum status write_image(const struct tool *tool, const struct image *image, const char *data,
                               struct error *error)
{
    int format = tool->output != NULL ? format_of(tool->output, (int)image->format) : (int)image->format;
    struct output output;
    if (data != NULL) { /* before the header, without which they are no image */
        RETURN_IF_ERROR(output_open(&output, data, false, error));
        RETURN_IF_ERROR(output_end(&output, image_write_data(image, output.file, error), error));
    }
    RETURN_IF_ERROR(output_open(&output, tool->output, false, error));
    return output_end(&output,
                      image_write(image, output.file, (enum image_format)format,
                                  data != NULL ? within_folder(data) : NULL, error),
                      error);
}

void tool_write_image(const struct tool *tool, const struct image *image)
{
    SCRATCH char *data = data_file(tool);
    TOOL_TRY(tool, write_image(tool, image, data, &error));
}

/* ---- a body and the voxels of an image ---- */

static const double most_ratio = 100; /* body to image */

int image_axis_across(const struct image *image, int voxel)
{
    for (int w = 0; w < 3; w++) {
        bool across = true;
        for (int c = 0; c < 3; c++) {
            across = across && (c == voxel || fabs(image->to_world[w][c]) <= 1e-3 * image_step(image, c));
        }
        if (across) {
            return w;
        }
    }
    return -1;
}

/* Bring the world and voxel axes of an image into the order of the body, or back. The voxel axis across a
 * slice may be moved behind the others without moving values. */
static void reorder(struct image *image, const struct image_axes *axes, bool back)
{
    struct image before = *image;
    for (int r = 0; r < 3; r++) {
        image->size[back ? axes->voxel[r] : r] = before.size[back ? r : axes->voxel[r]];
        for (int c = 0; c < 3; c++) {
            int world = axes->world[r], voxel = axes->voxel[c];
            image->to_world[back ? world : r][back ? voxel : c] =
                before.to_world[back ? r : world][back ? c : voxel];
        }
        image->to_world[back ? axes->world[r] : r][3] = before.to_world[back ? r : axes->world[r]][3];
    }
}

void image_to_body(const struct tool *tool, struct image *image, int dim, struct image_axes *axes)
{
    *axes = (struct image_axes){{0, 1, 2}, {0, 1, 2}};
    if (dim == 3) {
        return;
    }
    int flat = image->size[2] == 1 ? 2 : image->size[1] == 1 ? 1 : 0;
    int a = flat == 0 ? 1 : 0, b = flat == 2 ? 1 : 2, across = image_axis_across(image, flat);
    if (image->size[flat] > 1) {
        tool_fail(tool, STATUS_INPUT,
                  "the body is in 2D: it goes with an image of one slice across a world axis, not one of "
                  "several slices");
    }
    if (across < 0) {
        tool_fail(tool, STATUS_INPUT, "the slice is oblique to the axes of the world: resample it first");
    }
    *axes = (struct image_axes){{across == 0 ? 1 : 0, across == 2 ? 1 : 2, across}, {a, b, flat}};
    reorder(image, axes, false);
}

void image_from_body(struct image *image, const struct image_axes *axes)
{
    reorder(image, axes, true);
}

static double determinant(const struct image *grid, int dim)
{
    double m[3][4];
    image_to_voxel(grid, m);
    return dim == 2 ? determinant2(m[0], m[1]) : determinant3(m[0], m[1], m[2]);
}

double voxel_volume(const struct image *image, int dim)
{
    return 1 / fabs(determinant(image, dim));
}

double least_step(const struct image *image, int dim)
{
    double least = INFINITY;
    for (int i = 0; i < dim; i++) {
        least = fmin(least, image_step(image, i));
    }
    return least;
}

/* place[node_count * dim]: the nodes in voxels of the grid. */
static double *nodes_in_voxels(const struct tool *tool, const struct image *grid, const struct cells *cells,
                               const double *x)
{
    int dim = cells->dim;
    double inverse[3][4], *place;
    image_to_voxel(grid, inverse);
    TOOL_TRY(tool, NEW_ARRAY(&place, cells->node_count * dim, &error));
    for (int64_t n = 0; n < cells->node_count; n++) {
        double world[3] = {0, 0, grid->to_world[2][3]}, voxel[3];
        memcpy(world, x + n * dim, (size_t)dim * sizeof *x);
        image_map(&inverse[0][0], world, voxel);
        memcpy(place + n * dim, voxel, (size_t)dim * sizeof *place);
    }
    return place;
}

int32_t *find_owners(const struct tool *tool, const struct image *grid, const struct cells *cells,
                     const double *x, int64_t *doubly)
{
    struct cells placed = *cells;
    int32_t *owner;
    const int64_t size[3] = {(int64_t)grid->size[0], (int64_t)grid->size[1], (int64_t)grid->size[2]};
    SCRATCH double *place = nodes_in_voxels(tool, grid, cells, x);
    int sign = determinant(grid, cells->dim) < 0 ? -1 : 1;
    TOOL_TRY(tool, NEW_ARRAY(&owner, size[0] * size[1] * size[2], &error));
    placed.x = place;
    raster_cells(&placed, sign, size, owner, doubly);
    return owner;
}

static struct box image_box(const struct image *image)
{
    double corner[8][3];
    for (int c = 0; c < 8; c++) {
        double voxel[3];
        for (int i = 0; i < 3; i++) {
            voxel[i] = c >> i & 1 ? (double)image->size[i] - 1 : 0;
        }
        image_world(image, voxel, corner[c]);
    }
    return box_of(3, 8, corner[0]);
}

/* Exit if body and image do not overlap, or have impossible sizes. */
void check_image_overlap(const struct tool *tool, const struct image *grid, const struct cells *cells,
                         const double *x, int64_t inside)
{
    char body_text[128], grid_text[128];
    struct box body = box_of(cells->dim, cells->node_count, x), box = image_box(grid);
    box.dim = cells->dim;
    if (box_diagonal(&body) > most_ratio * box_diagonal(&box)) {
        tool_fail(tool, STATUS_INPUT,
                  "the body (%s) is more than %.0f times larger than the image (%s): is its unit right?",
                  box_text(&body, body_text), most_ratio, box_text(&box, grid_text));
    }
    if (inside == 0) {
        tool_fail(tool, STATUS_INPUT,
                  "no voxel of the image (%s) lies in the body (%s): another space, or unit?",
                  box_text(&box, grid_text), box_text(&body, body_text));
    }
}

void note_image_outside(const struct tool *tool, const struct image *image, const struct cells *cells,
                        const double *x)
{
    int64_t outside = 0;
    SCRATCH double *place = nodes_in_voxels(tool, image, cells, x);
    for (int64_t n = 0; n < cells->node_count; n++) {
        bool within = true;
        for (int i = 0; i < cells->dim; i++) {
            double at = place[n * cells->dim + i];
            within = within && at >= -1 && at <= (double)image->size[i];
        }
        outside += within ? 0 : 1;
    }
    if (outside > 0) {
        tool_note(tool,
                  "%jd of %jd nodes of the body lie more than half a voxel outside of the image: it shows a "
                  "part of the body, or another unit or direction of an axis",
                  outside, cells->node_count);
    }
}

/* ---- stiffness of tissues ---- */

enum status moduli_check(const double moduli[2], struct error *error)
{
    return moduli[0] > 0 && moduli[1] > -1 && moduli[1] < 0.5
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "E = %g, nu = %g: E must be positive, nu within (-1, .5)",
                      moduli[0], moduli[1]);
}

enum status tissue_read(const char *path, struct tissue *tissue, struct error *error)
{
    struct table *law = &tissue->law;
    *tissue = (struct tissue){0};
    RETURN_IF_ERROR(table_read(path, 3, 3, law, error));
    for (int64_t r = 0; r < law->rows; r++) {
        enum status status = moduli_check(law->values + 3 * r + 1, error);
        if (status == STATUS_OK && r > 0 && !(law->values[3 * r] > law->values[3 * (r - 1)])) {
            status = fail(error, STATUS_INPUT, "the values of the image (first column) must ascend");
        }
        RETURN_IF_ERROR(fail_in(error, status, "%s: line %jd", path, law->line[r]));
    }
    return STATUS_OK;
}

enum status tissue_parse(int count, const char *const text[], struct tissue *tissue, struct error *error)
{
    *tissue = (struct tissue){.count = count};
    RETURN_IF_ERROR(NEW_ARRAY(&tissue->moduli, count, error));
    for (int i = 0; i < count; i++) {
        int numbers;
        RETURN_IF_ERROR(
            parse_double_list(text[i], "--tissue", -DBL_MAX, DBL_MAX, 2, tissue->moduli[i], &numbers, error));
        if (numbers != 2) {
            return fail(error, STATUS_INPUT, "--tissue %s: two numbers, E (Pa) and nu", text[i]);
        }
        RETURN_IF_ERROR(fail_in(error, moduli_check(tissue->moduli[i], error), "--tissue"));
    }
    return STATUS_OK;
}

static void by_law(const struct table *law, double value, double moduli[2], int64_t *beyond)
{
    const double *rows = law->values;
    int64_t last = law->rows - 1, row = 0;
    *beyond += value < rows[0] || value > rows[3 * last];
    while (row < last - 1 && value > rows[3 * (row + 1)]) {
        row++;
    }
    const double *low = rows + 3 * row, *high = last > 0 ? low + 3 : low;
    double share = last > 0 ? fmin(fmax((value - low[0]) / (high[0] - low[0]), 0), 1) : 0;
    for (int i = 0; i < 2; i++) {
        moduli[i] = (1 - share) * low[1 + i] + share * high[1 + i];
    }
}

bool tissue_moduli(const struct tissue *tissue, const double *value, double moduli[2], int64_t *beyond)
{
    double sum = 0;
    if (tissue->law.rows > 0) {
        by_law(&tissue->law, value[0], moduli, beyond);
        return true;
    }
    moduli[0] = moduli[1] = 0;
    for (int i = 0; i < tissue->count; i++) {
        double share = fmax(value[i], 0);
        sum += share;
        moduli[0] += share * tissue->moduli[i][0];
        moduli[1] += share * tissue->moduli[i][1];
    }
    moduli[0] /= sum;
    moduli[1] /= sum;
    return sum > 0;
}

void tissue_free(struct tissue *tissue)
{
    table_free(&tissue->law);
    free(tissue->moduli);
    *tissue = (struct tissue){0};
}
