static const char usage[] =
    "interp - evaluate nodal fields at points\n"
    "\n"
    "usage: interp [-f FIELD[,FIELD...]] [--deformed] [-t] [-o FILE] [FILE]\n"
    "       interp -p POINTS [-u UNIT] [-k FACTOR | -R RADIUS] [-b BASIS] [-w WEIGHT] [--mu MU]\n"
    "              [--mu-unit UNIT] [-f FIELD[,FIELD...]] [--deformed] [--skip-outside] [-t] [-o FILE]\n"
    "              [FILE]\n"
    "\n"
    "Reads a stream with nodes.x (m) and fields at the nodes, and writes one with nodes.x = the\n"
    "points (m) and the fields there. By default the points are the stream's own points.x: the\n"
    "middles of smoothed cells, or others (ipoints -g, --lattice), and supports and shape functions\n"
    "are those that the stream records; without earlier sections the defaults of ipoints, support\n"
    "and shapefn. With -p the points are those of another file.\n"
    "\n"
    "Of results of mtled, u and u.frame.K are the solver's own field: its parameters and supports are\n"
    "in the stream, and at the nodes it is what u says; on a slit the mean of both sides. Options that\n"
    "choose other supports or shape\n"
    "functions ask for a fit instead, as do other fields: their values are taken as the parameters,\n"
    "u_h = sum phi_j u_j, moving least squares that reproduce linear fields (quadratic ones with mls2,\n"
    "and nearly so with mmls2) and smooth others. A point farther from the cells than the spacing of\n"
    "their nodes is an error (without cells: farther than two spacings from every node), unless\n"
    "--skip-outside leaves it out; nearer ones are extrapolated.\n"
    "\n"
    "Options:\n"
    "  -f, --field FIELD,...  the fields (default: every section of type f8 with one row per node)\n"
    "  -p, --points POINTS    the nodes.x of this stream; landmarks of 3D Slicer (.mrk.json, .fcsv); or,\n"
    "                         with -u, the rows of this table of coordinates (blanks or tabs between\n"
    "                         them, # begins a comment)\n"
    "  -u, --unit UNIT        POINTS is a table in m, cm, mm, um or so many metres\n"
    "  -k, --factor FACTOR    support radius = FACTOR times the local node spacing (default 1.8,\n"
    "                         in 3D 2)\n"
    "  -R, --radius RADIUS    constant radius: a length with its unit, e.g. 8mm (without one: m)\n"
    "  -b, --basis BASIS      mls1, mls2 or mmls2 (default), see shapefn\n"
    "  -w, --weight WEIGHT    quartic (default) or regularised\n"
    "      --mu MU[,MU...]    regularisation of mmls2, see shapefn\n"
    "      --mu-unit UNIT     MU is absolute, in coordinates of that unit\n"
    "      --deformed         add x.deformed: the points, m, moved by the displacement field u\n"
    "      --skip-outside     leave out the points that lie in no cell, as of a grid that covers the\n"
    "                         body; a section points.row then has the rows of POINTS that are there\n"
    "  -t, --text             write text instead of binary\n"
    "  -o, --output FILE      write to FILE, which appears only when whole; with\n"
    "                         --deformed and a name in .mrk.json or .fcsv, the moved points as landmarks\n"
    "\n"
    "Examples:\n"
    "  interp -f u -p landmarks.tsv -u mm --deformed -t u.dat\n"
    "  interp -p landmarks.mrk.json --deformed -o moved.mrk.json u.dat\n"
    "  interp -p fine.mts coarse.dat | fieldcmp - fine.dat\n"
    "  interp -f u -p grid.tsv -u mm --skip-outside -t u.dat\n";

#include "stage_options.h"
#include "output.h"
#include "points.h"
#include "stages/stages.h"

#include "approx/field/field.h"
#include "io/stream/sections.h"
#include "io/files/textfile.h"
#include "io/files/landmarks.h"

