static const char usage[] =
    "tovtk - write a stream for ParaView\n"
    "\n"
    "usage: tovtk [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x, the background cells if there are any, and fields:\n"
    "every section with one row for each node or each cell, and names other than\n"
    "lists (.ptr, .idx), facets, faces, sets and parameters. Nodes without cells become\n"
    "points. Where nodes and cells are equally many, sections cells.*, points.*, stress,\n"
    "strain, pressure, volume_ratio and fibre belong to the cells, all others to the nodes.\n"
    "Everything is in SI units, displacements are in m.\n"
    "\n"
    "Vectors in 2D get a third component of zeros. Symmetric tensors have six\n"
    "components in the order of VTK, xx, yy, zz, xy, yz, xz, in 2D too, so that\n"
    "ParaView's tensor filters give their principal values. What follows from the\n"
    "stress and the strain is added:\n"
    "  stress.von_mises   Pa\n"
    "  stress.principal   the principal stresses, Pa, the largest first\n"
    "  pressure           -tr(stress)/3, Pa, unless the stream has it\n"
    "  strain.principal   the principal strains, the largest first\n"
    "  J                  volume ratio sqrt det(1 + 2 strain), unless the stream has\n"
    "                     volume_ratio\n"
    "A vtu file holds the groups, too: facets.NAME and set.NAME are 1 at the nodes of\n"
    "each group of facets and each node set, 0 elsewhere, and region.NAME, field data,\n"
    "is the number of that region in cells.region.\n"
    "\n"
    "mtled with frames writes u.frame.0, u.frame.1, ... beside the final u, and other\n"
    "sections X.frame.K. Name a .pvd file to write them all: NAME.pvd lists\n"
    "NAME-0000.vtu, NAME-0001.vtu, ... with their times, each with the fields of its\n"
    "frame and those that nodes, support and ipoints made. Other files hold the final\n"
    "state only. mts print reactions.frames is the table of a load curve.\n"
    "\n"
    "The name's ending says what is written: .vtu, VTK XML unstructured grid, or .pvd. A\n"
    "name without ending, and standard output, are vtu. Other endings are refused.\n"
    "\n"
    "Options:\n"
    "  -t, --text         write numbers as text, not as base64\n"
    "  -o, --output FILE  write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  mtled brain2d.scene < table.mts | tovtk -o brain2d.pvd\n"
    "  tovtk -o u.vtu u.dat && paraview u.vtu\n";

#include "tovtk/plot.h"
#include "output.h"

#include <stdlib.h>
#include <string.h>

static void write_vtu(const struct tool *tool, struct plot *plot, int64_t frame, const char *name)
{
    struct output output;
    TOOL_TRY(tool, plot_choose(plot, frame, &error));
    TOOL_TRY(tool, output_open(&output, name, false, &error));
    vtu_write(output.file, plot, tool->text);
    TOOL_TRY(tool, output_end(&output, STATUS_OK, &error));
}

/* Write NAME-0001.vtu, ... and then NAME.pvd, which lists them. */
static void write_series(const struct tool *tool, struct plot *plot)
{
    struct output output;
    int64_t count = plot->frame_count > 0 ? plot->frame_count : 1;
    size_t stem = strlen(tool->output) - strlen(".pvd");
    const char *slash = strrchr(tool->output, '/');
    size_t folder = slash != NULL ? (size_t)(slash - tool->output) + 1 : 0;
    TOOL_SCRATCH(tool, char *, paths, count);
    TOOL_SCRATCH(tool, char *, names, count); /* relative to the .pvd file: the ends of the paths */
    TOOL_SCRATCH(tool, double, times, count);
    for (int64_t i = 0; i < count; i++) {
        int64_t frame = plot->frame_count > 0 ? plot->frames[i] : FRAME_NONE;
        TOOL_TRY(tool, plot_time(plot, frame, &times[i], &error));
        paths[i] =
            tool_text(tool, "%.*s-%04jd.vtu", (int)stem, tool->output, frame == FRAME_NONE ? 0 : frame);
        write_vtu(tool, plot, frame, paths[i]);
        names[i] = paths[i] + folder;
    }
    TOOL_TRY(tool, output_open(&output, tool->output, false, &error));
    pvd_write(output.file, count, names, times);
    TOOL_TRY(tool, output_end(&output, STATUS_OK, &error));
    for (int64_t i = 0; i < count; i++) {
        free(paths[i]);
    }
}

static void check_ending(const struct tool *tool)
{
    const char *path = tool->output != NULL ? tool->output : "", *slash = strrchr(path, '/');
    const char *ending = strrchr(slash != NULL ? slash + 1 : path, '.');
    if (ending != NULL && strcmp(ending, ".vtu") != 0 && strcmp(ending, ".pvd") != 0) {
        tool_fail(tool, STATUS_INPUT, "%s: %s files are not written: name it .vtu or .pvd", path, ending);
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(plot_free) struct plot plot = {0};
    tool_begin(&tool, usage, 0, 1, argc, argv);
    check_ending(&tool);
    bool is_series = tool.output != NULL && text_ends(tool.output, ".pvd");
    tool_read(&tool, tool.operands[0], &plot.stream);
    TOOL_TRY(&tool, plot_find(&plot, &error));
    if (is_series) {
        write_series(&tool, &plot);
    } else {
        write_vtu(&tool, &plot, FRAME_NONE, tool.output);
        if (plot.frame_count > 0) {
            tool_note(&tool, "only the final state is written: name a .pvd file for all %jd frames",
                      plot.frame_count);
        }
    }
    return tool_end(&tool);
}
