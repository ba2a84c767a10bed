static const char usage[] =
    "sample - values of an image at points\n"
    "\n"
    "usage: sample [-i METHOD] [-a SECTION] [-r REGION,...] [-u UNIT] [--outside V] [-o FILE] IMAGE [FILE]\n"
    "       sample --section NAME [-i METHOD] [-a SECTION] [--outside V] [-t] [-o FILE] IMAGE [FILE]\n"
    "       sample -p POINTS [-u UNIT] [-i METHOD] [--outside V] [-o FILE] IMAGE\n"
    "       sample --vector [-a SECTION] [--section NAME] [...] IMAGE [FILE]\n"
    "       sample --material TABLE [...] IMAGE [FILE]\n"
    "       sample --tissue E,NU [--tissue E,NU ...] [...] IMAGE... [FILE]\n"
    "\n"
    "Reads an image (NIfTI, NRRD or MetaImage; -: standard input) and prints a table with a\n"
    "row for each point: its coordinates and the image's values there (three for colours). The points are\n"
    "the nodes of a stream, its integration points or other points in it, or the rows of a table. The\n"
    "world axes of the image are those of the points: x to the right, y to the front, z up. Points in 2D\n"
    "go with an image of one slice: their x and y are the two world axes in it, in their order.\n"
    "\n"
    "With --material the values are turned into stiffness, by a table with rows of a value, E (Pa) and nu,\n"
    "ascending: linear between the rows, constant beyond. With --tissue each image is the probability of a\n"
    "tissue (0 to 1), and E and nu are the means of the tissues' weighted by it. The rows are then\n"
    "coordinates, E and nu at the integration points (ipoints is run with its defaults where it was\n"
    "not), as a scene's [material] takes them: table = FILE, unit = m. Leave to -r the regions of\n"
    "that material.\n"
    "\n"
    "With --vector the image holds directions of fibres, as of a diffusion tensor: three values at a voxel,\n"
    "along the world axes (to the left, to the back and up in NIfTI of intent 1007, NRRD and MetaImage).\n"
    "Signs and lengths do not matter: a (x) a of each voxel is interpolated, and the axis is the principal\n"
    "one. The stream is written with it at each integration point, as a section points.fibre, which mtled\n"
    "takes for a [material] with fibres that names neither fibre nor fibres; with -p it is a table. Where\n"
    "all voxels around a point have no length, it counts as outside; --outside 0 leaves zeros there.\n"
    "\n"
    "A point outside of the image, or where it is not finite, is an error, unless --outside gives it a\n"
    "value. Then such points are counted.\n"
    "\n"
    "Options:\n"
    "  -i, --interpolation METHOD\n"
    "                        nearest (for labels), linear (default) or cubic (Keys 1981)\n"
    "  -a, --at SECTION      the points: a section of coordinates, m (default nodes.x; points.x with\n"
    "                        --material and --tissue)\n"
    "  -r, --region REGION,...\n"
    "                        only the integration points in cells of these regions; needs points.x\n"
    "  -p, --points POINTS   the points: this table of coordinates, or landmarks of 3D Slicer, which are\n"
    "                        in mm (.mrk.json, .fcsv)\n"
    "  -u, --unit UNIT       of the coordinates read with -p and printed: m (default), cm, mm, um or so\n"
    "                        many metres\n"
    "      --outside V       the image's value at points outside of it\n"
    "      --section NAME    write the stream with a section of this name that holds the values\n"
    "      --vector          directions of fibres from an image of vectors\n"
    "      --material TABLE  stiffness from the values of an image\n"
    "      --tissue E,NU ...  stiffness from probabilities: E, Pa, and nu of an image's tissue\n"
    "  -t, --text            write the stream as text instead of binary\n"
    "  -o, --output FILE     write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  sample -i nearest labels.nii.gz body.mts > label_at_nodes.tsv\n"
    "  sample -p landmarks.tsv -u mm T1.nii.gz\n"
    "  nodes -u mm heart.msh | sample --vector dti.nii.gz - | mtled heart.scene > u.dat\n"
    "  sample --tissue 3000,0.49 --tissue 9000,0.49 white.nii.gz tumour.nii.gz table.mts > stiffness.tsv\n";

#include "images/images.h"
#include "points.h"
#include "stage_options.h"
#include "output.h"
#include "io/stream/sections.h"
#include "stages/views.h"