#include <string.h>

/* Points with their neighbours and shape functions. */
struct evaluated {
    struct field_shapes solved; /* the computed field whose shape functions these are, if any */
    struct points at;
    int64_t *row; /* at.count: of the file; owned */
    struct field_table table;
};

/* Options that need points of a file. */
static const char *const choose_supports[] = {RADIUS_OPTIONS, MLS_OPTIONS, NULL};

static bool writes_landmarks(const struct tool *tool)
{
    return tool->output != NULL && landmarks_named(tool->output);
}

static struct support_options parse(const struct tool *tool, int dim)
{
    struct support_options support = support_defaults(dim);
    const char *choice = tool_given(tool, "unit") ? "unit" : tool_first_given(tool, choose_supports);
    if (choice != NULL && !tool_given(tool, "points")) {
        tool_fail(tool, STATUS_INPUT, "--%s needs -p (else the stream's own supports are used)", choice);
    }
    if (tool_given(tool, "skip-outside") && !tool_given(tool, "points")) {
        tool_fail(tool, STATUS_INPUT, "--skip-outside needs -p (the stream's own points are in cells)");
    }
    if (writes_landmarks(tool) &&
        (!tool_given(tool, "deformed") || tool_given(tool, "field") || tool->text)) {
        tool_fail(tool, STATUS_INPUT, "-o %s: landmarks are moved points: give --deformed, without -f and -t",
                  tool->output);
    }
    radius_parse(tool, &support);
    (void)tool_length_unit(tool, "unit", 1.0);
    mls_parse(tool, &support.mls);
    return support;
}

/* The nodes of another stream. */
static void read_nodes(const struct tool *tool, const char *file, int dim, struct points *points)
{
    FREED_BY(stream_free) struct stream other = {0};
    struct error why;
    const char *name;
    FREED_BY(descriptor_close) int descriptor = tool_open(tool, file, &name);
    enum status status = stream_read(&other, descriptor, name, &why);
    if (status != STATUS_OK) {
        tool_fail(tool, status, "%s (a table of coordinates needs -u)", why.text);
    }
    TOOL_TRY(tool, fail_in(&error, stream_nodes(&other, &points->dim, NULL, NULL, &error), "%s", file));
    points_of_section(tool, &other, "nodes.x", points);
    if (points->dim != dim) {
        tool_fail(tool, STATUS_INPUT, "%s: nodes.x: points in %dD, the field is in %dD", file, points->dim,
                  dim);
    }
    points->what = file;
}

/* Leave out the points outside of the body, and note their number; or fail on the first one that is too far
 * outside. */
static enum status drop_outside(const struct tool *tool, const struct cells *cells, const double *spacing,
                                bool skip, const char *file, struct evaluated *points, struct error *error)
{
    int dim = cells->dim;
    int64_t kept = 0;
    NEW_SCRATCH(bool, outside, points->at.count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&points->row, points->at.count, error));
    RETURN_IF_ERROR(field_outside(cells, spacing, skip ? 0.0 : FIELD_MARGIN, points->at.count, points->at.x,
                                  outside, error));
    for (int64_t i = 0; i < points->at.count; i++) {
        if (outside[i] && !skip) {
            return fail(error, STATUS_INPUT,
                        "%s: row %jd at %s: farther from the body than the spacing of its nodes: is the "
                        "unit right? --skip-outside leaves such points out",
                        file, i, POINT_TEXT(dim, points->at.x + i * dim));
        }
        if (!outside[i]) {
            memmove(points->at.x + kept * dim, points->at.x + i * dim, (size_t)dim * sizeof *points->at.x);
            points->row[kept++] = i;
        }
    }
    if (kept == 0 && points->at.count > 0) {
        return fail(error, STATUS_INPUT, "%s: no point lies in the body: is the unit right?", file);
    }
    if (kept < points->at.count) {
        tool_note(tool, "%s: %jd of %jd points lie outside of the body: left out", file,
                  (points->at.count - kept), points->at.count);
    }
    points->at.count = kept;
    return STATUS_OK;
}

