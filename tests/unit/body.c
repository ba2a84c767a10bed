/* The force loop: no forces from rigid motion, forces that are the gradient of the energy and balance, exact
 * linear fields, and reported errors. */
#include "base/vector.h"
#include "body_setup.h"

/* Translation, quarter turns and other rotations make no forces, and no energy. */
static void check_rigid_motion(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    FREED_BY(body_free) struct body body = make_body(sample, setup);
    double *force = zeros(count, sizeof *force);
    double scale =
        50.0 * setup->material[0].shear_modulus * (sample->dim == 2 ? 1.0 : sample_size) * sample_size;
    for (int motion = 0; motion < 5; motion++) {
        double angle = motion == 0 ? 0.0 : motion < 3 ? M_PI / 2.0 * motion : uniform(random, -3.0, 3.0);
        double c = motion == 1 ? 0.0 : cos(angle), s = sin(angle);
        double about_z[9] = {c, -s, 0, s, c, 0, 0, 0, 1}, about_x[9] = {1, 0, 0, 0, c, -s, 0, s, c};
        double *u = linear_field(sample, motion == 4 && sample->dim == 3 ? about_x : about_z,
                                 (double[]){0.1, -0.05, 0.03});
        struct deformation deformation = body_force(&body, u, force);
        NEAR_TO(deformation.least_jacobian, 1.0, 1e-12);
        AT_MOST(largest(force, count), 1e-12 * scale);
        NEAR_TO(body_energy(&body, u), 0.0, 1e-12 * scale);
    }
}

TEST(rigid_motion)
{
    for_all(check_rigid_motion);
}

static void check_gradient(const struct sample *sample, const struct setup *setup, struct random *random)
{
    FREED_BY(body_free) struct body body = make_body(sample, setup);
    double *force = zeros(sample->cloud.node_count * sample->dim, sizeof *force);
    check_work(sample, &body, deformed_field(sample, &body, force, random), 5, random);
}

TEST(force_is_gradient)
{
    for_all(check_gradient);
}

/* Internal forces have neither sum nor moment. */
static void check_balance(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int dim = sample->dim;
    int64_t count = sample->cloud.node_count * dim;
    FREED_BY(body_free) struct body body = make_body(sample, setup);
    double *force = zeros(count, sizeof *force);
    double *u = deformed_field(sample, &body, force, random);
    double sum[3] = {0.0}, moment[3] = {0.0}, size;
    (void)body_force(&body, u, force);
    size = largest(force, count);
    assert_true(size > 1e-3);
    for (int64_t n = 0; n < sample->cloud.node_count; n++) {
        for (int a = 0; a < dim; a++) {
            int b = (a + 1) % dim;
            const double *X = sample->cloud.x + n * dim;
            sum[a] += force[n * dim + a];
            moment[a] +=
                (X[a] + u[n * dim + a]) * force[n * dim + b] - (X[b] + u[n * dim + b]) * force[n * dim + a];
        }
    }
    for (int a = 0; a < dim; a++) {
        NEAR_TO(sum[a], 0.0, 1e-12 * size);
        NEAR_TO(moment[a], 0.0, 1e-12 * size * sample_size);
    }
}

TEST(balance)
{
    for_all(check_balance);
}

/* Under u = (A - I) x every point has F = A, in the caller's order, and the stress of its own material; the
 * energy is that of the volume. */