#include "base/eigen.h"
#include "base/box.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points, and the values of images there. */
struct sampled {
    struct points points;
    struct box box; /* of all points of the stream, beside the regions, too, m; of a table: none */
    int64_t cols;   /* values at a point */
    double *value;  /* points.count * cols */
};

/* The options. */
struct request {
    enum image_method method;
    const char *at, *section; /* section: NULL: none is written */
    double unit, outside;
    bool stiffness, axes;
    struct tissue tissue;
    int image_count;
};

static void parse(const struct tool *tool, struct request *request)
{
    const char *tissue[OPTIONS_MOST_USES];
    int tissue_count = 0;
    for (int i = 0; i < tool->options.use_count; i++) {
        if (tool->options.use[i].option->repeats) { /* --tissue alone does */
            tissue[tissue_count++] = tool->options.use[i].value;
        }
    }
    *request = (struct request){.method = tool_image_method(tool),
                                .at = tool_value(tool, "at"),
                                .section = tool_value(tool, "section"),
                                .unit = tool_length_unit(tool, "unit", 1),
                                .outside = tool_number(tool, "outside", -DBL_MAX, DBL_MAX, 0),
                                .stiffness = tool_given(tool, "material") || tissue_count > 0,
                                .axes = tool_given(tool, "vector"),
                                .image_count = tissue_count > 0 ? tissue_count : 1};
    static const char *const exclusive[][2] = {
        {"material", "tissue"}, {"points", "at"},     {"points", "region"}, {"points", "section"},
        {"vector", "material"}, {"vector", "tissue"}, {"vector", "region"}, {"section", "region"}};
    for (size_t e = 0; e < sizeof exclusive / sizeof *exclusive; e++) {
        tool_excludes(tool, exclusive[e][0], exclusive[e][1]);
    }
    if (request->axes && !tool_given(tool, "points") && request->section == NULL) {
        request->section = "points.fibre";
    }
    if (request->section != NULL && strcmp(request->section, "points.fibre") != 0 &&
        section_kind_of(request->section) != NULL) {
        tool_fail(tool, STATUS_INPUT, "--section %s: other programs make this section: give another name",
                  request->section);
    }
    if (request->axes && request->outside != 0) {
        tool_fail(tool, STATUS_INPUT, "--outside: with --vector it is 0: no direction");
    }
    if (request->section != NULL && tool_given(tool, "unit")) {
        tool_fail(tool, STATUS_INPUT, "-u is for tables: it does not go with --section");
    }
    if (tool->text && request->section == NULL) {
        tool_fail(tool, STATUS_INPUT, "-t is for streams: it needs --section (a table is text)");
    }
    if (request->at == NULL) {
        request->at =
            request->stiffness || request->axes || tool_given(tool, "region") ? "points.x" : "nodes.x";
    }
    if (tool_given(tool, "region") && strcmp(request->at, "points.x") != 0) {
        tool_fail(tool, STATUS_INPUT, "--region is for integration points (points.x), not for %s",
                  request->at);
    }
    if (tool_given(tool, "material")) {
        TOOL_TRY(tool, tissue_read(tool_value(tool, "material"), &request->tissue, &error));
    } else if (tissue_count > 0) {
        TOOL_TRY(tool, tissue_parse(tissue_count, tissue, &request->tissue, &error));
    }
}

/* Whether all values are finite and, of axes, not all 0. */
static bool are_good(const struct request *request, const double *values, size_t count)
{
    bool some = !request->axes;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(values[i])) {
            return false;
        }
        some = some || values[i] != 0;
    }
    return some;
}

/* Exit if all points of the stream would lie in one voxel. */
static void check_extent(const struct tool *tool, double inverse[3][4], const char *name,
                         const struct sampled *rows)
{
    double widest = 0;
    for (int r = 0; r < 3; r++) {
        double voxels = 0;
        for (int d = 0; d < rows->box.dim; d++) {
            voxels += fabs(inverse[r][d]) * (rows->box.high[d] - rows->box.low[d]);
        }
        widest = fmax(widest, voxels);
    }
    if (widest > 0 && widest < 1) {
        tool_fail(tool, STATUS_INPUT,
                  "%s: all points lie within %.2g of a voxel of %s: another space, or unit?",
                  rows->points.what, widest, name);
    }
}

