static const char usage[] =
    "cloud - analytic clouds of nodes: regular, jittered, Halton, graded\n"
    "\n"
    "usage: cloud -d DIM -k KIND -n N[,N[,N]] --box X0,X1,Y0,Y1[,Z0,Z1] [--jitter FRACTION]\n"
    "             [--seed SEED] [--ratio RATIO] [--field FUNCTION] [-t] [-o FILE]\n"
    "\n"
    "Writes nodes.x (m) in a box; for all kinds but halton also cells, the squares or cubes of the lattice\n"
    "split into triangles or tetrahedra (region 'body'), and facets, the sides of the box, named xmin,\n"
    "xmax, ymin, ymax, zmin, zmax and oriented outward. No mesher is needed.\n"
    "\n"
    "Kinds:\n"
    "  regular                 lattice of N nodes along each axis, with those on the boundary; x fastest\n"
    "  jittered                the same, each inner node moved at random along each axis by at most\n"
    "                          FRACTION of the spacing. Triangles stay valid; where a tetrahedron is\n"
    "                          turned over (possible above 1/6), cells and facets are left out, with a\n"
    "                          note\n"
    "  halton                  the first N points of the Halton sequence (bases 2, 3, 5), none on the\n"
    "                          boundary\n"
    "  graded                  lattice whose spacing grows geometrically along each axis, from X0, Y0, Z0;\n"
    "                          the largest spacing is RATIO times the smallest\n"
    "\n"
    "Functions:\n"
    "  paper                   (1 - r^2) exp(-r^2 / 2), r^2 = x^2 + y^2 + z^2 (all in m)\n"
    "  linear                  1 + 2 x + 3 y + 4 z\n"
    "  quadratic               1 + 2 x + 3 y + 4 z + x^2 - 2 x y + 3 y^2 + x z - y z + 2 z^2\n"
    "\n"
    "Options:\n"
    "  -d, --dim DIM           2 or 3\n"
    "  -k, --kind KIND         regular, jittered, halton or graded\n"
    "  -n, --count N[,N[,N]]   nodes along each axis (one number: along all); halton: nodes in all\n"
    "      --box X0,X1,...     the box, m\n"
    "      --jitter FRACTION   0 to 0.5 (default 0.5)\n"
    "      --seed SEED         of the random numbers, 0 to 4294967295 (default 1)\n"
    "      --ratio RATIO       1 to 1e6 (default 4)\n"
    "      --field FUNCTION    add the section u: this function at the nodes (paper, linear or\n"
    "                          quadratic)\n"
    "  -t, --text              write text instead of binary\n"
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  cloud -d 2 -k regular -n 18 --box -4,4,-4,4 --field paper | mts list\n"
    "  cloud -d 3 -k jittered -n 9,9,17 --box 0,0.1,0,0.1,0,0.2 --jitter 0.15 --seed 7 -o cloud.mts\n";

#include "approx/points/cloud.h"
#include "stages/views.h"
#include "cell_report.h"
#include "tool.h"

#include <math.h>

static void check_kind(const struct tool *tool, const char *option, bool applies)
{
    if (tool_given(tool, option) && !applies) {
        tool_fail(tool, STATUS_INPUT, "--%s goes with another kind", option);
    }
}

static void parse_box(const struct tool *tool, const char *text, struct cloud_options *cloud)
{
    double box[6];
    int count;
    TOOL_TRY(tool, parse_double_list(text, "--box", -1e100, 1e100, 6, box, &count, &error));
    if (count != 2 * cloud->dim) {
        tool_fail(tool, STATUS_INPUT, "--box: %d numbers, not %d", count, 2 * cloud->dim);
    }
    for (int a = 0; a < cloud->dim; a++) {
        cloud->low[a] = box[2 * a];
        cloud->high[a] = box[2 * a + 1];
    }
}

