static const char usage[] =
    "tag - names for parts of the boundary, node sets and regions\n"
    "\n"
    "usage: tag [-u UNIT] [-f NAME=EXPRESSION]... [-n NAME=EXPRESSION]... [-r NAME=EXPRESSION]...\n"
    "              [-d NAME]... [--replace] [-v] [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x and cells (see nodes) and adds named groups, chosen by place:\n"
    "facets of the boundary, which the conditions of a scene name; sets of nodes; and regions, which have\n"
    "materials. The boundary is found from the cells: the mesh needs no names. Options are carried out in\n"
    "order: one may use the names that an earlier one has made.\n"
    "\n"
    "An EXPRESSION is a list of terms with 'or', 'and', 'without' between them, evaluated from left to\n"
    "right; after a term, 'grown:N' or 'shrunk:N' grows or shrinks what is chosen so far by N rings; nodes\n"
    "and cells shrink from the body's boundary, too. There are no brackets: make a group of the inner part\n"
    "first, and delete it by -d.\n"
    "\n"
    "Terms, in 3D (in 2D points and directions are of two numbers):\n"
    "  all                     the whole boundary, all nodes, all cells\n"
    "  boundary                the boundary; for -n the nodes on it\n"
    "  box:X0,Y0,Z0,X1,Y1,Z1   between these low and high corners\n"
    "  ball:X,Y,Z,RADIUS       in the ball\n"
    "  half:X,Y,Z,NX,NY,NZ     beyond the plane through a point, on the side that the direction points to\n"
    "  plane:X,Y,Z,NX,NY,NZ[,DISTANCE]  in that plane: all corners within a distance (default 1e-6\n"
    "                          of the body's diagonal)\n"
    "  low:AXIS,PART%          within that part of the body's box from its low end along x, y or z, or\n"
    "  high:AXIS,PART%         from its high end; the axis 'long' is that of the longest side\n"
    "  near:DISTANCE,FILE      within a distance of the points of a table (rows of coordinates)\n"
    "  along:DISTANCE,FILE     within a distance of a surface: STL, or a table of triangles (rows of nine\n"
    "                          numbers); in 2D curves (rows of points, blank lines between)\n"
    "  normal:NX,NY,NZ,DEGREES facets whose outward normal is within that angle of a direction\n"
    "  side:K,DEGREES          a side of the boundary, which ends at edges where it turns by more than the\n"
    "                          angle: the K-th largest (from 1), or, with\n"
    "  side:X,Y,Z,DEGREES      that nearest to a point; at 180 degrees sides are connected surfaces\n"
    "  body:K or body:X,Y,Z    a connected body (of cells with common faces), chosen in the same way\n"
    "  NAME                    the group of that name and of the same kind, or with its kind before it:\n"
    "  facets:NAME, nodes:NAME, region:NAME   so groups of one kind are made of those of another\n"
    "A facet or cell lies where its centre lies. Facets and nodes of a region or body are those of its\n"
    "cells; facets and cells of a set have all nodes in it.\n"
    "\n"
    "An empty selection and a name that exists are errors. Groups may overlap, but a new region takes\n"
    "its cells from the other regions; a region without cells is removed. When facets change, the\n"
    "sections of support and shapefn are removed.\n"
    "\n"
    "Options:\n"
    "  -f, --facets NAME=EXPRESSION ...  a group of facets of the boundary\n"
    "  -n, --nodes NAME=EXPRESSION ...   a set of nodes\n"
    "  -r, --region NAME=EXPRESSION ...  a region of cells\n"
    "  -d, --delete NAME ...     delete a group of facets or nodes, if need be facets:NAME, nodes:NAME\n"
    "      --replace             -f, -n and -r replace groups that exist\n"
    "  -u, --unit UNIT         unit of lengths in expressions and their files: m (default), cm, mm, um,\n"
    "                          or a number of metres\n"
    "  -v, --verbose           report each group on standard error: count, area, box, mean normal\n"
    "  -t, --text              write text instead of binary\n"
    "  -o, --output FILE       write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm liver.msh | tag -f held=low:long,12% -f pushed=high:long,12% -v > liver.mts\n"
    "  tag -u mm -f 'probe=ball:10,0,42,5 and normal:0,0,1,60' -f 'free=all without probe' < body.mts\n"
    "  tag -f 'cavity=side:2,180' -r 'tumour=ball:0.01,0,0.03,0.008' -n 'tip=plane:0,0,0.1,0,0,1'\n";

