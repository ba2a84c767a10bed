static const char usage[] =
    "sizefield - sizes for a graded mesh, finer where a solution needs it\n"
    "\n"
    "usage: sizefield [-s SHARE] [-n NODES] [--sag LENGTH] [--least LENGTH] [-u UNIT] [--field NAME]\n"
    "                 [-v] [-b | -t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a result of mtled and writes sizes of cells for a mesh whose error is SHARE of the present\n"
    "one, as a view of gmsh (.pos): a background field, in the unit of the geometry; or, for\n"
    "voxels --sizes, as a stream of nodes.x, cells and size (m). Both reach a little beyond the\n"
    "boundary, as no size is taken from places outside of them.\n"
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
    "  -b, --binary           write a stream, binary\n"
    "  -t, --text             write a stream, as text\n"
    "  -v, --verbose          report on standard error: least and largest size, nodes\n"
    "  -o, --output FILE      write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  sizefield -s 0.3 -u mm -o sizes.pos u.dat\n"
    "  printf 'Merge \"sizes.pos\";\\nBackground Mesh View[0];\\n' | cat body.geo - > graded.geo\n"
    "  printf 'Mesh.MeshSize%s = 0;\\n' ExtendFromBoundary FromPoints FromCurvature >> graded.geo\n"
    "  gmsh -2 graded.geo -o graded.msh\n"
    "  sizefield -b u.dat | voxels -h 6mm --sizes - labels.nii.gz > finer.mts\n";

#include "output.h"
#include "tool.h"
#include "stages/views.h"

#include "approx/error/field_error.h"

#include <string.h>

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

/* The cells with their sizes, and a layer beyond the boundary: dim simplices between each facet and its nodes
 * moved outward. */
struct layered {
    struct cells cells;
    double *x;     /* cells.node_count * dim, m: the nodes, and those of the boundary moved outward */
    int32_t *node; /* cells.count * (dim + 1) */
    double *size;  /* cells.node_count, m */
};

static void layered_free(struct layered *layered)
{
    FREE_ALL(layered->x, layered->node, layered->size);
}

static enum status layered_make(const struct cells *cells, const struct size_field *field,
                                struct layered *layered, struct error *error)
{
    int dim = cells->dim;
    const struct faces *boundary = &field->boundary;
    *layered = (struct layered){.cells = {.dim = dim, .node_count = cells->node_count}};
    NEW_SCRATCH(int32_t, outer, cells->node_count, error); /* node_count: number of the moved node; 0: none */
    RETURN_IF_ERROR(NEW_ARRAY(&layered->x, 2 * cells->node_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&layered->size, 2 * cells->node_count, error));
    RETURN_IF_ERROR(
        NEW_ARRAY(&layered->node, (cells->count + boundary->boundary_count * dim) * (dim + 1), error));
    memcpy(layered->x, cells->x, (size_t)(cells->node_count * dim) * sizeof(double));
    memcpy(layered->size, field->size, (size_t)cells->node_count * sizeof(double));
    memcpy(layered->node, cells->node, (size_t)(cells->count * (dim + 1)) * sizeof(int32_t));
    for (int64_t i = 0; i < boundary->boundary_count * dim; i++) {
        int64_t n = boundary->node[i], made = layered->cells.node_count;
        if (outer[n] == 0) {
            memcpy(layered->x + made * dim, field->outer + n * dim, (size_t)dim * sizeof(double));
            layered->size[made] = field->size[n];
            outer[n] = (int32_t)made;
            layered->cells.node_count++;
        }
    }
    int32_t *simplex = layered->node + cells->count * (dim + 1);
    for (int64_t f = 0; f < boundary->boundary_count; f++) {
        const int32_t *node = boundary->node + f * dim;
        for (int part = 0; part < dim; part++, simplex += dim + 1) {
            /* Moved nodes up to `part`, unmoved nodes from `part` on. */
            for (int k = 0; k <= dim; k++) {
                simplex[k] = k <= part ? outer[node[k]] : node[k - 1];
            }
        }
    }
    layered->cells.count = cells->count + boundary->boundary_count * dim;
    layered->cells.x = layered->x;
    layered->cells.node = layered->node;
    return STATUS_OK;
}

/* Print the simplices of a view of gmsh, ST or SS: corners and the sizes there. */
static void print_view(FILE *file, const struct layered *layered, double unit)
{
    int dim = layered->cells.dim;
    fprintf(file, "View \"size\" {\n");
    for (int64_t q = 0; q < layered->cells.count; q++) {
        const int32_t *node = layered->node + q * (dim + 1);
        fprintf(file, "%s(", dim == 2 ? "ST" : "SS");
        for (int k = 0; k <= dim; k++) {
            const double *x = layered->x + (int64_t)node[k] * dim;
            fprintf(file, "%s%.9g,%.9g,%.9g", k > 0 ? "," : "", x[0] / unit, x[1] / unit,
                    dim == 3 ? x[2] / unit : 0.0);
        }
        for (int k = 0; k <= dim; k++) {
            fprintf(file, "%s%.6g", k > 0 ? "," : "){", layered->size[node[k]] / unit);
        }
        fprintf(file, "};\n");
    }
    fprintf(file, "};\n");
}

static void orient(struct layered *layered)
{
    int corners = layered->cells.dim + 1;
    int64_t kept = 0;
    for (int64_t q = 0; q < layered->cells.count; q++) {
        int32_t *node = layered->node + q * corners, first = node[0];
        if (cell_volume(&layered->cells, q) < 0) {
            node[0] = node[1];
            node[1] = first;
        }
        if (cell_volume(&layered->cells, q) > 0) {
            memmove(layered->node + kept++ * corners, node, (size_t)corners * sizeof *node);
        }
    }
    layered->cells.count = kept;
}

static void write_sizes(const struct tool *tool, struct layered *layered)
{
    FREED_BY(stream_free) struct stream stream = {0};
    char attributes[64];
    const struct cells *cells = &layered->cells;
    orient(layered);
    tool_put(tool, &stream, "nodes.x", TYPE_F8, cells->node_count, cells->dim,
             vector_attributes(cells->dim, "m", attributes), array_take(&layered->x));
    tool_put(tool, &stream, "cells", TYPE_I4, cells->count, cells->dim + 1, "", array_take(&layered->node));
    tool_put(tool, &stream, "size", TYPE_F8, cells->node_count, 1, "unit=m", array_take(&layered->size));
    tool_write(tool, &stream);
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
    tool_excludes(&tool, "binary", "text");
    if (tool_given(&tool, "unit") && (tool_given(&tool, "binary") || tool.text)) {
        tool_fail(&tool, STATUS_INPUT, "-u goes without -b and -t: a stream is in m");
    }
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
    FREED_BY(layered_free) struct layered layered = {0};
    struct output output;
    TOOL_TRY(&tool, layered_make(&cells, &field, &layered, &error));
    if (tool_given(&tool, "binary") || tool.text) {
        write_sizes(&tool, &layered);
    } else {
        TOOL_TRY(&tool, output_open(&output, tool.output, false, &error));
        print_view(output.file, &layered, unit);
        TOOL_TRY(&tool, output_end(&output, STATUS_OK, &error));
    }
    if (tool_given(&tool, "verbose")) {
        report(&cells, &field, unit);
    }
    return tool_end(&tool);
}
