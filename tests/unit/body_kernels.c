/* How the force loop computes: the same bits from any number of threads, nodal volumes, the bound of the
 * stiffness, and the place of an inversion. */
#include "body_setup.h"

#include "solid/body/kernel.h"
#include "solid/body/nodal_volume.h"

/* The same bits for 1, 2 and 3 threads, and from one call to the next. */
static void check_threads(const struct sample *sample, const struct setup *setup, struct random *random)
{
    if (setup->model_count == 1 && (setup->averaged || setup->material[0].model != MATERIAL_NEO_HOOKEAN)) {
        return; /* threads that wait for each other are slow on a busy machine: not for every law */
    }
    int64_t count = sample->cloud.node_count * sample->dim;
    double *first = NULL, *u = random_field(sample, 1e-3, random), energy = 0.0;
    int before = omp_get_max_threads();
    for (int threads = 1; threads <= 3; threads++) {
        omp_set_num_threads(threads);
        FREED_BY(body_free) struct body body = make_body(sample, setup);
        double *force = zeros(count, sizeof *force);
        body.threads = threads; /* also where so many would not pay */
        for (int call = 0; call < 2; call++) {
            (void)body_force(&body, u, force);
            if (first == NULL) {
                first = zeros(count, sizeof *first);
                memcpy(first, force, (size_t)count * sizeof *first);
                energy = body_energy(&body, u);
            }
            assert_memory_equal(force, first, (size_t)count * sizeof *first);
            NEAR_TO(body_energy(&body, u), energy, 0.0);
        }
    }
    omp_set_num_threads(before);
}

TEST(threads)
{
    for_all(check_threads);
}

/* Averaging changes nothing where the bulk modulus is at most twice the shear modulus and U is a square. */
TEST(compressible)
{
    struct random random = {2};
    for (int i = 0; i < 4; i++) {
        const struct sample *sample = &samples[i];
        struct setup none = three_materials(false), whole = three_materials(true);
        for (int m = 0; m < 3; m++) {
            none.material[m].bulk_modulus = whole.material[m].bulk_modulus =
                1.5 * none.material[m].shear_modulus;
        }
        FREED_BY(body_free) struct body one = make_body(sample, &none), other = make_body(sample, &whole);
        int64_t count = sample->cloud.node_count * sample->dim;
        double *force = zeros(count, sizeof *force), *expected = zeros(count, sizeof *expected);
        double *u = deformed_field(sample, &one, force, &random), energy = body_energy(&one, u);
        (void)body_force(&one, u, expected);
        (void)body_force(&other, u, force);
        ALL_NEAR(count, force, expected, 1e-12 * largest(expected, count));
        NEAR_TO(body_energy(&other, u), energy, 1e-12 * energy);
    }
}

/* Nodal volumes share out the body, and its change of volume, among nodes and materials. */
TEST_IN_EACH_DIM(nodal_volumes)
{
    struct random random = {3};
    FREED_BY(sample_free) struct sample sample = make_sample(dim, false, 5);
    struct setup setup = three_materials(true);
    FREED_BY(body_free) struct body body = make_body(&sample, &setup);
    const struct nodal_volumes *volumes = &body.volumes;
    double *u = random_field(&sample, 1e-3, &random), volume = 0.0, content = 0.0, carried = 0.0,
           expected = 0.0;
    (void)body_energy(&body, u);
    for (int64_t a = 0; a < volumes->count; a++) {
        int32_t material = body.material[volumes->slot[volumes->ptr[a]] / (dim + 1)];
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
            int32_t slot = volumes->slot[i];
            volume += volumes->share[slot];
            assert_int_equal(volumes->of_point[slot], a);
            assert_int_equal(body.material[slot / (dim + 1)], material);
        }
        content += volumes->content[a];
    }
    for (int64_t q = 0; q < body.point_count; q++) {
        const struct material *material = &body.materials[body.material[q]];
        if (material_bulk(material) > nodal_volume_modulus(material)) {
            carried += body.weight[q];
            expected += body.weight[q] * material_volume_strain(material, body.J[q]);
        }
    }
    NEAR_TO(volume, carried, 1e-15);
    NEAR_TO(content, expected, 1e-15);
    assert_true(volumes->count > sample.cloud.node_count); /* some nodes lie between materials */
}