static void check_linear(const struct sample *sample, const struct setup *setup, struct random *random)
{
    static const double plane[9] = {1.2, 0.3, 0, -0.1, 0.9, 0, 0, 0, 1};
    static const double space[9] = {1.2, 0.3, 0.1, -0.1, 0.9, 0.2, 0.05, -0.3, 1.1};
    const double *A = sample->dim == 2 ? plane : space;
    FREED_BY(body_free) struct body body = make_body(sample, setup);
    double *u = linear_field(sample, A, (double[]){0.1, 0.2, -0.3}), C[9], J = determinant(A), energy = 0.0;
    double *F = zeros(sample->assembly.point_count * 9, sizeof *F);
    double *P = zeros(sample->assembly.point_count * 9, sizeof *P);
    double *force = zeros(sample->cloud.node_count * sample->dim, sizeof *force), volume = 0.0;
    (void)random;
    struct deformation deformation = body_force(&body, u, force);
    NEAR_TO(deformation.least_jacobian, J, 1e-12);
    body_gradient(&body, F);
    body_stress(&body, P);
    cofactor(A, C);
    for (int64_t q = 0; q < sample->assembly.point_count; q++) {
        const struct material *material = &setup->material[material_at(sample, setup, q)];
        double expected[9];
        material_isochoric_stress(material, A, expected);
        for (int i = 0; i < 9; i++) {
            NEAR_TO(F[9 * q + i], A[i], 1e-12);
            NEAR_TO(P[9 * q + i], expected[i] + material_pressure(material, J) * C[i], 1e-7);
        }
        volume += sample->assembly.weight[q];
        energy += sample->assembly.weight[q] *
                  (material_isochoric_energy(material, A) + material_volume_energy(material, J));
    }
    NEAR_TO(volume, pow(sample_size, sample->dim), 1e-15);
    NEAR_TO(body_energy(&body, u), energy, 1e-11 * energy);
    volume = 0.0;
    for (int64_t q = 0; q < body.point_count; q++) {
        volume += body.weight[q];
    }
    NEAR_TO(volume, pow(sample_size, sample->dim), 1e-15);
}

TEST(linear_fields)
{
    for_all(check_linear);
}

/* Tables that are not those of the faces or nodes. */
static void fault_of_smoothing(void)
{
    struct body body;
    struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, false);
    struct sample *sample = &samples[0];
    int32_t *material = zeros(sample->assembly.point_count, sizeof *material);
    struct body_input input = sample_input(sample, true, setup.material, 1, material);
    input.cell = NULL;
    double *edge_phi = stream_find(&sample->stream, "edge.phi")->data,
           *node_phi = stream_find(&sample->stream, "node.phi")->data;
    double *changed = &edge_phi[sample->assembly.lists.ptr[7]], before = *changed;
    *changed += 0.01;
    FAILS_WITH(body_build(&input, &body, &error), STATUS_INPUT,
               "edge.phi: edge 7: not the shape functions at this edge: run shapefn again");
    body_free(&body);
    *changed = before;
    changed = &node_phi[sample->assembly.node_lists.ptr[5]];
    before = *changed;
    *changed += 0.01;
    FAILS_WITH(body_build(&input, &body, &error), STATUS_INPUT,
               "node.phi: node 5: not the shape functions at this node: run shapefn again");
    body_free(&body);
    *changed = before;
    struct faces fewer = sample->assembly.faces;
    fewer.count--;
    input.faces = &fewer;
    FAILS(body_build(&input, &body, &error), STATUS_INPUT, "lacks a face: run ipoints for smoothed cells");
    body_free(&body);
}

TEST(faults)
{
    struct body body;
    static const struct material material = {.shear_modulus = 1.0, .bulk_modulus = 1.0};
    static const double x[4] = {0.0}, dphi[4] = {0.0};
    static const int32_t none[2] = {0};
    double weight[2] = {1.0, 1.0};
    int64_t ptr[3] = {0, 2, 2};
    struct neighbours lists = {.count = 2, .ptr = ptr, .idx = (int32_t[]){0, 1}};
    struct body_input input = {.cells = {.dim = 2, .node_count = 2, .x = x},
                               .point_count = 2,
                               .x = x,
                               .weight = weight,
                               .lists = &lists,
                               .dphi = dphi,
                               .materials = &material,
                               .material = none,
                               .material_count = 1};
    FAILS_WITH(body_build(&input, &body, &error), STATUS_INPUT,
               "points.weight: row 1: no weight or no neighbours");
    body_free(&body);
    ptr[1] = 1;
    weight[0] = (double)NAN;
    FAILS_WITH(body_build(&input, &body, &error), STATUS_INPUT,
               "points.weight: row 0: no weight or no neighbours");
    body_free(&body);
    weight[0] = 1.0;
    GOOD(body_build(&input, &body, &error));
    body_free(&body);
    input.point_count = 0;
    FAILS_WITH(body_build(&input, &body, &error), STATUS_INPUT, "points.x: 0 points: none, or too many");
    fault_of_smoothing();
}

