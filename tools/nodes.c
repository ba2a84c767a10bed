static const char usage[] =
    "nodes - mesh to node cloud, background cells, facets and node sets\n"
    "\n"
    "usage: nodes -u UNIT [-r REGION,...] [-v] [-t] [-o FILE] [MESH]\n"
    "       nodes -l [--regions-of ARRAY] [MESH]\n"
    "\n"
    "Reads a mesh from MESH or standard input: of gmsh (MSH 2.2 or 4.1, ASCII or binary, not partitioned),\n"
    "of Abaqus or CalculiX (.inp), of FEBio (.feb, 2.5 to 4.0), or an unstructured grid of VTK (.vtu,\n"
    ".vtk); triangles and quadrangles in a plane z = const, or tetrahedra, hexahedra, prisms and pyramids.\n"
    "Writes nodes.x (m), the nodes of its cells in the order of the file; cells, split into triangles or\n"
    "tetrahedra and positively oriented, with the physical group of each as cells.region; facets, the\n"
    "physical groups on the boundary, oriented outward, and facets.set; and as node sets, sets.ptr and\n"
    "sets.idx, the physical groups of lower dimension and those between two cells. Groups keep their\n"
    "names, with _ for blanks and commas, and _TAG appended to those that two share; one without a name is\n"
    "group_TAG. Where no physical group is of cells, or none of facets, the elementary tags (references of\n"
    "MEDIT) are groups group_TAG, but not one that all have: such cells are the region 'body'. Cells\n"
    "in no group, where others are in one, are 'unnamed'.\n"
    "\n"
    "Left out, with a note, are nodes and facets of no cell, empty groups, midside nodes of second-order\n"
    "cells, and the second of two equal cells. A cell in two groups belongs to the one of the lower tag.\n"
    "Bodies that touch but share no nodes stay two, with a note; so has a body that is one cell thick, as\n"
    "it bends too stiffly. Cells without volume or folded, nodes of one body at one\n"
    "place or on a facet of another cell, and truncated or inconsistent files are errors; but decks of\n"
    "Abaqus have no end that could be missing. Nothing in a file is run.\n"
    "\n"
    "Groups of other files: in a deck of Abaqus, flat or of one part and instance, the sections, or else\n"
    "the sets of elements, are regions, surfaces are facets, sets of nodes node sets. In a model of FEBio\n"
    "the parts are regions, surfaces and shells facets, sets of nodes node sets. In a file of VTK an array\n"
    "of whole numbers of the cells gives the regions, ARRAY_VALUE: cells.region of tovtk, whose facets and\n"
    "sets come back as node sets; gmsh:physical of meshio; the only one; or that of --regions-of. What\n"
    "else such a file says is left out, with a note.\n"
    "\n"
    "Geometries are meshed by 'gmsh -3 body.geo -o body.msh' (STEP, too; -2 in the plane).\n"
    "Other meshes: 'gmsh body.mesh -save -o body.msh' (MEDIT, UNV, Nastran and others), and what meshio\n"
    "reads (TetGen, MED, Exodus, SU2 and others), with its arrays of regions, by python3-meshio:\n"
    "  python3 -c 'import meshio as m; m.write(\"body.vtu\", m.read(\"body.node\"))'\n"
    "A closed surface in STL (which meshio makes of OFF and OBJ, gmsh of PLY) is filled by a file fill.geo\n"
    "of the lines Merge \"body.stl\";  Surface Loop(1) = {1};  Volume(1) = {1};\n"
    "and 'gmsh -3 fill.geo -o body.msh'.\n"
    "\n"
    "Options:\n"
    "  -u, --unit UNIT         unit of the coordinates: m, cm, mm, um, or metres as 0.0254 (required)\n"
    "  -r, --regions NAME,...  keep these regions only, with their nodes and facets\n"
    "      --regions-of ARRAY  the array of a VTK file's cells with their regions\n"
    "  -l, --list              instead: list the groups of the mesh, with dimension, tag and number of\n"
    "                          elements, and stop\n"
    "  -v, --verbose           report box, volume, connected bodies, and the cells of poorest quality\n"
    "                          (radius of the inscribed to the circumscribed sphere, 1 if regular)\n"
    "  -t, --text              write text instead of binary\n"
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  gmsh -2 brain2d.geo -o body.msh && nodes -u mm body.msh | mts list\n";

#include "cell_report.h"
#include "io/files/textfile.h"
#include "io/mesh/msh.h"
#include "stages/views.h"
#include "tool.h"

