static const char usage[] =
    "tomesh - write a stream as a mesh for other programs\n"
    "\n"
    "usage: tomesh -o FILE [-u UNIT] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x and cells (see nodes, voxels, cloud) and writes the mesh with its\n"
    "groups, so that other programs can compute the same case, and nodes reads the same body again.\n"
    "The ending of the name says what is written:\n"
    "  .msh  gmsh, MSH 4.1 as text: regions, groups of facets and node sets are physical groups\n"
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

#include "io/mesh/mesh_write.h"
#include "stages/views.h"

/* What is written of a stream, with what must be freed. */
struct body {
    struct mesh_view mesh;
    struct cell_regions regions;
    struct named_facets facets;
    struct named_sets sets;
};

static void body_free(struct body *body)
{
    cell_regions_free(&body->regions);
    named_facets_free(&body->facets);
    named_sets_free(&body->sets);
}

static enum status find_body(const struct stream *stream, struct body *body, struct error *error)
{
    struct mesh_view *mesh = &body->mesh;
    struct cells cells;
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    RETURN_IF_ERROR(stream_regions(stream, &body->regions, error));
    RETURN_IF_ERROR(stream_facets(stream, false, &cells, &body->facets, error));
    mesh->dim = cells.dim;
    mesh->node_count = cells.node_count;
    mesh->x = cells.x;
    mesh->cell_count = cells.count;
    mesh->cells = cells.node;
    mesh->region = body->regions.of_cell;
    mesh->regions = body->regions.names;
    mesh->facet_count = body->facets.count;
    mesh->facets = body->facets.facet;
    mesh->facet_set = body->facets.group;
    mesh->facet_sets = body->facets.names;
    if (stream_find(stream, "sets.ptr") != NULL) {
        RETURN_IF_ERROR(stream_sets(stream, true, cells.node_count, &body->sets, error));
        mesh->set_ptr = body->sets.lists.ptr;
        mesh->set_idx = body->sets.lists.idx;
        mesh->node_sets = body->sets.names;
    }
    return STATUS_OK;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct error error;
    struct output output;
    FREED_BY(stream_free) struct stream stream = {0};
    FREED_BY(body_free) struct body body = {0};
    tool_begin(&tool, usage, 0, 1, argc, argv);
    bool is_msh = tool.output != NULL && text_ends(tool.output, ".msh");
    if (!is_msh && (tool.output == NULL || !text_ends(tool.output, ".inp"))) {
        tool_fail(&tool, STATUS_INPUT, "-o FILE with a name that ends in .msh or .inp says what is written");
    }
    double unit = tool_length_unit(&tool, "unit", 1.0);
    tool_read(&tool, tool.operands[0], &stream);
    tool_check(&tool, find_body(&stream, &body, &error), &error);
    tool_print_to(&tool, &output, tool.output);
    enum status status = is_msh ? mesh_write_msh(output.file, &body.mesh, unit, &error)
                                : mesh_write_inp(output.file, &body.mesh, unit, &error);
    tool_check(&tool, output_end(&output, status, &error), &error);
    return tool_end(&tool);
}
