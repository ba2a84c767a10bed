static const char usage[] =
    "nodes - gmsh mesh to node cloud, background cells, facets and node sets\n"
    "\n"
    "usage: nodes -u UNIT [-r REGION,...] [-b | -t] [-o FILE] [MESH]\n"
    "       nodes -l [MESH]\n"
    "\n"
    "Reads a mesh of gmsh (MSH 2 or 4, ASCII or binary; first-order triangles and quadrangles in a plane\n"
    "z = const, or tetrahedra, hexahedra, prisms and pyramids) from MESH or standard input, and writes\n"
    "nodes.x (m), the nodes of its cells in the order of the file; cells, split into triangles or\n"
    "tetrahedra and positively oriented, with the physical group of each as cells.region; facets, the\n"
    "physical groups on the boundary, oriented outward, and facets.set; and as node sets, sets.ptr and\n"
    "sets.idx, the physical groups of lower dimension and those between two cells. Groups keep their\n"
    "names; one without a name is group_TAG, cells in no group are the region 'unnamed'.\n"
    "\n"
    "What is no part of the body is left out, with a note: nodes of no cell, facets of no cell, empty\n"
    "groups. Cells without volume, folded or in two groups, nodes at the same place, and files that are\n"
    "truncated or inconsistent are errors. Sections of the file other than its groups, nodes and elements\n"
    "are not looked at, and nothing in the file is run.\n"
    "\n"
    "Options:\n"
    "  -u, --unit UNIT         unit of the mesh's coordinates: m, cm, mm or um (required)\n"
    "  -r, --regions NAME,...  keep these regions only, with their nodes and facets\n"
    "  -l, --list              instead: list the physical groups of the mesh, with dimension, tag and\n"
    "                          number of elements, and stop\n"
    "  -b, --binary            write binary (default)\n"
    "  -t, --text              write text\n"
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  gmsh -2 brain2d.geo -o body.msh && nodes -u mm body.msh | mts list\n"
    "  nodes -l body.msh\n"
    "  nodes -u mm -r parenchyma,tumour < body.msh > body.mts\n";

#include "io/msh.h"
#include "tool.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

enum { UNIT, REGIONS, LIST, BINARY, TEXT, OUTPUT, OPTION_COUNT };

/* libgmsh is C++ and trusts that it gets memory: where it does not, some of its parts report something else,
 * others crash. These end the program with the right status and one line. */
typedef void new_handler(void);
new_handler *set_new_handler(new_handler *handler) __asm__("_ZSt15set_new_handlerPFvvE");

static void leave(const char *message)
{
    if (write(STDERR_FILENO, message, strlen(message)) < 0) {
        _exit((int)STATUS_SYSTEM);
    }
    _exit((int)STATUS_SYSTEM);
}

static void on_no_memory(void)
{
    leave("nodes: out of memory\n");
}

static void on_crash(int number)
{
    (void)number;
    leave("nodes: libgmsh crashed: out of memory? if not, please report this mesh\n");
}

static void read_mesh(const struct tool *tool, struct msh *msh)
{
    struct error error;
    struct sigaction before;
    const char *name;
    int descriptor = tool_open(tool, tool->operands[0], &name);
    (void)set_new_handler(on_no_memory);
    if (sigaction(SIGSEGV, NULL, &before) == 0 && before.sa_handler == SIG_DFL) { /* no sanitizer's */
        signal(SIGSEGV, on_crash);
    }
    tool_check(tool, msh_read(msh, descriptor, name, &error), &error);
    sigaction(SIGSEGV, &before, NULL);
    if (descriptor != STDIN_FILENO) {
        close(descriptor);
    }
}

static void list_groups(const struct msh *msh)
{
    puts("name\tdim\ttag\telements");
    for (int32_t i = 0; i < msh->group_count; i++) {
        const struct msh_group *group = &msh->groups[i];
        printf("%s\t%d\t%d\t%lld\n", group->name, group->dim, group->tag, (long long)group->element_count);
    }
}

static double parse(const struct tool *tool, const struct option options[])
{
    struct error error;
    double unit = 1;
    if (options[BINARY].given && options[TEXT].given) {
        tool_fail(tool, STATUS_INPUT, "give one of -b and -t");
    }
    if (options[LIST].given) {
        for (int i = 0; i < OPTION_COUNT; i++) {
            if (i != LIST && options[i].given) {
                tool_fail(tool, STATUS_INPUT, "-l goes with no other option");
            }
        }
    } else if (!options[UNIT].given) {
        tool_fail(tool, STATUS_INPUT, "the unit of the mesh is missing: give -u m, cm, mm or um");
    } else {
        tool_check(tool, parse_length_unit(options[UNIT].value, "-u", &unit, &error), &error);
    }
    return unit;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct msh msh;
    struct mesh mesh;
    struct stream stream;
    struct error error;
    struct option options[OPTION_COUNT] = {
        [UNIT] = {.letter = 'u', .name = "unit", .takes_value = true},
        [REGIONS] = {.letter = 'r', .name = "regions", .takes_value = true},
        [LIST] = {.letter = 'l', .name = "list"},
        [BINARY] = {.letter = 'b', .name = "binary"},
        [TEXT] = {.letter = 't', .name = "text"},
        [OUTPUT] = {.letter = 'o', .name = "output", .takes_value = true},
    };
    tool_begin(&tool, usage, options, OPTION_COUNT, 0, 1, argc, argv);
    double unit = parse(&tool, options);
    read_mesh(&tool, &msh);
    if (options[LIST].given) {
        list_groups(&msh);
        msh_free(&msh);
        return tool_end(&tool);
    }
    tool_check(&tool, mesh_build(&mesh, &msh, unit, options[REGIONS].value, &error), &error);
    msh_free(&msh);
    for (int32_t i = 0; i < mesh.notes.count; i++) {
        tool_note(&tool, "%s", mesh.notes.name[i]);
    }
    stream_init(&stream);
    tool_check(&tool, mesh_put(&mesh, &stream, &error), &error);
    tool_write(&tool, &stream, options[TEXT].given);
    stream_free(&stream);
    mesh_free(&mesh);
    return tool_end(&tool);
}
