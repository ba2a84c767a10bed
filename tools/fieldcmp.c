static const char usage[] =
    "fieldcmp - compare two nodal fields\n"
    "\n"
    "usage: fieldcmp [--tol-avg M] [--tol-max M] [--field NAME] [--region NAME] [--skip-outside]\n"
    "                [--percentiles] [-m FILE] [-t] A B\n"
    "\n"
    "Compares the field u (m) of stream A with that of stream B at the nodes of A; - is standard\n"
    "input. Where the two clouds of nodes coincide (within 1e-9 of their extent, in any order) the\n"
    "values are compared as they are; otherwise B's field is evaluated at A's nodes: of results of\n"
    "mtled the solver's own field, else a fit by MMLS. A node of A farther than two of B's node\n"
    "spacings from every node of B is an error.\n"
    "\n"
    "Prints one quantity per line, name and value separated by a tab. The difference at a node is the\n"
    "Euclidean norm of the difference of the two vectors; with fields in m these are lengths in m:\n"
    "  avg, max, rmse         average, maximum and root mean square of the differences\n"
    "  p50, p95, p99          percentiles\n"
    "  n                      nodes compared; outside: nodes left out by --skip-outside\n"
    "  clouds                 coincide or interpolated\n"
    "  max_at                 coordinates of the node of the maximum, m\n"
    "  reference              largest norm of B's field; avg_relative and max_relative: relative to\n"
    "                         it\n"
    "  n.REGION, avg.REGION, max.REGION, rmse.REGION, p95.REGION\n"
    "                         the same for the nodes of each region of A's cells\n"
    "\n"
    "A value in A or B that is not a finite number fails the comparison, with or without tolerances.\n"
    "\n"
    "Options:\n"
    "      --tol-avg M            largest average admitted (m; or with a unit, e.g. 0.1mm)\n"
    "      --tol-max M            largest maximum admitted\n"
    "      --field NAME           the field, of 1 to 3 columns (default u)\n"
    "      --region NAME          only the nodes of this region of A\n"
    "      --skip-outside         leave nodes outside of B's cloud out of the comparison\n"
    "      --percentiles          also p5, p10, p25, p75, p90\n"
    "  -m, --map FILE             write nodes.x, cells and the section difference (nan where not\n"
    "                             compared) to FILE\n"
    "  -t, --text                 write FILE as text\n"
    "\n"
    "Exit status:\n"
    "  0  within the tolerances, or none given\n"
    "  1  beyond one of them, or a value is not a number\n"
    "  2  wrong usage, unreadable or not comparable\n"
    "  3  input, output or memory failed\n"
    "\n"
    "Examples:\n"
    "  fieldcmp --tol-avg 0.1mm --tol-max 0.5mm u.dat reference.dat\n"
    "  mtled brain2d.scene table.mts | fieldcmp -m difference.mts - reference.dat\n";

#include "comparison.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TOL_AVG, TOL_MAX, FIELD, REGION, SKIP_OUTSIDE, PERCENTILES, MAP, TEXT, OPTION_COUNT };

/* What the command line asks for. */
struct request {
    double tol_avg, tol_max; /* infinite: any */
    const char *field;
    const char *region; /* NULL: all */
    const char *map;    /* the file; NULL: none */
    bool skip_outside, percentiles, text;
};

static struct request parse(const struct tool *tool, const struct option *options)
{
    if (options[TEXT].given && !options[MAP].given) {
        tool_fail(tool, STATUS_INPUT, "-t goes with -m");
    }
    return (struct request){.tol_avg = comparison_tolerance(tool, &options[TOL_AVG]),
                            .tol_max = comparison_tolerance(tool, &options[TOL_MAX]),
                            .field = options[FIELD].given ? options[FIELD].value : "u",
                            .region = options[REGION].value,
                            .map = options[MAP].value,
                            .skip_outside = options[SKIP_OUTSIDE].given,
                            .percentiles = options[PERCENTILES].given,
                            .text = options[TEXT].given};
}

/* Whether all values are numbers, and the differences within the tolerances. */
static bool judge(const struct tool *tool, const struct request *request, const struct side *a,
                  const struct side *b, const struct field_statistics *statistics)
{
    bool good = !side_has_unknown(tool, a, request->field);
    good = !side_has_unknown(tool, b, request->field) && good;
    good = comparison_within(tool, "avg", statistics->average, request->tol_avg) && good;
    return comparison_within(tool, "max", statistics->largest, request->tol_max) && good;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct side a, b;
    struct findings findings;
    struct error error;
    struct option options[OPTION_COUNT] = {
        [TOL_AVG] = {.name = "tol-avg", .takes_value = true},
        [TOL_MAX] = {.name = "tol-max", .takes_value = true},
        [FIELD] = {.name = "field", .takes_value = true},
        [REGION] = {.name = "region", .takes_value = true},
        [SKIP_OUTSIDE] = {.name = "skip-outside"},
        [PERCENTILES] = {.name = "percentiles"},
        [MAP] = {.letter = 'm', .name = "map", .takes_value = true},
        [TEXT] = {.letter = 't', .name = "text"},
    };
    tool_begin(&tool, usage, options, OPTION_COUNT, 2, 2, argc, argv);
    struct request request = parse(&tool, options);
    side_read(&tool, tool.operands[0], request.field, &a);
    side_read(&tool, tool.operands[1], request.field, &b);
    findings_make(&tool, request.region, request.skip_outside, request.field, &a, &b, &findings);
    print_findings(&findings, &a.field.cells, request.percentiles);
    print_relative(&findings);
    if (request.region == NULL) {
        tool_check(&tool, print_regions(&findings, &error), &error);
    }
    bool good = judge(&tool, &request, &a, &b, &findings.statistics);
    if (request.map != NULL) {
        comparison_write_map(&tool, &a, "difference", findings.comparison.difference, request.map,
                             request.text);
    }
    findings_free(&findings);
    stream_free(&a.stream);
    stream_free(&b.stream);
    int status = tool_end(&tool);
    return good ? status : (int)STATUS_VERDICT;
}
