static const char usage[] =
    "warp - move an image by a displacement field, or write the field as an image\n"
    "\n"
    "usage: warp [-i METHOD] [--like GRID] [--fill VALUES] [--vacated VALUES] [--inverse] [--frame K] [-v]\n"
    "            [-o FILE] IMAGE [FILE]\n"
    "       warp --field [--inverse] [--frame K] [-v] [-o FILE] GRID [FILE]\n"
    "\n"
    "Reads an image (NIfTI, NRRD or MetaImage; -: standard input) and a stream with nodes.x (m), cells\n"
    "and the displacement u (m), and writes the image moved: at each voxel x the value of IMAGE at the\n"
    "place X that moves to x, X + u(X) = x. The world axes of the image are those of the nodes: x to the\n"
    "right, y to the front, z up. A body in 2D moves an image of one slice: its x and y are the two world\n"
    "axes in the slice, in their order.\n"
    "Images may be scans, colours (RGB) or labels, of any type, size of voxels, order and direction of\n"
    "axes; values keep their type and scaling.\n"
    "\n"
    "Between the nodes the displacement is quadratic in each cell, continuous, with the gradients of the\n"
    "field that mtled solved for (its section parameters) at the nodes, or of a fit where the stream\n"
    "does not tell that field. Places are found by Newton's method to 1e-4 of a voxel, from\n"
    "the moved cell that the voxel lies in. Voxels outside of the moved body keep their value. So do\n"
    "voxels that the body has left, with a note, unless --vacated or --fill gives them a value. Where X\n"
    "lies outside of IMAGE the value is that of --fill, or 0, and a note counts these voxels.\n"
    "\n"
    "With --field the displacement field is written on the grid of an image instead, as a transform for\n"
    "programs based on ITK (3D Slicer, ANTs, plastimatch): vectors of float32, in mm, to the left, to the\n"
    "back, up (LPS), in NIfTI of 5 dimensions and intent 1007. It leads from places of the result to places\n"
    "of the image, X - x at x, and is 0 outside of the moved body. So it moves images; 3D Slicer moves\n"
    "points by it, too. With --inverse it is u at X, which moves points, and brings moved images back.\n"
    "\n"
    "The format written is that of the name of FILE, .nii.gz, .nii, .nrrd, .mha, or .nhdr or .mhd with the\n"
    "values in NAME.raw beside it, else that of IMAGE.\n"
    "A body of which no voxel is inside, or that is a hundred times larger than the image, is refused;\n"
    "folded cells are left out, with a note.\n"
    "\n"
    "Options:\n"
    "  -i, --interpolation METHOD\n"
    "                     nearest (for labels), linear (default) or cubic (Keys 1981)\n"
    "      --like GRID    write on the grid of this image, not that of IMAGE\n"
    "      --fill VALUES  the value of all voxels outside of the moved body, V, or by their label in IMAGE,\n"
    "                     LABEL=V,...; a V in this list is for all other labels\n"
    "      --vacated VALUES  the same for voxels where the body was and is no more; labels without a value\n"
    "                     have that of --fill\n"
    "      --field        write the displacement field\n"
    "      --inverse      the other way: at X the value of IMAGE, which shows the moved body, at X + u(X)\n"
    "      --frame K      take u.frame.K in place of u\n"
    "  -v, --verbose      tell what was moved, how far, and how exact the inverse map is\n"
    "  -o, --output FILE  write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  warp -i linear T1.nii.gz u.dat > predicted.nii.gz\n"
    "  warp -i nearest --vacated 0 -o moved.nii.gz labels.nii.gz u.dat\n"
    "  warp -i nearest --vacated 1=2 --fill 3=0 labels.nii.gz u.dat > resected.nii.gz\n"
    "  warp --field -o field.nrrd T1.nrrd u.dat\n"
    "  plastimatch warp --input T1.nrrd --xf field.nrrd --output-img predicted.nrrd\n";

#include "comparison.h"
#include "images/images.h"
#include "warp/label_values.h"

#include "approx/field/motion.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

static const double tolerance = 1e-4; /* of positions, in voxels */

/* ---- the loop over the voxels of a moved image, or of the field as an image ---- */

