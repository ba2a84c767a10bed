static const char usage[] =
    "voxels - label image to node cloud, background cells, facets and node sets\n"
    "\n"
    "usage: voxels -h LENGTH [--fine LENGTH[:NAME,...]] [--sizes FILE] [-l TABLE]\n"
    "              [-s AXIS=PLACE] [--largest] [-u UNIT] [-v] [-t] [-o FILE] [[LABEL=]IMAGE ...]\n"
    "       voxels -h LENGTH --surface NAME[|NAME] [--gap LENGTH] [--fine LENGTH[:NAME,...]] [-l TABLE]\n"
    "              [-s AXIS=PLACE] [--largest] [-u UNIT] [-v] [-o FILE] [[LABEL=]IMAGE ...]\n"
    "\n"
    "Reads a label image (NIfTI, NRRD or MetaImage; - or nothing: standard input) and writes\n"
    "what nodes writes of a mesh: nodes.x (world coordinates, m; x to the right, y to the front, z up),\n"
    "cells, cells.region with the labels' names, facets of the boundary in groups A|B of the region A and\n"
    "what lies beyond, B: 'outside' or a label that is left out; and as node sets A|B the interfaces.\n"
    "Of several images on one grid later ones lie on top where they are not 0; 3=MASK makes that a 3.\n"
    "\n"
    "A body-centred cubic lattice of cubes of LENGTH (2D: equilateral triangles) is cut where labels meet\n"
    "(isosurface stuffing, Labelle and Shewchuk 2007): where the shares of two labels, smoothed by cubic\n"
    "B-splines, are equal. Nodes of interfaces are moved by at most .55 voxels to keep the volume of each\n"
    "label, without specks that the lattice loses, with cavities that it fills. Cells have angles from 8 to\n"
    "165 degrees.\n"
    "\n"
    "Parts thinner than LENGTH may be lost, narrower gaps filled, and bodies about one lattice point left\n"
    "out, with a note: --fine keeps more. Bodies that share only a node or an edge are cut apart; where\n"
    "parts of one body do, the gap is filled, as are the tips of crevices.\n"
    "\n"
    "Parts of the boundary get names by tag: whole facets by place, or by a mask as in the last\n"
    "example, with nodes on its rim.\n"
    "\n"
    "A slice (an image of one, or chosen by -s) makes a body in the plane: x and y are the two world axes\n"
    "in the slice, in their order.\n"
    "\n"
    "The table has rows LABELS NAME: LABELS is a number, a range 3-5, a list 1,3-5, or * for all others but\n"
    "0. Labels of one name are one region. A NAME - makes labels part of the outside; a third word - leaves\n"
    "cells out, and NAME stands in the names of the walls around. # begins a comment. Without a\n"
    "table all labels but 0 are regions, with the names of the segments of a .seg.nrrd, or label_1, ...\n"
    "\n"
    "--surface writes a table for [contact] of a scene instead (unit = m): the triangles of the surface of\n"
    "a label (2D: curves, the label on their left). Normals point out of the label: a body within has\n"
    "side = back (2D: left).\n"
    "\n"
    "Options:\n"
    "  -h, --spacing LENGTH    of the lattice, with a unit: 6mm (required; a last -h is --help)\n"
    "      --fine LENGTH[:NAME,...]  spacing at all interfaces, with names at those of these labels only:\n"
    "                          that of -h is halved until it is no larger\n"
    "      --sizes FILE        lengths of edges, by sizefield -b: the spacing is halved where they ask so\n"
    "      --surface NAME[|NAME]  write the surface of the first label; with a second name (or outside)\n"
    "                          only where that lies beyond it\n"
    "      --gap LENGTH        move it outward by LENGTH, less where it would cross itself\n"
    "  -l, --labels TABLE      names of labels\n"
    "  -s, --slice AXIS=PLACE  the slice nearest to PLACE on a world axis, as z=12mm\n"
    "      --largest           the largest connected body only\n"
    "  -u, --unit UNIT         unit of the file's lengths, instead of what it says: m, cm, mm, um, or a\n"
    "                          number of metres\n"
    "  -v, --verbose           report volumes, nodes and angles\n"
    "  -t, --text              write text instead of binary\n"
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  voxels labels.nii.gz -h 6mm | shapefn | mtled craniotomy.scene > u.dat\n"
    "  printf '1 parenchyma\\n2 ventricles -\\n3,10-12 tumour\\n* -\\n' > names\n"
    "  voxels -l names -h 4mm -v < labels.nii.gz > body.mts\n"
    "  voxels -h 4mm brain.nii.gz 2=tumour_mask.nii.gz > body.mts\n"
    "  voxels -h 4mm -l names --surface 'parenchyma|outside' --gap 1mm labels.nii.gz > skull.tsv\n"
    "  voxels -h 4mm a.nii.gz 9=mask.nii.gz | tag -r label_1=all --replace -f 'part=label_9|outside'\n";

