static const char usage[] =
    "support - support domains and neighbour lists\n"
    "\n"
    "usage: support [-k FACTOR | -R RADIUS] [-m LEAST] [-n MOST]\n"
    "               [--no-widen] [--bound BOUND] [--reach RULE] [-i REGION[,REGION...]] [-b BASIS]\n"
    "               [-w WEIGHT] [--mu MU] [--mu-unit UNIT] [-v] [-t] [-o FILE] [FILE]\n"
    "\n"
    "Reads a stream with nodes.x (m) and points (see ipoints) and adds the support radius of every\n"
    "node and the lists of neighbours - the nodes whose supports contain the point - of the\n"
    "integration points, of the points on faces, and of the nodes. Where cells are flat, supports are as\n"
    "long as these are: ellipsoids, not balls (support.stretch), but with -R.\n"
    "\n"
    "Supports do not act across gaps: a neighbour is a node in sight through the cells, or not quite so:\n"
    "seen from a node of the cells at the point, with a detour of at most 5 %. Bodies that no\n"
    "face of a cell joins do not see each other, even where they touch; a node that cells share sees,\n"
    "and is seen by, all of them. Clouds without cells have neighbours by distance alone.\n"
    "\n"
    "Nor do they act across the boundaries between regions, or with -i across those of some: where the\n"
    "stiffness jumps the gradient of the displacement does, which shape functions that see both sides\n"
    "smooth away, and with it stress and force. The nodes of an interface belong to both sides, so that\n"
    "the displacement is continuous, with a support for each by its cells (support.sides). What lies on\n"
    "it has the shape functions of the region that comes first; where the stiffness jumps by more than\n"
    "2, mtled makes them those of the stiffer one.\n"
    "\n"
    "Where a list holds too few nodes, or badly placed ones, for the basis, all radii are widened for\n"
    "that point until the moment matrix is well conditioned and the gradients of the shape functions\n"
    "are bounded. If no radius up to eightfold bounds the gradients, the one of the least is taken, with\n"
    "a note; if none serves the moment matrix, the tool stops (status 1) and names the point. Without\n"
    "earlier sections the defaults of ipoints are run first.\n"
    "\n"
    "Options:\n"
    "  -k, --factor FACTOR    radius = FACTOR times the local node spacing (default 1.8, in 3D\n"
    "                         2)\n"
    "  -R, --radius RADIUS    constant radius: a length with its unit, e.g. 8mm (without one: m)\n"
    "  -m, --least LEAST      widen until at least so many neighbours\n"
    "  -n, --most MOST        keep only the MOST nearest neighbours (ties: the lower index)\n"
    "      --no-widen         leave unfit supports as they are, for shapefn to report\n"
    "      --bound BOUND      largest |grad phi| times spacing admitted (default 6)\n"
    "      --reach RULE       cells (default where there are cells), or distance: also across gaps\n"
    "  -i, --interface REGION[,REGION...]\n"
    "                         supports stop at the boundaries of these regions (default: of all), or\n"
    "                         with none at no interface\n"
    "  -b, --basis BASIS      mls1, mls2 or mmls2 (default): what the lists are for; shapefn follows\n"
    "                         it\n"
    "  -w, --weight WEIGHT    quartic (default) or regularised; shapefn follows it\n"
    "      --mu MU[,MU...]    regularisation of mmls2, see shapefn\n"
    "      --mu-unit UNIT     MU is absolute, in coordinates of that unit\n"
    "  -v, --verbose          report on standard error how many points were widened, and for each\n"
    "                         list the fewest, most and mean neighbours of a point\n"
    "  -t, --text             write text instead of binary\n"
    "  -o, --output FILE      write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | ipoints | support -k 2 > lists.mts\n"
    "  nodes -u mm body.msh | ipoints -g 4 | support -R 8mm --mu 1e-7 --mu-unit mm | shapefn > a.mts\n";

#include "stage_options.h"
#include "stages/stages.h"

#include <math.h>
#include <string.h>

static bool none_named(const struct tool *tool)
{
    return tool_given(tool, "interface") && strcmp(tool_value(tool, "interface"), "none") == 0;
}

static struct support_options parse(const struct tool *tool, int dim)
{
    struct support_options support = support_defaults(dim);
    radius_parse(tool, &support);
    support.least = tool_integer(tool, "least", 1, 100000, support.least);
    support.most = tool_integer(tool, "most", 1, 100000, support.most);
    if (support.most > 0 && support.most < support.least) {
        tool_fail(tool, STATUS_INPUT, "-n is less than -m");
    }
    support.gradient_bound = tool_number(tool, "bound", 1.0, 1e6, support.gradient_bound);
    support.visibility = (enum visibility_rule)tool_choice(tool, "reach", visibility_names,
                                                           VISIBILITY_RULE_COUNT, (int)support.visibility);
    if (tool_given(tool, "interface") && !none_named(tool) && support.visibility == VISIBILITY_DISTANCE) {
        tool_fail(tool, STATUS_INPUT, "--reach distance acts across the interfaces of -i");
    }
    support.widen = !tool_given(tool, "no-widen");
    mls_parse(tool, &support.mls);
    return support;
}

/* Note all widening in one line, then each list. */
static void note_report(const struct tool *tool, const struct support_report *report)
{
    int64_t widened = 0;
    double widest = 1.0;
    for (int l = 0; l < report->lists; l++) {
        widened += report->list[l].lists.widened;
        widest = fmax(widest, report->list[l].lists.widest);
    }
    if (report->visibility == VISIBILITY_DISTANCE) {
        tool_note(tool, "neighbours by distance alone: supports act across gaps");
    }
    tool_note(tool, "widened at %jd points, at most %.3g times", widened, widest);
    for (int l = 0; l < report->lists; l++) {
        const struct list_report *list = &report->list[l];
        const struct neighbours *found = &list->lists;
        tool_note(tool, "%jd %s: %jd to %jd neighbours, mean %.1f, widened at %jd", found->count, list->what,
                  found->fewest, found->most,
                  found->count > 0 ? (double)list->pairs / (double)found->count : 0.0, found->widened);
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(stream_free) struct stream stream = {0};
    int dim;
    struct support_report report;
    tool_begin(&tool, usage, 0, 1, argc, argv);
    (void)parse(&tool, 0); /* usage errors before waiting for the input */
    tool_read(&tool, tool.operands[0], &stream);
    TOOL_TRY(&tool, stream_nodes(&stream, &dim, NULL, NULL, &error));
    struct support_options support = parse(&tool, dim);
    stage_fill(&tool, &stream, "ipoints");
    SCRATCH int32_t *side = NULL;
    if (support.visibility == VISIBILITY_CELLS && !none_named(&tool)) {
        TOOL_TRY(&tool, stage_interfaces(&stream, tool_value(&tool, "interface"), &side, &error));
        support.side = side;
    }
    TOOL_TRY(&tool, stage_support(&stream, &support, &report, &error));
    if (tool_given(&tool, "reach") && report.visibility != support.visibility) {
        tool_fail(&tool, STATUS_INPUT, "--reach cells: the input has no cells: --reach distance");
    }
    support_note_steep(&tool, &support, &report);
    if (tool_given(&tool, "verbose")) {
        note_report(&tool, &report);
    }
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
