/* The force loop: no forces from rigid motion, forces that are the gradient of the energy and balance, exact
 * linear fields, the same bits from any number of threads, and inversion told where it is. */
#include "body_fixture.h"

#include "solid/kernel.h"

#include <omp.h>

enum { MATERIALS = 3 };

/* How a body is made from a sample. */
struct setup {
    bool averaged;
    double share, growth; /* pointwise */
    bool faces;           /* conforming cells: by means over faces, not by the table of gradients */
    bool single;
    int model_count; /* points take the models in turn, by their place */
    struct material material[MATERIALS];
};

static struct material make_material(enum material_model model, double youngs_modulus)
{
    struct material material = {.model = model, .density = 1000.0, .mooney_ratio = 0.4, .ogden_alpha = -4.7};
    material_set_moduli(&material, youngs_modulus, 0.49);
    return material;
}

static struct setup one_material(enum material_model model, bool averaged, double share)
{
    struct setup setup = {.averaged = averaged, .share = share, .model_count = 1};
    setup.material[0] = make_material(model, 3000.0);
    return setup;
}

static struct setup three_materials(bool averaged, double share)
{
    struct setup setup = {.averaged = averaged, .share = share, .model_count = 3};
    setup.material[0] = make_material(MATERIAL_NEO_HOOKEAN, 3000.0);
    setup.material[1] = make_material(MATERIAL_OGDEN, 2000.0);
    setup.material[2] = make_material(MATERIAL_NEO_HOOKEAN, 6000.0);
    return setup;
}

/* Materials lie in layers across axis 0. */
static int32_t material_at(const struct sample *sample, const struct setup *setup, int64_t q)
{
    return (int32_t)(sample->x[q * sample->dim] / sample_size * setup->model_count);
}

static struct body make_body(const struct sample *sample, const struct setup *setup)
{
    struct body body;
    struct error error;
    struct conforming_input conforming = sample_conforming(sample);
    int32_t *material = sample_array(sample->point_count, sizeof *material);
    for (int64_t q = 0; q < sample->point_count; q++) {
        material[q] = material_at(sample, setup, q);
    }
    struct body_input input = {.dim = sample->dim,
                               .node_count = sample->cloud.node_count,
                               .point_count = sample->point_count,
                               .node_x = sample->cloud.x,
                               .conforming = setup->faces ? &conforming : NULL,
                               .single = setup->single,
                               .x = sample->x,
                               .weight = sample->weight,
                               .ptr = sample->ptr,
                               .idx = sample->idx,
                               .dphi = sample->dphi,
                               .materials = setup->material,
                               .material = material,
                               .material_count = setup->model_count,
                               .hat_node = setup->averaged ? sample->hat_node : NULL,
                               .hat_value = sample->hat_value,
                               .pointwise_share = setup->share,
                               .share_growth = setup->growth};
    GOOD(body_build(&input, &body, &error));
    free(material);
    return body;
}

/* u = (A - I) x + b */
static double *linear_field(const struct sample *sample, const double *A, const double *b)
{
    int dim = sample->dim;
    double *u = sample_array(sample->cloud.node_count * dim, sizeof *u);
    for (int64_t n = 0; n < sample->cloud.node_count; n++) {
        for (int i = 0; i < dim; i++) {
            u[n * dim + i] = b != NULL ? b[i] : 0.0;
            for (int k = 0; k < dim; k++) {
                u[n * dim + i] += (A[3 * i + k] - (i == k)) * sample->cloud.x[n * dim + k];
            }
        }
    }
    return u;
}

static double *random_field(const struct sample *sample, double size, struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    double *u = sample_array(count, sizeof *u);
    for (int64_t i = 0; i < count; i++) {
        u[i] = size * uniform(random, -1.0, 1.0);
    }
    return u;
}

/* Made once: conforming cells and Gauss points in 2D, the same in 3D. */
static struct sample samples[4];

static int make_samples(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        samples[i] = make_sample(2 + i / 2, i % 2 == 0, i < 2 ? 6 : 4);
    }
    return 0;
}

static int free_samples(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        sample_free(&samples[i]);
    }
    return 0;
}

