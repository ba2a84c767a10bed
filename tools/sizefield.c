static const char usage[] =
    "sizefield - sizes for a graded mesh, finer where a solution needs it\n"
    "\n"
    "usage: sizefield [-s SHARE] [-n NODES] [--sag LENGTH] [--least LENGTH] [-u UNIT] [--field NAME]\n"
    "                 [-v] [-o FILE] [FILE]\n"
    "\n"
    "Reads a result of mtled and writes sizes of cells for a mesh whose error is SHARE of the present\n"
    "one, as a view of gmsh (.pos): a background field, in the unit of the geometry. It reaches a\n"
    "little beyond the boundary, as no size is taken from places outside of it.\n"
    "\n"
    "Where cells are too large is seen from their gradients of u: in each cell the distance of the\n"
    "gradient from the one averaged at its nodes (recovery: Zienkiewicz and Zhu 1987), within each\n"
    "region. Sizes are such that all cells have an equal part of it. At a place the size becomes at\n"
    "least a quarter of the present one and at most twice it, on the boundary, for the sake of its\n"
    "shape, at most as large; and it changes by at most .3 per length.\n"
    "How large the error is this does not tell: see fielderr.\n"
    "\n"
    "Options:\n"
    "  -s, --share SHARE      the error wanted, by the present one (default 0.25)\n"
    "  -n, --nodes NODES      the most nodes (default 100000): sizes that ask for more are all made\n"
    "                         larger by one factor, and that is noted\n"
    "      --sag LENGTH       facets of a curved boundary are at most about so far off it: where a body\n"
    "                         slides on another, its shape is an error that gradients do not show\n"
    "      --least LENGTH     no size is less: where a solution is singular, sizes become ever smaller,\n"
    "                         and a body that is pressed may fold in such small cells\n"
    "  -u, --unit UNIT        unit of the sizes and their places: m (default), cm, mm, um or so many\n"
    "                         metres\n"
    "      --field NAME       the field, of 1 to 3 columns (default u)\n"
    "  -v, --verbose          report on standard error: least and largest size, nodes\n"
    "  -o, --output FILE      write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  sizefield -s 0.3 -u mm -o sizes.pos u.dat\n"
    "  printf 'Merge \"sizes.pos\";\\nBackground Mesh View[0];\\n' | cat body.geo - > graded.geo\n"
    "  printf 'Mesh.MeshSize%s = 0;\\n' ExtendFromBoundary FromPoints FromCurvature >> graded.geo\n"
    "  gmsh -2 graded.geo -o graded.msh\n";

#include "output.h"
#include "tool.h"
#include "stages/views.h"

#include "approx/error/field_error.h"

/* Errors of the cells of a field, from its recovered gradient. */
static enum status recover(const struct stream *stream, const char *field, struct cells *cells,
                           double **squared, struct error *error)
{
    const struct section *section;
    FREED_BY(groups_free) struct groups regions = {0};
    RETURN_IF_ERROR(stream_cells(stream, true, cells, error));
    RETURN_IF_ERROR(stream_field(stream, field, 0, cells->node_count, &section, error));
    RETURN_IF_ERROR(stream_groups(stream, GROUP_REGION, false, &regions, error));
    RETURN_IF_ERROR(NEW_ARRAY(squared, cells->count, error));
    return fail_in(error,
                   field_error_recovered(cells, regions.group, (int32_t)regions.names.count, section->cols,
                                         section->data, *squared, error),
                   "%s", field);
}

/* Print a simplex of a view of gmsh, ST or SS: corners and the sizes there. */
static void print_simplex(FILE *file, int dim, const double *const corner[], const double size[], double unit)
{
    fprintf(file, "%s(", dim == 2 ? "ST" : "SS");
    for (int k = 0; k <= dim; k++) {
        fprintf(file, "%s%.9g,%.9g,%.9g", k > 0 ? "," : "", corner[k][0] / unit, corner[k][1] / unit,
                dim == 3 ? corner[k][2] / unit : 0.0);
    }
    for (int k = 0; k <= dim; k++) {
        fprintf(file, "%s%.6g", k > 0 ? "," : "){", size[k] / unit);
    }
    fprintf(file, "};\n");
}

/* Print the cells with their sizes, and a layer beyond the boundary: dim simplices between each facet and its
 * nodes moved outward. */
static void print_view(FILE *file, const struct cells *cells, const struct size_field *field, double unit)
{
    int dim = cells->dim;
    const double *corner[4];
    double size[4];
    fprintf(file, "View \"size\" {\n");
    for (int64_t q = 0; q < cells->count; q++) {
        cell_corners(cells, q, corner);
        for (int k = 0; k <= dim; k++) {
            size[k] = field->size[cells->node[q * (dim + 1) + k]];
        }
        print_simplex(file, dim, corner, size, unit);
    }
    for (int64_t f = 0; f < field->boundary.boundary_count * dim; f++) {
        const int32_t *node = field->boundary.node + f / dim * dim;
        for (int k = 0; k <= dim; k++) { /* moved nodes up to the part's number, unmoved nodes from it on */
            bool moved = k <= f % dim;
            int64_t n = node[moved ? k : k - 1];
            corner[k] = (moved ? field->outer : cells->x) + n * dim;
            size[k] = field->size[n];
        }
        print_simplex(file, dim, corner, size, unit);
    }
    fprintf(file, "};\n");
}

static void report(const struct cells *cells, const struct size_field *field, double unit)
{
    double least = field->size[0], most = field->size[0];
    for (int64_t n = 1; n < cells->node_count; n++) {
        least = field->size[n] < least ? field->size[n] : least;
        most = field->size[n] > most ? field->size[n] : most;
    }
    fprintf(stderr, "least size\t%.4g\nlargest size\t%.4g\nnodes\t%.0f\n", least / unit, most / unit,
            field->nodes);
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    struct cells cells;
    FREED_BY(size_field_free) struct size_field field = {0};
    SCRATCH double *squared = NULL;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    double unit = tool_length_unit(&tool, "unit", 1.0);
    struct size_field_request sizes = {.share = tool_number(&tool, "share", 1e-6, 1e6, 0.25),
                                       .most_nodes =
                                           (double)tool_integer(&tool, "nodes", 10, 100000000, 100000),
                                       .sag = tool_length(&tool, "sag", 0.0),
                                       .least = tool_length(&tool, "least", 0.0)};
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, recover(&stream, tool_given(&tool, "field") ? tool_value(&tool, "field") : "u", &cells,
                            &squared, &error));
    TOOL_TRY(&tool, size_field_build(&cells, squared, &sizes, &field, &error));
    if (field.unbound > sizes.most_nodes) {
        tool_note(&tool, "these sizes ask for %.3g nodes: made larger for %.0f (-n)", field.unbound,
                  sizes.most_nodes);
    }
    struct output output;
    TOOL_TRY(&tool, output_open(&output, tool.output, false, &error));
    print_view(output.file, &cells, &field, unit);
    TOOL_TRY(&tool, output_end(&output, STATUS_OK, &error));
    if (tool_given(&tool, "verbose")) {
        report(&cells, &field, unit);
    }
    return tool_end(&tool);
}