#include "cell_report.h"
#include "voxels/label_image.h"

#include "approx/cells/parts.h"
#include "approx/cells/quality.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* Errors of volume above this share are reported, and a share of the body outside of the cells with sizes. */
static const double reported_share = 0.01;

static double shown(int dim, double volume)
{
    return volume * (dim == 3 ? 1e6 : 1e4);
}

static void report_labels(const struct tool *tool, const struct label_image *image,
                          const struct label_cells *result, const struct cells *cells, bool verbose)
{
    int dim = result->dim;
    const char *unit = dim == 3 ? "ml" : "cm2";
    TOOL_SCRATCH(tool, double, volume, image->labels.count);
    TOOL_SCRATCH(tool, double, present, image->labels.count); /* without what --largest left out */
    TOOL_SCRATCH(tool, int64_t, lost, image->labels.count);
    TOOL_TRY(tool, label_cells_lost(&image->labels, image->table.kept, result, lost, &error));
    for (int64_t c = 0; c < cells->count; c++) {
        volume[result->label[c]] += cell_volume(cells, c);
    }
    for (int64_t v = 0; v < image->labels.size[0] * image->labels.size[1] * image->labels.size[2]; v++) {
        present[image->labels.label[v]] += image->voxel_volume;
    }
    for (int32_t l = 0; l < image->labels.count; l++) {
        if (!image->table.kept[l] && lost[l] > 0) {
            tool_note(tool,
                      "%s: %.3g %s of gaps and cavities narrower than the spacing are filled: see --fine",
                      image->table.names.name[l], shown(dim, (double)lost[l] * image->voxel_volume), unit);
        }
    }
    for (int32_t l = 1; l < image->labels.count; l++) {
        double all = shown(dim, image->volume[l]), before = shown(dim, present[l]),
               after = shown(dim, volume[l]);
        double missing = shown(dim, (double)lost[l] * image->voxel_volume);
        const char *name = image->table.names.name[l];
        if (!image->table.kept[l]) {
            if (verbose) {
                tool_note(tool, "%s: %.4g %s of voxels, left out", name, all, unit);
            }
            continue;
        }
        if (all - before > reported_share * all) {
            tool_note(tool, "%s: %.4g of %.4g %s lie in bodies that --largest leaves out", name, all - before,
                      all, unit);
        }
        if (before == 0) {
            continue;
        }
        if (after == 0) {
            tool_note(tool, "%s: all %.4g %s are lost: no part of it is as thick as the spacing", name,
                      before, unit);
        } else if (verbose || fabs(after - before) > reported_share * before) {
            tool_note(tool, "%s: %.4g %s of voxels, %.4g %s of cells (%+.2f %%)", name, before, unit, after,
                      unit, 100 * (after / before - 1));
        }
        if (after > 0 && missing > reported_share * before) {
            tool_note(
                tool,
                "%s: %.3g %s are lost in parts thinner than the spacing, and at sharp edges: see --fine",
                name, missing, unit);
        }
    }
}

static void report_bodies(const struct tool *tool, const struct cells *cells, bool verbose)
{
    int32_t count = 0;
    double total = 0, first = 0;
    TOOL_SCRATCH(tool, int32_t, part, cells->count);
    TOOL_TRY(tool, cells_parts(cells, part, &count, &error));
    for (int64_t c = 0; c < cells->count; c++) {
        double volume = cell_volume(cells, c);
        total += volume;
        first += part[c] == 0 ? volume : 0;
    }
    if (count > 1) {
        tool_note(
            tool,
            "%d connected bodies, %.3g %% of the %s in the largest: --largest keeps that one; a smaller "
            "-h, or --fine, keeps thin connections",
            count, 100 * first / total, cells->dim == 3 ? "volume" : "area");
    } else if (verbose) {
        tool_note(tool, "one connected body");
    }
}

