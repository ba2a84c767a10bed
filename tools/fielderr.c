static const char usage[] =
    "fielderr - estimate the discretisation error of a displacement\n"
    "\n"
    "usage: fielderr [-p ORDER] [-r RATIO] [--tol-avg M] [--tol-max M] [--field NAME] [--region NAME]\n"
    "                [--skip-outside] [--percentiles] [-m FILE] [-t] FINE COARSE [COARSER]\n"
    "\n"
    "Reads two results of mtled of the same scene, FINE and COARSE, whose cloud has half as many nodes\n"
    "per direction (gmsh -clscale 2, voxels with twice -h: an eighth of the work, 2D a quarter), and\n"
    "estimates how far FINE is from the solution on ever finer clouds; - is standard input. The estimate is\n"
    "extrapolated (Richardson): at each node of FINE, the distance of the two fields by\n"
    "2^ORDER - 1. The order is 2 where a solution is smooth, and between 1 and 2 where it is singular, as\n"
    "where prescribed and free boundary meet. It is taken from the gradients of the two fields, whose\n"
    "errors fall by half where the solution is smooth: twice their order, and at least 1.5.\n"
    "With a third result, COARSER, of half as many nodes again, the order is computed from the three, and\n"
    "limited to 1 .. 2.\n"
    "\n"
    "Prints what fieldcmp prints, of the estimated error: avg, max, rmse, p50, p95, p99 (m), n, clouds,\n"
    "max_at, the same of each region; and\n"
    "  mean                   the average over the body, as avg is that over the nodes, of which a graded\n"
    "                         cloud has most in few places\n"
    "  reference              largest norm of FINE's field; avg_relative and max_relative: relative to\n"
    "                         it\n"
    "  iteration              how far the errors of mtled's iterations, of FINE and COARSE, may have\n"
    "                         changed the estimate, m; if both results state them\n"
    "  dominant               discretisation where avg is larger than that; else iteration, with a note:\n"
    "                         a smaller tolerance in [solver] is needed before a finer cloud\n"
    "  order, ratio           the values used; cells_ratio: the ratio of the sizes of the cells\n"
    "  force.NAME             error of the force of each condition and contact that both results have\n"
    "                         (reactions = yes in [output]), N (2D: N/m); force_relative.NAME: relative\n"
    "                         to that force in FINE\n"
    "  energy, energy_relative  the same of the elastic energy (energy = yes), J (2D: J/m)\n"
    "\n"
    "The estimate does not contain errors that both results share: of the geometry (a polygon for a curve,\n"
    "a segmentation), the material, conditions and contacts. It is no upper bound. On clouds too coarse\n"
    "to converge with this order it may be wrong by a factor of two or three; at single nodes it is less\n"
    "certain than on average.\n"
    "\n"
    "Options:\n"
    "  -p, --order ORDER      the order, above 0 and up to 4 (default: as observed)\n"
    "  -r, --ratio RATIO      spacing of COARSE by that of FINE, above 1 (default 2)\n"
    "      --tol-avg M        largest average admitted (m; or with a unit, e.g. 0.1mm)\n"
    "      --tol-max M        largest maximum admitted\n"
    "      --field NAME       the field, of 1 to 3 columns (default u)\n"
    "      --region NAME      only the nodes of this region of FINE\n"
    "      --skip-outside     leave nodes outside of COARSE's cloud out\n"
    "      --percentiles      also p5, p10, p25, p75, p90\n"
    "  -m, --map FILE         write nodes.x, cells and the section error (nan where left out) to FILE\n"
    "  -t, --text             write FILE as text\n"
    "\n"
    "Exit status:\n"
    "  0  within the tolerances, or none given\n"
    "  1  beyond one of them, or a value is not a number\n"
    "  2  wrong usage, unreadable or not comparable\n"
    "  3  input, output or memory failed\n"
    "\n"
    "Examples:\n"
    "  gmsh -2 -clscale 2 body.geo -o coarse.msh\n"
    "  nodes -u mm coarse.msh | shapefn | mtled body.scene > coarse.dat\n"
    "  fielderr --tol-avg 0.1mm u.dat coarse.dat\n";

#include "comparison.h"

#include "approx/error/field_error.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* The ratio of the cells per direction by the ratio in use; values outside of these bounds are noted. */
static const double least_agreement = 0.65, most_agreement = 1.5;

