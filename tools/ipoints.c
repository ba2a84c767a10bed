static const char usage[] =
    "ipoints - background cells to integration points and weights\n"
    "\n"
    "usage: ipoints [-c | -g POINTS | --lattice N[,N[,N]]] [-v] [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x (m) and cells (see nodes) and adds integration points: points.x (m),\n"
    "points.weight (m2 in 2D, m3 in 3D) and points.cell; and the faces of the cells with quadrature\n"
    "points on them, facepoints.x (m): all faces for smoothed cells, else those of the boundary. In\n"
    "3D faces of smoothed cells away from the boundary share the points at the middles of their edges.\n"
    "\n"
    "Options:\n"
    "  -c, --conforming        one point per cell, gradients smoothed over the cell by the values of\n"
    "                          the shape functions on its faces; passes the linear patch test to\n"
    "                          round-off (default)\n"
    "  -g, --gauss POINTS      quadrature rule of that many points per cell: 1, 3, 4, 6, 7, 12 for\n"
    "                          triangles, 1, 4, 8, 14 for tetrahedra\n"
    "      --lattice N[,N[,N]] instead: a regular lattice of evaluation points over the box of the\n"
    "                          nodes, its ends included, of N points along each axis (one number:\n"
    "                          along all); needs no cells\n"
    "  -v, --verbose           report on standard error how many points there are\n"
    "  -t, --text              write text instead of binary\n"
    "  -o, --output FILE       write to FILE, none of the inputs, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | ipoints -g 4 | mts list\n"
    "  cloud -d 2 -k regular -n 18 --box -4,4,-4,4 | ipoints --lattice 81,81 > lattice.mts\n";

#include "tool.h"
#include "stages/stages.h"

static void parse_lattice(const struct tool *tool, const char *text, int64_t lattice[3])
{
    double numbers[3];
    int count;
    TOOL_TRY(tool, parse_double_list(text, "--lattice", 2, 1e6, 3, numbers, &count, &error));
    for (int a = 0; a < count; a++) {
        lattice[a] = (int64_t)numbers[a];
        if ((double)lattice[a] != numbers[a]) {
            tool_fail(tool, STATUS_INPUT, "--lattice: %g is not a whole number", numbers[a]);
        }
    }
}

static struct ipoints_options parse(const struct tool *tool)
{
    struct ipoints_options ipoints = ipoints_defaults();
    bool gauss = tool_given(tool, "gauss"), lattice = tool_given(tool, "lattice");
    if (tool_given(tool, "conforming") + gauss + lattice > 1) {
        tool_fail(tool, STATUS_INPUT, "give one of -c, -g and --lattice");
    }
    ipoints.smoothed = !gauss;
    if (gauss) {
        ipoints.gauss_points = (int)tool_integer(tool, "gauss", 1, 1000, 1);
    } else if (lattice) {
        parse_lattice(tool, tool_value(tool, "lattice"), ipoints.lattice);
    }
    return ipoints;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct stream stream;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    struct ipoints_options ipoints = parse(&tool); /* usage errors before waiting for the input */
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, stage_ipoints(&stream, &ipoints, &error));
    if (tool_given(&tool, "verbose")) {
        tool_note(&tool, "%lld points", (long long)stream_find(&stream, "points.x")->rows);
    }
    tool_write(&tool, &stream, tool_given(&tool, "text"));
    stream_free(&stream);
    return tool_end(&tool);
}
