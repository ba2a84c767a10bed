static const char usage[] =
    "tovtk - write a stream for ParaView or gmsh\n"
    "\n"
    "usage: tovtk [-t] [-f vtu|gmsh] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x, the background cells if there are any, and fields:\n"
    "every section with one row for each node or each cell, and names other than\n"
    "lists (.ptr, .idx), facets, faces and sets. Nodes without cells become points.\n"
    "Vectors in 2D are padded to three components. Where nodes and cells are equally\n"
    "many, sections cells.* and points.* belong to the cells, all others to the nodes.\n"
    "Everything is in SI units, displacements are in m.\n"
    "\n"
    "mtled with frames writes u.frame.1, u.frame.2, ... beside the final u. Name a\n"
    ".pvd file to write them all: NAME.pvd lists NAME-0001.vtu, NAME-0002.vtu, ... with\n"
    "their times, each with the fields of its frame and those that nodes, support and\n"
    "ipoints made. Other files hold the final state only. With -f gmsh, views hold all\n"
    "frames as their time steps.\n"
    "\n"
    "Options:\n"
    "  -f, --format FORMAT  vtu: VTK XML unstructured grid, for ParaView (default);\n"
    "                       gmsh: mesh (MSH 2.2) with post-processing views\n"
    "  -t, --text           write numbers as text in a vtu file, not as base64\n"
    "  -o, --output FILE    write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  mtled brain2d.scene < table.mts | tovtk -o brain2d.pvd\n"
    "  tovtk -f gmsh u.dat > u.msh && gmsh u.msh\n";

#include "output.h"
#include "stages.h"

#include "io/vtk.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FORMAT, TEXT, OUTPUT, OPTION_COUNT };

static const char frame_infix[] = ".frame.";

struct label {
    char text[128];
};

/* What is written: the stream, seen as a mesh, fields and frames. */
struct plot {
    struct stream stream;
    struct vtk_mesh mesh;
    struct vtk_field *fields; /* of the frame chosen last; room for every section */
    struct label *labels;     /* their names */
    int64_t field_count;
    int64_t *frames; /* the numbers of the frames, ascending */
    int64_t frame_count;
    char names[1 << 16]; /* of the regions */
};

static bool begins_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

static bool ends_with(const char *text, const char *suffix)
{
    size_t length = strlen(text);
    size_t tail = strlen(suffix);
    return length >= tail && strcmp(text + length - tail, suffix) == 0;
}

/* K of a section X.frame.K with K >= 1; 0 for another section. *length receives that of X. */
static int64_t frame_of(const char *name, size_t *length)
{
    struct error ignored;
    int64_t frame = 0;
    const char *infix = strstr(name, frame_infix);
    *length = infix != NULL ? (size_t)(infix - name) : strlen(name);
    if (infix == NULL ||
        parse_integer(infix + strlen(frame_infix), name, 1, INT32_MAX, &frame, &ignored) != STATUS_OK) {
        return 0;
    }
    return frame;
}

/* Does a section of this name (X of X.frame.K) describe the reference state, the same in all frames? */
static bool is_static(const char *name)
{
    return begins_with(name, "cells.") || begins_with(name, "nodes.") || begins_with(name, "support.") ||
           strcmp(name, "points.weight") == 0;
}

/* Lists, geometry and what belongs to neither nodes nor cells, whatever its number of rows. */
static bool is_structure(const char *name)
{
    static const char *const exact[] = {"nodes.x", "cells", "facets", "faces", "points.x", "points.cell"};
    for (size_t i = 0; i < sizeof exact / sizeof exact[0]; i++) {
        if (strcmp(name, exact[i]) == 0) {
            return true;
        }
    }
    return begins_with(name, "facets.") || begins_with(name, "faces.") || begins_with(name, "facepoints.") ||
           begins_with(name, "sets.") || ends_with(name, ".ptr") || ends_with(name, ".idx");
}

/* Is the section a field on nodes or cells? */
static bool is_field(const struct vtk_mesh *mesh, const struct section *section, bool *of_cells)
{
    bool for_cells = begins_with(section->name, "cells.") || begins_with(section->name, "points.");
    bool fits_cells = mesh->node != NULL && section->rows == mesh->cell_count;
    bool fits_nodes = section->rows == mesh->node_count;
    *of_cells = fits_cells && (for_cells || !fits_nodes);
    return (fits_cells || fits_nodes) && section->cols > 0 && !is_structure(section->name);
}