/* Make supports and shape functions at the points: integration points of the stream, or points of a file,
 * which may be outside; the shape functions are those of the computed field, or chosen by options. */
static enum status make_table(const struct tool *tool, const struct field_shapes *known,
                              const struct support_options *support, const struct stream *stream, bool skip,
                              const char *file, struct evaluated *points, struct error *error)
{
    struct cells cells;
    struct field_shapes fit = {.support = *support, .shapes = support->mls};
    RETURN_IF_ERROR(stream_cells(stream, false, &cells, error));
    NEW_SCRATCH(double, spacing, cells.node_count, error);
    NEW_SCRATCH(double, radius, cells.node_count, error);
    RETURN_IF_ERROR(field_spacing(&cells, spacing, error));
    RETURN_IF_ERROR(support_radii(support, cells.node_count, spacing, radius, error));
    fit.supports.radius = radius;
    if (file != NULL) {
        RETURN_IF_ERROR(drop_outside(tool, &cells, spacing, skip, file, points, error));
    }
    return field_table_build(known->supports.radius != NULL ? known : &fit, &cells, NULL, points->at.count,
                             points->at.x, file != NULL ? file : "points.x", &points->table, error);
}

/* Whether a section is a nodal field, not part of the discretisation. */
static bool is_field(const struct section *section, int64_t node_count)
{
    if (section_stage(section->name) < MADE_WITH_RESULTS || solved_is_parameters(section)) {
        return false;
    }
    return section->type == TYPE_F8 && section->rows == node_count;
}

static void evaluate(const struct evaluated *points, const struct section *field, double *values)
{
    field_evaluate(points->at.count, points->table.lists.ptr, points->table.lists.idx, points->table.phi,
                   field->cols, field->data, values);
}

static void put_values(const struct tool *tool, const struct stream *stream, const struct section *field,
                       const struct evaluated *points, struct stream *output)
{
    double *values;
    const struct section *from = solved_parameters(stream, &points->solved, field);
    TOOL_TRY(tool, NEW_ARRAY(&values, points->at.count * field->cols, &error));
    evaluate(points, from, values);
    tool_put(tool, output, field->name, TYPE_F8, points->at.count, field->cols, field->attributes, values);
}

static void put_fields(const struct tool *tool, const struct stream *stream, int64_t node_count,
                       const char *names, const struct evaluated *points, struct stream *output)
{
    SCRATCH char *list = tool_memory(tool, strdup(names));
    for (char *rest = list, *name; (name = strsep(&rest, ",")) != NULL;) {
        const struct section *field = stream_find(stream, name);
        if (field == NULL || !is_field(field, node_count)) {
            tool_fail(tool, STATUS_INPUT,
                      "-f: no field '%s' of type f8 with one row per node (see mts list)%s", name,
                      field != NULL && field->rows != node_count
                          ? "; one row per integration point or cell: see tovtk"
                          : "");
        }
        if (stream_find(output, name) != NULL) {
            tool_fail(tool, STATUS_INPUT, "-f: field '%s' given twice", name);
        }
        put_values(tool, stream, field, points, output);
    }
}

static void put_deformed(const struct tool *tool, const struct stream *stream, int dim, int64_t node_count,
                         const struct evaluated *points, struct stream *output)
{
    char attributes[64];
    const struct section *u;
    double *x;
    TOOL_TRY(tool, stream_field(stream, "u", dim, node_count, &u, &error));
    TOOL_TRY(tool, NEW_ARRAY(&x, points->at.count * dim, &error));
    u = solved_parameters(stream, &points->solved, u);
    evaluate(points, u, x);
    for (int64_t i = 0; i < points->at.count * dim; i++) {
        x[i] += points->at.x[i];
    }
    tool_put(tool, output, "x.deformed", TYPE_F8, points->at.count, dim,
             vector_attributes(dim, "m", attributes), x);
}

