static const char usage[] =
    "part - cut a body into parts, each a stream of its own\n"
    "\n"
    "usage: part -k PARTS [-w WIDEN] [-f FACTOR | -R RADIUS] [-v] [-t] [-o NAME] [FILE]\n"
    "\n"
    "Reads a stream with nodes and cells (see nodes, voxels, cloud) and cuts it into PARTS of about\n"
    "equal work, with few nodes between them, by METIS. Each part is written as a stream under NAME,\n"
    "in which %d is its number, from 0. It has the nodes and cells of the part, and a halo of those of\n"
    "others that supports reach over, so that ipoints, support and shapefn compute on it what they\n"
    "compute on the whole body: run the three, with the same options, on each part, side by side or on\n"
    "several machines. mtled takes all parts as they are, and unpart puts tables and fields together\n"
    "again; both to the same bytes.\n"
    "\n"
    "Nodes and cells keep their order. part.node and part.cell have their numbers in the body, part.owner\n"
    "the part that each node belongs to; a cell belongs to the part with most of its vertices. Sections\n"
    "of ipoints, support and shapefn, results other than fields at the nodes, and unknown sections are\n"
    "left out, with a note. Groups are to be made before a body is cut.\n"
    "\n"
    "Options:\n"
    "  -k, --parts PARTS      how many parts\n"
    "  -w, --widen WIDEN      the most that support will widen radii (default 1.5); unpart refuses parts\n"
    "                         whose halo turns out too narrow\n"
    "  -f, --factor FACTOR    support's -k, if it is to be given (default 1.8, in 3D 2)\n"
    "  -R, --radius RADIUS    support's -R, if it is to be given\n"
    "  -v, --verbose          report on standard error, as a table of one row: parts; mean and largest\n"
    "                         number of own nodes; of nodes with the halo in the streams; of nodes of\n"
    "                         others that an evaluation needs, and of the parts that these belong to; bytes\n"
    "                         that a part exchanges in an evaluation, mean and largest; imbalance, the\n"
    "                         largest work over the mean, less 1. Without -o that is all.\n"
    "  -t, --text             write text instead of binary\n"
    "  -o, --output NAME      each part's file, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | part -k 8 -o part.%d.mts\n"
    "  ls part.?.mts | xargs -P 8 -I {} shapefn -o {}.table {}\n"
    "  mpirun -n 4 mtled -o u.dat body.scene part.%d.mts.table\n"
    "  unpart part.?.mts.table > table.mts\n";

#include "parts/cut_body.h"
#include "stage_options.h"

#include <stdlib.h>
#include <zlib.h>

/* The report of -v. */
struct report {
    double own, nodes, needed, others, work;
    double most_own, most_nodes, most_needed, most_others, most_work;
};

static void add(double value, double *sum, double *most)
{
    *sum += value;
    *most = value > *most ? value : *most;
}

static void print_report(const struct cut_body *whole, const struct report *report)
{
    int32_t parts = whole->partition.parts;
    /* Displacements of other parts' nodes are received, forces on them sent; and the reverse for own nodes.
     */
    double bytes = 2.0 * whole->cells.dim * sizeof(double);
    fprintf(stderr,
            "parts\town_nodes\town_most\tstored_nodes\tstored_most\tneeded_nodes\tneeded_most\tother_parts"
            "\tother_parts_most\tbytes\tbytes_most\timbalance\n");
    fprintf(stderr, "%d\t%.0f\t%.0f\t%.0f\t%.0f\t%.0f\t%.0f\t%.1f\t%.0f\t%.0f\t%.0f\t%.4f\n", parts,
            report->own / parts, report->most_own, report->nodes / parts, report->most_nodes,
            report->needed / parts, report->most_needed, report->others / parts, report->most_others,
            bytes * report->needed / parts, bytes * report->most_needed,
            report->most_work * parts / report->work - 1.0);
}

