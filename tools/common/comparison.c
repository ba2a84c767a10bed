#include "comparison.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The value of a tolerance: a length, or a number in the field's own unit; 0 is allowed. Infinite if it is
 * not given. */
static double tolerance_of(const struct tool *tool, const char *option)
{
    const char *text = tool_value(tool, option);
    bool is_plain = text != NULL && strspn(text, "+-.0123456789eE") == strlen(text);
    return is_plain ? tool_number(tool, option, 0.0, 1e300, INFINITY) : tool_length(tool, option, INFINITY);
}

const char *comparison_field(const struct tool *tool)
{
    tool_requires(tool, "text", "map");
    (void)tolerance_of(tool, "tol-avg");
    (void)tolerance_of(tool, "tol-max");
    return tool_given(tool, "field") ? tool_value(tool, "field") : "u";
}

static enum status view_side(struct side *side, const char *field, struct error *error)
{
    struct nodal_field *view = &side->field;
    RETURN_IF_ERROR(stream_cells(&side->stream, false, &view->cells, error));
    RETURN_IF_ERROR(stream_field(&side->stream, field, 0, view->cells.node_count, &side->section, error));
    RETURN_IF_ERROR(stage_recorded(&side->stream, "parameters", &side->solved, error));
    const struct section *parameters = solved_parameters(&side->stream, &side->solved, side->section);
    view->cols = side->section->cols;
    view->values = side->section->data;
    if (parameters != side->section) {
        view->parameters = parameters->data;
        view->shapes = &side->solved;
    }
    return STATUS_OK;
}

void side_read(const struct tool *tool, const char *file, const char *field, struct side *side)
{
    *side = (struct side){.name = file == NULL || strcmp(file, "-") == 0 ? "standard input" : file};
    tool_read(tool, file, &side->stream);
    TOOL_TRY(tool, fail_in(&error, view_side(side, field, &error), "%s", side->name));
}

void side_read_displacement(const struct tool *tool, const char *file, const char *field, int dim,
                            struct side *side)
{
    side_read(tool, file, field, side);
    const struct nodal_field *u = &side->field;
    dim = dim > 0 ? dim : u->cells.dim;
    if (u->cells.dim != dim || u->cols != dim) {
        tool_fail(tool, STATUS_INPUT, "%s: %s has %jd columns in %dD, where %d in %dD are wanted", side->name,
                  field, u->cols, u->cells.dim, dim, dim);
    }
    if (u->cells.count == 0) {
        tool_fail(tool, STATUS_INPUT, "%s: has no cells, between which %s is interpolated", side->name,
                  field);
    }
    if (!isfinite(field_largest(u->cells.node_count, u->cols, u->values))) {
        tool_fail(tool, STATUS_INPUT, "%s: %s has values that are not finite numbers", side->name, field);
    }
}

void sides_check(const struct tool *tool, const struct side *first, const struct side *second)
{
    const struct nodal_field *a = &first->field, *b = &second->field;
    if (a->cells.dim != b->cells.dim || a->cols != b->cols) {
        tool_fail(tool, STATUS_INPUT, "%s: %jd columns in %dD against %jd columns in %dD",
                  first->section->name, a->cols, a->cells.dim, b->cols, b->cells.dim);
    }
}

static bool has_unknown(const struct tool *tool, const struct side *side)
{
    for (int64_t i = 0; i < side->field.cells.node_count * side->field.cols; i++) {
        if (!isfinite(side->field.values[i])) {
            tool_note(tool, "%s: %s: row %jd: not a finite number", side->name, side->section->name,
                      (i / side->field.cols));
            return true;
        }
    }
    return false;
}

/* Mark the nodes of the cells of a region. */
static void mark_region(const struct cells *cells, const struct groups *regions, int64_t region, bool *marked)
{
    int corners = cells->dim + 1;
    memset(marked, 0, (size_t)cells->node_count * sizeof *marked);
    for (int64_t i = 0; i < cells->count * corners; i++) {
        marked[cells->node[i]] |= regions->group[i / corners] == region;
    }
}