/* The Cauchy stress of smoothed cells is symmetric in any state, as a rotation changes no energy. */
static void check_symmetry(const struct sample *sample, const struct setup *setup, struct random *random)
{
    FREED_BY(body_free) struct body body = make_body(sample, setup);
    int64_t count = sample->cloud.node_count * sample->dim, points = sample->assembly.point_count;
    double *F = zeros(points * 9, sizeof *F), *P = zeros(points * 9, sizeof *P);
    double *force = zeros(count, sizeof *force), *u = deformed_field(sample, &body, force, random),
           most = 0.0;
    (void)body_force(&body, u, force);
    body_gradient(&body, F);
    body_stress(&body, P);
    for (int64_t i = 0; i < points * 9; i++) {
        most = fmax(most, fabs(P[i]));
    }
    for (int64_t q = 0; q < points; q++) {
        for (int i = 0; i < 9; i++) {
            const double *p = P + 9 * q, *f = F + 9 * q;
            double one = vector_dot(3, p + i / 3 * 3, f + i % 3 * 3);
            double other = vector_dot(3, p + i % 3 * 3, f + i / 3 * 3);
            NEAR_TO(one, other, 1e-10 * most);
        }
    }
}

TEST(cauchy_stress_is_symmetric)
{
    for_all(check_symmetry);
}

/* A body of many blocks: forces from the caller's
 * table and the stresses, one point after the other; of smoothed cells as the slope of the energy. */
TEST(many_blocks)
{
    struct random random = {7};
    for (int i = 0; i < 4; i++) {
        bool by_faces = i >= 2;
        FREED_BY(sample_free) struct sample sample = make_sample(2, by_faces, by_faces ? 80 : 45);
        struct setup setup = three_materials(i % 2 == 1);
        setup.faces = by_faces;
        FREED_BY(body_free) struct body body = make_body(&sample, &setup);
        int64_t count = sample.cloud.node_count * 2;
        double *force = zeros(count, sizeof *force), *expected = zeros(count, sizeof *expected);
        double *P = zeros(sample.assembly.point_count * 9, sizeof *P);
        double *u = deformed_field(&sample, &body, force, &random);
        assert_true(body.block_count > 30);
        (void)body_force(&body, u, force);
        body_stress(&body, P);
        for (int64_t q = 0; q < sample.assembly.point_count && !by_faces; q++) {
            for (int64_t k = sample.lists.ptr[q] * 2; k < sample.lists.ptr[q + 1] * 2; k++) {
                for (int a = 0; a < 2; a++) {
                    expected[sample.lists.idx[k / 2] * 2 + a] +=
                        sample.assembly.weight[q] * P[9 * q + 3 * a + k % 2] * sample.dphi[k];
                }
            }
        }
        for (int64_t k = 0; k < count && !by_faces; k++) {
            NEAR_TO(force[k], expected[k], 1e-12 * largest(expected, count));
        }
        memcpy(expected, force, (size_t)count * sizeof *force);
        for (body.threads = 2; body.threads < 4; body.threads++) {
            (void)body_force(&body, u, force);
            assert_memory_equal(force, expected, (size_t)count * sizeof *force);
        }
        check_work(&sample, &body, u, 1, &random);
    }
}

RUN_TESTS(make_samples, free_samples)
