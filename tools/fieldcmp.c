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

#include "regions.h"
#include "solved.h"

#include "approx/field_compare.h"

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

/* One of the two streams. */
struct side {
    const char *name;
    struct stream stream;
    const struct section *section; /* of the field */
    struct nodal_field field;
    struct solved solved;
};

/* A length, or a number of the field's own unit; 0 is allowed. */
static double parse_tolerance(const struct tool *tool, const struct option *option)
{
    struct error error;
    double value = INFINITY;
    char what[32];
    if (!option->given) {
        return value;
    }
    snprintf(what, sizeof what, "--%s", option->name);
    bool plain = strspn(option->value, "+-.0123456789eE") == strlen(option->value);
    tool_check(tool,
               plain ? parse_double(option->value, what, 0.0, 1e300, &value, &error)
                     : parse_length(option->value, what, &value, &error),
               &error);
    return value;
}

static struct request parse(const struct tool *tool, const struct option *options)
{
    if (options[TEXT].given && !options[MAP].given) {
        tool_fail(tool, STATUS_INPUT, "-t goes with -m");
    }
    return (struct request){.tol_avg = parse_tolerance(tool, &options[TOL_AVG]),
                            .tol_max = parse_tolerance(tool, &options[TOL_MAX]),
                            .field = options[FIELD].given ? options[FIELD].value : "u",
                            .region = options[REGION].value,
                            .map = options[MAP].value,
                            .skip_outside = options[SKIP_OUTSIDE].given,
                            .percentiles = options[PERCENTILES].given,
                            .text = options[TEXT].given};
}

static void read_side(const struct tool *tool, const char *file, const char *field, struct side *side)
{
    struct error error;
    const struct section *section;
    *side = (struct side){.name = strcmp(file, "-") == 0 ? "standard input" : file};
    tool_read(tool, file, &side->stream);
    enum status status = stream_cells(&side->stream, false, &side->field.cells, &error);
    if (status == STATUS_OK) {
        status = stream_need(&side->stream, field, TYPE_F8, 0, "mtled", &section, &error);
    }
    if (status == STATUS_OK && (section->cols > 3 || section->rows != side->field.cells.node_count)) {
        status =
            fail(&error, STATUS_INPUT,
                 "%s: %lld rows of %lld columns: not a field of 1 to 3 columns on %lld nodes", field,
                 (long long)section->rows, (long long)section->cols, (long long)side->field.cells.node_count);
    }
    if (status != STATUS_OK) {
        tool_fail(tool, status, "%s: %s", side->name, error.text);
    }
    status = solved_read(&side->stream, &side->solved, &error);
    if (status != STATUS_OK) {
        tool_fail(tool, status, "%s: %s", side->name, error.text);
    }
    const struct section *parameters = solved_parameters(&side->stream, &side->solved, section);
    side->section = section;
    side->field.cols = section->cols;
    side->field.values = section->data;
    if (parameters != section) {
        side->field.parameters = parameters->data;
        side->field.radius = side->solved.radius;
        side->field.support = &side->solved.recorded.support;
        side->field.shapes = &side->solved.recorded.shapes;
    }
}

static void check_same_kind(const struct tool *tool, const struct nodal_field *a, const struct nodal_field *b,
                            const char *name)
{
    if (a->cells.dim != b->cells.dim || a->cols != b->cols) {
        tool_fail(tool, STATUS_INPUT, "%s: %lld columns in %dD against %lld columns in %dD", name,
                  (long long)a->cols, a->cells.dim, (long long)b->cols, b->cells.dim);
    }
}

/* Notes the first value that is not finite; returns whether there is one. */
static bool has_unknown(const struct tool *tool, const struct side *side, const char *field)
{
    for (int64_t i = 0; i < side->field.cells.node_count * side->field.cols; i++) {
        if (!isfinite(side->field.values[i])) {
            tool_note(tool, "%s: %s: row %lld: not a finite number", side->name, field,
                      (long long)(i / side->field.cols));
            return true;
        }
    }
    return false;
}

/* What the two fields differ by. */
struct findings {
    struct regions regions; /* of A */
    struct field_comparison comparison;
    struct field_statistics statistics; /* of all nodes compared */
    double reference;                   /* largest norm of B's field */
};

static void compare(const struct tool *tool, const struct request *request, const struct side *a,
                    const struct side *b, struct findings *findings)
{
    struct error error;
    struct field_comparison *comparison = &findings->comparison;
    bool *chosen;
    tool_check(tool, regions_read(&a->stream, &a->field.cells, &findings->regions, &error), &error);
    tool_check(tool, regions_choose(&findings->regions, request->region, &chosen, &error), &error);
    enum status status =
        field_compare(&a->field, &b->field, chosen, request->skip_outside, comparison, &error);
    if (status != STATUS_OK) {
        tool_fail(tool, status, "%s%s", error.text,
                  comparison->outside > 0 ? ": --skip-outside leaves them out" : "");
    }
    if (comparison->count == 0) {
        tool_fail(tool, STATUS_INPUT, "no node of A to compare");
    }
    tool_check(tool,
               field_statistics(comparison->count, comparison->node, comparison->difference,
                                &findings->statistics, &error),
               &error);
    findings->reference = field_largest(b->field.cells.node_count, b->field.cols, b->field.values);
    free(chosen);
}

static void findings_free(struct findings *findings)
{
    regions_free(&findings->regions);
    field_comparison_free(&findings->comparison);
    field_statistics_free(&findings->statistics);
}

