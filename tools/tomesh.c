static const char usage[] =
    "tomesh - write a stream as a mesh for other programs\n"
    "\n"
    "usage: tomesh -o FILE [-u UNIT] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x and cells (see nodes, voxels, cloud) and writes the mesh with its\n"
    "groups, so that other programs can compute the same case, and nodes reads the same body again.\n"
    "The ending of the name says what is written:\n"
    "  .msh  gmsh, MSH 2.2 as text: regions, groups of facets and node sets are physical groups\n"
    "        with their names\n"
    "  .inp  Abaqus and CalculiX: *NODE, *ELEMENT of type C3D4 (2D: CPE3) with an element set for\n"
    "        each region, *NSET for each node set, *SURFACE of element faces for each group of\n"
    "        facets. These programs read names without regard to case.\n"
    "Nodes keep their order and count from 1; a node set or group without members is written as an\n"
    "empty one. Fields are not written: see tovtk.\n"
    "\n"
    "Options:\n"
    "  -u, --unit UNIT    of the lengths written: m (default), cm, mm, um or so many metres\n"
    "  -o, --output FILE  write to FILE, which appears only when whole (required)\n"
    "\n"
    "Examples:\n"
    "  voxels -h 6mm labels.nii.gz | tomesh -u mm -o body.msh\n"
    "  nodes -u mm body.msh | tomesh -u mm -o body.inp\n";

#include "output.h"

#include "stages/views.h"

#include "base/memory.h"

#include <inttypes.h>

/* What is written of a stream. */
struct body {
    struct cells cells;
    struct groups regions;
    struct groups facets;
    struct groups sets;
};

/* The formats: Gmsh reference manual, "MSH file format"; Abaqus keywords, as the CalculiX manual has them. */

/* Lengths are divided rather than multiplied, so that 0.01 m is 10 mm and not 10.000000000000002. */
static void print_place(FILE *file, const struct cells *cells, int64_t node, double unit,
                        const char *separator)
{
    for (int a = 0; a < 3; a++) {
        double x = a < cells->dim ? cells->x[node * cells->dim + a] / unit : 0.0;
        fprintf(file, "%s%.17g", a == 0 ? "" : separator, x);
    }
    fputc('\n', file);
}

/* The end of the run of items of one group that begins at `first`: groups are written in runs, so that items
 * keep their order. */
static int64_t run_end(int64_t count, const int32_t *group, int64_t first)
{
    int64_t end = first + 1;
    while (end < count && group[end] == group[first]) {
        end++;
    }
    return end;
}

/* ---- MSH ---- */

/* Groups of one dimension: a physical group and an entity for each name, with the same tag, from 1. */
struct mesh_part {
    int dim, type, corners; /* type: gmsh's number of the element */
    int64_t count;          /* elements */
    const int32_t *element, *group;
    const struct names *names;
};

static void print_elements(FILE *file, const struct mesh_part *part, int64_t *tag)
{
    for (int64_t e = 0; e < part->count; e++) {
        int group = part->group[e] + 1;
        fprintf(file, "%" PRId64 " %d 2 %d %d", ++*tag, part->type, group, group);
        for (int c = 0; c < part->corners; c++) {
            fprintf(file, " %d", part->element[e * part->corners + c] + 1);
        }
        fputc('\n', file);
    }
}

