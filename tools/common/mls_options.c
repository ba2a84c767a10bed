#include "mls_options.h"

#include "stages/mls_settings.h"

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