/* Exit unless the second cloud is coarser. Returns the ratio of the cells per direction. */
static double check_coarser(const struct tool *tool, double ratio, const struct side *fine,
                            const struct side *coarse)
{
    sides_check(tool, fine, coarse);
    const struct cells *f = &fine->field.cells, *c = &coarse->field.cells;
    bool both = f->count > 0 && c->count > 0; /* else of the nodes */
    double more = both ? (double)f->count / (double)c->count : (double)f->node_count / (double)c->node_count;
    double found = pow(more, 1.0 / f->dim);
    if (!(found > 1.0)) {
        tool_fail(tool, STATUS_INPUT,
                  "%s has %jd nodes, %s %jd: the coarser result comes second, on a cloud of its own",
                  fine->name, fine->field.cells.node_count, coarse->name, coarse->field.cells.node_count);
    }
    if (found < least_agreement * ratio || found > most_agreement * ratio) {
        tool_note(tool, "%s has %.2g times as many cells per direction as %s, not %.3g: see -r", fine->name,
                  found, coarse->name, ratio);
    }
    return found;
}

/* The difference of two rows; *length: the norm of the fine one. */
static double row_difference(const struct section *fine, int64_t i, const struct section *coarse, int64_t k,
                             double *length)
{
    const double *f = (const double *)fine->data + i * fine->cols;
    const double *c = (const double *)coarse->data + k * coarse->cols;
    *length = field_largest(1, fine->cols, f);
    return vector_distance((int)fine->cols, f, c);
}

static const struct section *find_table(const struct side *side, const char *name, int64_t cols)
{
    const struct section *section = stream_find(&side->stream, name);
    return section != NULL && section->type == TYPE_F8 && section->cols == cols ? section : NULL;
}

static enum status print_forces(const struct side *fine, const struct side *coarse, double share,
                                struct error *error)
{
    int dim = fine->field.cells.dim;
    const struct section *f = find_table(fine, "reactions", dim);
    const struct section *c = find_table(coarse, "reactions", dim);
    FREED_BY(names_free) struct names of_fine = {0}, of_coarse = {0};
    if (f == NULL || c == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(names_of(f, "rows", &of_fine, error));
    RETURN_IF_ERROR(names_of(c, "rows", &of_coarse, error));
    for (int64_t i = 0; i < of_fine.count && i < f->rows; i++) {
        for (int64_t k = 0; k < of_coarse.count && k < c->rows; k++) {
            if (strcmp(of_fine.name[i], of_coarse.name[k]) == 0) {
                double length, off = row_difference(f, i, c, k, &length);
                print_quantity("force", of_fine.name[i], share * off);
                print_quantity("force_relative", of_fine.name[i], off == 0.0 ? 0.0 : share * off / length);
            }
        }
    }
    return STATUS_OK;
}

static void print_energy(const struct side *fine, const struct side *coarse, double share)
{
    const struct section *f = find_table(fine, "energy", 2), *c = find_table(coarse, "energy", 2);
    if (f != NULL && c != NULL && f->rows == 1 && c->rows == 1) {
        double at_rest = *(const double *)f->data, off = fabs(at_rest - *(const double *)c->data);
        print_quantity("energy", NULL, share * off);
        print_quantity("energy_relative", NULL, off == 0.0 ? 0.0 : share * off / fabs(at_rest));
    }
}

/* The average difference of two results over all nodes of the first. */
static double average_difference(const struct tool *tool, const struct side *first, const struct side *second)
{
    FREED_BY(findings_free) struct findings findings = {0};
    findings_make(tool, NULL, first, second, &findings);
    return findings.statistics.average;
}

/* The square of the error of a field's gradient, by its recovered gradient; NAN without cells or where a
 * value is not a number. */
static enum status gradient_error(const struct side *side, double *sum, struct error *error)
{
    const struct nodal_field *field = &side->field;
    const struct cells *cells = &field->cells;
    FREED_BY(groups_free) struct groups regions = {0};
    NEW_SCRATCH(double, squared, cells->count, error);
    *sum = NAN;
    if (cells->count == 0 || !isfinite(field_largest(cells->node_count, field->cols, field->values))) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_groups(&side->stream, GROUP_REGION, false, &regions, error));
    RETURN_IF_ERROR(field_error_recovered(cells, regions.group, (int32_t)regions.names.count, field->cols,
                                          field->values, squared, error));
    *sum = 0.0;
    for (int64_t q = 0; q < cells->count; q++) {
        *sum += squared[q];
    }
    return STATUS_OK;
}