/* Choose the fields of a frame, or of the final state when frame == 0. */
static void choose_fields(struct plot *plot, int64_t frame)
{
    plot->field_count = 0;
    for (int64_t s = 0; s < plot->stream.section_count; s++) {
        const struct section *section = &plot->stream.sections[s];
        struct vtk_field field = {.section = section};
        size_t length;
        bool is_wanted = frame_of(section->name, &length) == frame ||
                         (frame_of(section->name, &length) == 0 && is_static(section->name));
        if (is_wanted && is_field(&plot->mesh, section, &field.of_cells)) {
            struct label *label = &plot->labels[plot->field_count];
            snprintf(label->text, sizeof label->text, "%.*s", (int)length, section->name);
            field.name = label->text;
            plot->fields[plot->field_count++] = field;
        }
    }
}

static int compare_frames(const void *a, const void *b)
{
    int64_t left = *(const int64_t *)a;
    int64_t right = *(const int64_t *)b;
    return (left > right) - (left < right);
}

static enum status find_frames(struct plot *plot, struct error *error)
{
    enum status status = STATUS_OK;
    int64_t count = 0;
    TRY(NEW_ARRAY(&plot->frames, plot->stream.section_count, error));
    for (int64_t s = 0; s < plot->stream.section_count; s++) {
        size_t length;
        int64_t frame = frame_of(plot->stream.sections[s].name, &length);
        if (frame > 0) {
            plot->frames[count++] = frame;
        }
    }
    qsort(plot->frames, (size_t)count, sizeof *plot->frames, compare_frames);
    for (int64_t i = 0; i < count; i++) {
        if (i == 0 || plot->frames[i] != plot->frames[i - 1]) {
            plot->frames[plot->frame_count++] = plot->frames[i];
        }
    }
done:
    return status;
}

/* attribute time= of the first section of the frame that has one, else its number; 0 for the final state. */
static enum status time_of(const struct plot *plot, int64_t frame, double *time, struct error *error)
{
    *time = (double)frame;
    for (int64_t s = 0; s < plot->stream.section_count; s++) {
        const struct section *section = &plot->stream.sections[s];
        size_t length;
        char text[64];
        if (frame > 0 && frame_of(section->name, &length) == frame &&
            section_attribute(section, "time", text, sizeof text)) {
            return parse_double(text, section->name, -1e300, 1e300, time, error);
        }
    }
    return STATUS_OK;
}

static enum status find_mesh(struct plot *plot, struct error *error)
{
    const struct section *region = stream_find(&plot->stream, "cells.region");
    struct cells cells;
    enum status status = STATUS_OK;
    struct vtk_mesh *mesh = &plot->mesh;
    TRY(stream_nodes(&plot->stream, &mesh->dim, &mesh->node_count, &mesh->x, error));
    TRY(stream_cells(&plot->stream, false, &cells, error));
    mesh->cell_count = cells.count;
    mesh->node = cells.count > 0 ? cells.node : NULL;
    mesh->region_names = plot->names;
    if (mesh->node != NULL && region != NULL) {
        TRY(stream_need(&plot->stream, "cells.region", TYPE_I4, 1, "nodes", &region, error));
        if (region->rows != cells.count) {
            TRY(fail(error, STATUS_INPUT, "cells.region: has %lld rows, cells %lld", (long long)region->rows,
                     (long long)cells.count));
        }
        mesh->region = region->data;
        section_attribute(region, "names", plot->names, sizeof plot->names);
    }
    TRY(NEW_ARRAY(&plot->fields, plot->stream.section_count, error));
    TRY(NEW_ARRAY(&plot->labels, plot->stream.section_count, error));
    TRY(find_frames(plot, error));
done:
    return status;
}

/* Number i of the frames; 0, the final state, when there are none. */
static int64_t frame_number(const struct plot *plot, int64_t i)
{
    return plot->frame_count > 0 ? plot->frames[i] : 0;
}

static int64_t state_count(const struct plot *plot)
{
    return plot->frame_count > 0 ? plot->frame_count : 1;
}

/* The mesh and all frames. */
static enum status write_gmsh(struct plot *plot, FILE *file, struct error *error)
{
    enum status status = STATUS_OK;
    TRY(gmsh_write_mesh(file, &plot->mesh, error));
    for (int64_t i = 0; i < state_count(plot); i++) {
        int64_t frame = frame_number(plot, i);
        double time;
        TRY(time_of(plot, frame, &time, error));
        choose_fields(plot, frame);
        for (int64_t f = 0; f < plot->field_count; f++) {
            const struct vtk_field *field = &plot->fields[f];
            if (i == 0 || !is_static(field->name)) { /* the reference state once */
                TRY(gmsh_write_field(file, &plot->mesh, field, i, time, error));
            }
        }
    }
done:
    return status;
}

/* One frame as a vtu file. */
static enum status write_vtu(struct plot *plot, int64_t frame, bool text, FILE *file, struct error *error)
{
    choose_fields(plot, frame);
    return vtu_write(file, &plot->mesh, plot->fields, plot->field_count, text, error);
}

/* A file that appears only when whole, or standard output when its name is NULL. */
struct target {
    const char *name;
    struct output output;
    FILE *file;
};

