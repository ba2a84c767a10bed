static const char usage[] =
    "incise - cut a body along a surface, or take a region out\n"
    "\n"
    "usage: incise [-s FILE [-u UNIT] [-n NAME] [-d FILE] [-x] [-l PART%]] [-r REGION] [-v] [-t]\n"
    "              [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes and cells (see nodes, voxels) and cuts the body along a blade: in 3D\n"
    "triangles, in 2D curves. The blade may end within the body, where the cut then has its edge, go\n"
    "through it, or branch. Cells are divided along it, nodes on it are doubled, and each of the two\n"
    "faces is boundary with a name: facets NAME|front, that of the part in front of the blade, to\n"
    "which its normals point (2D: on the right of the curve), and NAME|back. Nodes where they meet\n"
    "are the set NAME|edge. A cut of a name that exists extends it. Nodes near the blade are moved onto\n"
    "it, but stay on the boundaries of body, regions and groups; edges and corners of the blade are cut\n"
    "off within a cell. Regions, groups, sets and points.fibre go along; other sections of later stages\n"
    "are left out.\n"
    "\n"
    "A cut that closes needs a contact of its faces in the scene: facets = NAME|front,\n"
    "against = NAME|back. To go on from the state before the cut: mtled --start. A blade that opens\n"
    "nothing is an error.\n"
    "\n"
    "Options:\n"
    "  -s, --surface FILE   the blade: STL, or a table of triangles (rows of nine numbers); in 2D curves\n"
    "                       (rows of points, blank lines between)\n"
    "  -u, --unit UNIT      its unit: m (default), cm, mm, um, or a number of metres\n"
    "  -n, --name NAME      of the cut (default cut)\n"
    "  -d, --deformed FILE  the blade is where the body is deformed by u of this stream, a result of mtled\n"
    "                       for these cells or others of the body\n"
    "  -x, --excise         take out what lies behind the blade, which is closed\n"
    "  -l, --least PART%    take out pieces at the cut that are smaller than this part of the body, by\n"
    "                       volume (default 0: keep all; below 0.1% they are noted)\n"
    "  -r, --region REGION  take out the cells of a region; the wall that is left is facets NAME|wall\n"
    "                       (default REGION|wall)\n"
    "  -v, --verbose        report on standard error what was cut, and the pieces\n"
    "  -t, --text           write text instead of binary\n"
    "  -o, --output FILE    write to FILE, none of the inputs, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm liver.msh | incise -s blade.stl -u mm -n knife | shapefn | mtled scene > u.dat\n"
    "  incise -s deeper.stl -u mm -n knife -d u.dat body.mts | mtled -s u.dat scene > deeper.dat\n"
    "  voxels head.nii.gz -h 5mm | incise -r tumour > resected.mts\n";

#include "comparison.h"
#include "groups/group_body.h"

#include "approx/field/field.h"
#include "io/files/surface.h"
#include "stages/incise.h"

#include <string.h>

/* Pieces that are smaller than this part of the body are noted. */
static const double small_piece = 1e-3;

static double parse_least(const struct tool *tool)
{
    const char *text = tool_value(tool, "least");
    double value = 0.0;
    if (text != NULL) {
        SCRATCH char *number = tool_memory(tool, strdup(text));
        if (!text_ends(number, "%")) {
            tool_fail(tool, STATUS_INPUT, "-l: '%.40s' is not a percentage: 1%%", text);
        }
        number[strlen(number) - 1] = '\0';
        TOOL_TRY(tool, parse_double(number, "-l", 0.0, 100.0, &value, &error));
    }
    return value / 100.0;
}

static void read_blade(const struct tool *tool, const struct stream *stream, struct blade *blade)
{
    const char *file = tool_value(tool, "surface");
    double unit = tool_length_unit(tool, "unit", 1.0);
    SCRATCH double *corners = NULL;
    int dim = 0;
    int64_t count = 0;
    TOOL_TRY(tool, stream_nodes(stream, &dim, NULL, NULL, &error));
    TOOL_TRY(tool, surface_facets(file, dim, unit, &corners, &count, &error));
    TOOL_TRY(tool, fail_in(&error, blade_build(dim, count, corners, blade, &error), "%s", file));
}