/* The order by the errors of the gradients of two results. */
static double order_of_gradients(const struct tool *tool, double ratio, const struct side *fine,
                                 const struct side *coarse)
{
    double near, far;
    TOOL_TRY(tool, gradient_error(fine, &near, &error));
    TOOL_TRY(tool, gradient_error(coarse, &far, &error));
    bool known = isfinite(near) && isfinite(far);
    return known ? field_error_order(near, far, ratio, FIELD_ERROR_ORDER) : FIELD_ERROR_ORDER;
}

/* The order that is requested, or that observed. It is that of the whole body even if a region is requested:
 * the error of a region partly comes from elsewhere, and an average over more nodes varies less. */
static double choose_order(struct tool *tool, double ratio, const struct side *fine,
                           const struct side *coarse, const struct findings *findings)
{
    struct side coarser;
    if (tool_given(tool, "order")) {
        return tool_number(tool, "order", 0.01, 4.0, 0.0);
    }
    if (tool->operand_count < 3) {
        return order_of_gradients(tool, ratio, fine, coarse);
    }
    side_read(tool, tool->operands[2], fine->section->name, &coarser);
    (void)check_coarser(tool, ratio, coarse, &coarser);
    double near =
        tool_given(tool, "region") ? average_difference(tool, fine, coarse) : findings->statistics.average;
    double far = average_difference(tool, coarse, &coarser);
    stream_free(&coarser.stream);
    return field_error_order(near, far, ratio, FIELD_ERROR_LEAST_ORDER);
}

/* Print the error of the iterations of both results that the estimate, `share` of their difference, contains,
 * and which error dominates: this one or the discretisation's, `average`. */
static void print_iteration(const struct tool *tool, const struct side *fine, const struct side *coarse,
                            double share, double average)
{
    double own = iteration_error(fine), other = iteration_error(coarse);
    if (own < 0.0 || other < 0.0) {
        return;
    }
    double left = own + share * (own + other);
    print_quantity("iteration", NULL, left);
    printf("dominant\t%s\n", average > left ? "discretisation" : "iteration");
    if (!(average > left)) {
        tool_note(tool,
                  "the iterations may have left %.3g m: a smaller tolerance in [solver] shows the error "
                  "of the discretisation",
                  left);
    }
}

/* Turn differences of the two fields into the error of the first one. */
static void scale(struct findings *findings, double share, int64_t node_count)
{
    struct field_statistics *all = &findings->statistics;
    for (int64_t n = 0; n < node_count; n++) {
        findings->comparison.difference[n] *= share;
    }
    for (int64_t i = 0; i < all->count; i++) {
        all->sorted[i] *= share;
    }
    all->average *= share;
    all->largest *= share;
    all->rmse *= share;
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct side fine, coarse;
    struct findings findings;
    tool_begin(&tool, usage, 2, 3, argc, argv);
    const char *field = comparison_field(&tool), *region = tool_value(&tool, "region");
    if (tool_given(&tool, "order") && tool.operand_count > 2) {
        tool_fail(&tool, STATUS_INPUT, "-p: of three results the order is observed");
    }
    (void)tool_number(&tool, "order", 0.01, 4.0, 0.0); /* usage errors before waiting for the input */
    double ratio = tool_number(&tool, "ratio", 1.01, 100.0, 2.0);
    side_read(&tool, tool.operands[0], field, &fine);
    side_read(&tool, tool.operands[1], field, &coarse);
    double found = check_coarser(&tool, ratio, &fine, &coarse);
    findings_make(&tool, region, &fine, &coarse, &findings);
    double order = choose_order(&tool, ratio, &fine, &coarse, &findings);
    double share = field_error_share(ratio, order);
    scale(&findings, share, fine.field.cells.node_count);
    findings.reference = field_largest(fine.field.cells.node_count, fine.field.cols, fine.field.values);
    print_findings(&tool, &findings, &fine.field.cells);
    if (region == NULL && fine.field.cells.count > 0) {
        print_quantity("mean", NULL, field_error_mean(&fine.field.cells, findings.comparison.difference));
    }
    print_iteration(&tool, &fine, &coarse, share, findings.statistics.average);
    print_quantity("order", NULL, order);
    print_quantity("ratio", NULL, ratio);
    print_quantity("cells_ratio", NULL, found);
    TOOL_TRY(&tool, print_forces(&fine, &coarse, share, &error));
    print_energy(&fine, &coarse, share);
    return comparison_end(&tool, &fine, &coarse, &findings, "error");
}