static void target_open(const struct tool *tool, struct target *target, const char *name)
{
    struct error error;
    *target = (struct target){.name = name, .file = stdout};
    if (name == NULL) {
        return;
    }
    tool_check(tool, output_open(&target->output, name, &error), &error);
    int descriptor = dup(target->output.descriptor); /* the output closes its own */
    target->file = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
    if (target->file == NULL) {
        int cause = errno;
        output_abandon(&target->output);
        tool_fail(tool, STATUS_SYSTEM, "%s: %s", name, strerror(cause));
    }
}

/* Give the file its name if the writing went well; exit if not. */
static void target_close(const struct tool *tool, struct target *target, enum status status,
                         struct error *error)
{
    const char *name = target->name != NULL ? target->name : "standard output";
    if (target->name != NULL && fclose(target->file) != 0 && status == STATUS_OK) {
        status = fail(error, STATUS_SYSTEM, "%s", strerror(errno));
    }
    if (status != STATUS_OK) {
        if (target->name != NULL) {
            output_abandon(&target->output);
        }
        tool_fail(tool, status, "%s: %s", name, error->text);
    }
    if (target->name != NULL) {
        tool_check(tool, output_commit(&target->output, error), error);
    }
}

/* NAME-0001.vtu, ... and at last the NAME.pvd that lists them. */
static void write_series(const struct tool *tool, struct plot *plot, bool text)
{
    struct error error;
    struct target target;
    int64_t count = state_count(plot);
    size_t stem = strlen(tool->output) - strlen(".pvd");
    const char *slash = strrchr(tool->output, '/');
    size_t folder = slash != NULL ? (size_t)(slash - tool->output) + 1 : 0;
    char **paths, **names; /* the names are relative to the .pvd file: the ends of the paths */
    double *times;
    tool_check(tool, NEW_ARRAY(&paths, count, &error), &error);
    tool_check(tool, NEW_ARRAY(&names, count, &error), &error);
    tool_check(tool, NEW_ARRAY(&times, count, &error), &error);
    for (int64_t i = 0; i < count; i++) {
        int64_t frame = frame_number(plot, i);
        tool_check(tool, time_of(plot, frame, &times[i], &error), &error);
        if (asprintf(&paths[i], "%.*s-%04lld.vtu", (int)stem, tool->output, (long long)frame) < 0) {
            tool_fail(tool, STATUS_SYSTEM, "out of memory");
        }
        target_open(tool, &target, paths[i]);
        target_close(tool, &target, write_vtu(plot, frame, text, target.file, &error), &error);
        names[i] = paths[i] + folder;
    }
    target_open(tool, &target, tool->output);
    target_close(tool, &target, pvd_write(target.file, count, names, times, &error), &error);
    for (int64_t i = 0; i < count; i++) {
        free(paths[i]);
    }
    free(paths);
    free(names);
    free(times);
}

int main(int argc, char *argv[])
{
    static const char *const formats[] = {"vtu", "gmsh"};
    struct tool tool;
    struct error error;
    struct option options[OPTION_COUNT] = {
        [FORMAT] = {.letter = 'f', .name = "format", .takes_value = true},
        [TEXT] = {.letter = 't', .name = "text"},
        [OUTPUT] = {.letter = 'o', .name = "output", .takes_value = true},
    };
    struct plot plot = {0};
    struct target target;
    int format = 0;
    tool_begin(&tool, usage, options, OPTION_COUNT, 0, 1, argc, argv);
    if (options[FORMAT].given) {
        tool_check(&tool, parse_choice(options[FORMAT].value, "-f", formats, 2, &format, &error), &error);
    }
    bool is_gmsh = format == 1;
    bool is_series = tool.output != NULL && ends_with(tool.output, ".pvd");
    if (is_gmsh && (is_series || options[TEXT].given)) {
        tool_fail(&tool, STATUS_INPUT, "%s is for -f vtu", is_series ? "a .pvd file" : "-t");
    }
    tool_read(&tool, tool.operands[0], &plot.stream);
    tool_check(&tool, find_mesh(&plot, &error), &error);
    if (is_series) {
        write_series(&tool, &plot, options[TEXT].given);
    } else {
        if (plot.frame_count > 0 && !is_gmsh) {
            tool_note(&tool, "only the final state is written: name a .pvd file for all %lld frames",
                      (long long)plot.frame_count);
        }
        target_open(&tool, &target, tool.output);
        target_close(&tool, &target,
                     is_gmsh ? write_gmsh(&plot, target.file, &error)
                             : write_vtu(&plot, 0, options[TEXT].given, target.file, &error),
                     &error);
    }
    stream_free(&plot.stream);
    free(plot.fields);
    free(plot.labels);
    free(plot.frames);
    return tool_end(&tool);
}
