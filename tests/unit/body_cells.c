/* Smoothed cells in the force loop: gradients as those of the table, and volume ratios that make up the
 * volume within the boundary. */
#include "body_setup.h"

#include "approx/cells/quadrature.h"
#include "base/vector.h"
#include "solid/body/nodal_offset.h"
#include "solid/body/stress.h"

/* Displacement at a node, or mean over a face, from the tables of shape functions. */
static void value_at_node(const struct sample *sample, int64_t node, const double *u, double *value)
{
    int dim = sample->dim;
    memset(value, 0, 3 * sizeof *value);
    for (int64_t i = sample->assembly.node_lists.ptr[node]; i < sample->assembly.node_lists.ptr[node + 1];
         i++) {
        for (int a = 0; a < dim; a++) {
            value[a] +=
                sample->assembly.node_phi[i] * u[(int64_t)sample->assembly.node_lists.idx[i] * dim + a];
        }
    }
}

static void mean_of_face(const struct sample *sample, int64_t face, const double *u, double *mean)
{
    int dim = sample->dim, points = FACE_POINTS(dim);
    const struct quadrature_rule rule = quadrature_face_rule(dim);
    memset(mean, 0, 3 * sizeof *mean);
    for (int64_t p = face * points; p < (face + 1) * points; p++) {
        for (int64_t i = sample->assembly.boundary_lists.ptr[p];
             i < sample->assembly.boundary_lists.ptr[p + 1]; i++) {
            double share = rule.weight[p % points] * sample->assembly.boundary_phi[i];
            add_scaled(dim, share, u + (int64_t)sample->assembly.boundary_lists.idx[i] * dim, mean);
        }
    }
}

/* Area vector of a facet with corners x, by its cross product; its sense is that of the corners. */
static void area_of(int dim, double x[3][3], double area[3])
{
    double a[3], b[3];
    for (int i = 0; i < 3; i++) {
        a[i] = x[1][i] - x[0][i];
        b[i] = dim == 3 ? 0.5 * (x[2][i] - x[0][i]) : i == 2 ? 1.0 : 0.0;
    }
    vector_cross(a, b, area);
}

/* What a facet of the boundary adds to the volume inside: of the cone over the triangle of its deformed
 * corners, and what lies between that and the face, whose mean is known. */
static double volume_below(const struct sample *sample, int64_t face, const double *u)
{
    int dim = sample->dim;
    const int32_t *vertex = sample->assembly.faces.node + face * dim, *cell = sample->assembly.cells.node;
    double rest[3][3] = {{0.0}}, x[3][3] = {{0.0}}, inside[3] = {0.0}, centre[3] = {0.0}, mean[3], area[3];
    cell += (int64_t)sample->assembly.faces.cell[2 * face] * (dim + 1);
    mean_of_face(sample, face, u, mean);
    for (int k = 0; k < dim; k++) {
        double value[3];
        value_at_node(sample, vertex[k], u, value);
        for (int a = 0; a < dim; a++) {
            rest[k][a] = sample->cloud.x[(int64_t)vertex[k] * dim + a];
            x[k][a] = rest[k][a] + value[a];
            centre[a] += x[k][a] / dim;
            mean[a] += rest[k][a] / dim;
        }
    }
    for (int k = 0; k <= dim; k++) { /* from the facet into its cell */
        for (int a = 0; a < dim; a++) {
            inside[a] += sample->cloud.x[(int64_t)cell[k] * dim + a] - rest[0][a];
        }
    }
    area_of(dim, rest, area);
    double sense = vector_dot(3, area, inside) < 0.0 ? 1.0 : -1.0;
    area_of(dim, x, area);
    for (int a = 0; a < 3; a++) {
        mean[a] += centre[a] / dim - centre[a];
    }
    return sense * vector_dot(3, mean, area);
}

