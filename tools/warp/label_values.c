#include "warp/label_values.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Exit unless voxels of the image have the label. */
static void check_label(const struct tool *tool, const struct image *image, const char *option, int64_t label)
{
    bool found = false;
    if (image->components > 1) {
        tool_fail(tool, STATUS_INPUT, "--%s: %s has %zu values at each voxel, not labels", option,
                  tool->operands[0], image->components);
    }
    for (size_t v = 0; v < image_voxels(image) && !found; v++) {
        found = image_whole(image, image->values[v]) == (double)label;
    }
    if (!found) {
        tool_fail(tool, STATUS_INPUT, "--%s: no voxel of %s has the label %jd", option, tool->operands[0],
                  label);
    }
}

void label_values_parse(const struct tool *tool, const char *option, const struct image *image,
                        struct label_values *values)
{
    double least, most;
    char what[16];
    snprintf(what, sizeof what, "--%s", option);
    image_range(image, &least, &most);
    SCRATCH char *copy = tool_given(tool, option) ? tool_text(tool, "%s", tool_value(tool, option)) : NULL;
    for (char *rest = copy, *item; (item = strsep(&rest, ",")) != NULL; values->count++) {
        char *equals = strchr(item, '=');
        int64_t label = -1;
        double value;
        if (equals != NULL) {
            *equals = '\0';
            TOOL_TRY(tool, parse_integer(item, what, 0, INT32_MAX, &label, &error));
            check_label(tool, image, option, label);
        }
        TOOL_TRY(tool,
                 parse_double(equals != NULL ? equals + 1 : item, what, -DBL_MAX, DBL_MAX, &value, &error));
        if (value < least || value > most) {
            tool_fail(tool, STATUS_INPUT, "%s %g: values of %s are from %g to %g", what, value,
                      tool->operands[0], least, most);
        }
        for (int i = 0; i < values->count; i++) {
            if (values->label[i] == (double)label) {
                tool_fail(tool, STATUS_INPUT, "%s %s: two values for %s", what, tool_value(tool, option),
                          equals != NULL ? item : "all other labels");
            }
        }
        if (values->count == MOST_LABELS) {
            tool_fail(tool, STATUS_INPUT, "%s: more than %d labels", what, MOST_LABELS);
        }
        values->label[values->count] = (double)label;
        values->value[values->count] = value;
    }
}

double label_value(const struct label_values *values, double label)
{
    double others = NAN;
    for (int i = 0; i < values->count; i++) {
        if (values->label[i] == label) {
            return values->value[i];
        }
        others = values->label[i] < 0 ? values->value[i] : others;
    }
    return others;
}