static struct cloud_options parse(const struct tool *tool)
{
    static const char *const kinds[] = {"regular", "jittered", "halton", "graded"};
    static const char *const required[] = {"dim", "kind", "count", "box"};
    struct cloud_options cloud = {0};
    for (int i = 0; i < 4; i++) {
        if (!tool_given(tool, required[i])) {
            tool_fail(tool, STATUS_INPUT, "--%s is missing (see -h)", required[i]);
        }
    }
    cloud.dim = (int)tool_integer(tool, "dim", 2, 3, 2);
    cloud.kind = (enum cloud_kind)tool_choice(tool, "kind", kinds, 4, 0);
    tool_whole_numbers(tool, "count", 1, INT32_MAX, cloud.kind == CLOUD_HALTON ? 1 : cloud.dim, cloud.count);
    parse_box(tool, tool_value(tool, "box"), &cloud);
    check_kind(tool, "jitter", cloud.kind == CLOUD_JITTERED);
    check_kind(tool, "ratio", cloud.kind == CLOUD_GRADED);
    check_kind(tool, "seed", cloud.kind == CLOUD_JITTERED);
    cloud.jitter = tool_number(tool, "jitter", 0, 0.5, 0.5);
    cloud.ratio = tool_number(tool, "ratio", 1, 1e6, 4);
    cloud.seed = (uint32_t)tool_integer(tool, "seed", 0, UINT32_MAX, 1);
    return cloud;
}

/* Put the function with this number in the list of names as u. */
static void put_field(const struct tool *tool, struct stream *stream, const struct cloud *cloud, int function)
{
    double *values;
    TOOL_TRY(tool, NEW_ARRAY(&values, cloud->node_count, &error));
    for (int64_t n = 0; n < cloud->node_count; n++) {
        const double *at = &cloud->x[n * cloud->dim];
        double x = at[0], y = at[1], z = cloud->dim == 3 ? at[2] : 0, square = x * x + y * y + z * z;
        double linear = 1 + 2 * x + 3 * y + 4 * z;
        values[n] = function == 0   ? (1 - square) * exp(-square / 2)
                    : function == 1 ? linear
                                    : linear + x * x - 2 * x * y + 3 * y * y + x * z - y * z + 2 * z * z;
    }
    tool_put(tool, stream, "u", TYPE_F8, cloud->node_count, 1, "", values);
}

/* Put the cloud as a mesh of one region; region[cell_count] is zero and must outlive the stream. */
static enum status put_cloud(struct stream *stream, const struct cloud *cloud, int32_t region[],
                             struct error *error)
{
    static char body[] = "body", plane[] = "xmin,xmax,ymin,ymax", space[] = "xmin,xmax,ymin,ymax,zmin,zmax";
    const struct names regions = {.count = 1, .list = body},
                       sides = {.count = 2 * cloud->dim, .list = cloud->dim == 2 ? plane : space};
    char attributes[64];
    int dim = cloud->dim;
    RETURN_IF_ERROR(stream_put(stream, "nodes.x", TYPE_F8, cloud->node_count, dim,
                               vector_attributes(dim, "m", attributes), cloud->x, false, error));
    if (cloud->cell_count == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(
        stream_put(stream, "cells", TYPE_I4, cloud->cell_count, dim + 1, "", cloud->cells, false, error));
    RETURN_IF_ERROR(
        stream_put_named(stream, "cells.region", TYPE_I4, cloud->cell_count, &regions, region, false, error));
    RETURN_IF_ERROR(
        stream_put(stream, "facets", TYPE_I4, cloud->facet_count, dim, "", cloud->facets, false, error));
    return stream_put_named(stream, "facets.set", TYPE_I4, cloud->facet_count, &sides, cloud->facet_set,
                            false, error);
}

int main(int argc, char *argv[])
{
    static const char *const functions[] = {"paper", "linear", "quadratic"};
    struct tool tool;
    FREED_BY(cloud_free) struct cloud cloud = {0};
    FREED_BY(stream_free) struct stream stream = {0};
    tool_begin(&tool, usage, 0, 0, argc, argv);
    struct cloud_options wanted = parse(&tool);
    int function = tool_choice(&tool, "field", functions, 3, 0);
    TOOL_TRY(&tool, cloud_make(&wanted, &cloud, &error));
    if (wanted.kind != CLOUD_HALTON && cloud.cell_count == 0) {
        tool_note(&tool, "jitter %g turns tetrahedra over: cells and facets are left out", wanted.jitter);
    }
    struct cells cells = {cloud.dim, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    tool_note_thin(&tool, &cells);
    TOOL_SCRATCH(&tool, int32_t, region, cloud.cell_count);
    TOOL_TRY(&tool, put_cloud(&stream, &cloud, region, &error));
    if (tool_given(&tool, "field")) {
        put_field(&tool, &stream, &cloud, function);
    }
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