/* The outcome: numbers of voxels, and largest values. */
struct warp_report {
    int64_t moved, vacated, beyond; /* in the moved body; uncovered; with a place outside of the image */
    int64_t left;                   /* uncovered, with their old value */
    int64_t doubly, inexact;        /* in two cells; whose place was not found */
    double farthest;                /* displacement, m */
    double inconsistency;           /* |place(X) - x|, m */
};

/* The input of the loop over voxels. */
struct warp_job {
    enum image_method method;
    bool inverse;
    struct label_values fill, vacated; /* outside of the moved body, and where it has been */
    const struct image *source;        /* NULL: the field is written */
    double source_voxel[3][4];
    const struct motion *motion;
    const int32_t *owner,
        *other;       /* cell of each voxel in the state of the result; and in the other state, or NULL */
    double tolerance; /* m */
    const struct image_axes *axes;
    struct image *result;
};

/* place[]: the position in the other state that corresponds to x; outside of the body x itself. */
static void find_place(const struct warp_job *job, int64_t v, const double x[3], double place[3],
                       struct warp_report *report)
{
    int dim = job->motion->cells.dim;
    double residual = 0;
    memcpy(place, x, 3 * sizeof *x);
    if (job->owner[v] < 0) {
        return;
    }
    if (job->inverse) {
        motion_place(job->motion, job->owner[v], x, place);
    } else if (!motion_inverse(job->motion, job->owner[v], x, job->tolerance, place, &residual)) {
        report->inexact++;
    }
    report->moved++;
    report->farthest = fmax(report->farthest, vector_distance(dim, place, x));
    report->inconsistency = fmax(report->inconsistency, residual);
}

/* The value that the options give a voxel outside of the moved body; NAN: none. */
static double given_value(const struct warp_job *job, const double voxel[3], bool vacated)
{
    double label = NAN;
    if (job->source->components == 1 && image_sample(job->source, IMAGE_NEAREST, voxel, &label)) {
        label = image_whole(job->source, label);
    }
    double value = vacated ? label_value(&job->vacated, label) : NAN;
    return isnan(value) ? label_value(&job->fill, label) : value;
}

/* Set the value of the moved image at voxel v, that of the source at `place`. */
static void put_value(const struct warp_job *job, int64_t v, const double place[3],
                      struct warp_report *report)
{
    size_t components = job->result->components;
    double voxel[3], *value = job->result->values + (size_t)v * components;
    bool outside = job->owner[v] < 0, vacated = outside && job->other[v] >= 0;
    image_map(&job->source_voxel[0][0], place, voxel);
    double given = outside ? given_value(job, voxel, vacated) : NAN, others = label_value(&job->fill, NAN);
    report->vacated += vacated;
    report->left += vacated && isnan(given);
    if (isnan(given) && image_sample(job->source, job->method, voxel, value)) {
        return;
    }
    report->beyond += isnan(given);
    for (size_t c = 0; c < components; c++) {
        value[c] = !isnan(given) ? given : isnan(others) ? 0 : others;
    }
}

static void do_row(const struct warp_job *job, int64_t row, struct warp_report *report)
{
    struct image *result = job->result;
    int64_t width = (int64_t)result->size[0], height = (int64_t)result->size[1];
    int64_t j = row % height, k = row / height;
    for (int64_t i = 0; i < width; i++) {
        int64_t v = row * width + i;
        const double voxel[3] = {(double)i, (double)j, (double)k};
        double x[3], place[3];
        image_world(result, voxel, x);
        find_place(job, v, x, place, report);
        if (job->source != NULL) {
            put_value(job, v, place, report);
            continue;
        }
        for (int c = 0; c < 3; c++) { /* to ITK's axes and unit */
            int axis = job->axes->world[c];
            result->values[3 * v + axis] = (axis < 2 ? -1e3 : 1e3) * (place[c] - x[c]);
        }
    }
}

