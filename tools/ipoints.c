static const char usage[] =
    "ipoints - background cells to integration points and weights\n"
    "\n"
    "usage: ipoints [-c | -g POINTS | --lattice N[,N[,N]]] [-v] [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x (m) and cells (see nodes) and adds integration points: points.x (m),\n"
    "points.weight (m2 in 2D, m3 in 3D) and points.cell; and the faces of the cells with quadrature\n"
    "points on them, facepoints.x (m): all faces for smoothed cells, else those of the boundary.\n"
    "The points are on faces of the boundary and, for smoothed cells, at the midpoints of all edges.\n"
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
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | ipoints -g 4 | mts list\n"
    "  cloud -d 2 -k regular -n 18 --box -4,4,-4,4 | ipoints --lattice 81,81 > lattice.mts\n";

#include "stages/stages.h"
#include "tool.h"

/* dim: of the stream; 0: not known yet. */
static struct ipoints_options parse(const struct tool *tool, int dim)
{
    struct ipoints_options ipoints = {0};
    bool gauss = tool_given(tool, "gauss"), lattice = tool_given(tool, "lattice");
    if (tool_given(tool, "conforming") + gauss + lattice > 1) {
        tool_fail(tool, STATUS_INPUT, "give one of -c, -g and --lattice");
    }
    if (gauss) {
        ipoints.gauss_points = (int)tool_integer(tool, "gauss", 1, 1000, 1);
    } else if (lattice) {
        tool_whole_numbers(tool, "lattice", 2, 1e6, dim, ipoints.lattice);
    }
    return ipoints;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    int dim;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    (void)parse(&tool, 0); /* usage errors before waiting for the input */
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, stream_nodes(&stream, &dim, NULL, NULL, &error));
    struct ipoints_options ipoints = parse(&tool, dim);
    TOOL_TRY(&tool, stage_ipoints(&stream, &ipoints, &error));
    if (tool_given(&tool, "verbose")) {
        tool_note(&tool, "%jd points", stream_find(&stream, "points.x")->rows);
    }
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
