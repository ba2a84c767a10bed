/* Conditions that depend on each other: met where they agree, sharing their forces by the least norm; named
 * where they do not; and rows so nearly dependent, or so long, that a plain factorization suffers. */
#include "unit.h"

#include "solid/assembly/assembly.h"

enum { NODES = 12 };

/* One-component rows on the nodes of a line; the mass is 1 to 2. */
struct line {
    struct solid_system system;
    struct load_curve curve;
    double X[2 * NODES], mass[NODES], u[2 * NODES], factor;
};

static void line_begin(struct line *line)
{
    *line = (struct line){.curve = curve_of_kind(CURVE_LINEAR), .factor = 1.0};
    line->system.dim = 2;
    line->system.node_count = NODES;
    line->system.X = line->X;
    line->system.curves = calloc(1, sizeof line->curve);
    line->system.factor = calloc(1, sizeof line->factor);
    assert_non_null(line->system.curves);
    assert_non_null(line->system.factor);
    line->system.curves[0] = line->curve;
    line->system.curve_count = 1;
    constraint_rows_init(&line->system.rows, 2);
    for (int n = 0; n < NODES; n++) {
        line->X[2 * n] = 0.1 * n;
        line->mass[n] = 1.0 + n % 3 * 0.5;
    }
}

/* The mean over the nodes first..last-1 of the component along x is to be `target`. */
static void hold(struct line *line, int32_t first, int32_t last, double target, int32_t section)
{
    static const double along_x[2] = {1.0, 0.0};
    int32_t idx[NODES];
    double phi[NODES];
    for (int32_t n = first; n < last; n++) {
        idx[n - first] = n;
        phi[n - first] = 1.0 / (last - first);
    }
    GOOD(constraint_rows_add(&line->system.rows, last - first, idx, phi, along_x, target, 0, section, first,
                             &error));
}

/* Project from a rough field; all rows are met to round-off. */
static void meets_all(struct line *line, struct constraint *constraint)
{
    struct random random = {7};
    for (int i = 0; i < 2 * NODES; i++) {
        line->u[i] = uniform(&random, -1.0, 1.0);
    }
    constraint_project(constraint, &line->factor, line->u);
    AT_MOST(constraint_violation(constraint, &line->factor, line->u, NULL), 1e-12);
}

/* G^T force, along x. */
static void spread(const struct line *line, const double *force, double *total)
{
    double both[2 * NODES] = {0.0};
    FREED_BY(constraint_nodes_free) struct constraint_nodes nodes = {0};
    GOOD(constraint_nodes_build(&line->system.rows, NODES, NULL, NULL, &nodes, &error));
    constraint_nodes_spread(&nodes, force, both);
    for (int n = 0; n < NODES; n++) {
        total[n] = both[2 * n];
    }
}

/* Twice the same, and a mean of others: the forces on the nodes stay, twins share equally, and no other
 * shares have a smaller norm. */
TEST(dependent_rows_share)
{
    struct line line;
    FREED_BY(constraint_free) struct constraint constraint = {0};
    line_begin(&line);
    hold(&line, 0, 2, 0.1, 0);
    hold(&line, 2, 4, 0.3, 0);
    hold(&line, 0, 4, 0.2, 1); /* the mean of the two */
    hold(&line, 6, 7, 0.5, 0);
    hold(&line, 6, 7, 0.5, 1); /* again */
    GOOD(system_constrain(&line.system, line.mass, &constraint, &error));
    assert_int_equal(constraint.factor.dropped, 2);
    meets_all(&line, &constraint);
    double force[5], shared[5], before[NODES], after[NODES];
    memcpy(force, constraint.multiplier, sizeof force);
    memcpy(shared, force, sizeof force);
    GOOD(constraint_share_out(&constraint, shared, &error));
    spread(&line, force, before);
    spread(&line, shared, after);
    ALL_NEAR(NODES, after, before, 1e-7);
    NEAR_TO(shared[3], shared[4], 1e-6);
    NEAR_TO(shared[3] + shared[4], force[3] + force[4], 1e-7);
    /* The least norm is across the combination (1, 1, -2) / 2 that is zero, in the metric of the diagonal. */
    double across = 0.0;
    static const double zero[3] = {1.0, 1.0, -2.0};
    static const int first[3] = {0, 2, 0}, last[3] = {2, 4, 4};
    for (int r = 0; r < 3; r++) {
        double weight = 0.0;
        for (int n = first[r]; n < last[r]; n++) {
            weight += 1.0 / line.mass[n] / (last[r] - first[r]) / (last[r] - first[r]);
        }
        across += zero[r] * weight * shared[r];
    }
    NEAR_TO(across, 0.0, 1e-6);
    assert_true(fabs(shared[2]) > 1e-3);
    system_free(&line.system);
}