static void report_cells(const struct tool *tool, const struct cells *cells, double spacing, bool verbose)
{
    double least = 180, most = 0;
    for (int64_t c = 0; c < cells->count; c++) {
        double angles[2];
        (void)cell_quality(cells, c, angles);
        least = fmin(least, angles[0]);
        most = fmax(most, angles[1]);
    }
    if (least < LABEL_CELLS_LEAST_ANGLE || most > LABEL_CELLS_MOST_ANGLE) {
        tool_note(tool, "angles from %.1f to %.1f degrees, beyond %g to %g: another spacing may avoid them",
                  least, most, LABEL_CELLS_LEAST_ANGLE, LABEL_CELLS_MOST_ANGLE);
    }
    if (!verbose) {
        return;
    }
    tool_note(tool, "spacing %g m: %jd nodes, %jd cells, %s from %.1f to %.1f degrees", spacing,
              cells->node_count, cells->count, cells->dim == 3 ? "dihedral angles" : "angles", least, most);
}

static void report(const struct tool *tool, const struct label_image *image, const struct label_cells *result,
                   double spacing, bool surface, bool verbose)
{
    struct cells cells = label_cells_view(result);
    if (result->unsized > reported_share) {
        tool_note(tool, "%.3g %% of the body lie beyond the sizes: cells there are of the spacing of -h",
                  100 * result->unsized);
    }
    if (result->specks > 0) {
        tool_note(tool, "%jd bodies no larger than the spacing, %.3g %s in all, are left out", result->specks,
                  shown(cells.dim, result->speck_volume), cells.dim == 3 ? "ml" : "cm2");
    }
    if (result->pinched > 0) {
        tool_note(tool, "bodies that hung together by a node or an edge alone are cut apart at %jd nodes",
                  result->pinched);
    }
    if (result->hinges > 0) {
        tool_note(tool,
                  "parts of a body touch by a node or an edge alone at %jd nodes: --fine may tell them apart",
                  result->hinges);
    }
    report_labels(tool, image, result, &cells, verbose);
    report_bodies(tool, &cells, verbose);
    report_cells(tool, &cells, spacing, verbose);
    if (!surface) {
        tool_note_thin(tool, &cells);
    }
    if (verbose || result->astray > 0) {
        tool_note(tool, "nodes of interfaces: farthest %.2g voxels off, %jd of them more than %g",
                  result->farthest / labels_voxel(&image->labels), result->astray, LABEL_CELLS_MOST_ASTRAY);
    }
}

static void write_stream(const struct tool *tool, const struct label_image *image,
                         const struct label_cells *result)
{
    FREED_BY(stream_free) struct stream stream = {0};
    TOOL_TRY(tool, label_mesh_put(image, result, &stream, &error));
    tool_write(tool, &stream);
}

/* The value of --fine, "3mm" or "3mm:ventricles,tumour", which must be less than `spacing`, m: *finest, m.
 * Returns an array of labels, to be freed; NULL: of all. Exits on failure. */
static bool *label_fine_parse(const struct tool *tool, const struct label_image *image, const char *text,
                              double spacing, double *finest)
{
    bool *fine = NULL;
    SCRATCH char *copy = tool_memory(tool, strdup(text));
    char *names = copy;
    const char *length = strsep(&names, ":");
    TOOL_TRY(tool, parse_length(length, "--fine", LEAST_LENGTH, finest, &error));
    if (*finest >= spacing) {
        tool_fail(tool, STATUS_INPUT, "--fine: %s is not less than the spacing of -h", length);
    }
    if (names != NULL) {
        TOOL_TRY(tool, NEW_ARRAY(&fine, image->labels.count, &error));
    }
    while (names != NULL) {
        const char *name = strsep(&names, ",");
        int64_t label = names_find(&image->table.names, name);
        if (label <= 0) {
            tool_fail(tool, STATUS_INPUT, "--fine: no label '%.60s'", name);
        }
        fine[label] = true;
    }
    return fine;
}