static void find_points(const struct tool *tool, struct stream *stream, int dim, struct evaluated *points)
{
    const char *file = tool_value(tool, "points");
    struct support_options support = parse(tool, dim);
    if (tool_first_given(tool, choose_supports) == NULL) {
        TOOL_TRY(tool, stage_recorded(stream, "parameters", &points->solved, &error));
    }
    struct field_shapes known = points->solved;
    if (file == NULL) {
        const struct section *radius = stream_find(stream, "support.radius");
        stage_fill(tool, stream, "ipoints");
        points_of_section(tool, stream, "points.x", &points->at);
        if (known.supports.radius == NULL && radius != NULL) {
            TOOL_TRY(tool, stage_recorded(stream, "support", &known, &error));
        }
    } else if (tool_given(tool, "unit") || landmarks_named(file)) {
        double unit = tool_length_unit(tool, "unit", table_unit(file, 1));
        if (unit != table_unit(file, unit)) {
            tool_fail(tool, STATUS_INPUT, "-u %s: landmarks are in mm", tool_value(tool, "unit"));
        }
        points_of_table(tool, file, dim, &points->at);
    } else {
        read_nodes(tool, file, dim, &points->at);
    }
    TOOL_TRY(tool, make_table(tool, &known, &support, stream, tool_given(tool, "skip-outside"), file, points,
                              &error));
}

/* Write the moved points, with the names that they have in their file. */
static void write_landmarks(const struct tool *tool, int dim, const struct evaluated *points,
                            const double *moved)
{
    struct output output;
    if (dim != 3) {
        tool_fail(tool, STATUS_INPUT, "-o %s: landmarks are points in 3D", tool->output);
    }
    TOOL_TRY(tool, output_open(&output, tool->output, false, &error));
    landmarks_print(output.file, tool->output, points->at.count, moved, points->row, points->at.label);
    TOOL_TRY(tool, output_end(&output, STATUS_OK, &error));
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0}, output = {0};
    struct evaluated points = {.row = NULL};
    int dim;
    int64_t node_count;
    const double *nodes;
    char attributes[64];
    tool_begin(&tool, usage, 0, 1, argc, argv);
    (void)parse(&tool, 0); /* usage errors before waiting for the input */
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, stream_nodes(&stream, &dim, &node_count, &nodes, &error));
    find_points(&tool, &stream, dim, &points);
    output.provenance = stream.provenance;
    stream.provenance = (struct names){0};
    tool_put(&tool, &output, "nodes.x", TYPE_F8, points.at.count, dim,
             vector_attributes(dim, "m", attributes), points.at.x);
    if (tool_given(&tool, "field")) {
        put_fields(&tool, &stream, node_count, tool_value(&tool, "field"), &points, &output);
    } else {
        for (int64_t s = 0; s < stream.section_count; s++) {
            if (is_field(&stream.sections[s], node_count)) {
                put_values(&tool, &stream, &stream.sections[s], &points, &output);
            }
        }
        if (output.section_count == 1) {
            tool_fail(&tool, STATUS_INPUT, "no fields: no section of type f8 has one row per node");
        }
    }
    if (tool_given(&tool, "deformed")) {
        put_deformed(&tool, &stream, dim, node_count, &points, &output);
    }
    if (writes_landmarks(&tool)) {
        write_landmarks(&tool, dim, &points, stream_find(&output, "x.deformed")->data);
    } else {
        if (tool_given(&tool, "skip-outside")) {
            tool_put(&tool, &output, "points.row", TYPE_I8, points.at.count, 1, "", array_take(&points.row));
        }
        tool_write(&tool, &output);
    }
    field_table_free(&points.table);
    FREE_ALL(points.row, points.at.label, points.at.text);
    return tool_end(&tool);
}