/* at[nodes * dim] = the nodes of the stream, moved by u of a result. */
static enum status deform(const struct tool *tool, const struct stream *stream, double **at,
                          struct error *error)
{
    const char *file = tool_value(tool, "deformed");
    struct cells cells;
    struct side side;
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    side_read_displacement(tool, file, "u", cells.dim, &side);
    const struct nodal_field *field = &side.field;
    RETURN_IF_ERROR(NEW_ARRAY(at, cells.node_count * cells.dim, error));
    RETURN_IF_ERROR(fail_in(error, field_carry(&field->cells, field->cols, field->values, &cells, *at, error),
                            "-d: %s", file));
    for (int64_t i = 0; i < cells.node_count * cells.dim; i++) {
        (*at)[i] += cells.x[i];
    }
    stream_free(&side.stream);
    return STATUS_OK;
}

static void tell(const struct tool *tool, const struct incise_options *options,
                 const struct incise_report *report, int dim)
{
    const char *size = dim == 2 ? "m" : "m2", *volume = dim == 2 ? "m2" : "m3";
    if (report->unopened > 0) {
        tool_note(tool, "%jd parts of the blade open nothing", report->unopened);
    }
    if (options->least == 0.0 && report->smallest < small_piece * report->volume) {
        tool_note(tool, "a piece of %.3g %s, %.2g %% of the body, is cut off: see -l", report->smallest,
                  volume, 100.0 * report->smallest / report->volume);
    }
    if (report->taken_out > 0) {
        tool_note(tool, "pieces taken out: %d, %.4g %s", (int)report->taken_out, report->taken, volume);
    }
    if (tool_given(tool, "verbose") && options->region != NULL) {
        tool_note(tool, "%s: %jd cells taken out", options->region, report->region_cells);
    }
    if (tool_given(tool, "verbose") && options->blade != NULL) {
        tool_note(tool,
                  "%s: faces of %.4g %s, %jd nodes on the edge; nodes: %jd put on edges, %jd moved, %jd "
                  "doubled; pieces: %d, the smallest of %.4g %s; poorest quality of a cell %.2g",
                  options->name, report->face_area, size, report->edge, report->split, report->moved,
                  report->doubled, (int)(report->pieces - report->taken_out), report->smallest, volume,
                  report->poorest);
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    FREED_BY(blade_free) struct blade blade = {0};
    SCRATCH double *at = NULL;
    static const char *const of_blade[] = {"unit", "deformed", "excise", "least"};
    struct incise_report report;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    struct incise_options options = {.region = tool_value(&tool, "region"), .least = parse_least(&tool)};
    if (options.region == NULL && !tool_given(&tool, "surface")) {
        tool_fail(&tool, STATUS_INPUT, "nothing to do: give -s or -r (see -h)");
    }
    for (size_t i = 0; i < sizeof of_blade / sizeof *of_blade; i++) {
        tool_requires(&tool, of_blade[i], "surface");
    }
    options.name = tool_given(&tool, "name")      ? tool_value(&tool, "name")
                   : tool_given(&tool, "surface") ? "cut"
                                                  : options.region;
    options.excise = tool_given(&tool, "excise");
    TOOL_TRY(&tool, fail_in(&error, group_check_name(options.name, &error), "-n"));
    tool_read(&tool, tool.operands[0], &stream);
    if (tool_given(&tool, "surface")) {
        read_blade(&tool, &stream, &blade);
        options.blade = &blade;
    }
    if (tool_given(&tool, "deformed")) {
        TOOL_TRY(&tool, deform(&tool, &stream, &at, &error));
        options.at = at;
    }
    const char *context = tool_given(&tool, "surface") ? tool_value(&tool, "surface") : "-r";
    TOOL_TRY(&tool, fail_in(&error, stage_incise(&stream, &options, &report, &error), "%s", context));
    int dim = (int)stream_find(&stream, "nodes.x")->cols;
    tell(&tool, &options, &report, dim);
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