static double factorial(int n)
{
    return n > 1 ? n * factorial(n - 1) : 1.0;
}

/* The pressure projection is the compliance of a bubble in a regular cell, here with gradients of N of length
 * one. The mean over a simplex of a product of powers a_k of the N_k is d! prod a_k! / (d + sum a_k)!. */
TEST_IN_EACH_DIM(pressure_projection)
{
    struct material material = {.shear_modulus = 3.0, .stiffness = 1.0};
    double bubble = factorial(dim) / factorial(2 * dim + 1), stiffness = 0.0, gradient = 0.0, mean = 0.0,
           square = 0.0, pressure[] = {0.3, -1.1, 2.0, 0.7};
    for (int i = 0; i <= dim; i++) {
        mean += pressure[i] / (dim + 1);
        square += pressure[i] * pressure[i] / (dim + 1);
        for (int j = 0; j <= dim; j++) {
            double product = i == j ? 1.0 : -1.0 / dim;
            gradient += product * pressure[i] * pressure[j];
            stiffness += product * factorial(dim) * pow(2.0, i == j ? dim : dim - 1) / factorial(3 * dim);
        }
    }
    stiffness *= material.shear_modulus * (1.0 + 1.0 / dim);
    NEAR_TO(nodal_pressure_compliance(&material, dim) * (square - mean * mean),
            bubble * bubble * gradient / stiffness, 1e-14);
}

/* at_edge[nodes]: nodes on two sides of the first axis' lower side. */
static bool *edge_nodes(const struct sample *sample)
{
    bool *at_edge;
    ARRAY(at_edge, sample->cloud.node_count);
    for (int64_t n = 0; n < sample->cloud.node_count; n++) {
        const double *x = sample->cloud.x + n * sample->dim;
        at_edge[n] = x[0] <= 0.0 && (x[1] <= 0.0 || x[1] >= sample_size);
    }
    return at_edge;
}

/* Nodes at edges have no nodal volume, the others share all; means are taken at some nodes only. */
static void check_shares(const struct sample *sample, const struct body *body, const bool *at_edge)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    double volume = 0.0, whole = 0.0;
    int64_t means = 0;
    for (int64_t q = 0; q < body->point_count; q++) {
        whole += body->weight[q];
        for (int64_t s = q * vertices; s < (q + 1) * vertices; s++) {
            int64_t cell = sample->assembly.point_cell[body->order.points[q]];
            int32_t node = sample->assembly.cells.node[cell * vertices + s - q * vertices];
            volume += volumes->share[s];
            assert_true(at_edge[node] == !(volumes->share[s] > 0.0));
        }
    }
    NEAR_TO(volume, whole, 1e-15);
    for (int64_t a = 0; a < volumes->count; a++) {
        means += volumes->modulus[a] > 0.0;
    }
    assert_true(means > 3 && means < volumes->count / 2);
}

/* Of bodies with edges forces are the gradient of the energy, also where materials share nodal volumes; a
 * uniform change of volume meets the bulk modulus. */
TEST_IN_EACH_DIM(edges)
{
    struct random random = {5};
    FREED_BY(sample_free) struct sample sample = make_sample(dim, true, 5);
    SCRATCH bool *at_edge = edge_nodes(&sample);
    struct setup one = one_material(MATERIAL_NEO_HOOKEAN, true), three = three_materials(true),
                 other = one_material(law_find("neo-hookean-log"), true);
    one.faces = three.faces = other.faces = true;
    one.at_edge = three.at_edge = other.at_edge = at_edge;
    three.group = (int32_t[]){0, 0, 1};
    FREED_BY(body_free)
    struct body body = make_body(&sample, &one), mixed = make_body(&sample, &three),
                logarithmic = make_body(&sample, &other);
    double *u = linear_field(&sample, (double[]){1.01, 0, 0, 0, 1.01, 0, 0, 0, 1.01}, NULL);
    double pressure = material_pressure(&one.material[0], dim == 2 ? 1.0201 : 1.030301);
    (void)body_energy(&body, u);
    for (int64_t q = 0; q < body.point_count; q++) {
        NEAR_TO(nodal_volume_pressure(&body, q), pressure, 1e-9 * pressure);
    }
    check_shares(&sample, &body, at_edge);
    double *force = zeros(sample.cloud.node_count * dim, sizeof *force);
    check_work(&sample, &body, deformed_field(&sample, &body, force, &random), 1, &random);
    check_work(&sample, &mixed, deformed_field(&sample, &mixed, force, &random), 1, &random);
    check_work(&sample, &logarithmic, deformed_field(&sample, &logarithmic, force, &random), 1, &random);
}