#include "groups/group_body.h"
#include "tool.h"

#include "base/box.h"
#include "base/memory.h"
#include "io/stream/sections.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* ---- the options ---- */

/* One use of an option: "--facets held=low:long,12%" */
struct request {
    struct group_body *body;
    const struct option_use *use;
    double unit;
    bool replace;
};

/* Facets, nodes, cells. */
static const char *const plurals[GROUP_KINDS] = {"facets", "nodes", "cells"};

static enum status make_group(const struct request *request, enum group_kind kind, struct error *error)
{
    struct group_body *body = request->body;
    const struct items *items = &body->items[kind];
    const char *expression = strchr(request->use->value, '=');
    int64_t count = 0;
    if (expression == NULL) {
        return fail(error, STATUS_INPUT, "lacks its '=': see -h");
    }
    SCRATCH char *name = strndup(request->use->value, (size_t)(expression - request->use->value));
    if (name == NULL) {
        return fail_memory(error, "a name");
    }
    RETURN_IF_ERROR(group_check_name(name, error));
    if (body->cells.count == 0 && kind != GROUP_NODES) {
        return fail(error, STATUS_INPUT, "the stream has no cells, only nodes can be grouped (-n)");
    }
    if (names_find(&body->groups[kind].names, name) >= 0 && !request->replace) {
        return fail(error, STATUS_INPUT, "there is one of that name already: --replace replaces it");
    }
    NEW_SCRATCH(bool, chosen, items->count, error);
    RETURN_IF_ERROR(group_select(body, kind, expression + 1, request->unit, chosen, error));
    for (int64_t i = 0; i < items->count; i++) {
        count += chosen[i];
    }
    if (count == 0) {
        struct box box = box_of(body->cells.dim, body->cells.node_count, body->cells.x);
        char place[128];
        return fail(error, STATUS_INPUT, "chooses none of %jd %s; the body's box is %s", items->count,
                    plurals[kind], box_text(&box, place));
    }
    return group_put(body, kind, name, chosen, error);
}

/* Delete the group "NAME" or "KIND:NAME". */
static enum status delete_group(const struct request *request, struct error *error)
{
    const char *name = request->use->value;
    int64_t place = -1;
    int kind = 0;
    for (int k = 0; k < GROUP_KINDS; k++) {
        size_t length = strlen(group_kind_names[k]);
        bool prefixed = strncmp(name, group_kind_names[k], length) == 0 && name[length] == ':';
        int64_t found = names_find(&request->body->groups[k].names, prefixed ? name + length + 1 : name);
        if (found >= 0 && place >= 0) {
            return fail(error, STATUS_INPUT, "both %s and %s have that name: write %s:%s or %s:%s",
                        group_kind_names[kind], group_kind_names[k], group_kind_names[kind], name,
                        group_kind_names[k], name);
        }
        kind = found >= 0 ? k : kind;
        place = found >= 0 ? found : place;
    }
    if (place < 0 || kind == GROUP_REGION) {
        return fail(error, STATUS_INPUT,
                    place < 0 ? "no group of that name: -v lists them"
                              : "its cells would belong to no region: give them another region by -r");
    }
    return group_remove(&request->body->groups[kind], place, error);
}

static enum status carry_out(const struct request *request, struct error *error)
{
    char letter = request->use->option->letter;
    return letter == 'd' ? delete_group(request, error)
                         : make_group(request,
                                      letter == 'f'   ? GROUP_FACETS
                                      : letter == 'n' ? GROUP_NODES
                                                      : GROUP_REGION,
                                      error);
}

/* ---- the result ---- */

static void drop_empty_regions(const struct tool *tool, struct group_list *regions)
{
    TOOL_SCRATCH(tool, bool, any, regions->names.count);
    for (int64_t i = 0; i < regions->count; i++) {
        any[regions->member[i].group] = true;
    }
    for (int64_t g = regions->names.count - 1; g >= 0 && regions->changed; g--) {
        if (!any[g]) {
            tool_note(tool, "region '%s' has no cells left: its name is dropped", regions->names.name[g]);
            TOOL_TRY(tool, group_remove(regions, g, &error));
        }
    }
}