/* Sample one image at all points, into columns from `first` on. */
static void sample_image(const struct tool *tool, const struct request *request, const struct image *image,
                         const char *name, struct sampled *rows, int64_t first)
{
    double inverse[3][4];
    int64_t outside = 0, first_outside = -1;
    image_to_voxel(image, inverse);
    check_extent(tool, inverse, name, rows);
    for (int64_t p = 0; p < rows->points.count; p++) {
        double place[3] = {0, 0, image->to_world[2][3]}, voxel[3];
        double *value = rows->value + p * rows->cols + first;
        memcpy(place, rows->points.x + p * rows->points.dim, (size_t)rows->points.dim * sizeof *place);
        image_map(&inverse[0][0], place, voxel);
        if (!image_sample(image, request->method, voxel, value) ||
            !are_good(request, value, image->components)) {
            first_outside = outside++ == 0 ? p : first_outside;
            for (size_t c = 0; c < image->components; c++) {
                value[c] = request->outside;
            }
        }
    }
    if (outside == 0) {
        return;
    }
    if (!tool_given(tool, "outside")) {
        tool_fail(tool, STATUS_INPUT,
                  "%s: row %jd at %s m, one of %jd of %jd: outside of %s, or not finite there: is the "
                  "unit right? "
                  "--outside V gives such points a value",
                  rows->points.what, first_outside,
                  POINT_TEXT(rows->points.dim, rows->points.x + first_outside * rows->points.dim), outside,
                  rows->points.count, name);
    }
    tool_note(tool, "%s: %jd of %jd points are outside of %s, or it is not finite there: %g taken",
              rows->points.what, outside, rows->points.count, name, request->outside);
}

static void check_probabilities(const struct tool *tool, const struct image *image, const char *name)
{
    for (size_t v = 0; v < image_voxels(image); v++) {
        if (isfinite(image->values[v]) && !(image->values[v] >= -0.001 && image->values[v] <= 1.001)) {
            tool_fail(tool, STATUS_INPUT, "%s: a value of %g: probabilities of tissues are from 0 to 1", name,
                      image->values[v]);
        }
    }
}

/* Replace the vectors of an image by a (x) a in the axes of the body. */
static void square_vectors(const struct tool *tool, const struct image_axes *axes, int dim,
                           struct image *image, const char *name)
{
    int count = dim * (dim + 1) / 2;
    double *values, mirror = image->intent == IMAGE_INTENT_VECTOR ? -1 : 1;
    if (image->components != 3 || image->datatype == IMAGE_RGB24) {
        tool_fail(tool, STATUS_INPUT, "%s: %s at a voxel: --vector takes images of vectors of three numbers",
                  name, image->components == 3 ? "a colour" : "not three values");
    }
    TOOL_TRY(tool, NEW_ARRAY(&values, (int64_t)image_voxels(image) * count, &error));
    for (size_t v = 0; v < image_voxels(image); v++) {
        const double *from = image->values + 3 * v;
        double world[3] = {mirror * from[0], mirror * from[1], from[2]}, a[3];
        for (int i = 0; i < 3; i++) {
            a[i] = world[axes->world[i]];
        }
        axis_square(dim, a, values + v * (size_t)count);
    }
    free(image->values);
    image->values = values;
    image->components = (size_t)count;
}

/* Replace the sampled a (x) a by their axes, 0 where there is none. */
static void find_axes(const struct tool *tool, struct sampled *rows)
{
    double *axes;
    TOOL_TRY(tool, NEW_ARRAY(&axes, rows->points.count * rows->points.dim, &error));
    for (int64_t p = 0; p < rows->points.count; p++) {
        double *axis = axes + p * rows->points.dim;
        if (!axis_principal(rows->points.dim, rows->value + p * rows->cols, axis)) {
            memset(axis, 0, (size_t)rows->points.dim * sizeof *axis);
        }
    }
    free(rows->value);
    rows->value = axes;
    rows->cols = rows->points.dim;
}

/* Sample all images. The first one determines the number of values at a point. */
static void sample_images(const struct tool *tool, const struct request *request, struct sampled *rows)
{
    for (int i = 0; i < request->image_count; i++) {
        FREED_BY(image_free) struct image image = {0};
        struct image_axes axes;
        tool_read_image(tool, tool->operands[i], &image);
        image_to_body(tool, &image, rows->points.dim, &axes);
        if (request->stiffness && image.components != 1) {
            tool_fail(tool, STATUS_INPUT, "%s: %zu values at a voxel: stiffness comes from one",
                      tool->operands[i], image.components);
        }
        if (request->axes) {
            square_vectors(tool, &axes, rows->points.dim, &image, tool->operands[i]);
        }
        if (request->tissue.count > 0) {
            check_probabilities(tool, &image, tool->operands[i]);
        }
        if (i == 0) {
            rows->cols = request->stiffness ? request->image_count : (int64_t)image.components;
            TOOL_TRY(tool, NEW_ARRAY(&rows->value, rows->points.count * rows->cols, &error));
        }
        sample_image(tool, request, &image, tool->operands[i], rows, i);
    }
}

