/* Command lines that use the options of a usage text. */
#include "unit.h"

#include "base/options.h"

static const char usage[] = "program - does something\n"
                            "\n"
                            "usage: program [-k FACTOR] [--part NAME=PLACE]... [--no-widen] [-v] [FILE]\n"
                            "\n"
                            "  -x, --example VALUE   is not in the block of options\n"
                            "\n"
                            "Options:\n"
                            "  -k, --factor FACTOR   a number\n"
                            "      --no-widen        has no letter, and goes with\n"
                            "                        -k alone, which this line does not declare\n"
                            "  -i, --interpolation METHOD\n"
                            "                        is explained on the next line\n"
                            "      --part NAME=PLACE ...  may be given more than once\n"
                            "  -m, --mu MU[,MU...]   may not\n"
                            "  -v, --verbose\n"
                            "\n"
                            "      --after           is not in the block either\n";

/* The command line of blank-separated words, parsed; *operands receives the operands, joined by blanks. */
static enum status parse(const char *line, struct options *options, char operands[256], struct error *error)
{
    static char copy[256];
    char *argv[32] = {"program"}, *rest = strcpy(copy, line);
    int argc = 1, operand_count;
    options_declare(options, usage);
    for (char *word = strsep(&rest, " "); word != NULL; word = strsep(&rest, " ")) {
        argv[argc++] = word;
    }
    enum status status = options_parse(options, argc, argv, &operand_count, error);
    operands[0] = '\0';
    for (int i = 1; status == STATUS_OK && i <= operand_count; i++) {
        strcat(strcat(operands, i > 1 ? " " : ""), argv[i]);
    }
    return status;
}

TEST(uses)
{
    struct options options;
    char operands[256];
    GOOD(parse("a -vk3 --part=x=1 - --part y -- -k", &options, operands, &error));
    assert_string_equal(operands, "a - -k");
    assert_true(options_find(&options, "verbose")->given);
    assert_false(options_find(&options, "no-widen")->given);
    assert_string_equal(options_find(&options, "factor")->value, "3");
    assert_string_equal(options_find(&options, "part")->value, "y");
    assert_int_equal(options.use_count, 3);
    assert_string_equal(options.use[0].option->name, "factor");
    assert_string_equal(options.use[1].value, "x=1");
    assert_string_equal(options.use[2].value, "y");
}

TEST(refused)
{
    static const char *const cases[][2] = {
        {"-k 1 --factor 2", "option --factor given twice"},   {"-vv", "option -v given twice"},
        {"--verbose=1", "option --verbose=1 takes no value"}, {"-k", "option -k lacks its value"},
        {"--part", "option --part lacks its value"},          {"-vz", "unknown option -z in -vz (see -h)"},
        {"--example 1", "unknown option --example (see -h)"}, {"--fact 1", "unknown option --fact (see -h)"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct options options;
        char operands[256];
        FAILS_WITH(parse(cases[i][0], &options, operands, &error), STATUS_INPUT, cases[i][1]);
    }
}

RUN_TESTS(NULL, NULL)
