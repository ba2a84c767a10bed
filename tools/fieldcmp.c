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
    "  iteration_a, iteration_b  how far the iterations of mtled may have left A and B from where they\n"
    "                         would end, at the worst node, m: a difference below that is of the\n"
    "                         iteration. What lies above is of the clouds: see fielderr\n"
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

static void print_iteration(const char *name, const struct side *side)
{
    double error = iteration_error(side);
    if (error >= 0.0) {
        print_quantity(name, NULL, error);
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct side a, b;
    struct findings findings;
    tool_begin(&tool, usage, 2, 2, argc, argv);
    const char *field = comparison_field(&tool);
    side_read(&tool, tool.operands[0], field, &a);
    side_read(&tool, tool.operands[1], field, &b);
    findings_make(&tool, tool_value(&tool, "region"), &a, &b, &findings);
    print_findings(&tool, &findings, &a.field.cells);
    print_iteration("iteration_a", &a);
    print_iteration("iteration_b", &b);
    return comparison_end(&tool, &a, &b, &findings, "difference");
}