/* Every combination of dimension, integration, material and averaging. */
static void for_all(void (*check)(const struct sample *, const struct setup *, struct random *))
{
    static const double shares[] = {0.0, 0.1, 1.0};
    struct random random = {1};
    for (int i = 0; i < 4; i++) {
        for (int model = 0; model < (int)MATERIAL_MODEL_COUNT; model++) {
            struct setup setup = one_material((enum material_model)model, false, 0.5);
            check(&samples[i], &setup, &random);
            setup = one_material((enum material_model)model, true, 0.1);
            check(&samples[i], &setup, &random);
            setup.faces = samples[i].conforming;
            check(&samples[i], &setup, &random);
        }
        for (int s = 0; s < 3; s++) {
            struct setup setup = three_materials(true, shares[s]);
            setup.growth = 3.0;
            check(&samples[i], &setup, &random);
            setup = one_material(MATERIAL_NEO_HOOKEAN, true, shares[s]);
            check(&samples[i], &setup, &random);
            setup.growth = 20.0;
            check(&samples[i], &setup, &random);
        }
        for (int averaged = 0; averaged < 2 && samples[i].conforming; averaged++) {
            struct setup setup = three_materials(averaged == 1, 0.1);
            setup.growth = 3.0;
            setup.faces = true;
            check(&samples[i], &setup, &random);
        }
    }
}

static double largest(const double *values, int64_t count)
{
    double most = 0.0;
    for (int64_t i = 0; i < count; i++) {
        most = fabs(values[i]) <= most ? most : isnan(values[i]) ? INFINITY : fabs(values[i]);
    }
    return most;
}

/* Translation, quarter turns and other rotations make no forces, and no energy. */
static void check_rigid_motion(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    struct body body = make_body(sample, setup);
    double *force = sample_array(count, sizeof *force);
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
        free(u);
    }
    free(force);
    body_free(&body);
}

static void rigid_motion(void **state)
{
    (void)state;
    for_all(check_rigid_motion);
}

/* Random displacements, as large as leaves J > 0.3. */
static double *deformed_field(const struct sample *sample, struct body *body, double *force,
                              struct random *random)
{
    double *u = random_field(sample, 0.05 * sample_size, random);
    while (body_force(body, u, force).least_jacobian < 0.3) {
        for (int64_t i = 0; i < sample->cloud.node_count * sample->dim; i++) {
            u[i] *= 0.9;
        }
    }
    return u;
}

/* In random directions, f . v = d/dt W(u + t v). */
static void check_gradient(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    struct body body = make_body(sample, setup);
    double *force = sample_array(count, sizeof *force), *at = sample_array(count, sizeof *at);
    double *u = deformed_field(sample, &body, force, random);
    (void)body_force(&body, u, force);
    for (int direction = 0; direction < 5; direction++) {
        double *v = random_field(sample, 1.0, random), work = 0.0, value[4], h = 2e-7, sum = 0.0;
        for (int k = 0; k < 4; k++) {
            for (int64_t i = 0; i < count; i++) {
                at[i] = u[i] + h * (k < 2 ? k - 2 : k - 1) * v[i];
            }
            value[k] = body_energy(&body, at);
        }
        for (int64_t i = 0; i < count; i++) {
            work += force[i] * v[i];
            sum += fabs(force[i] * v[i]);
        }
        NEAR_TO(work, (value[0] - 8.0 * value[1] + 8.0 * value[2] - value[3]) / (12.0 * h), 2e-7 * sum);
        free(v);
    }
    free(u);
    free(at);
    free(force);
    body_free(&body);
}

static void force_is_gradient(void **state)
{
    (void)state;
    for_all(check_gradient);
}

/* Internal forces have neither sum nor moment. */
static void check_balance(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int dim = sample->dim;
    int64_t count = sample->cloud.node_count * dim;
    struct body body = make_body(sample, setup);
    double *force = sample_array(count, sizeof *force);
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
    free(u);
    free(force);
    body_free(&body);
}

static void balance(void **state)
{
    (void)state;
    for_all(check_balance);
}

/* Under u = (A - I) x every point has F = A, in the caller's order, and the stress of its own material; the
 * energy is that of the volume. */
