/* Quadrature, faces of cells, tables of shape functions and their smoothing over smoothed cells. */
#include "box_fixture.h"
#include "cell_table.h"

#include "approx/cells/face_edges.h"
#include "approx/cells/quadrature.h"
#include "base/vector.h"

/* Integral of prod lambda_k^p_k over a simplex of volume 1: d! prod p_k! / (d + sum p_k)!. */
static double exact_monomial(int vertices, const int *power)
{
    double value = tgamma(vertices), sum = vertices;
    for (int k = 0; k < vertices; k++) {
        value *= tgamma(power[k] + 1.0);
        sum += power[k];
    }
    return value / tgamma(sum);
}

/* The largest error of a rule over all barycentric monomials of exactly that degree. */
static double degree_error(const struct quadrature_rule *rule, int degree)
{
    double worst = 0.0;
    int power[4];
    for (int code = 0; code < 4096; code++) {
        int sum = 0;
        for (int k = 0, rest = code; k < 4; k++, rest /= 8) {
            power[k] = rest % 8;
            sum += power[k];
        }
        if (sum != degree || (rule->vertices < 4 && power[3] > 0) || (rule->vertices < 3 && power[2] > 0)) {
            continue;
        }
        double value = -exact_monomial(rule->vertices, power);
        for (int q = 0; q < rule->points; q++) {
            double term = rule->weight[q];
            for (int k = 0; k < rule->vertices; k++) {
                term *= pow(rule->barycentric[q * rule->vertices + k], power[k]);
            }
            value += term;
        }
        worst = worse(worst, value);
    }
    return worst;
}

static void check_rule(const struct quadrature_rule *rule, int degree)
{
    for (int q = 0; q < rule->points; q++) {
        double sum = 0.0;
        assert_true(rule->weight[q] > 0.0);
        for (int k = 0; k < rule->vertices; k++) {
            assert_true(rule->barycentric[q * rule->vertices + k] > 0.0);
            sum += rule->barycentric[q * rule->vertices + k];
        }
        AT_MOST(fabs(sum - 1.0), 1e-14);
    }
    for (int d = 0; d <= degree; d++) {
        AT_MOST(degree_error(rule, d), 1e-14);
    }
    assert_true(degree_error(rule, degree + 1) > 1e-6);
}

TEST(quadrature_degrees)
{
    static const int rules[][3] = {{2, 1, 1},  {2, 3, 2}, {2, 4, 1}, {2, 6, 4}, {2, 7, 5},
                                   {2, 12, 6}, {3, 1, 1}, {3, 4, 2}, {3, 8, 3}, {3, 14, 5}};
    struct quadrature_rule rule;
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        GOOD(quadrature_cell_rule(rules[i][0], rules[i][1], &rule, &error));
        assert_int_equal(rule.points, rules[i][1]);
        assert_int_equal(rule.vertices, rules[i][0] + 1);
        check_rule(&rule, rules[i][2]);
    }
    rule = quadrature_face_rule(2);
    assert_int_equal(rule.points, 2);
    check_rule(&rule, 3);
    rule = quadrature_face_rule(3);
    assert_int_equal(rule.points, 3);
    check_rule(&rule, 2);
    FAILS(quadrature_cell_rule(2, 5, &rule, &error), STATUS_INPUT, "");
    FAILS(quadrature_cell_rule(3, 3, &rule, &error), STATUS_INPUT, "");
}

/* Volumes fill the box; the faces of each cell close; each face stands once, outward from its first cell. */
TEST_IN_EACH_DIM(cells_and_faces)
{
    FREED_BY(cloud_free) struct cloud cloud = box_cloud(dim, 6, dim == 2 ? 0.4 : 0.1, 1.0);
    struct cells cells = cells_of(&cloud);
    FREED_BY(faces_free) struct faces faces = {0}, boundary = {0};
    double volume = 0.0, area_unit = pow(0.1, dim - 1);
    GOOD(cells_check(&cells, &error));
    for (int64_t c = 0; c < cells.count; c++) {
        volume += cell_volume(&cells, c);
    }
    AT_MOST(fabs(volume / pow(0.1, dim) - 1.0), 1e-12);
    GOOD(faces_build(&cells, false, &faces, &error));
    GOOD(faces_build(&cells, true, &boundary, &error));
    double *closed = zeros(cells.count * dim, sizeof *closed);
    int *sides = zeros(cells.count, sizeof *sides);
    int64_t outer = 0;
    for (int64_t f = 0; f < faces.count; f++) {
        double area[3], centroid[3], outward = 0.0;
        face_area_vector(dim, cells.x, faces.node + f * dim, area);
        cell_centroid(&cells, faces.cell[2 * f], centroid);
        for (int a = 0; a < dim; a++) {
            outward += area[a] * (cells.x[(int64_t)faces.node[f * dim] * dim + a] - centroid[a]);
        }
        assert_true(outward > 0.0);
        for (int side = 0; side < 2; side++) {
            int32_t cell = faces.cell[2 * f + side];
            if (cell < 0) {
                assert_int_equal(side, 1);
                continue;
            }
            sides[cell]++;
            for (int a = 0; a < dim; a++) {
                closed[cell * dim + a] += side == 0 ? area[a] : -area[a];
            }
        }
        if (faces.cell[2 * f + 1] < 0) {
            assert_memory_equal(boundary.node + outer * dim, faces.node + f * dim,
                                (size_t)dim * sizeof(int32_t));
            assert_int_equal(boundary.cell[2 * outer + 1], -1);
            outer++;
        } else {
            assert_true(faces.cell[2 * f] < faces.cell[2 * f + 1]);
        }
    }
    assert_int_equal(outer, boundary.count);
    assert_int_equal(outer, dim == 2 ? 4 * 5 : 6 * 5 * 5 * 2);
    for (int64_t c = 0; c < cells.count; c++) {
        assert_int_equal(sides[c], dim + 1);
    }
    for (int64_t i = 0; i < cells.count * dim; i++) {
        AT_MOST(fabs(closed[i]) / area_unit, 1e-14);
    }
}

