/* A body assembled with conditions, as the tools do it: what is held, patches of linear fields, and
 * conditions that disagree. */
#include "lattice_fixture.h"

#include "solid/equilibrium/newton.h"

/* The facets of sides of the box, see lattice_options. */
static struct facet_set side_facets(const struct lattice *l, unsigned sides, int32_t **facet)
{
    int dim = l->options.dim;
    struct facet_set set = {0};
    ARRAY(*facet, l->cloud.facet_count * dim);
    for (int64_t f = 0; f < l->cloud.facet_count; f++) {
        if (sides >> l->cloud.facet_set[f] & 1u) {
            memcpy(*facet + set.count++ * dim, l->cloud.facets + f * dim, (size_t)dim * sizeof **facet);
        }
    }
    set.facet = *facet;
    return set;
}

/* Assemble anew with conditions. */
static enum status assemble(struct lattice *l, const struct condition *conditions, int64_t count,
                            struct error *note, struct error *error)
{
    system_free(&l->system);
    ARRAY(l->assembly.curves, 1);
    l->assembly.curves[0] = curve_of_kind(CURVE_SMOOTH);
    l->assembly.curve_count = 1;
    l->assembly.conditions = conditions;
    l->assembly.condition_count = count;
    return assembly_build(&l->assembly, &l->system, note, error);
}

/* u = A x prescribed by a table on the whole boundary is u within. */
TEST_IN_EACH_DIM(linear_field_by_table)
{
    static const double A[3][3] = {{0.02, 0.01, -0.01}, {0.03, -0.02, 0.01}, {0.01, -0.01, 0.015}};
    FREED_BY(lattice_free) struct lattice l = {0};
    struct error note;
    SCRATCH int32_t *facet = NULL;
    struct lattice_options options = lattice_defaults(dim, 5);
    options.jitter = 0.1;
    lattice_build(&l, &options);
    double *rows = zeros(l.assembly.cells.node_count * 2 * dim, sizeof *rows);
    for (int64_t n = 0; n < l.assembly.cells.node_count; n++) {
        for (int i = 0; i < dim; i++) {
            rows[n * 2 * dim + i] = l.assembly.cells.x[n * dim + i];
            for (int k = 0; k < dim; k++) {
                rows[n * 2 * dim + dim + i] += A[i][k] * l.assembly.cells.x[n * dim + k];
            }
        }
    }
    const struct condition all = {.name = "all",
                                  .where = "scene:1: [displacement all]",
                                  .facets = side_facets(&l, 63u, &facet),
                                  .kind = CONDITION_TABLE,
                                  .row_count = l.assembly.cells.node_count,
                                  .rows = rows,
                                  .unit = 1.0,
                                  .table = "table"};
    GOOD(assemble(&l, &all, 1, &note, &error));
    assert_string_equal(note.text, "");
    double *u = lattice_vector(&l), *field = lattice_vector(&l);
    struct statics_options to_rest = {.tolerance = 1e-8};
    struct statics_report report;
    GOOD(newton_run(&l.system, &to_rest, u, NULL, &report, &error));
    assert_int_equal(report.outcome, STATICS_CONVERGED);
    assembly_nodal_field(&l.assembly, u, field);
    for (int64_t n = 0; n < l.assembly.cells.node_count; n++) {
        ALL_NEAR(dim, field + n * dim, rows + n * 2 * dim + dim, 1e-9);
    }
}

/* Only the faces within one condition are held; those of a corner between two are not. */
TEST(held_faces)
{
    FREED_BY(lattice_free) struct lattice l = {0};
    SCRATCH int32_t *low = NULL, *high = NULL;
    SCRATCH bool *held = NULL;
    int64_t count = 0;
    struct lattice_options options = lattice_defaults(2, 5);
    lattice_build(&l, &options);
    const struct condition conditions[] = {
        {.facets = side_facets(&l, 1u << 2, &low), .kind = CONDITION_NORMAL},
        {.facets = side_facets(&l, 1u << 3, &high)}};
    l.assembly.conditions = conditions;
    l.assembly.condition_count = 2;
    GOOD(assembly_held_faces(&l.assembly, 1, &held, &error));
    for (int64_t f = 0; f < l.assembly.boundary.count; f++) {
        const double *a = l.assembly.cells.x + 2 * (int64_t)l.assembly.boundary.node[2 * f],
                     *b = l.assembly.cells.x + 2 * (int64_t)l.assembly.boundary.node[2 * f + 1];
        bool flat = a[1] == b[1] && (a[1] < 1e-9 || a[1] > 0.1 - 1e-9);
        assert_int_equal(held[f], flat);
        count += held[f];
    }
    assert_int_equal(count, 8);
}

/* Two conditions that share a corner: far apart an error that names both, a little apart a note. */
TEST(shared_corners)
{
    FREED_BY(lattice_free) struct lattice l = {0};
    struct error note, said;
    SCRATCH int32_t *low = NULL, *side = NULL;
    struct lattice_options options = lattice_defaults(2, 5);
    lattice_build(&l, &options);
    struct condition conditions[] = {
        {.name = "low", .where = "s:1: [displacement low]", .facets = side_facets(&l, 1u << 2, &low)},
        {.name = "side", .where = "s:2: [displacement side]", .facets = side_facets(&l, 1u, &side)}};
    conditions[1].components[1] = 1e-3;
    assert_int_equal(assemble(&l, conditions, 2, &note, &said), STATUS_INPUT);
    assert_ptr_equal(strstr(said.text, "s:2: [displacement side]: node "), said.text);
    assert_non_null(strstr(said.text, "0 m in [displacement low]"));
    conditions[0].components[1] = 0.95e-3;
    GOOD(assemble(&l, conditions, 2, &note, &error));
    assert_non_null(strstr(note.text, "is prescribed twice"));
    assert_string_equal(l.system.conditions[l.system.rows.section[0]].name, "low");
    conditions[0].components[1] = 1e-3;
    GOOD(assemble(&l, conditions, 2, &note, &error));
    assert_string_equal(note.text, "");
}

RUN_TESTS(NULL, NULL)