static void check_linear(const struct sample *sample, const struct setup *setup, struct random *random)
{
    static const double plane[9] = {1.2, 0.3, 0, -0.1, 0.9, 0, 0, 0, 1};
    static const double space[9] = {1.2, 0.3, 0.1, -0.1, 0.9, 0.2, 0.05, -0.3, 1.1};
    const double *A = sample->dim == 2 ? plane : space;
    struct body body = make_body(sample, setup);
    double *u = linear_field(sample, A, (double[]){0.1, 0.2, -0.3}), C[9], J = determinant(A), energy = 0.0;
    double *F = sample_array(sample->point_count * 9, sizeof *F);
    double *P = sample_array(sample->point_count * 9, sizeof *P);
    double *force = sample_array(sample->cloud.node_count * sample->dim, sizeof *force), volume = 0.0;
    (void)random;
    struct deformation deformation = body_force(&body, u, force);
    NEAR_TO(deformation.least_jacobian, J, 1e-12);
    body_gradient(&body, F);
    body_stress(&body, P);
    cofactor(A, C);
    for (int64_t q = 0; q < sample->point_count; q++) {
        const struct material *material = &setup->material[material_at(sample, setup, q)];
        double expected[9];
        material_shape_stress(material, A, expected);
        for (int i = 0; i < 9; i++) {
            NEAR_TO(F[9 * q + i], A[i], 1e-12);
            NEAR_TO(P[9 * q + i], expected[i] + material_pressure(material, J) * C[i], 1e-7);
        }
        volume += sample->weight[q];
        energy +=
            sample->weight[q] * (material_shape_energy(material, A) + material_volume_energy(material, J));
    }
    NEAR_TO(volume, pow(sample_size, sample->dim), 1e-15);
    NEAR_TO(body_energy(&body, u), energy, 1e-11 * energy);
    volume = 0.0;
    for (int64_t q = 0; q < body.point_count; q++) {
        volume += body.weight[q];
    }
    NEAR_TO(volume, pow(sample_size, sample->dim), 1e-15);
    free(u);
    free(F);
    free(P);
    free(force);
    body_free(&body);
}

static void linear_fields(void **state)
{
    (void)state;
    for_all(check_linear);
}

/* A linear field of a body of one material is in equilibrium inside: with conforming cells to round-off. */
static void patch(void **state)
{
    (void)state;
    static const double A[9] = {1.1, 0.2, 0, 0.1, 0.95, 0, 0, 0, 1};
    for (int dim = 2; dim <= 3; dim++) {
        struct sample sample = make_sample(dim, true, dim == 2 ? 9 : 7);
        for (int averaged = 0; averaged < 2; averaged++) {
            struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, averaged == 1, 0.1);
            setup.faces = true;
            struct body body = make_body(&sample, &setup);
            int64_t inner = 0;
            double *u = linear_field(&sample, A, NULL);
            double *force = sample_array(sample.cloud.node_count * dim, sizeof *force);
            bool *outer = sample_array(sample.cloud.node_count, sizeof *outer);
            for (int64_t f = 0; f < sample.faces.count; f++) {
                for (int g = 0; g < sample.face_rule.points && sample.faces.cell[2 * f + 1] < 0; g++) {
                    int64_t point = f * sample.face_rule.points + g;
                    for (int64_t i = sample.face_lists.ptr[point]; i < sample.face_lists.ptr[point + 1];
                         i++) {
                        outer[sample.face_lists.idx[i]] = true; /* the boundary's integral feels it */
                    }
                }
            }
            (void)body_force(&body, u, force);
            double most = largest(force, sample.cloud.node_count * dim);
            for (int64_t n = 0; n < sample.cloud.node_count; n++) {
                inner += !outer[n];
                for (int a = 0; a < dim && !outer[n]; a++) {
                    NEAR_TO(force[n * dim + a], 0.0, 1e-12 * most);
                }
            }
            assert_true(inner > 0);
            free(u);
            free(force);
            free(outer);
            body_free(&body);
        }
        sample_free(&sample);
    }
}

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
        struct body body = make_body(sample, setup);
        double *force = sample_array(count, sizeof *force);
        body.threads = threads; /* also where so many would not pay */
        for (int call = 0; call < 2; call++) {
            (void)body_force(&body, u, force);
            if (first == NULL) {
                first = sample_array(count, sizeof *first);
                memcpy(first, force, (size_t)count * sizeof *first);
                energy = body_energy(&body, u);
            }
            assert_memory_equal(force, first, (size_t)count * sizeof *first);
            NEAR_TO(body_energy(&body, u), energy, 0.0);
        }
        free(force);
        body_free(&body);
    }
    omp_set_num_threads(before);
    free(first);
    free(u);
}

