static const char usage[] =
    "sizefield - sizes for a graded mesh, finer where a solution needs it\n"
    "\n"
    "usage: sizefield [-s SHARE] [-n NODES] [--sag LENGTH] [--least LENGTH] [-u UNIT] [--field NAME]\n"
    "                 [-v] [-o FILE] [FILE]\n"
    "\n"
    "Reads a result of mtled and writes sizes of cells for a mesh whose error is SHARE of the present\n"
    "one, as a view of gmsh (.pos): a background field, in the unit of the geometry. It reaches a little\n"
    "beyond the boundary, as gmsh takes no size from places outside of a view.\n"
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
#include "regions.h"
#include "tool.h"
#include "views.h"

#include "approx/field_error.h"
#include "approx/size_field.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What the command line asks for. */
struct request {
    struct size_field_request sizes;
    double unit; /* m */
    const char *field;
    bool verbose;
};

static struct request parse(const struct tool *tool)
{
    return (struct request){
        .sizes = {.share = tool_number(tool, "share", 1e-6, 1e6, 0.25),
                  .most_nodes = (double)tool_integer(tool, "nodes", 10, 100000000, 100000),
                  .sag = tool_length(tool, "sag", 0.0),
                  .least = tool_length(tool, "least", 0.0)},
        .unit = tool_length_unit(tool, "unit", 1.0),
        .field = tool_given(tool, "field") ? tool_value(tool, "field") : "u",
        .verbose = tool_given(tool, "verbose")};
}

/* Errors of the cells of a field, from its recovered gradient. */
static enum status recover(const struct stream *stream, const char *field, struct cells *cells,
                           double **squared, struct error *error)
{
    enum status status;
    const struct section *section;
    struct regions regions = {0};
    TRY(stream_cells(stream, true, cells, error));
    TRY(stream_need(stream, field, TYPE_F8, 0, "mtled", &section, error));
    if (section->cols > 3 || section->rows != cells->node_count) {
        TRY(fail(error, STATUS_INPUT,
                 "%s: %lld rows of %lld columns: not a field of 1 to 3 columns on %lld nodes", field,
                 (long long)section->rows, (long long)section->cols, (long long)cells->node_count));
    }
    TRY(regions_read(stream, cells, &regions, error));
    const struct section *region = regions.count > 0 ? stream_find(stream, "cells.region") : NULL;
    TRY(NEW_ARRAY(squared, cells->count, error));
    status = field_error_recovered(cells, region != NULL ? region->data : NULL, regions.count, section->cols,
                                   section->data, *squared, error);
    if (status != STATUS_OK) {
        status = fail_in(error, status, "%s", field);
    }
done:
    regions_free(&regions);
    return status;
}

/* A simplex of a view of gmsh, ST or SS: its corners and the sizes there. */
static void print_simplex(FILE *file, int dim, const double *const x[], const double size[], double unit)
{
    fprintf(file, "%s(", dim == 2 ? "ST" : "SS");
    for (int k = 0; k <= dim; k++) {
        fprintf(file, "%s%.9g,%.9g,%.9g", k > 0 ? "," : "", x[k][0] / unit, x[k][1] / unit,
                dim == 3 ? x[k][2] / unit : 0.0);
    }
    for (int k = 0; k <= dim; k++) {
        fprintf(file, "%s%.6g", k > 0 ? "," : "){", size[k] / unit);
    }
    fprintf(file, "};\n");
}

/* The cells, and a layer beyond the boundary: between each facet and its nodes moved outward dim simplices.
 */
static void print_view(FILE *file, const struct cells *cells, const struct size_field *field, double unit)
{
    int dim = cells->dim;
    const double *x[4];
    double size[4];
    fprintf(file, "View \"size\" {\n");
    for (int64_t q = 0; q < cells->count; q++) {
        for (int k = 0; k <= dim; k++) {
            int32_t n = cells->node[q * (dim + 1) + k];
            x[k] = cells->x + n * dim;
            size[k] = field->size[n];
        }
        print_simplex(file, dim, x, size, unit);
    }
    for (int64_t f = 0; f < field->boundary.boundary_count; f++) {
        const int32_t *node = field->boundary.node + f * dim;
        for (int part = 0; part < dim; part++) {
            /* Nodes up to `part` moved outward, those from `part` on at their places. */
            for (int k = 0; k <= dim; k++) {
                int32_t n = node[k <= part ? k : k - 1];
                x[k] = (k <= part ? field->outer : cells->x) + n * dim;
                size[k] = field->size[n];
            }
            print_simplex(file, dim, x, size, unit);
        }
    }
    fprintf(file, "};\n");
}

static void write_view(const struct tool *tool, const struct cells *cells, const struct size_field *field,
                       double unit)
{
    struct output output;
    struct error error;
    if (tool->output == NULL) {
        print_view(stdout, cells, field, unit);
        return;
    }
    tool_check(tool, output_open(&output, tool->output, &error), &error);
    int descriptor = dup(output.descriptor); /* the output closes its own */
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    int reason = errno;
    if (file != NULL) {
        errno = 0;
        print_view(file, cells, field, unit);
        reason = ferror(file) != 0 ? errno : 0;
        reason = fclose(file) != 0 && reason == 0 ? errno : reason;
    }
    if (reason != 0 || file == NULL) {
        tool_fail(tool, STATUS_SYSTEM, "%s: %s", tool->output, strerror(reason));
    }
    tool_check(tool, output_commit(&output, &error), &error);
}

static void report(const struct request *request, const struct cells *cells, const struct size_field *field)
{
    double least = field->size[0], most = field->size[0];
    for (int64_t n = 1; n < cells->node_count; n++) {
        least = field->size[n] < least ? field->size[n] : least;
        most = field->size[n] > most ? field->size[n] : most;
    }
    fprintf(stderr, "least size\t%.4g\nlargest size\t%.4g\nnodes\t%.0f\n", least / request->unit,
            most / request->unit, field->nodes);
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct stream stream;
    struct cells cells;
    struct size_field field;
    struct error error;
    double *squared = NULL;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    struct request request = parse(&tool);
    tool_read(&tool, tool.operands[0], &stream);
    tool_check(&tool, recover(&stream, request.field, &cells, &squared, &error), &error);
    tool_check(&tool, size_field_build(&cells, squared, &request.sizes, &field, &error), &error);
    if (field.unbound > request.sizes.most_nodes) {
        tool_note(&tool, "these sizes ask for %.3g nodes: made larger for %.0f (-n)", field.unbound,
                  request.sizes.most_nodes);
    }
    write_view(&tool, &cells, &field, request.unit);
    if (request.verbose) {
        report(&request, &cells, &field);
    }
    size_field_free(&field);
    free(squared);
    stream_free(&stream);
    return tool_end(&tool);
}