/* Read the sections nodes.x, cells and size of a stream, in the dimension of the image. Returns the sizes, a
 * view of it. Exits on failure. */
static const double *label_sizes_read(const struct tool *tool, const struct label_image *image,
                                      struct stream *stream, struct cells *cells)
{
    const struct section *section;
    tool_read(tool, tool_value(tool, "sizes"), stream);
    TOOL_TRY(tool, stream_cells(stream, true, cells, &error));
    TOOL_TRY(tool, stream_need(stream, "size", TYPE_F8, 1, "sizefield -b", &section, &error));
    if (cells->dim != image->labels.dim) {
        tool_fail(tool, STATUS_INPUT, "--sizes: cells in %dD, the image is of a body in %dD", cells->dim,
                  image->labels.dim);
    }
    if (section->rows != cells->node_count) {
        tool_fail(tool, STATUS_INPUT, "--sizes: size: %jd rows for %jd nodes", section->rows,
                  cells->node_count);
    }
    TOOL_TRY(tool, fail_in(&error, section_check_numbers(section, POSITIVE, &error), "--sizes"));
    return section->data;
}

/* Progress on a terminal: the step that begins; NULL: none. */
static void show_step(const char *step)
{
    fprintf(stderr, "\r%78s\r%s%s", "", step != NULL ? "voxels: " : "", step != NULL ? step : "");
}

static void check_options(const struct tool *tool)
{
    if (!tool_given(tool, "spacing")) {
        tool_fail(tool, STATUS_INPUT, "the spacing is missing: give -h LENGTH, as -h 6mm");
    }
    if (tool_given(tool, "surface") && tool_given(tool, "text")) {
        tool_fail(tool, STATUS_INPUT, "--surface goes without -t: it writes a table");
    }
    tool_requires(tool, "gap", "surface");
}

int main(int argc, char *argv[])
{
    static char help[] = "--help";
    struct tool tool;
    FREED_BY(label_image_free) struct label_image image = {0};
    FREED_BY(label_cells_free) struct label_cells result = {0};
    if (argc > 1 && strcmp(argv[argc - 1], "-h") == 0) {
        argv[argc - 1] = help;
    }
    tool_begin(&tool, usage, 0, argc, argc, argv);
    check_options(&tool);
    double spacing = tool_length(&tool, "spacing", 0);
    (void)tool_length(&tool, "gap", 0); /* usage errors before waiting for the input */
    label_image_read(&tool, &image);
    struct label_surface_options surface = {0};
    if (tool_given(&tool, "surface")) {
        label_surface_parse(&tool, &image, &surface);
        for (int32_t l = 0; l < image.labels.count; l++) {
            image.table.kept[l] = l == surface.inner;
        }
    }
    struct label_cells_options label_cells_options = {.spacing = spacing,
                                                      .keep = image.table.kept,
                                                      .largest = tool_given(&tool, "largest"),
                                                      .begin = isatty(STDERR_FILENO) ? show_step : NULL};
    SCRATCH bool *fine = NULL;
    if (tool_given(&tool, "fine")) {
        fine =
            label_fine_parse(&tool, &image, tool_value(&tool, "fine"), spacing, &label_cells_options.finest);
        label_cells_options.fine = fine;
    }
    FREED_BY(stream_free) struct stream sizes = {0};
    struct cells sized;
    if (tool_given(&tool, "sizes")) {
        label_cells_options.size = label_sizes_read(&tool, &image, &sizes, &sized);
        label_cells_options.sized = &sized;
    }
    struct error error;
    enum status status = label_cells_make(&image.labels, &label_cells_options, &result, &error);
    const char *length = tool_value(&tool, "spacing");
    if (status == STATUS_INPUT && !isalpha((unsigned char)length[strlen(length) - 1])) {
        tool_fail(&tool, status, "%s -h %s is %s m: give a unit, as -h %smm", error.text, length, length,
                  length);
    }
    tool_check(&tool, status, &error);
    report(&tool, &image, &result, spacing, tool_given(&tool, "surface"), tool_given(&tool, "verbose"));
    if (tool_given(&tool, "surface")) {
        label_surface_write(&tool, &result, &surface);
    } else {
        write_stream(&tool, &image, &result);
    }
    return tool_end(&tool);
}