static void threads(void **state)
{
    (void)state;
    for_all(check_threads);
}

/* Whatever the instructions: the same forces but for round-off. */
static void check_instructions(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    static const char *const sets[] = {"plain", "avx2", "avx512"};
    struct body body = make_body(sample, setup);
    double *force = sample_array(count, sizeof *force), *expected = sample_array(count, sizeof *expected);
    double *u = deformed_field(sample, &body, force, random);
    (void)body_force(&body, u, expected);
    for (int k = 0; k < 3; k++) {
        const struct force_kernels *kernels = force_kernels_select(sets[k], sample->dim);
        if (kernels == NULL) {
            assert_int_not_equal(k, 0); /* one for every processor */
            continue;
        }
        body.kernels = kernels;
        (void)body_force(&body, u, force);
        for (int64_t i = 0; i < count; i++) {
            NEAR_TO(force[i], expected[i], 1e-12 * largest(expected, count));
        }
    }
    free(u);
    free(force);
    free(expected);
    body_free(&body);
}

static void instructions(void **state)
{
    (void)state;
    for_all(check_instructions);
}

/* Displacement at a node, or mean over a face, from the tables of shape functions. */
static void value_at_node(const struct sample *sample, int64_t node, const double *u, double *value)
{
    int dim = sample->dim;
    memset(value, 0, 3 * sizeof *value);
    for (int64_t i = sample->node_lists.ptr[node]; i < sample->node_lists.ptr[node + 1]; i++) {
        for (int a = 0; a < dim; a++) {
            value[a] += sample->node_phi[i] * u[(int64_t)sample->node_lists.idx[i] * dim + a];
        }
    }
}

