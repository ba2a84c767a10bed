static const char usage[] =
    "ipoints - background cells to integration points and weights\n"
    "\n"
    "usage: ipoints [-c | -g POINTS | --lattice N[,N[,N]]] [-v] [-t] [-o FILE] [FILE]\n"
    "       ipoints -a TOLERANCE [-g POINTS] [--levels LEVELS] [-k FACTOR | -R RADIUS] [-b BASIS]\n"
    "               [-w WEIGHT] [--mu MU] [--mu-unit UNIT] [-v] [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x (m) and cells (see nodes) and adds integration points: points.x (m),\n"
    "points.weight (m2 in 2D, m3 in 3D) and points.cell; and the faces of the cells with quadrature\n"
    "points on them, facepoints.x (m): all faces for smoothed cells, else those of the boundary.\n"
    "The points are on faces of the boundary and, for smoothed cells, at the midpoints of all edges.\n"
    "\n"
    "Adaptive integration (-a) halves the edges of each cell, or of parts of it, until the integral\n"
    "of the products of the shape functions' gradients over the cell (a matrix, in the Frobenius norm)\n"
    "changes by less than the tolerance. The shape functions are those of a stream that has been\n"
    "through support, or those that support makes by default; -k, -R, -b, -w, --mu and --mu-unit\n"
    "choose others. Give support the same options afterwards. Where the last level is still too\n"
    "coarse, as it is where supports had to be widened and the gradients jump, a note says so.\n"
    "\n"
    "Options:\n"
    "  -c, --conforming        one point per cell, gradients smoothed over the cell by the values of\n"
    "                          the shape functions on its faces; passes the linear patch test to\n"
    "                          round-off (default)\n"
    "  -g, --gauss POINTS      quadrature rule of that many points per cell: 1, 3, 4, 6, 7, 12 for\n"
    "                          triangles, 1, 4, 8, 14 for tetrahedra; with -a the rule on each part\n"
    "                          (default there: 3 and 4)\n"
    "  -a, --adaptive TOLERANCE  subdivide each cell until it changes by less, relative to the cell\n"
    "      --levels LEVELS     halve a cell's edges at most so often (default 4, in 3D 3)\n"
    "  -k, --factor FACTOR     support radius = FACTOR times the local node spacing (default 1.8,\n"
    "                          in 3D 2)\n"
    "  -R, --radius RADIUS     constant support radius: a length with its unit, e.g. 8mm (without: m)\n"
    "  -b, --basis BASIS       mls1, mls2 or mmls2 (default), see shapefn\n"
    "  -w, --weight WEIGHT     quartic (default) or regularised\n"
    "      --mu MU[,MU...]     regularisation of mmls2, see shapefn\n"
    "      --mu-unit UNIT      MU is absolute, in coordinates of that unit\n"
    "      --lattice N[,N[,N]] instead: a regular lattice of evaluation points over the box of the\n"
    "                          nodes, its ends included, of N points along each axis (one number:\n"
    "                          along all); needs no cells\n"
    "  -v, --verbose           report on standard error how many points there are\n"
    "  -t, --text              write text instead of binary\n"
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | ipoints -g 4 | mts list\n"
    "  nodes -u mm body.msh | ipoints -a 0.02 -k 2 | support -k 2 | shapefn > table.mts\n"
    "  cloud -d 2 -k regular -n 18 --box -4,4,-4,4 | ipoints --lattice 81,81 > lattice.mts\n";

#include "stage_options.h"
#include "stages/stages.h"

/* The options of adaptive integration; shape functions not given by options are those of `mls`. */
static struct adaptive_options parse_adaptive(const struct tool *tool, const struct mls *mls)
{
    struct adaptive_options adaptive = adaptive_defaults(mls->dim);
    adaptive.support.mls = *mls;
    adaptive.tolerance = tool_number(tool, "adaptive", 1e-12, 10, adaptive.tolerance);
    adaptive.rule_points = (int)tool_integer(tool, "gauss", 1, 1000, adaptive.rule_points);
    adaptive.levels = (int)tool_integer(tool, "levels", 0, ADAPTIVE_MOST_LEVELS, adaptive.levels);
    radius_parse(tool, &adaptive.support);
    mls_parse(tool, &adaptive.support.mls);
    return adaptive;
}

static struct ipoints_options parse(const struct tool *tool, const struct mls *mls)
{
    static const char *const of_adaptive[] = {"levels", RADIUS_OPTIONS, MLS_OPTIONS, NULL};
    bool gauss = tool_given(tool, "gauss"), adaptive = tool_given(tool, "adaptive");
    struct ipoints_options ipoints = {.smoothed = !gauss && !adaptive};
    const char *extra = tool_first_given(tool, of_adaptive);
    if (tool_given(tool, "conforming") + (gauss || adaptive) + tool_given(tool, "lattice") > 1) {
        tool_fail(tool, STATUS_INPUT, "give one of -c, -g, -a and --lattice (-a may have its -g)");
    }
    if (extra != NULL && !adaptive) {
        tool_fail(tool, STATUS_INPUT, "--%s is for adaptive integration: give -a too", extra);
    }
    ipoints.given_radius = tool_given(tool, "factor") || tool_given(tool, "radius");
    if (adaptive) {
        ipoints.adaptive = true;
        ipoints.refinement = parse_adaptive(tool, mls);
    } else if (gauss) {
        ipoints.gauss_points = (int)tool_integer(tool, "gauss", 1, 1000, 1);
    } else if (tool_given(tool, "lattice")) {
        tool_whole_numbers(tool, "lattice", 2, 1e6, mls->dim, ipoints.lattice);
    }
    return ipoints;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    struct mls any = mls_default(0);
    struct field_shapes recorded;
    int64_t unresolved;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    (void)parse(&tool, &any); /* usage errors before waiting for the input */
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, stage_recorded(&stream, "support", &recorded, &error));
    struct ipoints_options ipoints = parse(&tool, &recorded.support.mls);
    ipoints.refinement.support.visibility = recorded.support.visibility;
    TOOL_TRY(&tool, stage_ipoints(&stream, &ipoints, &unresolved, &error));
    if (unresolved > 0) {
        tool_note(&tool, "%jd cells change by more than the tolerance even at level %d", unresolved,
                  ipoints.refinement.levels);
    }
    if (tool_given(&tool, "verbose")) {
        tool_note(&tool, "%jd points", stream_find(&stream, "points.x")->rows);
    }
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
