static const char usage[] =
    "fieldcmp - compare two nodal fields\n"
    "\n"
    "usage: fieldcmp [--tol-avg M] [--tol-max M] [--field NAME] [--region NAME] [--skip-outside]\n"
    "                [--percentiles] [-m FILE] [-t] A B\n"
    "\n"
    "Compares the field u (m) of stream A with that of stream B at the nodes of A; - is standard\n"
    "input. Where the two clouds of nodes coincide (within 1e-9 of their extent, in any order) the\n"
    "values are compared as they are; otherwise B's field is interpolated to A's nodes by MMLS. A\n"
    "node of A farther than two of B's node spacings from every node of B is an error.\n"
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
    "Exit status: 0 within the tolerances (or none given); 1 beyond one of them, or not a number; 2\n"
    "unreadable or not comparable; 3 input/output or memory failure.\n"
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
    "Examples:\n"
    "  fieldcmp --tol-avg 0.1mm --tol-max 0.5mm u.dat reference.dat\n"
    "  mtled brain2d.scene table.mts | fieldcmp -m difference.mts - reference.dat\n";

#include "stages.h"

#include "approx/field_compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TOL_AVG, TOL_MAX, FIELD, REGION, SKIP_OUTSIDE, PERCENTILES, MAP, TEXT, OPTION_COUNT };

/* One of the two streams. */
struct side {
    const char *name;
    struct stream stream;
    struct nodal_field field;
};

/* A length, or a number of the field's own unit; 0 is allowed. */
static double parse_tolerance(const struct tool *tool, const struct option *option)
{
    struct error error;
    double value = INFINITY;
    if (!option->given) {
        return value;
    }
    bool plain = strspn(option->value, "+-.0123456789eE") == strlen(option->value);
    tool_check(tool,
               plain ? parse_double(option->value, option->name, 0.0, 1e300, &value, &error)
                     : parse_length(option->value, option->name, &value, &error),
               &error);
    return value;
}

