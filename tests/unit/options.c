/* Options as a usage text declares them, and command lines that use them. */
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

TEST(declarations)
{
    static const struct option expected[] = {
        {'k', "factor", true, false, false, NULL},
        {'\0', "no-widen", false, false, false, NULL},
        {'i', "interpolation", true, false, false, NULL},
        {'\0', "part", true, true, false, NULL},
        {'m', "mu", true, false, false, NULL},
        {'v', "verbose", false, false, false, NULL},
        {'h', "help", false, false, false, NULL},
        {'\0', "version", false, false, false, NULL},
    };
    enum { EXPECTED = sizeof expected / sizeof *expected };
    struct options options;
    char text[32];
    options_declare(&options, usage);
    assert_int_equal(options.count, EXPECTED);
    for (int i = 0; i < EXPECTED; i++) {
        const struct option *option = &options.option[i];
        assert_string_equal(option->name, expected[i].name);
        assert_int_equal(option->letter, expected[i].letter);
        assert_int_equal(option->takes_value, expected[i].takes_value);
        assert_int_equal(option->repeats, expected[i].repeats);
        assert_false(option->given);
        assert_null(option->value);
        assert_ptr_equal(options_find(&options, expected[i].name), option);
    }
    assert_true(options_has(&options, "mu"));
    assert_false(options_has(&options, "m"));
    assert_false(options_has(&options, "after"));
    assert_string_equal(option_text(options_find(&options, "factor"), text), "-k");
    assert_string_equal(option_text(options_find(&options, "no-widen"), text), "--no-widen");
}

/* A tool's own -h leaves --help without a letter; a text without a block declares these two alone. */
TEST(own_letter)
{
    struct options options;
    options_declare(&options, "voxels\n\nOptions:\n  -h, --spacing LENGTH  required\n");
    assert_int_equal(options_find(&options, "spacing")->letter, 'h');
    assert_int_equal(options_find(&options, "help")->letter, '\0');
    options_declare(&options, "voxels\n");
    assert_int_equal(options.count, 2);
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