static void print_line(const char *name, const char *region, double value)
{
    printf("%s%s%s\t%.9g\n", name, region != NULL ? "." : "", region != NULL ? region : "", value);
}

static void print_percentiles(const struct field_statistics *statistics, bool all)
{
    static const int percents[] = {5, 10, 25, 50, 75, 90, 95, 99};
    char name[16];
    for (size_t i = 0; i < sizeof percents / sizeof *percents; i++) {
        if (all || percents[i] == 50 || percents[i] >= 95) {
            snprintf(name, sizeof name, "p%d", percents[i]);
            print_line(name, NULL, field_percentile(statistics, percents[i]));
        }
    }
}

static double relative(double value, double reference)
{
    return value == 0.0 ? 0.0 : value / reference;
}

static void print_table(const struct findings *findings, const struct cells *cells, bool percentiles)
{
    const struct field_comparison *comparison = &findings->comparison;
    const struct field_statistics *all = &findings->statistics;
    print_line("avg", NULL, all->average);
    print_line("max", NULL, all->largest);
    print_line("rmse", NULL, all->rmse);
    print_percentiles(all, percentiles);
    printf("n\t%lld\n", (long long)all->count);
    if (!comparison->coincide) {
        printf("outside\t%lld\n", (long long)comparison->outside);
    }
    printf("clouds\t%s\n", comparison->coincide ? "coincide" : "interpolated");
    for (int i = 0; i < cells->dim; i++) {
        printf("%s%.9g", i == 0 ? "max_at\t" : " ", cells->x[all->largest_at * cells->dim + i]);
    }
    putchar('\n');
    print_line("reference", NULL, findings->reference);
    print_line("avg_relative", NULL, relative(all->average, findings->reference));
    print_line("max_relative", NULL, relative(all->largest, findings->reference));
}

/* Statistics of the nodes of each region among those compared. */
static enum status print_regions(const struct field_comparison *comparison, const struct regions *regions,
                                 struct error *error)
{
    enum status status;
    int64_t *node = NULL;
    TRY(NEW_ARRAY(&node, comparison->count, error));
    for (int r = 0; r < regions->count; r++) {
        struct field_statistics statistics;
        int64_t count = 0;
        for (int64_t i = 0; i < comparison->count; i++) {
            if (regions->member[comparison->node[i] * regions->count + r]) {
                node[count++] = comparison->node[i];
            }
        }
        printf("n.%s\t%lld\n", regions->name[r], (long long)count);
        if (count > 0) {
            TRY(field_statistics(count, node, comparison->difference, &statistics, error));
            print_line("avg", regions->name[r], statistics.average);
            print_line("max", regions->name[r], statistics.largest);
            print_line("rmse", regions->name[r], statistics.rmse);
            print_line("p95", regions->name[r], field_percentile(&statistics, 95));
            field_statistics_free(&statistics);
        }
    }
done:
    free(node);
    return status;
}

/* A's nodes and cells with the difference at each node. */
static void write_map(struct tool *tool, struct side *a, const struct field_comparison *comparison,
                      const char *file, bool text)
{
    struct error error;
    static const char *const kept[] = {"nodes.x", "cells", "cells.region"};
    struct stream *stream = &a->stream;
    char unit[32], attributes[48] = "";
    if (section_attribute(a->section, "unit", unit, sizeof unit) && strchr(unit, ',') == NULL) {
        snprintf(attributes, sizeof attributes, "unit=%s", unit);
    }
    for (int64_t s = stream->section_count; s-- > 0;) {
        bool keep = false;
        for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
            keep = keep || strcmp(stream->sections[s].name, kept[k]) == 0;
        }
        if (!keep) {
            stream_remove(stream, stream->sections[s].name);
        }
    }
    tool_check(tool,
               stream_put(stream, "difference", TYPE_F8, a->field.cells.node_count, 1, attributes,
                          comparison->difference, false, &error),
               &error);
    tool->output = file;
    tool_write(tool, stream, text);
}

/* Whether a value is within its tolerance; NaN is not. */
static bool within(const struct tool *tool, const char *name, double value, double tolerance)
{
    if (!(value <= tolerance)) {
        if (isfinite(tolerance)) {
            tool_note(tool, "%s %.9g is beyond %.9g", name, value, tolerance);
        }
        return false;
    }
    return true;
}

/* Whether all values are numbers, and the differences within the tolerances. */
static bool judge(const struct tool *tool, const struct request *request, const struct side *a,
                  const struct side *b, const struct field_statistics *statistics)
{
    bool good = !has_unknown(tool, a, request->field);
    good = !has_unknown(tool, b, request->field) && good;
    good = within(tool, "avg", statistics->average, request->tol_avg) && good;
    return within(tool, "max", statistics->largest, request->tol_max) && good;
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
    read_side(&tool, tool.operands[0], request.field, &a);
    read_side(&tool, tool.operands[1], request.field, &b);
    check_same_kind(&tool, &a.field, &b.field, request.field);
    compare(&tool, &request, &a, &b, &findings);
    print_table(&findings, &a.field.cells, request.percentiles);
    if (request.region == NULL) {
        tool_check(&tool, print_regions(&findings.comparison, &findings.regions, &error), &error);
    }
    bool good = judge(&tool, &request, &a, &b, &findings.statistics);
    if (request.map != NULL) {
        write_map(&tool, &a, &findings.comparison, request.map, request.text);
    }
    findings_free(&findings);
    stream_free(&a.stream);
    stream_free(&b.stream);
    int status = tool_end(&tool);
    return good ? status : (int)STATUS_VERDICT;
}
