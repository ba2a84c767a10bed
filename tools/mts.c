static const char usage[] =
    "mts - list, print, convert, check and thin out streams\n"
    "\n"
    "usage: mts list [-v] [FILE]\n"
    "       mts print SECTION [FILE]\n"
    "       mts text [-o FILE] [FILE]\n"
    "       mts binary [-o FILE] [FILE]\n"
    "       mts check [FILE]\n"
    "       mts recover [-t] [-o FILE] [FILE]\n"
    "       mts keep [-t] [-o FILE] PATTERN[,PATTERN...] [FILE]\n"
    "       mts drop [-t] [-o FILE] PATTERN[,PATTERN...] [FILE]\n"
    "\n"
    "Works on the streams described in mts(5), whatever their sections.\n"
    "\n"
    "Commands:\n"
    "  list          a line per section: name, type, rows, columns, attributes; between tabs\n"
    "  print         the rows of one section as a bare table, for awk or numpy\n"
    "  text, binary  the same stream in that form; the numbers stay the same to the last bit\n"
    "  check         whether sections of known names are what they should be: shapes that agree, indices\n"
    "                in range, cells of positive volume, numbers finite, weights positive, neighbour lists\n"
    "                ascending, shape functions that sum to 1 within 1e-9, no node that hangs on a facet of\n"
    "                its own body; a line on standard output for each violation, and status 1 if there is\n"
    "                one. Told without a verdict: nodes that hang on a facet of another body, cells of\n"
    "                quality (radius of the inscribed to that of the circumscribed sphere, 1 for a regular\n"
    "                one) below .01, the poorest first, and how many connected bodies, if several\n"
    "  recover       the whole sections of a stream that was stopped, cut short or damaged, as a stream;\n"
    "                what is wrong with it on standard error\n"
    "  keep, drop    the stream with only, or without, the sections that match a PATTERN, in which * and ?\n"
    "                stand for any letters, as in a shell; a pattern that nothing matches is an error\n"
    "\n"
    "Options:\n"
    "  -v, --verbose      list: first the command lines that made the stream\n"
    "  -t, --text         keep, drop, recover: write text instead of binary\n"
    "  -o, --output FILE  write to FILE, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  mts print nodes.x u.dat | awk '{ print $1 * 1000, $2 * 1000 }'\n"
    "  nodes -u mm body.msh | shapefn | mts check\n"
    "  mts keep 'nodes.x,u' < all.mts > u.mts\n";

#include "tool.h"

#include "approx/cells/quality.h"
#include "cell_report.h"
#include "io/files/textfile.h"
#include "stages/stages.h"

#include <fnmatch.h>
#include <inttypes.h>
#include <string.h>

/* A command, with the number of its operands and its options. */
struct command {
    const char *name;
    int least, most;
    const char *allows; /* letters of options */
    int (*run)(struct tool *tool);
};

static int list(struct tool *tool)
{
    FREED_BY(stream_free) struct stream stream = {0};
    tool_read(tool, tool->operands[1], &stream);
    for (int64_t i = 0; tool_given(tool, "verbose") && i < stream.provenance.count; i++) {
        printf("# @ %s\n", stream.provenance.name[i]);
    }
    for (int64_t i = 0; i < stream.section_count; i++) {
        const struct section *section = &stream.sections[i];
        printf("%s\t%s\t%" PRId64 "\t%" PRId64 "\t%s\n", section->name, element_type_name(section->type),
               section->rows, section->cols, section->attributes);
    }
    return tool_end(tool);
}

static int print(struct tool *tool)
{
    FREED_BY(stream_free) struct stream stream = {0};
    const char *name = tool->operands[1];
    tool_read(tool, tool->operands[2], &stream);
    const struct section *section = stream_find(&stream, name);
    if (section == NULL) {
        tool_fail(tool, STATUS_INPUT, "no section %s: see mts list", name);
    }
    stream_write_rows(section, stdout);
    return tool_end(tool);
}

static int convert(struct tool *tool)
{
    FREED_BY(stream_free) struct stream stream = {0};
    tool->text = strcmp(tool->operands[0], "text") == 0;
    tool_read(tool, tool->operands[1], &stream);
    tool_copy(tool, &stream);
    return tool_end(tool);
}

static int print_cells(const struct tool *tool, const struct stream *stream)
{
    struct cells cells;
    struct cell_report report;
    struct error error;
    char text[128];
    if (stream_find(stream, "nodes.x") == NULL || stream_find(stream, "cells") == NULL ||
        stream_cells(stream, true, &cells, &error) != STATUS_OK) {
        return 0; /* the error has been reported */
    }
    enum status status = cell_report_make(&cells, POOR_QUALITY, &report, &error);
    if (status == STATUS_INPUT) { /* a face of three cells */
        puts(error.text);
        return 1;
    }
    tool_check(tool, status, &error);
    for (int i = 0; i < report.listed; i++) {
        printf("cells: row %" PRId64 ": poor: %s\n", report.poorest[i].item,
               cell_report_describe(&cells, &report.poorest[i], text));
    }
    if (report.poor > report.listed) {
        printf("cells: %" PRId64 " more of quality below %g\n", report.poor - report.listed, POOR_QUALITY);
    }
    FREED_BY(groups_free) struct groups facets = {0};
    FREED_BY(names_free) struct names hanging = {0};
    bool parts;
    if (stream_groups(stream, GROUP_FACETS, false, &facets, &error) != STATUS_OK) {
        facets.count = 0; /* reported, too */
    }
    tool_check(tool, cell_report_hanging(&cells, facets.count, facets.node, &parts, &hanging, &error),
               &error);
    for (int64_t i = 0; i < hanging.count; i++) {
        printf("cells: %s\n", hanging.name[i]);
    }
    if (report.bodies > 1) {
        printf("cells: %d connected bodies\n", report.bodies);
    }
    return parts;
}

