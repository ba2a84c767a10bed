static const char usage[] =
    "fibres - directions of fibres in a wall, which turn from one surface to another\n"
    "\n"
    "usage: fibres --from FACETS,ANGLE --to FACETS,ANGLE --axis X,Y,Z [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x, cells and named facets, in 3D, and writes it with a section\n"
    "points.fibre: a unit direction at each integration point (ipoints is run with its defaults where\n"
    "it was not). A [material] of mtled whose law has fibres, or that is active, takes them if it names\n"
    "neither fibre nor fibres.\n"
    "\n"
    "The depth e in the wall is d1 / (d1 + d2), with the distances d1 and d2 from the two surfaces; n is\n"
    "the direction across, from the first to the second one: the mean of their normals at the nearest\n"
    "points, weighted by 1 - e and e. Fibres lie in the plane across n. With c = axis x n, which goes round\n"
    "the axis, and l = n x c, which goes along it, a fibre is cos(a) c + sin(a) l, and a goes from the\n"
    "first angle to the second one in proportion to e. Where n is along the axis, as at an apex, c has no\n"
    "direction and is taken as the coordinate axis that is the farthest from it.\n"
    "\n"
    "FACETS is a group of facets, or an expression that chooses some, see tag.\n"
    "\n"
    "Options:\n"
    "      --from FACETS,ANGLE  the first surface, as of the chamber of a ventricle, and the angle of\n"
    "                        fibres there, degrees from -180 to 180\n"
    "      --to FACETS,ANGLE  the second one\n"
    "      --axis X,Y,Z      a direction along the wall, as that from apex to base\n"
    "  -t, --text            write text instead of binary\n"
    "  -o, --output FILE     write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  fibres --from inside,90 --to outside,-90 --axis 0,0,1 body.mts | mtled heart.scene > u.dat\n"
    "  fibres --from inside,60 --to 'outside or lid,-60' --axis 0,0,1 body.mts | tovtk -o f.vtu\n";

#include "groups/group_body.h"
#include "stage_options.h"

#include "base/vector.h"
#include "solid/rigid/wall.h"
#include "stages/views.h"

#include <string.h>

/* One side of the wall. */
struct side {
    struct rigid_surface surface;
    double angle; /* degrees */
};

/* Read FACETS,ANGLE. */
static enum status read_side(const struct group_body *body, const char *text, struct side *side,
                             struct error *error)
{
    const char *comma = strrchr(text, ',');
    if (comma == NULL) {
        return fail(error, STATUS_INPUT, "lacks its angle: takes FACETS,ANGLE");
    }
    SCRATCH char *expression = strndup(text, (size_t)(comma - text));
    if (expression == NULL) {
        return fail_memory(error, "an expression");
    }
    RETURN_IF_ERROR(parse_double(comma + 1, "the angle", -180, 180, &side->angle, error));
    NEW_SCRATCH(bool, chosen, body->items[GROUP_FACETS].count, error);
    RETURN_IF_ERROR(group_select(body, GROUP_FACETS, expression, 1, chosen, error));
    NEW_SCRATCH(int32_t, facet, body->boundary.count * 3, error);
    int64_t count = 0;
    for (int64_t f = 0; f < body->boundary.count; f++) {
        memcpy(facet + 3 * count, body->boundary.node + 3 * f, 3 * sizeof *facet);
        count += chosen[f];
    }
    return count > 0 ? rigid_of_facets(3, body->cells.x, count, facet, &side->surface, error)
                     : fail(error, STATUS_INPUT, "chooses no facets of the boundary");
}

static void get_side(const struct tool *tool, const struct group_body *body, const char *option,
                     struct side *side)
{
    struct error error;
    if (!tool_given(tool, option)) {
        tool_fail(tool, STATUS_INPUT, "--%s is missing: see -h", option);
    }
    const char *text = tool_value(tool, option);
    tool_check(tool, fail_in(&error, read_side(body, text, side, &error), "--%s %s", option, text), &error);
}

static void read_axis(const struct tool *tool, double axis[3])
{
    const char *text = tool_value(tool, "axis");
    if (text == NULL) {
        tool_fail(tool, STATUS_INPUT, "--axis is missing: see -h");
    }
    int count;
    TOOL_TRY(tool, parse_double_list(text, "--axis", -1e6, 1e6, 3, axis, &count, &error));
    if (count < 3 || !(vector_dot(3, axis, axis) > 0)) {
        tool_fail(tool, STATUS_INPUT, "--axis %s: takes a direction of three numbers, as 0,0,1", text);
    }
}

/* Note if fibres turn too far for one direction in a cell: by 30 degrees and more across most faces. */
static void note_turns(const struct tool *tool, const struct stream *stream, const double *fibre)
{
    struct faces faces = {0};
    int64_t far = 0;
    if (stream_find(stream, "faces") == NULL || !points_are_smoothed(stream_find(stream, "points.x"))) {
        return;
    }
    TOOL_TRY(tool, stream_faces(stream, &faces, &error));
    for (int64_t f = faces.boundary_count; f < faces.count; f++) {
        double cosine = vector_dot(3, fibre + 3 * faces.cell[2 * f], fibre + 3 * faces.cell[2 * f + 1]);
        far += cosine * cosine < 0.75; /* that of 30 degrees */
    }
    int64_t inside = faces.count - faces.boundary_count;
    if (2 * far > inside) {
        tool_note(tool,
                  "fibres turn by more than 30 degrees across %.0f %% of the inner faces, and a cell has one "
                  "direction: displacements may be 10 %% off, give more cells across the wall",
                  100.0 * (double)far / (double)inside);
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    FREED_BY(group_body_free) struct group_body body = {0};
    struct side from = {.angle = 0}, to = {.angle = 0};
    const struct section *points;
    double axis[3], *fibre;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    read_axis(&tool, axis);
    tool_read(&tool, tool.operands[0], &stream);
    stage_fill(&tool, &stream, "ipoints");
    TOOL_TRY(&tool, group_body_read(&stream, &body, &error));
    if (body.cells.count == 0 || body.cells.dim != 3) {
        tool_fail(&tool, STATUS_INPUT, "the stream has no cells in 3D: a wall has two surfaces");
    }
    get_side(&tool, &body, "from", &from);
    get_side(&tool, &body, "to", &to);
    TOOL_TRY(&tool, stream_view(&stream, "points.x", &points, &error));
    TOOL_TRY(&tool, NEW_ARRAY(&fibre, 3 * points->rows, &error));
    struct wall wall = {
        .from = &from.surface, .to = &to.surface, .axis = axis, .angles = {from.angle, to.angle}};
    TOOL_TRY(&tool, wall_fibres(&wall, points->rows, points->data, fibre, &error));
    note_turns(&tool, &stream, fibre);
    rigid_free(&from.surface);
    rigid_free(&to.surface);
    tool_put(&tool, &stream, "points.fibre", TYPE_F8, points->rows, 3, "unit=1 cols=x,y,z", fibre);
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