/* Targets that disagree are a verdict with both sections, the node, its place and the difference. */
TEST(disagreement_is_named)
{
    struct line line;
    FREED_BY(constraint_free) struct constraint constraint = {0};
    struct error said;
    static const struct condition conditions[] = {{.name = "plate"}, {.name = "rim"}};
    line_begin(&line);
    line.system.conditions = conditions;
    hold(&line, 3, 4, 0.25, 0);
    hold(&line, 3, 4, 0.5, 1);
    assert_int_equal(system_constrain(&line.system, line.mass, &constraint, &said), STATUS_VERDICT);
    assert_non_null(strstr(said.text, "[displacement plate]"));
    assert_non_null(strstr(said.text, "[displacement rim]"));
    assert_non_null(strstr(said.text, "node 3 at (0.3, 0)"));
    assert_non_null(strstr(said.text, "by 0.25 m")); /* at full load */
    assert_non_null(strstr(said.text, "components = free"));
    system_free(&line.system);
}

/* A row over all nodes beside one for each node but one: it is long, and not taken for a dependent one. */
TEST(long_rows)
{
    for (int32_t all = 0; all < 2; all++) {
        struct line line;
        FREED_BY(constraint_free) struct constraint constraint = {0};
        line_begin(&line);
        hold(&line, 0, NODES, 1.0, 1);
        for (int32_t n = all == 0; n < NODES; n++) {
            hold(&line, n, n + 1, 1.0, 0);
        }
        GOOD(system_constrain(&line.system, line.mass, &constraint, &error));
        assert_int_equal(constraint.factor.dropped, all);
        meets_all(&line, &constraint);
        system_free(&line.system);
    }
}

/* Chains of rows that overlap almost whole: none may blow up, whatever is dropped. */
TEST(nearly_dependent_rows)
{
    for (double off = 1e-2; off > 1e-16; off *= 0.1) {
        struct line line;
        FREED_BY(constraint_free) struct constraint constraint = {0};
        static const double along_x[2] = {1.0, 0.0};
        struct random random = {11};
        line_begin(&line);
        for (int r = 0; r < 30; r++) {
            int32_t idx[3] = {r % 5, r % 5 + 1, r % 5 + 2};
            double phi[3], sum = 0.0;
            for (int i = 0; i < 3; i++) {
                phi[i] = 1.0 + off * uniform(&random, -1.0, 1.0);
                sum += phi[i];
            }
            for (int i = 0; i < 3; i++) {
                phi[i] /= sum;
            }
            GOOD(constraint_rows_add(&line.system.rows, 3, idx, phi, along_x, 1.0, 0, 0, idx[0], &error));
        }
        GOOD(system_constrain(&line.system, line.mass, &constraint, &error));
        assert_true(constraint.factor.dropped >= 23);
        constraint_project(&constraint, &line.factor, line.u);
        AT_MOST(constraint_violation(&constraint, &line.factor, line.u, NULL), 1e-4);
        for (int n = 0; n < 7; n++) {
            AT_MOST(fabs(line.u[2 * n]), 10.0);
        }
        GOOD(constraint_share_out(&constraint, constraint.multiplier, &error));
        system_free(&line.system);
    }
}

RUN_TESTS(NULL, NULL)