/* The elements of the lowest dimension come first. */
static void write_msh(FILE *file, const struct body *body, double unit)
{
    const struct cells *cells = &body->cells;
    const struct groups *sets = &body->sets, *facets = &body->facets;
    int dim = cells->dim;
    int64_t names = 0, elements = 0, tag = 0;
    const struct mesh_part part[3] = {
        {0, 15, 1, sets->count, sets->node, sets->group, &sets->names},
        {dim - 1, dim == 3 ? 2 : 1, dim, facets->count, facets->node, facets->group, &facets->names},
        {dim, dim == 3 ? 4 : 2, dim + 1, cells->count, cells->node, body->regions.group,
         &body->regions.names}};
    for (int k = 0; k < 3; k++) {
        names += part[k].names->count;
        elements += part[k].count;
    }
    fprintf(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%" PRId64 "\n", names);
    for (int k = 0; k < 3; k++) {
        for (int32_t g = 0; g < part[k].names->count; g++) {
            fprintf(file, "%d %d \"%s\"\n", part[k].dim, g + 1, part[k].names->name[g]);
        }
    }
    fprintf(file, "$EndPhysicalNames\n$Nodes\n%" PRId64 "\n", cells->node_count);
    for (int64_t n = 0; n < cells->node_count; n++) {
        fprintf(file, "%" PRId64 " ", n + 1);
        print_place(file, cells, n, unit, " ");
    }
    fprintf(file, "$EndNodes\n$Elements\n%" PRId64 "\n", elements);
    for (int k = 0; k < 3; k++) {
        print_elements(file, &part[k], &tag);
    }
    fprintf(file, "$EndElements\n");
}

/* ---- decks of Abaqus and CalculiX ---- */

static void print_cells(FILE *file, const struct cells *cells, const struct groups *regions)
{
    for (int64_t c = 0; c < cells->count;) {
        int64_t end = run_end(cells->count, regions->group, c);
        fprintf(file, "*ELEMENT, TYPE=%s, ELSET=%s\n", cells->dim == 3 ? "C3D4" : "CPE3",
                regions->names.name[regions->group[c]]);
        for (; c < end; c++) {
            fprintf(file, "%" PRId64, c + 1);
            for (int k = 0; k <= cells->dim; k++) {
                fprintf(file, ", %d", cells->node[c * (cells->dim + 1) + k] + 1);
            }
            fputc('\n', file);
        }
    }
}

/* The faces of an element by the corner that each lies opposite. */
static const char *const face_names[2][4] = {{"S2", "S3", "S1", ""}, {"S3", "S4", "S2", "S1"}};

static enum status print_surfaces(FILE *file, const struct cells *cells, const struct groups *facets,
                                  struct error *error)
{
    FREED_BY(faces_free) struct faces faces = {0};
    NEW_SCRATCH(int64_t, found, facets->count, error);
    RETURN_IF_ERROR(faces_build(cells, true, &faces, error));
    RETURN_IF_ERROR(faces_find(&faces, facets->count, facets->node, found, error));
    for (int32_t g = 0; g < facets->names.count; g++) {
        fprintf(file, "*SURFACE, TYPE=ELEMENT, NAME=%s\n", facets->names.name[g]);
        for (int64_t f = 0; f < facets->count; f++) {
            int vertex = 0;
            if (facets->group[f] != g) {
                continue;
            }
            if (found[f] < 0) {
                return fail(error, STATUS_INPUT, "facets: row %" PRId64 ": no face of exactly one cell", f);
            }
            int64_t cell = faces.cell[2 * found[f]];
            const int32_t *corner = cells->node + cell * (cells->dim + 1),
                          *node = facets->node + f * cells->dim;
            while (corner[vertex] == node[0] || corner[vertex] == node[1] ||
                   corner[vertex] == node[cells->dim - 1]) {
                vertex++;
            }
            fprintf(file, "%" PRId64 ", %s\n", cell + 1, face_names[cells->dim == 3][vertex]);
        }
    }
    return STATUS_OK;
}

/* Print the body as a deck of Abaqus and CalculiX; lists eight to a line. */
static enum status write_inp(FILE *file, const struct body *body, double unit, struct error *error)
{
    const struct groups *sets = &body->sets;
    fprintf(file, "*NODE\n");
    for (int64_t n = 0; n < body->cells.node_count; n++) {
        fprintf(file, "%" PRId64 ", ", n + 1);
        print_place(file, &body->cells, n, unit, ", ");
    }
    print_cells(file, &body->cells, &body->regions);
    for (int64_t g = 0, first = 0; g < sets->names.count; g++) {
        fprintf(file, "*NSET, NSET=%s\n", sets->names.name[g]);
        int64_t end =
            first < sets->count && sets->group[first] == g ? run_end(sets->count, sets->group, first) : first;
        for (int64_t i = first; i < end; i++) {
            fprintf(file, "%d%s", sets->node[i] + 1,
                    i + 1 == end           ? "\n"
                    : (i - first) % 8 == 7 ? ",\n"
                                           : ", ");
        }
        first = end;
    }
    return print_surfaces(file, &body->cells, &body->facets, error);
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct output output;
    FREED_BY(stream_free) struct stream stream = {0};
    struct body body;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    bool is_msh = tool.output != NULL && text_ends(tool.output, ".msh");
    if (!is_msh && (tool.output == NULL || !text_ends(tool.output, ".inp"))) {
        tool_fail(&tool, STATUS_INPUT, "-o FILE with a name that ends in .msh or .inp says what is written");
    }
    double unit = tool_length_unit(&tool, "unit", 1.0);
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, stream_cells(&stream, true, &body.cells, &error));
    TOOL_TRY(&tool, stream_groups(&stream, GROUP_REGION, true, &body.regions, &error));
    TOOL_TRY(&tool, stream_groups(&stream, GROUP_FACETS, false, &body.facets, &error));
    TOOL_TRY(&tool, stream_groups(&stream, GROUP_NODES, false, &body.sets, &error));
    TOOL_TRY(&tool, output_open(&output, tool.output, false, &error));
    if (is_msh) {
        write_msh(output.file, &body, unit);
        TOOL_TRY(&tool, output_end(&output, STATUS_OK, &error));
    } else {
        TOOL_TRY(&tool, output_end(&output, write_inp(output.file, &body, unit, &error), &error));
    }
    groups_free(&body.regions);
    groups_free(&body.facets);
    groups_free(&body.sets);
    return tool_end(&tool);
}