/* "facets held: 34, area 0.00012 m2, box 0 0 0 to 0.1 0.1 0 m, mean normal 0 0 -1" */
static void report(const struct tool *tool, const struct group_body *body, enum group_kind kind,
                   int64_t group)
{
    static const char *const of_dim[2][2] = {{"length", "area"}, {"area", "volume"}};
    const struct items *items = &body->items[kind];
    int dim = items->dim;
    struct box box = box_of(dim, 0, NULL);
    double sum[3] = {0};
    double size = 0;
    char place[128];
    char text[512] = "";
    const struct group_list *list = &body->groups[kind];
    int64_t count = 0;
    for (int64_t i = 0; i < list->count; i++) {
        if (list->member[i].group != group) {
            continue;
        }
        int32_t item = list->member[i].item;
        count++;
        double normal[3];
        for (int k = 0; k < items->corners; k++) {
            box_add(&box, 1, items->x + (int64_t)items->item[item * items->corners + k] * dim);
        }
        if (kind == GROUP_REGION) {
            size += cell_volume(&body->cells, item);
        } else if (kind == GROUP_FACETS) {
            face_area_vector(dim, items->x, items->item + (int64_t)item * dim, normal);
            add_scaled(dim, 1.0, normal, sum);
            size += vector_length(dim, normal);
        }
    }
    text_append(text, sizeof text, "%jd", count);
    if (kind != GROUP_NODES) {
        bool region = kind == GROUP_REGION;
        int power = dim - !region;
        text_append(text, sizeof text, ", %s %.4g m%.0d", of_dim[region][dim - 2], size,
                    power == 1 ? 0 : power);
    }
    text_append(text, sizeof text, ", box %s%s", box_text(&box, place),
                kind == GROUP_FACETS ? ", mean normal" : "");
    for (int k = 0; k < dim && kind == GROUP_FACETS; k++) {
        double share = size > 0 ? sum[k] / size : 0;
        text_append(text, sizeof text, " %.3g", fabs(share) < 1e-9 ? 0 : share);
    }
    tool_note(tool, "%s %s: %s", group_kind_names[kind], list->names.name[group], text);
}

static void finish(const struct tool *tool, struct group_body *body, struct stream *stream, bool verbose)
{
    drop_empty_regions(tool, &body->groups[GROUP_REGION]);
    for (int kind = 0; kind < GROUP_KINDS && verbose; kind++) {
        for (int64_t g = 0; g < body->groups[kind].names.count; g++) {
            report(tool, body, (enum group_kind)kind, g);
        }
    }
    TOOL_TRY(tool, group_body_write(body, stream, &error));
    if (body->groups[GROUP_FACETS].changed) {
        int64_t before = stream->section_count;
        sections_remove(stream, MADE_WITH_SUPPORT, MADE_WITH_SHAPES);
        if (stream->section_count < before) {
            tool_note(tool, "facets have changed: the sections of support and shapefn are left out");
        }
    }
}

static const char *const changes[] = {"facets", "nodes", "region", "delete", NULL};

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    FREED_BY(group_body_free) struct group_body body = {0};
    tool_begin(&tool, usage, 0, 1, argc, argv);
    if (tool_first_given(&tool, changes) == NULL && !tool_given(&tool, "verbose")) {
        tool_fail(&tool, STATUS_INPUT, "nothing to do: give -f, -n, -r, -d or -v (see -h)");
    }
    double unit = tool_length_unit(&tool, "unit", 1);
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, group_body_read(&stream, &body, &error));
    for (int i = 0; i < tool.options.use_count; i++) {
        const struct option_use *use = &tool.options.use[i];
        struct request request = {&body, use, unit, tool_given(&tool, "replace")};
        if (use->option->repeats) {
            TOOL_TRY(&tool, fail_in(&error, carry_out(&request, &error), "--%s %.80s", use->option->name,
                                    use->value));
        }
    }
    finish(&tool, &body, &stream, tool_given(&tool, "verbose"));
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