/* A body of one material, of that Poisson's ratio. */
static struct body make_alike(const struct sample *sample, double poisson_ratio)
{
    struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, true);
    material_set_moduli(&setup.material[0], 3000.0, poisson_ratio);
    return make_body(sample, &setup);
}

/* The pressures solve A pi = b to what is stated of Chebyshev's iterations. */
TEST(nodal_pressures)
{
    const double poisson_ratio[3] = {0.49, 0.4999, 0.49999};
    for (int k = 0; k < 6; k++) {
        FREED_BY(sample_free) struct sample sample = make_sample(2 + k % 2, false, 5);
        FREED_BY(body_free) struct body body = make_alike(&sample, poisson_ratio[k / 2]);
        struct nodal_volumes *volumes = &body.volumes;
        /* A pi - b of any b, against b. */
        const struct nodal_pressures *pressures = &volumes->pressures;
        double missing2 = 0.0, whole2 = 0.0;
        for (int64_t a = 0; a < volumes->count; a++) {
            volumes->content[a] = sin(1.0 + (double)(a * a % 89)) / pressures->inverse[a];
        }
        nodal_pressures_solve(&body);
        for (int64_t a = 0; a < volumes->count; a++) {
            double sum = -volumes->content[a];
            for (int64_t at = pressures->matrix.ptr[a]; at < pressures->matrix.ptr[a + 1]; at++) {
                sum += pressures->matrix.value[at] * volumes->pressure[pressures->matrix.idx[at]];
            }
            missing2 += sum * sum;
            whole2 += volumes->content[a] * volumes->content[a];
        }
        AT_MOST(sqrt(missing2 / whole2),
                2.0 * 0.02 / 0.98); /* by the iterations, and scaled for uniform ones */
    }
}

/* Nodal volumes of no size, between two materials of a group, count for nothing. */
TEST(empty_volumes)
{
    FREED_BY(body_free) struct body body = {0};
    struct material material[2] = {make_material(MATERIAL_NEO_HOOKEAN, 3000.0),
                                   make_material(MATERIAL_NEO_HOOKEAN, 6000.0)};
    struct neighbours lists = {.count = 2, .ptr = (int64_t[]){0, 3, 6}, .idx = (int32_t[]){0, 1, 2, 0, 2, 3}};
    struct body_input input = {.cells = {.dim = 2,
                                         .node_count = 4,
                                         .x = (double[]){0, 0, 1, 0, 0, 1, -1, 0},
                                         .count = 2,
                                         .node = (int32_t[]){0, 1, 2, 0, 2, 3}},
                               .point_count = 2,
                               .x = (double[]){0.5, 0.0, -0.6, 0.0},
                               .weight = (double[]){0.5, 0.5},
                               .cell = (int32_t[]){0, 1},
                               .lists = &lists,
                               .dphi = (double[]){-1, 0, 1, -1, 0, 1, 0, -1, 1, 0, -1, 1},
                               .materials = material,
                               .material = (int32_t[]){0, 1},
                               .material_count = 2,
                               .group = (int32_t[]){0, 0}};
    double u[8] = {0.0, 0.0, 0.1, 0.0, 0.0, 0.2, 0.0, 0.1}, force[8];
    GOOD(body_build(&input, &body, &error));
    (void)body_force(&body, u, force);
    for (int i = 0; i < 8; i++) {
        assert_true(isfinite(force[i]));
    }
    assert_true(body_energy(&body, u) > 0.0);
}

/* The bound of the stiffness, at rest and deformed: no diagonal entry exceeds it, and at rest, but for the
 * stabilisation of cells, the sum over the components is known. */