static void find_moduli(const struct tool *tool, const struct tissue *tissue, struct sampled *rows)
{
    double(*moduli)[2];
    int64_t beyond = 0;
    TOOL_TRY(tool, NEW_ARRAY(&moduli, rows->points.count, &error));
    for (int64_t p = 0; p < rows->points.count; p++) {
        if (!tissue_moduli(tissue, rows->value + p * rows->cols, moduli[p], &beyond)) {
            tool_fail(tool, STATUS_INPUT,
                      "%s: row %jd at %s m: no tissue has a probability above 0 there (--outside 1 gives "
                      "points outside "
                      "of the images the mean of all)",
                      rows->points.what, p,
                      POINT_TEXT(rows->points.dim, rows->points.x + p * rows->points.dim));
        }
    }
    if (beyond > 0) {
        tool_note(tool, "%jd of %jd values lie beyond the table of --material: its first or last row taken",
                  beyond, rows->points.count);
    }
    free(rows->value);
    rows->value = *moduli;
    rows->cols = 2;
}

static void print_rows(FILE *file, const struct request *request, const struct sampled *rows)
{
    fprintf(file, "# x y%s", rows->points.dim == 3 ? " z" : "");
    for (int64_t c = 0; c < rows->cols; c++) {
        fprintf(file, " %s", request->stiffness ? c == 0 ? "E" : "nu" : "value");
    }
    fprintf(file, "\n");
    for (int64_t p = 0; p < rows->points.count; p++) {
        for (int i = 0; i < rows->points.dim; i++) {
            fprintf(file, "%s%.17g", i > 0 ? " " : "",
                    rows->points.x[p * rows->points.dim + i] / request->unit);
        }
        for (int64_t c = 0; c < rows->cols; c++) {
            fprintf(file, " %.17g", rows->value[p * rows->cols + c]);
        }
        fprintf(file, "\n");
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    struct request request;
    struct sampled rows = {.cols = 0};
    struct output output;
    char attributes[64];
    tool_begin(&tool, usage, 1, OPTIONS_MOST_USES + 1, argc, argv);
    parse(&tool, &request);
    const char *points = tool_value(&tool, "points");
    int most = request.image_count + (points == NULL ? 1 : 0);
    if (tool.operand_count < request.image_count || tool.operand_count > most) {
        tool_fail(&tool, STATUS_INPUT, "%d operands: %d image%s%s (see -h)", tool.operand_count,
                  request.image_count, request.image_count > 1 ? "s, one for each --tissue," : "",
                  points == NULL ? " and a stream, if not on standard input, are expected" : " expected");
    }
    if (points != NULL) {
        points_of_table(&tool, points, 0, &rows.points);
    } else {
        tool_read(&tool, tool.operands[request.image_count], &stream);
        if (strcmp(request.at, "points.x") == 0) {
            stage_fill(&tool, &stream, "ipoints");
        }
        points_of_section(&tool, &stream, request.at, &rows.points);
        rows.box = box_of(rows.points.dim, rows.points.count, rows.points.x);
    }
    if (tool_given(&tool, "region")) {
        points_in_regions(&tool, &stream, tool_value(&tool, "region"), &rows.points);
    }
    sample_images(&tool, &request, &rows);
    if (request.stiffness) {
        find_moduli(&tool, &request.tissue, &rows);
    }
    if (request.axes) {
        find_axes(&tool, &rows);
    }
    if (request.section != NULL) {
        tool_put(&tool, &stream, request.section, TYPE_F8, rows.points.count, rows.cols,
                 request.stiffness ? "cols=E,nu"
                 : request.axes    ? vector_attributes(rows.points.dim, "1", attributes)
                                   : "",
                 array_take(&rows.value));
        tool_write(&tool, &stream);
    } else {
        TOOL_TRY(&tool, output_open(&output, tool.output, false, &error));
        print_rows(output.file, &request, &rows);
        TOOL_TRY(&tool, output_end(&output, STATUS_OK, &error));
    }
    points_free(&rows.points);
    free(rows.value);
    tissue_free(&request.tissue);
    return tool_end(&tool);
}