static int check(struct tool *tool)
{
    FREED_BY(stream_free) struct stream stream = {0};
    tool_read(tool, tool->operands[1], &stream);
    FREED_BY(names_free) struct names violations = {0};
    TOOL_TRY(tool, stream_check(&stream, &violations, &error));
    for (int64_t i = 0; i < violations.count; i++) {
        puts(violations.name[i]);
    }
    int64_t count = violations.count + print_cells(tool, &stream);
    int status = tool_end(tool);
    return count > 0 ? (int)STATUS_VERDICT : status;
}

static int recover(struct tool *tool)
{
    FREED_BY(stream_free) struct stream stream = {0};
    struct error why = {""}, error;
    const char *name;
    FREED_BY(descriptor_close) int descriptor = tool_open(tool, tool->operands[1], &name);
    tool_check(tool, stream_recover(&stream, descriptor, name, &why, &error), &error);
    if (why.text[0] != '\0') {
        tool_note(tool, "%s: %s: took the %jd sections before", name, why.text, stream.section_count);
    }
    tool_write(tool, &stream);
    return tool_end(tool);
}

/* Whether the name matches one of the patterns; marks in used[] those that it matches. */
static bool matches(const char *name, const struct names *patterns, bool used[])
{
    bool any = false;
    for (int64_t i = 0; i < patterns->count; i++) {
        if (fnmatch(patterns->name[i], name, 0) == 0) {
            used[i] = any = true;
        }
    }
    return any;
}

static int select_sections(struct tool *tool)
{
    bool keep = strcmp(tool->operands[0], "keep") == 0;
    FREED_BY(stream_free) struct stream stream = {0};
    FREED_BY(names_free) struct names patterns = {0};
    TOOL_TRY(tool, names_split(&patterns, tool->operands[1], &error));
    if (patterns.count == 0) {
        tool_fail(tool, STATUS_INPUT, "%s: the list of patterns is empty", tool->operands[0]);
    }
    TOOL_SCRATCH(tool, bool, used, patterns.count);
    tool_read(tool, tool->operands[2], &stream);
    for (int64_t i = stream.section_count - 1; i >= 0; i--) {
        if (matches(stream.sections[i].name, &patterns, used) != keep) {
            stream_remove(&stream, stream.sections[i].name);
        }
    }
    for (int64_t i = 0; i < patterns.count; i++) {
        if (!used[i]) {
            tool_fail(tool, STATUS_INPUT, "no section matches '%s': see mts list", patterns.name[i]);
        }
    }
    tool_write(tool, &stream);
    return tool_end(tool);
}

static const struct command commands[] = {
    {"list", 0, 1, "v", list},
    {"print", 1, 2, "", print},
    {"text", 0, 1, "o", convert},
    {"binary", 0, 1, "o", convert},
    {"check", 0, 1, "", check},
    {"recover", 0, 1, "to", recover},
    {"keep", 1, 2, "to", select_sections},
    {"drop", 1, 2, "to", select_sections},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

/* The command named by the first operand, with its operands and options checked. */
static const struct command *find_command(const struct tool *tool)
{
    const char *names[COMMANDS];
    int index;
    for (int i = 0; i < COMMANDS; i++) {
        names[i] = commands[i].name;
    }
    TOOL_TRY(tool, parse_choice(tool->operands[0], "command", names, COMMANDS, &index, &error));
    const struct command *command = &commands[index];
    int operands = tool->operand_count - 1;
    if (operands < command->least) {
        tool_fail(tool, STATUS_INPUT, "%s: lacks %s (see -h)", command->name,
                  command->run == print ? "the name of a section" : "a pattern");
    }
    if (operands > command->most) {
        tool_fail(tool, STATUS_INPUT, "%s: unexpected operand '%s' (see -h)", command->name,
                  tool->operands[command->most + 1]);
    }
    for (int i = 0; i < tool->options.count; i++) {
        const struct option *option = &tool->options.option[i];
        if (option->given && strchr(command->allows, option->letter) == NULL) {
            tool_fail(tool, STATUS_INPUT, "%s: takes no option -%c (see -h)", command->name, option->letter);
        }
    }
    return command;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    tool_begin(&tool, usage, 1, 3, argc, argv);
    return find_command(&tool)->run(&tool);
}