/* Averages over the faces and the table smoothed over the cells that they make. */
struct smoothed {
    struct cloud cloud;
    struct cells cells;
    struct faces faces;
    double *points; /* of the faces */
    struct table table;
    struct neighbours lists;
    struct shape_rows edges;
    struct cell_table smooth;
};

static void smoothed_build(struct smoothed *s, int dim, int64_t per_axis, enum basis basis, double offset)
{
    struct support_options options = options_for(dim, basis, WEIGHT_QUARTIC);
    s->cloud = box_cloud(dim, per_axis, dim == 2 ? 0.3 : 0.1, offset);
    s->cells = cells_of(&s->cloud);
    GOOD(faces_build(&s->cells, false, &s->faces, &error));
    int64_t count = face_point_count(&s->faces);
    s->points = malloc((size_t)(count * dim) * sizeof(double));
    assert_non_null(s->points);
    face_points(&s->faces, s->cells.x, s->points);
    GOOD(tabulate(&options, s->cells.node_count, s->cells.x, count, s->points, &s->table, &error));
    s->lists = s->table.lists;
    GOOD(shape_on_edges(&s->lists, s->table.phi, &s->faces, &s->edges, &error));
    struct neighbours edges = {.count = face_row_count(&s->faces), .ptr = s->edges.ptr, .idx = s->edges.idx};
    FREED_BY(table_free) struct table at_nodes = {0};
    GOOD(tabulate(&options, s->cells.node_count, s->cells.x, s->cells.node_count, s->cells.x, &at_nodes,
                  &error));
    struct neighbours nodes = at_nodes.lists;
    const struct cell_sources sources = {&edges, &nodes, s->edges.phi, at_nodes.phi};
    s->smooth = cell_table_make(&s->cells, &s->faces, &sources);
}

static void smoothed_free(struct smoothed *s)
{
    shape_rows_free(&s->edges);
    cell_table_free(&s->smooth);
    table_free(&s->table);
    faces_free(&s->faces);
    cloud_free(&s->cloud);
    free(s->points);
}

/* sum phi = 1, sum phi x = centroid, sum grad phi = 0, sum grad phi x^T = I: so linear fields are exact. */
TEST_IN_EACH_DIM(smoothing_is_consistent)
{
    for (int b = 0; b < BASIS_COUNT; b++) {
        for (double offset = 0.0; offset <= 1.0; offset += 1.0) {
            FREED_BY(smoothed_free) struct smoothed s = {0};
            int64_t per_axis = dim == 2 ? 9 : 6;
            smoothed_build(&s, dim, per_axis, (enum basis)b, offset);
            double *centroids = zeros(s.cells.count * dim, sizeof *centroids);
            for (int64_t c = 0; c < s.cells.count; c++) {
                cell_centroid(&s.cells, c, centroids + c * dim);
                for (int64_t i = s.smooth.ptr[c] + 1; i < s.smooth.ptr[c + 1]; i++) {
                    assert_true(s.smooth.idx[i] > s.smooth.idx[i - 1]);
                }
            }
            struct table view = {.phi = s.smooth.phi,
                                 .dphi = s.smooth.dphi,
                                 .lists = {.count = s.cells.count, .ptr = s.smooth.ptr, .idx = s.smooth.idx}};
            struct defects worst =
                table_defects(&view, dim, s.cells.x, centroids, 0.2 / (double)(per_axis - 1));
            AT_MOST(worst.unity, 1e-12);
            AT_MOST(worst.position, 1e-12);
            AT_MOST(worst.gradient_sum, 1e-12);
            AT_MOST(worst.gradient_position, 1e-12);
        }
    }
}

/* Each row is the mean of the values at its points. */
TEST_IN_EACH_DIM(rows_of_edges)
{
    FREED_BY(smoothed_free) struct smoothed s = {0};
    smoothed_build(&s, dim, dim == 2 ? 9 : 6, BASIS_MODIFIED, 0.0);
    double *row = zeros(s.cells.node_count, sizeof *row);
    for (int64_t r = 0; r < face_row_count(&s.faces); r++) {
        int count;
        int64_t first = face_row_points(&s.faces, r, &count);
        int64_t begin = s.lists.ptr[first], end = s.lists.ptr[first + count];
        for (int64_t i = begin; i < end; i++) {
            row[s.lists.idx[i]] += s.table.phi[i] / count;
        }
        for (int64_t i = s.edges.ptr[r]; i < s.edges.ptr[r + 1]; i++) {
            assert_true(i == s.edges.ptr[r] || s.edges.idx[i] > s.edges.idx[i - 1]);
            AT_MOST(fabs(s.edges.phi[i] - row[s.edges.idx[i]]), 1e-15);
            row[s.edges.idx[i]] = 0.0;
        }
        for (int64_t i = begin; i < end; i++) {
            assert_true(row[s.lists.idx[i]] == 0.0); /* nobody is left out */
        }
    }
}

RUN_TESTS(NULL, NULL)