/* Find the value of each voxel of the result, and add to the report. */
static void warp_voxels(const struct warp_job *job, struct warp_report *report)
{
    int64_t rows = (int64_t)(job->result->size[1] * job->result->size[2]);
#pragma omp parallel for schedule(dynamic, 16)
    for (int64_t row = 0; row < rows; row++) {
        struct warp_report own = {0};
        do_row(job, row, &own);
#pragma omp critical
        {
            report->moved += own.moved, report->vacated += own.vacated, report->left += own.left;
            report->beyond += own.beyond, report->inexact += own.inexact;
            report->farthest = fmax(report->farthest, own.farthest);
            report->inconsistency = fmax(report->inconsistency, own.inconsistency);
        }
    }
}

/* ---- what is read and told ---- */

static void check_options(const struct tool *tool)
{
    static const char *const of_images[] = {"interpolation", "like", "fill", "vacated", NULL};
    const char *of_image = tool_first_given(tool, of_images);
    if (tool_given(tool, "field") && of_image != NULL) {
        tool_fail(tool, STATUS_INPUT, "--%s is for images, not for --field", of_image);
    }
    tool_check_image_output(tool);
}

static void print_report(const struct tool *tool, const struct warp_job *job, const struct image *grid,
                         const struct warp_report *report)
{
    const struct motion *motion = job->motion;
    int dim = motion->cells.dim;
    int64_t first = 0, folded = motion_folded(motion, &first);
    if (folded > 0) {
        tool_note(tool,
                  "%jd of %jd cells are folded (the first: row %jd of cells), and left out: what lies "
                  "there shows "
                  "their neighbours or stays",
                  folded, motion->cells.count, first);
    }
    if (report->beyond > 0) {
        tool_note(tool, "%jd voxels show places outside of the image: %s there", report->beyond,
                  isnan(label_value(&job->fill, NAN)) ? "0" : "the value of --fill");
    }
    if (report->left > 0) {
        tool_note(tool, "%jd voxels that the body left keep their old value: see --vacated", report->left);
    }
    if (!tool_given(tool, "verbose")) {
        return;
    }
    tool_note(tool, "%zu x %zu x %zu voxels of %.4g x %.4g x %.4g mm", grid->size[0], grid->size[1],
              grid->size[2], 1e3 * image_step(grid, 0), 1e3 * image_step(grid, 1), 1e3 * image_step(grid, 2));
    tool_note(tool,
              dim == 3 ? "%jd voxels in the %sbody, %.6g ml; displacement at most %.4g mm"
                       : "%jd voxels in the %sbody, %.6g cm2; displacement at most %.4g mm",
              report->moved, job->inverse ? "" : "moved ",
              (dim == 3 ? 1e6 : 1e4) * (double)report->moved * voxel_volume(grid, dim),
              1e3 * report->farthest);
    if (report->doubly > 0) {
        tool_note(tool, "%jd voxels lie in two parts of the moved body", report->doubly);
    }
    if (tool_given(tool, "vacated")) {
        tool_note(tool, "%jd voxels were left by the body", report->vacated);
    }
    if (!job->inverse) {
        tool_note(tool,
                  "inverse map: largest residual %.2g voxels; Newton did not converge to %.0e in %jd voxels, "
                  "where the linear inverse of the cell is taken",
                  report->inconsistency / least_step(grid, dim), tolerance, report->inexact);
    }
}

/* Make the result, all zero: an image like the source on the grid of another one, or the field there. */
static void new_result(const struct tool *tool, bool field, struct image *source, const struct image *grid,
                       struct image *result)
{
    TOOL_TRY(tool, image_new(result, grid->size, field ? 3 : source->components, &error));
    double *values = result->values;
    if (!field) {
        *result = *source;
        result->values = values;
        source->segment_count = 0; /* the result has them */
        source->segment = NULL;
        result->unit = grid->unit;
    } else { /* the vectors are in mm, and ITK reads mm */
        snprintf(result->description, sizeof result->description, "displacement, mm, LPS, from %s",
                 tool_given(tool, "inverse") ? "reference to moved" : "result to image");
        result->format = grid->format;
    }
    memcpy(result->size, grid->size, sizeof result->size);
    memcpy(result->to_world, grid->to_world, sizeof result->to_world);
    result->space = grid->space;
    result->version = grid->version;
}