static void write_parts(const struct cut_body *whole, bool wanted, struct report *report)
{
    FREED_BY(body_part_work_free) struct body_part_work work = {0};
    const char *name = whole->tool->output;
    tool_provenance(whole->tool, whole->stream);
    for (int32_t k = 0; k < whole->partition.parts; k++) {
        FREED_BY(body_part_free) struct body_part body = {0};
        TOOL_TRY(whole->tool,
                 body_part_build(&whole->partition, k, whole->own_cell + whole->own_ptr[k],
                                 whole->own_ptr[k + 1] - whole->own_ptr[k], wanted, &work, &body, &error));
        add((double)body.own_nodes, &report->own, &report->most_own);
        add((double)body.node_count, &report->nodes, &report->most_nodes);
        add((double)body.needed, &report->needed, &report->most_needed);
        add((double)body.others, &report->others, &report->most_others);
        add(body.work, &report->work, &report->most_work);
        if (wanted) {
            struct stream part = {0};
            SCRATCH char *file = tool_numbered(whole->tool, "-o ", name, k);
            cut_body_make_part(whole, k, &body, &part);
            stream_inherit(&part, whole->stream);
            whole->tool->output = file;
            tool_copy(whole->tool, &part);
            stream_inherit(whole->stream, &part);
            stream_free(&part);
        }
    }
}

/* A number that identifies the parts of one cut. */
static uint32_t identify(const struct cut_body *whole)
{
    const struct cells *cells = &whole->cells;
    uLong crc = crc32_z(0, NULL, 0);
    crc = crc32_z(crc, (const Bytef *)cells->x, (size_t)(cells->node_count * cells->dim) * sizeof *cells->x);
    crc = crc32_z(crc, (const Bytef *)cells->node,
                  (size_t)(cells->count * (cells->dim + 1)) * sizeof *cells->node);
    crc = crc32_z(crc, (const Bytef *)whole->owner, (size_t)cells->node_count * sizeof *whole->owner);
    return (uint32_t)crc32_z(crc, (const Bytef *)&whole->partition.widen, sizeof whole->partition.widen);
}

/* Cut the body. Only this program calls METIS; the others are linked without it. */
static void cut(struct cut_body *whole, const struct support_options *support)
{
    struct tool *tool = whole->tool;
    struct cells *cells = &whole->cells;
    TOOL_TRY(tool, NEW_ARRAY(&whole->radius, cells->node_count, &error));
    TOOL_TRY(tool, NEW_ARRAY(&whole->owner, cells->node_count, &error));
    TOOL_TRY(tool, NEW_ARRAY(&whole->work, cells->count, &error));
    TOOL_TRY(tool, stage_radii(whole->stream, support, cells->node_count, cells->x, whole->radius, &error));
    TOOL_TRY(tool,
             point_grid_build(&whole->grid, cells->dim, cells->node_count, cells->x, whole->radius, &error));
    TOOL_TRY(tool, cell_stars_build(cells, &whole->stars, &error));
    TOOL_TRY(tool, partition_work(cells, &whole->grid, whole->work, &error));
    TOOL_TRY(tool, partition_nodes(cells, &whole->stars, whole->work, whole->partition.parts, whole->owner,
                                   &error));
    whole->partition.cells = cells;
    whole->partition.stars = &whole->stars;
    whole->partition.grid = &whole->grid;
    whole->partition.owner = whole->owner;
    whole->partition.work = whole->work;
    TOOL_TRY(tool, partition_own_cells(&whole->partition, &whole->own_ptr, &whole->own_cell, &error));
    whole->cut = identify(whole);
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    FREED_BY(cut_body_free) struct cut_body whole = {.tool = &tool, .stream = &stream};
    struct support_options support = support_defaults(2);
    tool_begin(&tool, usage, 0, 1, argc, argv);
    if (!tool_given(&tool, "parts")) {
        tool_fail(&tool, STATUS_INPUT, "give -k PARTS (see -h)");
    }
    whole.partition.parts = (int32_t)tool_integer(&tool, "parts", 1, 1000000, 1);
    whole.partition.widen = tool_number(&tool, "widen", 1.0, 8.0, 1.5);
    radius_parse(&tool, &support);
    if (tool.output != NULL) {
        free(tool_numbered(&tool, "-o ", tool.output, 0));
    } else if (!tool_given(&tool, "verbose")) {
        tool_fail(&tool, STATUS_INPUT, "nothing to do: give -o NAME or -v (see -h)");
    }
    tool_read(&tool, tool.operands[0], &stream);
    if (stream_find(&stream, "part.node") != NULL) {
        tool_fail(&tool, STATUS_INPUT, "part.node: the input is a part already");
    }
    TOOL_TRY(&tool, stream_cells(&stream, true, &whole.cells, &error));
    support = support_defaults(whole.cells.dim);
    radius_parse(&tool, &support);
    cut(&whole, &support);
    cut_body_drop_sections(&whole);
    struct report report = {0};
    write_parts(&whole, tool.output != NULL, &report);
    if (tool_given(&tool, "verbose")) {
        print_report(&whole, &report);
    }
    return tool_end(&tool);
}