#include "base/box.h"

#include <math.h>

static void list_groups(const struct msh *msh)
{
    puts("name\tdim\ttag\telements");
    for (int32_t i = 0; i < msh->group_count; i++) {
        const struct msh_group *group = &msh->groups[i];
        printf("%s\t%d\t%d\t%jd\n", group->name, group->dim, group->tag, group->element_count);
    }
}

static void report(const struct tool *tool, const struct cells *cells, bool verbose)
{
    struct box box = box_of(cells->dim, cells->node_count, cells->x);
    double diagonal = box_diagonal(&box);
    struct cell_report cell_report;
    char text[128];
    if (diagonal > CELL_REPORT_LARGEST || diagonal < CELL_REPORT_SMALLEST) {
        tool_note(tool, "the body is %.3g m across: is the unit of -u right?", diagonal);
    }
    tool_note_thin(tool, cells);
    if (!verbose) {
        return;
    }
    TOOL_TRY(tool, cell_report_make(cells, INFINITY, &cell_report, &error));
    tool_note(tool, "%jd nodes, %jd cells, box %s, %s %.4g %s, %d connected bod%s", cells->node_count,
              cells->count, box_text(&box, text), cells->dim == 2 ? "area" : "volume", cell_report.volume,
              cells->dim == 2 ? "m2" : "m3", cell_report.bodies, cell_report.bodies == 1 ? "y" : "ies");
    tool_note(tool, "quality of the cells: least %.2g, median %.2g", cell_report.least_median[0],
              cell_report.least_median[1]);
    for (int i = 0; i < cell_report.listed && i < 3; i++) {
        tool_note(tool, "cell %jd: %s", cell_report.poorest[i].item,
                  cell_report_describe(cells, &cell_report.poorest[i], text));
    }
}

/* Cells of one body that part, at nodes which hang on their facets or are there twice, are an error;
 * different bodies may touch, and faces of slits that have names, not numbers of entities. */
static void check_joined(const struct tool *tool, const struct cells *cells, const struct section *facets)
{
    bool parts;
    FREED_BY(names_free) struct names said = {0};
    TOOL_TRY(tool, cell_report_hanging(cells, facets != NULL ? facets->rows : 0,
                                       facets != NULL ? facets->data : NULL, &parts, &said, &error));
    if (parts) {
        tool_fail(tool, STATUS_INPUT, "%s", said.name[0]);
    }
    for (int64_t i = 0; i < said.count; i++) {
        tool_note(tool, "%s", said.name[i]);
    }
}

static void check_options(const struct tool *tool)
{
    static const char *const of_stream[] = {"unit", "regions", "verbose", "text", "output", NULL};
    if (tool_given(tool, "list") && tool_first_given(tool, of_stream) != NULL) {
        tool_fail(tool, STATUS_INPUT, "-l goes with no other option");
    }
    if (!tool_given(tool, "list") && !tool_given(tool, "unit")) {
        tool_fail(tool, STATUS_INPUT,
                  "the unit of the mesh is missing: give -u m, cm, mm or um, or a number");
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(msh_free) struct msh msh = {0};
    const char *name;
    struct cells cells;
    FREED_BY(stream_free) struct stream stream = {0};
    tool_begin(&tool, usage, 0, 1, argc, argv);
    check_options(&tool);
    double unit = tool_length_unit(&tool, "unit", 1.0);
    FREED_BY(descriptor_close) int descriptor = tool_open(&tool, tool.operands[0], &name);
    TOOL_TRY(&tool, msh_read(&msh, descriptor, name, tool_value(&tool, "regions-of"), &error));
    if (tool_given(&tool, "list")) {
        list_groups(&msh);
        return tool_end(&tool);
    }
    TOOL_TRY(&tool, mesh_build(&msh, unit, tool_value(&tool, "regions"), &stream, &error));
    TOOL_TRY(&tool, stream_cells(&stream, true, &cells, &error));
    const struct section *facets = stream_find(&stream, "facets");
    check_joined(&tool, &cells, msh.by_entity[cells.dim - 1] ? NULL : facets);
    for (int64_t i = 0; i < msh.notes.count; i++) {
        tool_note(&tool, "%s", msh.notes.name[i]);
    }
    if (facets == NULL) {
        tool_note(&tool, "no part of the boundary has a name: the program tag makes names");
    }
    report(&tool, &cells, tool_given(&tool, "verbose"));
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