static void mean_of_face(const struct sample *sample, int64_t face, const double *u, double *mean)
{
    int dim = sample->dim, points = sample->face_rule.points;
    memset(mean, 0, 3 * sizeof *mean);
    for (int64_t p = face * points; p < (face + 1) * points; p++) {
        for (int64_t i = sample->face_lists.ptr[p]; i < sample->face_lists.ptr[p + 1]; i++) {
            double share = sample->face_rule.weight[p % points] * sample->face_phi[i];
            for (int a = 0; a < dim; a++) {
                mean[a] += share * u[(int64_t)sample->face_lists.idx[i] * dim + a];
            }
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
    for (int i = 0; i < 3; i++) {
        area[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* What a facet of the boundary adds to the volume inside: of the cone over the triangle of its deformed
 * corners, and what lies between that and the face, whose mean is known. */
static double volume_below(const struct sample *sample, int64_t face, const double *u)
{
    int dim = sample->dim;
    const int32_t *vertex = sample->faces.node + face * dim, *cell = sample->cells.node;
    double rest[3][3] = {{0.0}}, x[3][3] = {{0.0}}, inside[3] = {0.0}, centre[3] = {0.0}, mean[3], area[3];
    cell += (int64_t)sample->faces.cell[2 * face] * (dim + 1);
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
    double sense = dot(area, inside) < 0.0 ? 1.0 : -1.0;
    area_of(dim, x, area);
    for (int a = 0; a < 3; a++) {
        mean[a] += centre[a] / dim - centre[a];
    }
    return sense * dot(mean, area);
}

/* Whatever the field, the volume ratios of conforming cells make up the volume within the boundary. */
static void enclosed_volume(void **state)
{
    (void)state;
    struct random random = {17};
    for (int i = 0; i < 4; i += 2) {
        const struct sample *sample = &samples[i];
        struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, true, 0.1);
        setup.faces = true;
        struct body body = make_body(sample, &setup);
        double *u = random_field(sample, 0.05 * sample_size, &random), sum = 0.0, means = 0.0, inside = 0.0;
        double *F = sample_array(sample->point_count * 9, sizeof *F), rest = pow(sample_size, sample->dim);
        (void)body_energy(&body, u);
        body_gradient(&body, F);
        for (int64_t q = 0; q < body.point_count; q++) {
            sum += body.weight[q] * body.J[q];
            means += body.weight[q] * determinant(F + 9 * body.order[q]);
        }
        for (int64_t f = 0; f < sample->faces.count; f++) {
            inside += sample->faces.cell[2 * f + 1] < 0 ? volume_below(sample, f, u) : 0.0;
        }
        NEAR_TO(sum, inside, 1e-13 * rest);

        assert_true(fabs(means - inside) > 1e-4 * rest); /* the determinants of the means do not */
        free(u);
        free(F);
        body_free(&body);
    }
}

/* Conforming cells by means over their faces: the gradients of the table, but for round-off; and for a small
 * field, where J differs from det F by a square, its forces and energy. */
static void faces(void **state)
{
    (void)state;
    struct random random = {11};
    for (int i = 0; i < 4; i += 2) {
        for (int kind = 0; kind < 2; kind++) {
            const struct sample *sample = &samples[i];
            struct setup setup = three_materials(kind == 1, 0.1);
            int64_t count = sample->cloud.node_count * sample->dim, size = sample->point_count * 9;
            struct body by_table = make_body(sample, &setup);
            setup.faces = true;
            struct body by_faces = make_body(sample, &setup);
            double *force = sample_array(count, sizeof *force),
                   *expected = sample_array(count, sizeof *expected);
            double *F = sample_array(size, sizeof *F), *F_expected = sample_array(size, sizeof *F_expected);
            double *u = deformed_field(sample, &by_table, expected, &random);
            struct deformation least = body_force(&by_table, u, expected),
                               other = body_force(&by_faces, u, force);
            body_gradient(&by_table, F_expected);
            body_gradient(&by_faces, F);
            for (int64_t k = 0; k < size; k++) {
                NEAR_TO(F[k], F_expected[k], 1e-12);
            }
            NEAR_TO(least.least_jacobian, other.least_jacobian, 1e-12);
            assert_int_equal(least.point, other.point);
            for (int64_t k = 0; k < count; k++) {
                u[k] *= 1e-5;
            }
            (void)body_force(&by_table, u, expected);
            (void)body_force(&by_faces, u, force);
            for (int64_t k = 0; k < count; k++) {
                NEAR_TO(force[k], expected[k], 1e-4 * largest(expected, count));
            }
            double energy = body_energy(&by_table, u);
            NEAR_TO(body_energy(&by_faces, u), energy, 1e-4 * energy);
            free(u);
            free(F);
            free(F_expected);
            free(force);
            free(expected);
            body_free(&by_table);
            body_free(&by_faces);
        }
    }
}

/* Tables in single precision: forces as in double to 1e-5. */
static void check_single(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    struct setup narrow = *setup;
    narrow.single = true;
    struct body body = make_body(sample, setup), narrowed = make_body(sample, &narrow);
    double *force = sample_array(count, sizeof *force), *expected = sample_array(count, sizeof *expected);
    double *u = deformed_field(sample, &body, expected, random), most = 0.0;
    (void)body_force(&body, u, expected);
    (void)body_force(&narrowed, u, force);
    for (int64_t k = 0; k < count; k++) {
        NEAR_TO(force[k], expected[k], 1e-5 * largest(expected, count));
        most = fmax(most, fabs(force[k] - expected[k]));
    }
    assert_true(most > 0.0); /* it is another table */
    NEAR_TO(body_energy(&narrowed, u), body_energy(&body, u), 1e-5 * body_energy(&body, u));
    free(u);
    free(force);
    free(expected);
    body_free(&body);
    body_free(&narrowed);
}

static void single_precision(void **state)
{
    (void)state;
    for_all(check_single);
}

/* Keeping the whole volume pointwise is the same as not averaging, where U is a square. */
static void whole_share(void **state)
{
    (void)state;
    struct random random = {2};
    for (int i = 0; i < 4; i++) {
        const struct sample *sample = &samples[i];
        struct setup none = three_materials(false, 0.0), whole = three_materials(true, 1.0);
        struct body one = make_body(sample, &none), other = make_body(sample, &whole);
        int64_t count = sample->cloud.node_count * sample->dim;
        double *force = sample_array(count, sizeof *force), *expected = sample_array(count, sizeof *expected);
        double *u = deformed_field(sample, &one, force, &random), energy = body_energy(&one, u);
        (void)body_force(&one, u, expected);
        (void)body_force(&other, u, force);
        for (int64_t k = 0; k < count; k++) {
            NEAR_TO(force[k], expected[k], 1e-12 * largest(expected, count));
        }
        NEAR_TO(body_energy(&other, u), energy, 1e-12 * energy);
        free(u);
        free(force);
        free(expected);
        body_free(&one);
        body_free(&other);
    }
}

/* The averaged volume of each hat is that of its points, and the hats share the body out. */
static void hats(void **state)
{
    (void)state;
    struct random random = {3};
    for (int dim = 2; dim <= 3; dim++) {
        struct sample sample = make_sample(dim, false, 5);
        struct setup setup = three_materials(true, 0.0);
        struct body body = make_body(&sample, &setup);
        double *u = random_field(&sample, 1e-3, &random), volume = 0.0, deformed = 0.0, expected = 0.0;
        (void)body_energy(&body, u);
        for (int64_t a = 0; a < body.hats.count; a++) {
            double share = 0.0;
            for (int64_t i = body.hats.ptr[a]; i < body.hats.ptr[a + 1]; i++) {
                share += body.hats.share[i];
                assert_int_equal(body.material[body.hats.point[i]], body.hats.material[a]);
            }
            NEAR_TO(share, 1.0, 1e-14);
            volume += body.hats.volume[a];
            deformed += body.hats.volume[a] * body.hats.theta[a];
        }
        for (int64_t q = 0; q < body.point_count; q++) {
            expected += body.weight[q] * body.J[q];
        }
        NEAR_TO(volume, pow(sample_size, dim), 1e-15);
        NEAR_TO(deformed, expected, 1e-15);
        assert_true(body.hats.count > sample.cloud.node_count); /* some nodes lie between materials */
        free(u);
        body_free(&body);
        sample_free(&sample);
    }
}

/* The bound of the stiffness, at rest and deformed: no diagonal entry exceeds it, and at rest the sum over
 * the components is known. */
static void diagonal(void **state)
{
    (void)state;
    struct random random = {5};
    for (int i = 0; i < 4; i++) {
        const struct sample *sample = &samples[i / 2 * 2];
        int dim = sample->dim;
        bool deformed = i % 2 == 1;
        struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, false, 1.0);
        struct body body = make_body(sample, &setup);
        int64_t count = sample->cloud.node_count * dim;
        double mu = setup.material[0].shear_modulus, h = 1e-8;
        double wave = material_wave_modulus(&setup.material[0]), lambda = wave - 2.0 * mu;
        double *bound = sample_array(sample->cloud.node_count, sizeof *bound);
        double *force = sample_array(count, sizeof *force);
        double *u = deformed ? deformed_field(sample, &body, force, &random) : sample_array(count, sizeof *u);
        (void)body_force(&body, u, force);
        body_diagonal(&body, bound);
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
            if (!deformed) {
                NEAR_TO(trace, bound[n] * (lambda + (dim + 1) * mu) / wave, 1e-6 * bound[n]);
            }
        }
        free(bound);
        free(u);
        free(force);
        body_free(&body);
    }
}

/* The least J and where it is, inverted or not; not a number counts as the worst. */
static void check_inversion(const struct sample *sample, const struct setup *setup, struct random *random)
{
    int dim = sample->dim;
    int64_t count = sample->cloud.node_count * dim, nodes = sample->cloud.node_count;
    struct body body = make_body(sample, setup);
    double *force = sample_array(count, sizeof *force), *F = sample_array(sample->point_count * 9, sizeof *F);
    double *u = random_field(sample, 1e-4, random);
    for (int round = 0; round < 4; round++) {
        int64_t node = (int64_t)uniform(random, 0.0, (double)nodes), least = 0;
        double inward = sample->cloud.x[node * dim] < 0.5 * sample_size ? 1.0 : -1.0;
        u[node * dim] += 3.0 * sample_size * inward; /* through its neighbours */
        struct deformation deformation = body_force(&body, u, force);
        body_gradient(&body, F);
        for (int64_t q = 0; q < sample->point_count; q++) {
            double G[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
            for (int64_t i = sample->ptr[q]; i < sample->ptr[q + 1]; i++) {
                for (int k = 0; k < dim * dim; k++) {
                    G[k / dim * 3 + k % dim] +=
                        u[(int64_t)sample->idx[i] * dim + k / dim] * sample->dphi[i * dim + k % dim];
                }
            }
            for (int k = 0; k < 9; k++) {
                NEAR_TO(F[9 * q + k], G[k], 1e-11);
            }
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
    for (int64_t i = sample->ptr[deformation.point]; i < sample->ptr[deformation.point + 1]; i++) {
        touched = touched || sample->idx[i] == 3 / dim;
    }
    assert_true(touched || setup->faces); /* faces are worked on in groups: a neighbour may have it first */
    free(u);
    free(F);
    free(force);
    body_free(&body);
}

static void inversion(void **state)
{
    (void)state;
    for_all(check_inversion);
}

/* A table of gradients that is not that of the faces. */
static void fault_of_smoothing(void)
{
    struct body body;
    struct error error;
    struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, false, 1.0);
    struct sample *sample = &samples[0];
    struct conforming_input conforming = sample_conforming(sample);
    int32_t *material = sample_array(sample->point_count, sizeof *material);
    struct body_input input = {.dim = 2,
                               .node_count = sample->cloud.node_count,
                               .point_count = sample->point_count,
                               .x = sample->x,
                               .weight = sample->weight,
                               .ptr = sample->ptr,
                               .idx = sample->idx,
                               .dphi = sample->dphi,
                               .materials = setup.material,
                               .material = material,
                               .material_count = 1,
                               .conforming = &conforming};
    double *changed = &sample->dphi[2 * sample->ptr[7]], before = *changed;
    *changed += 1.0;
    assert_int_equal(body_build(&input, &body, &error), STATUS_INPUT);
    assert_string_equal(error.text, "shape.dphi: row 7: not smoothed from face.phi: run shapefn again");
    *changed = before;
    conforming.face_count--;
    assert_int_equal(body_build(&input, &body, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "lacks a face: run ipoints for conforming cells"));
    free(material);
}

static void faults(void **state)
{
    (void)state;
    struct body body;
    struct error error;
    static const struct material material = {.shear_modulus = 1.0, .bulk_modulus = 1.0};
    static const double x[4] = {0.0}, dphi[4] = {0.0};
    static const int32_t idx[2] = {0, 1}, none[2] = {0};
    double weight[2] = {1.0, 1.0};
    int64_t ptr[3] = {0, 2, 2};
    struct body_input input = {.dim = 2,
                               .node_count = 2,
                               .point_count = 2,
                               .x = x,
                               .weight = weight,
                               .ptr = ptr,
                               .idx = idx,
                               .dphi = dphi,
                               .materials = &material,
                               .material = none,
                               .material_count = 1};
    assert_int_equal(body_build(&input, &body, &error), STATUS_INPUT);
    assert_string_equal(error.text, "points.weight: row 1: no weight or no neighbours");
    assert_null(body.order);
    ptr[1] = 1;
    weight[0] = (double)NAN;
    assert_int_equal(body_build(&input, &body, &error), STATUS_INPUT);
    assert_string_equal(error.text, "points.weight: row 0: no weight or no neighbours");
    weight[0] = 1.0;
    GOOD(body_build(&input, &body, &error));
    body_free(&body);
    input.point_count = 0;
    assert_int_equal(body_build(&input, &body, &error), STATUS_INPUT);
    assert_string_equal(error.text, "points.x: 0 points: none, or too many");
    fault_of_smoothing();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rigid_motion),
        cmocka_unit_test(force_is_gradient),
        cmocka_unit_test(balance),
        cmocka_unit_test(linear_fields),
        cmocka_unit_test(patch),
        cmocka_unit_test(threads),
        cmocka_unit_test(instructions),
        cmocka_unit_test(whole_share),
        cmocka_unit_test(faces),
        cmocka_unit_test(enclosed_volume),
        cmocka_unit_test(single_precision),
        cmocka_unit_test(hats),
        cmocka_unit_test(diagonal),
        cmocka_unit_test(inversion),
        cmocka_unit_test(faults),
    };
    omp_set_num_threads(1); /* the test of threads takes more */
    return cmocka_run_group_tests(tests, make_samples, free_samples);
}