static void note_not_finite(const struct tool *tool, const struct image *image)
{
    size_t count = 0;
    for (size_t i = 0; i < image_voxels(image) * image->components; i++) {
        count += isfinite(image->values[i]) ? 0 : 1;
    }
    if (count > 0) {
        tool_note(tool, "%s: %zu values are not finite: neither is what is interpolated beside them",
                  tool->operands[0], count);
    }
}

/* Build the motion, with gradients of the field that mtled computed, if the stream has it. */
static void build_motion(const struct tool *tool, const struct nodal_field *u, struct motion *motion)
{
    struct error error;
    enum status status = motion_build(u, false, motion, &error);
    if (status == STATUS_VERDICT) {
        tool_note(tool, "displacement taken as linear in each cell: %s", error.text);
        motion_free(motion);
        status = motion_build(u, true, motion, &error);
    }
    tool_check(tool, status, &error);
}

/* Bring the axes of the image, and of the grid of the result, into the order of the body's axes. */
static void turn_images(const struct tool *tool, int dim, struct image *image, struct image *like,
                        struct image_axes *axes)
{
    image_to_body(tool, image, dim, axes);
    int across = axes->world[2];
    if (tool_given(tool, "like")) {
        image_to_body(tool, like, dim, axes);
    }
    if (across != axes->world[2]) {
        tool_fail(tool, STATUS_INPUT, "--like %s: lies in another plane than %s", tool_value(tool, "like"),
                  tool->operands[0]);
    }
}

/* For each voxel of the grid the cell that contains it in the state of the result. */
static int32_t *find_seen(const struct tool *tool, const struct image *grid, const struct cells *cells,
                          const double *seen, int64_t *doubly)
{
    int64_t inside = 0;
    int32_t *owner = find_owners(tool, grid, cells, seen, doubly);
    for (size_t v = 0; v < image_voxels(grid); v++) {
        inside += owner[v] >= 0;
    }
    check_image_overlap(tool, grid, cells, seen, inside);
    return owner;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct side side;
    struct warp_report report = {0};
    FREED_BY(image_free) struct image image = {0}, like = {0}, result = {0};
    FREED_BY(motion_free) struct motion motion = {0};
    struct image_axes axes; /* of the grid */
    char section[32] = "u";
    int64_t ignored;
    tool_begin(&tool, usage, 1, 2, argc, argv);
    struct warp_job job = {.method = tool_image_method(&tool), .inverse = tool_given(&tool, "inverse")};
    bool field = tool_given(&tool, "field");
    check_options(&tool);
    if (tool_given(&tool, "frame")) {
        snprintf(section, sizeof section, "u.frame.%jd", tool_integer(&tool, "frame", 0, INT32_MAX, 0));
    }
    tool_read_image(&tool, tool.operands[0], &image);
    label_values_parse(&tool, "fill", &image, &job.fill);
    label_values_parse(&tool, "vacated", &image, &job.vacated);
    if (tool_given(&tool, "like")) {
        tool_read_image(&tool, tool_value(&tool, "like"), &like);
    }
    side_read_displacement(&tool, tool.operands[1], section, 0, &side);
    const struct cells cells = side.field.cells;
    turn_images(&tool, cells.dim, &image, &like, &axes);
    build_motion(&tool, &side.field, &motion);
    const struct image *grid = tool_given(&tool, "like") ? &like : &image;
    const double *seen = job.inverse ? cells.x : motion.moved;
    const double *unseen = job.inverse ? motion.moved : cells.x;
    SCRATCH int32_t *owner = find_seen(&tool, grid, &cells, seen, &report.doubly), *other = NULL;
    note_image_outside(&tool, &image, &cells, unseen);
    if (!field) {
        other = find_owners(&tool, grid, &cells, unseen, &ignored);
        note_not_finite(&tool, &image);
        job.source = &image;
    }
    new_result(&tool, field, &image, grid, &result);
    job.motion = &motion;
    job.owner = owner;
    job.other = other;
    job.tolerance = tolerance * least_step(grid, cells.dim);
    job.axes = &axes;
    job.result = &result;
    image_to_voxel(&image, job.source_voxel);
    warp_voxels(&job, &report);
    print_report(&tool, &job, grid, &report);
    image_from_body(&result, &axes);
    stream_free(&side.stream);
    tool_write_image(&tool, &result);
    return tool_end(&tool);
}
