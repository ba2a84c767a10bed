#include "stage_options.h"

#include "stages/stages.h"

#include <string.h>

void mls_parse(const struct tool *tool, struct mls *mls)
{
    const struct mls_texts texts = {tool_value(tool, "basis"), tool_value(tool, "weight"),
                                    tool_value(tool, "mu"), tool_value(tool, "mu-unit")};
    TOOL_TRY(tool, mls_apply(&texts, mls, &error));
}

void radius_parse(const struct tool *tool, struct support_options *support)
{
    tool_excludes(tool, "factor", "radius");
    support->factor = tool_number(tool, "factor", 0.1, 100, support->factor);
    support->radius = tool_length(tool, "radius", support->radius);
}

void support_note_steep(const struct tool *tool, const struct support_options *options,
                        const struct support_report *report)
{
    for (int l = 0; l < report->lists; l++) {
        const struct list_report *list = &report->list[l];
        const struct steep_points *steep = &list->lists.steep;
        if (steep->count > 0) {
            tool_note(tool,
                      "%s: %jd of %jd have gradients beyond the bound with all radii; the least steep are "
                      "taken: worst at %s m, |grad phi| times spacing %.3g for %g",
                      list->what, steep->count, list->lists.count, list->steepest, steep->steepness,
                      options->gradient_bound);
        }
    }
}

/* Run a stage with its defaults, add its provenance, and append its name to ran[size]. */
static void fill_one(const struct tool *tool, struct stream *stream, const char *stage, char *ran,
                     size_t size)
{
    struct field_shapes recorded;
    TOOL_TRY(tool, stage_recorded(stream, "support", &recorded, &error));
    if (strcmp(stage, "ipoints") == 0) {
        const struct ipoints_options options = {.smoothed = true};
        int64_t unresolved;
        TOOL_TRY(tool, stage_ipoints(stream, &options, &unresolved, &error));
    } else if (strcmp(stage, "support") == 0) {
        struct support_options options = support_defaults(recorded.support.mls.dim);
        struct support_report report;
        SCRATCH int32_t *side = NULL;
        TOOL_TRY(tool, stage_interfaces(stream, NULL, &side, &error));
        options.side = side;
        TOOL_TRY(tool, stage_support(stream, &options, &report, &error));
        support_note_steep(tool, &options, &report);
    } else {
        TOOL_TRY(tool, stage_shapefn(stream, &recorded.support.mls, &error));
    }
    char *argv[] = {(char *)(uintptr_t)stage, NULL};
    TOOL_TRY(tool, stream_add_provenance(stream, 1, argv, &error));
    text_append(ran, size, "%s%s", ran[0] != '\0' ? ", " : "", stage);
}

void stage_fill(const struct tool *tool, struct stream *stream, const char *upto)
{
    static const char *const stages[] = {"ipoints", "support", "shapefn"};
    static const char *const marks[] = {"points.x", "support.radius", "node.phi"};
    char ran[64] = "";
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        if (stream_find(stream, marks[i]) == NULL) {
            fill_one(tool, stream, stages[i], ran, sizeof ran);
        }
        if (strcmp(stages[i], upto) == 0) {
            break;
        }
    }
    if (ran[0] != '\0') {
        tool_note(tool, "no sections of %s in the input: ran with defaults", ran);
    }
}