TEST(diagonal)
{
    struct random random = {5};
    for (int i = 0; i < 6; i++) {
        /* the stabilisation of cells is bounded roughly */
        bool by_faces = i >= 4, deformed = !by_faces && i % 2 == 1;
        const struct sample *sample = &samples[by_faces ? (i - 4) * 2 : i / 2 * 2];
        int dim = sample->dim;
        struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, false);
        setup.faces = by_faces;
        FREED_BY(body_free) struct body body = make_body(sample, &setup);
        int64_t count = sample->cloud.node_count * dim;
        double mu = setup.material[0].shear_modulus, h = 1e-8;
        double wave = material_wave_modulus(&setup.material[0]), lambda = wave - 2.0 * mu;
        double *bound = zeros(sample->cloud.node_count, sizeof *bound);
        double *force = zeros(count, sizeof *force);
        double *u = deformed ? deformed_field(sample, &body, force, &random) : zeros(count, sizeof *u);
        (void)body_force(&body, u, force);
        body_diagonal(&body, false, bound);
        for (int64_t n = 0; n < sample->cloud.node_count; n++) {
            double trace = 0.0;
            for (int64_t k = n * dim; k < (n + 1) * dim; k++) {
                double at = u[k], low;
                u[k] = at - h;
                (void)body_force(&body, u, force);
                low = force[k];
                u[k] = at + h;
                (void)body_force(&body, u, force);
                u[k] = at;
                AT_MOST((force[k] - low) / (2.0 * h), bound[n] * (1.0 + 1e-6));
                trace += (force[k] - low) / (2.0 * h);
            }
            if (!deformed && !by_faces) {
                NEAR_TO(trace, bound[n] * (lambda + (dim + 1) * mu) / wave, 1e-6 * bound[n]);
            }
        }
    }
}

/* The least J and where it is, inverted or not; not a number counts as the worst. */
static void check_inversion(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int dim = sample->dim;
    int64_t count = sample->cloud.node_count * dim, nodes = sample->cloud.node_count;
    FREED_BY(body_free) struct body body = make_body(sample, setup);
    double *force = zeros(count, sizeof *force), *F = zeros(sample->assembly.point_count * 9, sizeof *F);
    double *u = random_field(sample, 1e-4, random);
    for (int round = 0; round < 4; round++) {
        int64_t node = (int64_t)uniform(random, 0.0, (double)nodes), least = 0;
        double inward = sample->cloud.x[node * dim] < 0.5 * sample_size ? 1.0 : -1.0;
        u[node * dim] += 3.0 * sample_size * inward; /* through its neighbours */
        struct deformation deformation = body_force(&body, u, force);
        body_gradient(&body, F);
        for (int64_t q = 0; q < sample->assembly.point_count; q++) {
            double G[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
            for (int64_t i = sample->lists.ptr[q]; i < sample->lists.ptr[q + 1]; i++) {
                for (int k = 0; k < dim * dim; k++) {
                    G[k / dim * 3 + k % dim] +=
                        u[(int64_t)sample->lists.idx[i] * dim + k / dim] * sample->dphi[i * dim + k % dim];
                }
            }
            ALL_NEAR(9, F + 9 * q, G, 1e-11);
            least = determinant(F + 9 * q) < determinant(F + 9 * least) ? q : least;
        }
        assert_true(deformation.least_jacobian < 0.0);
        NEAR_TO(deformation.least_jacobian, determinant(F + 9 * least), 1e-11);
        assert_int_equal(deformation.point, least);
    }
    u[3] = (double)NAN;
    struct deformation deformation = body_force(&body, u, force);
    assert_true(isnan(deformation.least_jacobian));
    bool touched = false;
    for (int64_t i = sample->lists.ptr[deformation.point]; i < sample->lists.ptr[deformation.point + 1];
         i++) {
        touched = touched || sample->lists.idx[i] == 3 / dim;
    }
    assert_true(touched || setup->faces); /* faces are worked on in groups: a neighbour may have it first */
}

TEST(inversion)
{
    for_all(check_inversion);
}

RUN_TESTS(make_samples, free_samples)