/* (*chosen)[node_count], to be freed: the nodes of region `name`; NULL (all nodes) without a name. */
static enum status choose_nodes(const struct side *a, const char *name, struct findings *findings,
                                bool **chosen, struct error *error)
{
    const struct cells *cells = &a->field.cells;
    int64_t region;
    if (stream_find(&a->stream, "cells.region") != NULL && cells->count > 0) {
        RETURN_IF_ERROR(stream_groups(&a->stream, GROUP_REGION, true, &findings->regions, error));
    }
    if (name == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(
        fail_in(error, names_need(&findings->regions.names, "region", name, &region, error), "--region"));
    RETURN_IF_ERROR(NEW_ARRAY(chosen, cells->node_count, error));
    mark_region(cells, &findings->regions, region, *chosen);
    return STATUS_OK;
}

void findings_make(const struct tool *tool, const char *region, const struct side *a, const struct side *b,
                   struct findings *findings)
{
    struct error why;
    struct field_comparison *comparison = &findings->comparison;
    SCRATCH bool *chosen = NULL;
    *findings = (struct findings){.reference = 0.0};
    sides_check(tool, a, b);
    TOOL_TRY(tool, choose_nodes(a, region, findings, &chosen, &error));
    enum status status =
        field_compare(&a->field, &b->field, chosen, tool_given(tool, "skip-outside"), comparison, &why);
    if (status != STATUS_OK) {
        tool_fail(tool, status, "%s%s", why.text,
                  comparison->outside > 0 ? ": --skip-outside leaves them out" : "");
    }
    if (comparison->count == 0) {
        tool_fail(tool, STATUS_INPUT, "no node of A to compare");
    }
    TOOL_TRY(tool, field_statistics(comparison->count, comparison->node, comparison->difference,
                                    &findings->statistics, &error));
    findings->reference = field_largest(b->field.cells.node_count, b->field.cols, b->field.values);
}

void findings_free(struct findings *findings)
{
    groups_free(&findings->regions);
    field_comparison_free(&findings->comparison);
    field_statistics_free(&findings->statistics);
}

void print_quantity(const char *name, const char *part, double value)
{
    printf("%s%s%s\t%.9g\n", name, part != NULL ? "." : "", part != NULL ? part : "", value);
}

static void print_percentiles(const struct field_statistics *statistics, bool all)
{
    static const int percents[] = {5, 10, 25, 50, 75, 90, 95, 99};
    char name[16];
    for (size_t i = 0; i < sizeof percents / sizeof *percents; i++) {
        if (all || percents[i] == 50 || percents[i] >= 95) {
            snprintf(name, sizeof name, "p%d", percents[i]);
            print_quantity(name, NULL, field_percentile(statistics, percents[i]));
        }
    }
}

static double relative(double value, double reference)
{
    return value == 0.0 ? 0.0 : value / reference;
}

void print_findings(const struct tool *tool, const struct findings *findings, const struct cells *cells)
{
    const struct field_comparison *comparison = &findings->comparison;
    const struct field_statistics *all = &findings->statistics;
    print_quantity("avg", NULL, all->average);
    print_quantity("max", NULL, all->largest);
    print_quantity("rmse", NULL, all->rmse);
    print_percentiles(all, tool_given(tool, "percentiles"));
    printf("n\t%jd\n", all->count);
    if (!comparison->coincide) {
        printf("outside\t%jd\n", comparison->outside);
    }
    printf("clouds\t%s\n", comparison->coincide ? "coincide" : "interpolated");
    for (int i = 0; i < cells->dim; i++) {
        printf("%s%.9g", i == 0 ? "max_at\t" : " ", cells->x[all->largest_at * cells->dim + i]);
    }
    putchar('\n');
    print_quantity("reference", NULL, findings->reference);
    print_quantity("avg_relative", NULL, relative(all->average, findings->reference));
    print_quantity("max_relative", NULL, relative(all->largest, findings->reference));
}

double iteration_error(const struct side *side)
{
    const struct section *section = stream_find(&side->stream, "iteration");
    bool known = section != NULL && section->type == TYPE_F8 && section->rows == 1 && section->cols == 1 &&
                 strcmp(side->section->name, "u") == 0;
    return known ? *(const double *)section->data : -1.0;
}

static enum status print_regions(const struct cells *cells, const struct findings *findings,
                                 struct error *error)
{
    const struct field_comparison *comparison = &findings->comparison;
    const struct names *names = &findings->regions.names;
    NEW_SCRATCH(int64_t, node, comparison->count, error);
    NEW_SCRATCH(bool, marked, cells->node_count, error);
    for (int64_t r = 0; r < names->count; r++) {
        struct field_statistics statistics;
        int64_t count = 0;
        mark_region(cells, &findings->regions, r, marked);
        for (int64_t i = 0; i < comparison->count; i++) {
            if (marked[comparison->node[i]]) {
                node[count++] = comparison->node[i];
            }
        }
        printf("n.%s\t%jd\n", names->name[r], count);
        if (count > 0) {
            RETURN_IF_ERROR(field_statistics(count, node, comparison->difference, &statistics, error));
            print_quantity("avg", names->name[r], statistics.average);
            print_quantity("max", names->name[r], statistics.largest);
            print_quantity("rmse", names->name[r], statistics.rmse);
            print_quantity("p95", names->name[r], field_percentile(&statistics, 95));
            field_statistics_free(&statistics);
        }
    }
    return STATUS_OK;
}

/* Write A's nodes and cells with a value at each node, section `name`, to a file. */
static void write_map(struct tool *tool, struct side *a, const char *name, double *value, const char *file)
{
    static const char *const kept[] = {"nodes.x", "cells", "cells.region"};
    FREED_BY(stream_free) struct stream map = {.provenance = a->stream.provenance};
    char unit[32], attributes[48] = "";
    a->stream.provenance = (struct names){0};
    if (section_attribute(a->section, "unit", unit, sizeof unit) && strchr(unit, ',') == NULL) {
        snprintf(attributes, sizeof attributes, "unit=%s", unit);
    }
    for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
        const struct section *s = stream_find(&a->stream, kept[k]);
        TOOL_TRY(tool, s == NULL ? STATUS_OK
                                 : stream_put(&map, s->name, s->type, s->rows, s->cols, s->attributes,
                                              s->data, false, &error));
    }
    TOOL_TRY(tool,
             stream_put(&map, name, TYPE_F8, a->field.cells.node_count, 1, attributes, value, false, &error));
    tool->output = file;
    tool_write(tool, &map);
}

/* Whether a value is within the tolerance of an option, which NaN is not; else note it. */
static bool is_within(const struct tool *tool, const char *name, double value, const char *option)
{
    double tolerance = tolerance_of(tool, option);
    bool within = value <= tolerance;
    if (!within && isfinite(tolerance)) {
        tool_note(tool, "%s %.9g is beyond %.9g", name, value, tolerance);
    }
    return within;
}

int comparison_end(struct tool *tool, struct side *a, struct side *b, struct findings *findings,
                   const char *name)
{
    if (!tool_given(tool, "region")) {
        TOOL_TRY(tool, print_regions(&a->field.cells, findings, &error));
    }
    bool good = !has_unknown(tool, a);
    good = !has_unknown(tool, b) && good;
    good = is_within(tool, "avg", findings->statistics.average, "tol-avg") && good;
    good = is_within(tool, "max", findings->statistics.largest, "tol-max") && good;
    if (tool_given(tool, "map")) {
        write_map(tool, a, name, findings->comparison.difference, tool_value(tool, "map"));
    }
    findings_free(findings);
    stream_free(&a->stream);
    stream_free(&b->stream);
    int status = tool_end(tool);
    return good ? status : (int)STATUS_VERDICT;
}
