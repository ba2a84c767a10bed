static const char usage[] =
    "shapefn - shape functions of moving least squares\n"
    "\n"
    "usage: shapefn [-b BASIS] [-w WEIGHT] [--mu MU[,MU...]] [--mu-unit UNIT] [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with points and neighbour lists (see support) and adds what mtled computes with.\n"
    "Smoothed cells have the shape functions on their edges, edge.phi: their gradients\n"
    "follow from these by the divergence theorem. Other integration points (ipoints -g, -a, --lattice)\n"
    "have values and gradients, shape.phi and shape.dphi (1/m). Both have the values node.phi at the\n"
    "nodes and boundary.phi at the quadrature points of faces on the boundary. The points on faces and\n"
    "their lists are not needed any more and are left out: to run support or shapefn again, begin with\n"
    "ipoints. A support whose moment matrix is singular or ill-conditioned is an error that names the\n"
    "point (status 1). Without earlier sections the defaults of ipoints and support are run first.\n"
    "\n"
    "Options:\n"
    "  -b, --basis BASIS      mls1: linear MLS; mls2: quadratic MLS; mmls2: quadratic, with its\n"
    "                         second-order monomials regularised, never singular where mls1 is not\n"
    "                         (default: as support)\n"
    "  -w, --weight WEIGHT    quartic spline, or regularised (Most and Bucher 2005, almost\n"
    "                         interpolating) (default: as support)\n"
    "      --mu MU[,MU...]    the regularisation, for all second-order monomials or for each:\n"
    "                         x2,xy,y2 in 2D, x2,xy,xz,y2,yz,z2 in 3D; dimensionless, relative to the\n"
    "                         support radius s to the fourth power (default 1e-7 for squares, half of\n"
    "                         that for products: the same along any axes)\n"
    "      --mu-unit UNIT     MU is absolute, in coordinates of that unit (m, cm, mm, um): mu / s^4\n"
    "                         is used\n"
    "  -t, --text             write text instead of binary\n"
    "  -o, --output FILE      write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | shapefn | mtled scene > u.dat\n"
    "  nodes -u mm body.msh | ipoints -g 4 | support -R 9mm | shapefn --mu 1e-7 --mu-unit mm > table.mts\n";

#include "stage_options.h"
#include "stages/stages.h"

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    struct mls mls = mls_default(0);
    struct field_shapes recorded;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    mls_parse(&tool, &mls);
    tool_read(&tool, tool.operands[0], &stream);
    stage_fill(&tool, &stream, "support");
    TOOL_TRY(&tool, stage_recorded(&stream, "support", &recorded, &error));
    recorded.shapes = recorded.support.mls;
    mls_parse(&tool, &recorded.shapes);
    TOOL_TRY(&tool, stage_shapefn(&stream, &recorded.shapes, &error));
    /* Other tools evaluate the shape functions by these settings. */
    const struct section *radius = stream_find(&stream, "support.radius");
    TOOL_TRY(&tool, stage_record(&stream, &recorded, radius->rows, &error));
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
