#include "tool.h"

bool tool_given(const struct tool *tool, const char *option)
{
    return options_find(&tool->options, option)->given;
}

const char *tool_value(const struct tool *tool, const char *option)
{
    return options_find(&tool->options, option)->value;
}

/* Parse the value of the option if it is given. */
#define PARSE_GIVEN(parse, ...)                                                                              \
    do {                                                                                                     \
        char what[32];                                                                                       \
        const struct option *found = options_find(&tool->options, option);                                   \
        if (found->given) {                                                                                  \
            TOOL_TRY(tool, parse(found->value, option_text(found, what), __VA_ARGS__, &error));              \
        }                                                                                                    \
    } while (0)

double tool_number(const struct tool *tool, const char *option, double least, double most, double otherwise)
{
    double value = otherwise;
    PARSE_GIVEN(parse_double, least, most, &value);
    return value;
}

int64_t tool_integer(const struct tool *tool, const char *option, int64_t least, int64_t most,
                     int64_t otherwise)
{
    int64_t value = otherwise;
    PARSE_GIVEN(parse_integer, least, most, &value);
    return value;
}

double tool_length(const struct tool *tool, const char *option, double otherwise)
{
    double value = otherwise;
    PARSE_GIVEN(parse_length, LEAST_LENGTH, &value);
    return value;
}

double tool_length_unit(const struct tool *tool, const char *option, double otherwise)
{
    double value = otherwise;
    PARSE_GIVEN(parse_length_unit, &value);
    return value;
}

int tool_choice(const struct tool *tool, const char *option, const char *const choices[], int count,
                int otherwise)
{
    int choice = otherwise;
    PARSE_GIVEN(parse_choice, choices, count, &choice);
    return choice;
}

int tool_whole_numbers(const struct tool *tool, const char *option, double least, double most,
                       int64_t numbers[3])
{
    double values[3];
    int count = 1;
    char what[32];
    const struct option *found = options_find(&tool->options, option);
    TOOL_TRY(tool, parse_double_list(found->value, option_text(found, what), least, most, 3, values, &count,
                                     &error));
    for (int a = 0; a < 3; a++) {
        double value = values[a < count ? a : 0];
        numbers[a] = (int64_t)value;
        if ((double)numbers[a] != value) {
            tool_fail(tool, STATUS_INPUT, "%s: %g is not a whole number", what, value);
        }
    }
    return count;
}

const char *tool_first_given(const struct tool *tool, const char *const options[])
{
    for (int i = 0; options[i] != NULL; i++) {
        if (tool_given(tool, options[i])) {
            return options[i];
        }
    }
    return NULL;
}

int tool_values(const struct tool *tool, const char *option, const char *values[OPTIONS_MOST_USES])
{
    const struct option *found = options_find(&tool->options, option);
    int count = 0;
    for (int i = 0; i < tool->options.use_count; i++) {
        if (tool->options.use[i].option == found) {
            values[count++] = tool->options.use[i].value;
        }
    }
    return count;
}

/* Exit with the message if the first option was given, and the other one was or was not. */
static void refuse_pair(const struct tool *tool, const char *option, const char *other, bool both,
                        const char *between)
{
    char one[32], two[32];
    const struct option *first = options_find(&tool->options, option),
                        *second = options_find(&tool->options, other);
    if (first->given && second->given == both) {
        tool_fail(tool, STATUS_INPUT, "%s%s %s %s", both ? "give one of " : "", option_text(first, one),
                  between, option_text(second, two));
    }
}

void tool_excludes(const struct tool *tool, const char *option, const char *other)
{
    refuse_pair(tool, option, other, true, "and");
}

void tool_requires(const struct tool *tool, const char *option, const char *other)
{
    refuse_pair(tool, option, other, false, "goes with");
}
