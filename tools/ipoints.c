static const char usage[] =
    "ipoints - background cells to integration points and weights\n"
    "\n"
    "usage: ipoints [-c | -g POINTS | --lattice N,N[,N]] [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x (m) and cells (see nodes) and adds integration points: points.x (m),\n"
    "points.weight (m2 in 2D, m3 in 3D) and points.cell; and the faces of the cells with quadrature\n"
    "points on them, facepoints.x (m) and facepoints.weight: all faces for conforming cells, else\n"
    "those of the boundary.\n"
    "\n"
    "Options:\n"
    "  -c, --conforming        one point per cell, gradients smoothed over the cell by the values of\n"
    "                          the shape functions on its faces; passes the linear patch test to\n"
    "                          round-off (default)\n"
    "  -g, --gauss POINTS      quadrature rule of that many points per cell: 1, 3, 4, 6, 7, 12 for\n"
    "                          triangles, 1, 4, 8, 14 for tetrahedra\n"
    "      --lattice N,N[,N]   instead: a regular lattice of evaluation points over the box of the\n"
    "                          nodes, its ends included; needs no cells\n"
    "  -t, --text              write text instead of binary\n"
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | ipoints -g 4 | mts list\n"
    "  cloud -d 2 -k regular -n 18 --box -4,4,-4,4 | ipoints --lattice 81,81 > lattice.mts\n";

#include "stages.h"

enum { CONFORMING, GAUSS, LATTICE, TEXT, OUTPUT, OPTION_COUNT };

static struct ipoints_options parse(const struct tool *tool, const struct option *options)
{
    struct ipoints_options ipoints = ipoints_defaults();
    struct error error;
    if (options[CONFORMING].given + options[GAUSS].given + options[LATTICE].given > 1) {
        tool_fail(tool, STATUS_INPUT, "give one of -c, -g and --lattice");
    }
    if (options[GAUSS].given) {
        int64_t points;
        tool_check(tool, parse_integer(options[GAUSS].value, "-g", 1, 1000, &points, &error), &error);
        ipoints.conforming = false;
        ipoints.gauss_points = (int)points;
    }
    if (options[LATTICE].given) {
        double numbers[3];
        int count;
        tool_check(tool,
                   parse_double_list(options[LATTICE].value, "--lattice", 2, 1e6, 3, numbers, &count, &error),
                   &error);
        for (int a = 0; a < 3; a++) {
            double number = numbers[a < count ? a : count - 1];
            ipoints.lattice[a] = (int64_t)number;
            if ((double)ipoints.lattice[a] != number) {
                tool_fail(tool, STATUS_INPUT, "--lattice: %g is not a whole number", number);
            }
        }
    }
    return ipoints;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct stream stream;
    struct error error;
    struct option options[OPTION_COUNT] = {
        [CONFORMING] = {.letter = 'c', .name = "conforming"},
        [GAUSS] = {.letter = 'g', .name = "gauss", .takes_value = true},
        [LATTICE] = {.name = "lattice", .takes_value = true},
        [TEXT] = {.letter = 't', .name = "text"},
        [OUTPUT] = {.letter = 'o', .name = "output", .takes_value = true},
    };
    tool_begin(&tool, usage, options, OPTION_COUNT, 0, 1, argc, argv);
    struct ipoints_options ipoints = parse(&tool, options);
    tool_read(&tool, tool.operands[0], &stream);
    tool_check(&tool, stage_ipoints(&stream, &ipoints, &error), &error);
    tool_write(&tool, &stream, options[TEXT].given);
    stream_free(&stream);
    return tool_end(&tool);
}