static void read_side(const struct tool *tool, const char *file, const char *field, struct side *side)
{
    struct error error;
    const struct section *section;
    side->name = strcmp(file, "-") == 0 ? "standard input" : file;
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
    side->field.cols = section->cols;
    side->field.values = section->data;
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

/* The regions of A's cells: their names, and for each node the region of every cell at it. */
struct regions {
    int count;
    char **name;
    char *list;   /* the names' storage */
    bool *member; /* node_count * count */
};

static enum status regions_read(const struct side *side, struct regions *regions, struct error *error)
{
    enum status status = STATUS_OK;
    const struct section *section = stream_find(&side->stream, "cells.region");
    const struct cells *cells = &side->field.cells;
    *regions = (struct regions){0};
    if (section == NULL || cells->count == 0) {
        return STATUS_OK;
    }
    TRY(stream_need(&side->stream, "cells.region", TYPE_I4, 1, "nodes", &section, error));
    size_t size = strlen(section->attributes) + 1;
    TRY(NEW_ARRAY(&regions->list, (int64_t)size, error));
    if (section->rows != cells->count || !section_attribute(section, "names", regions->list, size)) {
        status = fail(error, STATUS_INPUT, "cells.region: no names=, or not one row per cell");
        goto done;
    }
    TRY(NEW_ARRAY(&regions->name, (int64_t)size, error));
    for (char *rest = regions->list; rest != NULL;) {
        regions->name[regions->count++] = strsep(&rest, ",");
    }
    TRY(NEW_ARRAY(&regions->member, cells->node_count * regions->count, error));
    const int32_t *region = section->data;
    for (int64_t c = 0; c < cells->count; c++) {
        if (region[c] < 0 || region[c] >= regions->count) {
            status =
                fail(error, STATUS_INPUT, "cells.region: row %lld: no region %d", (long long)c, region[c]);
            goto done;
        }
        for (int k = 0; k <= cells->dim; k++) {
            regions->member[cells->node[c * (cells->dim + 1) + k] * regions->count + region[c]] = true;
        }
    }
done:
    return status;
}

static void regions_free(struct regions *regions)
{
    free(regions->name);
    free(regions->list);
    free(regions->member);
}

/* chosen[node_count]: the nodes of one region; NULL (all) without its name. */
static enum status choose_nodes(int64_t node_count, const struct regions *regions, const char *region,
                                bool **chosen, struct error *error)
{
    enum status status;
    int index = 0;
    *chosen = NULL;
    if (region == NULL) {
        return STATUS_OK;
    }
    while (index < regions->count && strcmp(regions->name[index], region) != 0) {
        index++;
    }
    if (index == regions->count) {
        char list[256] = "none";
        for (int r = 0; r < regions->count; r++) {
            size_t length = r == 0 ? 0 : strlen(list);
            snprintf(list + length, sizeof list - length, "%s%s", r == 0 ? "" : ", ", regions->name[r]);
        }
        return fail(error, STATUS_INPUT, "--region: no region '%s'; there are: %s", region, list);
    }
    TRY(NEW_ARRAY(chosen, node_count, error));
    for (int64_t n = 0; n < node_count; n++) {
        (*chosen)[n] = regions->member[n * regions->count + index];
    }
done:
    return status;
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

static void print_table(const struct field_comparison *comparison, const struct field_statistics *all,
                        const struct side *a, double reference, bool percentiles)
{
    print_line("avg", NULL, all->average);
    print_line("max", NULL, all->largest);
    print_line("rmse", NULL, all->rmse);
    print_percentiles(all, percentiles);
    printf("n\t%lld\n", (long long)all->count);
    if (!comparison->coincide) {
        printf("outside\t%lld\n", (long long)comparison->outside);
    }
    printf("clouds\t%s\n", comparison->coincide ? "coincide" : "interpolated");
    for (int i = 0; i < a->field.cells.dim; i++) {
        printf("%s%.9g", i == 0 ? "max_at\t" : " ",
               a->field.cells.x[all->largest_at * a->field.cells.dim + i]);
    }
    putchar('\n');
    print_line("reference", NULL, reference);
    print_line("avg_relative", NULL, relative(all->average, reference));
    print_line("max_relative", NULL, relative(all->largest, reference));
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
               stream_put(stream, "difference", TYPE_F8, a->field.cells.node_count, 1, "unit=m",
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

int main(int argc, char *argv[])
{
    struct tool tool;
    struct side a, b;
    struct regions regions;
    struct field_comparison comparison;
    bool *chosen;
    struct field_statistics statistics;
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
    double tol_avg = parse_tolerance(&tool, &options[TOL_AVG]);
    double tol_max = parse_tolerance(&tool, &options[TOL_MAX]);
    const char *field = options[FIELD].given ? options[FIELD].value : "u";
    if (options[TEXT].given && !options[MAP].given) {
        tool_fail(&tool, STATUS_INPUT, "-t goes with -m");
    }
    read_side(&tool, tool.operands[0], field, &a);
    read_side(&tool, tool.operands[1], field, &b);
    if (a.field.cells.dim != b.field.cells.dim || a.field.cols != b.field.cols) {
        tool_fail(&tool, STATUS_INPUT, "%s: %lld columns in %dD against %lld columns in %dD", field,
                  (long long)a.field.cols, a.field.cells.dim, (long long)b.field.cols, b.field.cells.dim);
    }

    tool_check(&tool, regions_read(&a, &regions, &error), &error);
    tool_check(&tool,
               choose_nodes(a.field.cells.node_count, &regions, options[REGION].value, &chosen, &error),
               &error);
    enum status status =
        field_compare(&a.field, &b.field, chosen, options[SKIP_OUTSIDE].given, &comparison, &error);
    if (status != STATUS_OK) {
        tool_fail(&tool, status, "%s%s", error.text,
                  comparison.outside > 0 ? ": --skip-outside leaves them out" : "");
    }
    if (comparison.count == 0) {
        tool_fail(&tool, STATUS_INPUT, "no node of A to compare");
    }
    tool_check(
        &tool,
        field_statistics(comparison.count, comparison.node, comparison.difference, &statistics, &error),
        &error);

    double reference = field_largest(b.field.cells.node_count, b.field.cols, b.field.values);
    print_table(&comparison, &statistics, &a, reference, options[PERCENTILES].given);
    if (!options[REGION].given) {
        tool_check(&tool, print_regions(&comparison, &regions, &error), &error);
    }
    bool good = !has_unknown(&tool, &a, field);
    good = !has_unknown(&tool, &b, field) && good;
    good = within(&tool, "avg", statistics.average, tol_avg) && good;
    good = within(&tool, "max", statistics.largest, tol_max) && good;
    if (options[MAP].given) {
        write_map(&tool, &a, &comparison, options[MAP].value, options[TEXT].given);
    }
    regions_free(&regions);
    field_statistics_free(&statistics);
    field_comparison_free(&comparison);
    free(chosen);
    stream_free(&a.stream);
    stream_free(&b.stream);
    int ended = tool_end(&tool);
    return ended != 0 || good ? ended : (int)STATUS_VERDICT;
}