/* Whatever the field, the volume ratios of smoothed cells make up the volume within the boundary. */
TEST(enclosed_volume)
{
    struct random random = {17};
    for (int i = 0; i < 4; i += 2) {
        const struct sample *sample = &samples[i];
        struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, true);
        setup.faces = true;
        FREED_BY(body_free) struct body body = make_body(sample, &setup);
        double *u = random_field(sample, 0.05 * sample_size, &random), sum = 0.0, averages = 0.0,
               inside = 0.0;
        double *F = zeros(sample->assembly.point_count * 9, sizeof *F), rest = pow(sample_size, sample->dim);
        (void)body_energy(&body, u);
        body_gradient(&body, F);
        for (int64_t q = 0; q < body.point_count; q++) {
            sum += body.weight[q] * body.J[q];
            averages += body.weight[q] * determinant(F + 9 * body.order.points[q]);
        }
        for (int64_t f = 0; f < sample->assembly.faces.count; f++) {
            inside += sample->assembly.faces.cell[2 * f + 1] < 0 ? volume_below(sample, f, u) : 0.0;
        }
        NEAR_TO(sum, inside, 1e-13 * rest);

        assert_true(fabs(averages - inside) > 1e-4 * rest); /* the determinants of the averages do not */
    }
}

/* Smoothed cells by averages over their faces: the gradients of the table, but for round-off; and for a small
 * field, where J differs from det F by a square, its forces and energy. */
TEST(faces)
{
    struct random random = {11};
    for (int i = 0; i < 4; i += 2) {
        for (int kind = 0; kind < 2; kind++) {
            const struct sample *sample = &samples[i];
            struct setup setup = three_materials(kind == 1);
            int64_t count = sample->cloud.node_count * sample->dim, size = sample->assembly.point_count * 9;
            FREED_BY(body_free) struct body by_table = make_body(sample, &setup);
            setup.faces = true;
            FREED_BY(body_free) struct body by_faces = make_body(sample, &setup);
            double *force = zeros(count, sizeof *force), *expected = zeros(count, sizeof *expected);
            double *F = zeros(size, sizeof *F), *F_expected = zeros(size, sizeof *F_expected);
            double *u = deformed_field(sample, &by_table, expected, &random);
            struct deformation least = body_force(&by_table, u, expected),
                               other = body_force(&by_faces, u, force);
            body_gradient(&by_table, F_expected);
            body_gradient(&by_faces, F);
            ALL_NEAR(size, F, F_expected, 1e-12);
            NEAR_TO(least.least_jacobian, other.least_jacobian, 1e-12);
            assert_int_equal(least.point, other.point);
            for (int64_t k = 0; k < count; k++) {
                u[k] *= 1e-5; /* the two volume ratios differ by a square */
            }
            double energy = body_energy(&by_table, u), of_faces = body_energy(&by_faces, u);
            double stabilised = nodal_offsets_energy(&by_faces);
            for (int64_t q = 0; q < by_faces.point_count; q++) {
                double volumetric;
                stabilised += stress_variance_energy(&by_faces, q, &volumetric);
                stabilised += volumetric;
            }
            assert_true(stabilised > 0.0);
            NEAR_TO(of_faces - stabilised, energy, 1e-4 * energy);
        }
    }
}

/* The kernels of the neo-Hookean law and what serves all laws, one cell at a time: the same forces. */
TEST(general_law)
{
    struct random random = {13};
    for (int i = 0; i < 8; i++) {
        const struct sample *sample = &samples[i % 4];
        int64_t count = sample->cloud.node_count * sample->dim;
        struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, i < 4);
        setup.faces = sample->smoothed;
        FREED_BY(body_free) struct body body = make_body(sample, &setup);
        double *force = zeros(count, sizeof *force), *expected = zeros(count, sizeof *expected);
        double *u = deformed_field(sample, &body, force, &random);
        (void)body_force(&body, u, force);
        for (int64_t b = 0; b < body.block_count; b++) {
            assert_true(body.blocks[b].neo_hookean);
            body.blocks[b].neo_hookean = false;
        }
        (void)body_force(&body, u, expected);
        ALL_NEAR(count, force, expected, 1e-12 * largest(expected, count));
    }
}

RUN_TESTS(make_samples, free_samples)
