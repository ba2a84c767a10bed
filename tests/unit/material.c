/* Material laws: stresses are gradients of energies, do not see rotations, are Hooke's at small strain, and
 * take the values of closed forms in homogeneous states. */
#include "law_fixture.h"
#include "unit.h"

#include "base/vector.h"
#include "io/scene/scene.h"
#include "solid/material/ellipticity.h"

#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

static struct material make(const char *law)
{
    return make_material(law_find(law), 3000.0);
}

enum { MATERIALS = SAMPLE_LAWS };
static struct material all[MATERIALS];

static int make_all(void **state)
{
    (void)state;
    for (int i = 0; i < law_count; i++) {
        (void)make_material(i, 3000.0);
    }
    for (int i = 0; i < MATERIALS; i++) {
        all[i] = sample_material(i, 3000.0, 0.49);
    }
    return 0;
}

static double energy(const struct material *material, const double F[9])
{
    return material_isochoric_energy(material, F) + material_volume_energy(material, determinant(F));
}

static void stress(const struct material *material, const double F[9], double P[9])
{
    double C[9];
    material_isochoric_stress(material, F, P);
    cofactor(F, C);
    add_scaled(9, material_pressure(material, determinant(F)), C, P);
}

/* A = B C */
static void multiply(const double B[9], const double C[9], double A[9])
{
    for (int i = 0; i < 9; i++) {
        A[i] = B[i / 3 * 3] * C[i % 3] + B[i / 3 * 3 + 1] * C[3 + i % 3] + B[i / 3 * 3 + 2] * C[6 + i % 3];
    }
}

static void random_rotation(struct random *random, double Q[9])
{
    double q[4], norm2 = 0.0;
    for (int i = 0; i < 4; i++) {
        q[i] = uniform(random, -1.0, 1.0);
        norm2 += q[i] * q[i];
    }
    double s = 2.0 / norm2, w = q[3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        Q[4 * i] = 1.0 - s * (q[j] * q[j] + q[k] * q[k]);
        Q[3 * i + j] = s * (q[i] * q[j] - q[k] * w);
        Q[3 * j + i] = s * (q[i] * q[j] + q[k] * w);
    }
}

/* F with 0.3 < det F < 3 and large strains. */
static void random_gradient(struct random *random, double F[9])
{
    do {
        for (int i = 0; i < 9; i++) {
            F[i] = (i % 4 == 0) + uniform(random, -0.6, 0.6);
        }
    } while (determinant(F) < 0.3 || determinant(F) > 3.0);
}

/* Uniaxial, biaxial, shear, volume, and all of these turned; then anything. */
static void take_state(int round, struct random *random, double F[9])
{
    static const double states[4][9] = {{1.3, 0, 0, 0, 1, 0, 0, 0, 1},
                                        {1.2, 0, 0, 0, 0.9, 0, 0, 0, 1},
                                        {1, 0.4, 0, 0, 1, 0, 0, 0, 1},
                                        {1.12, 0, 0, 0, 1.1, 0, 0, 0, 1.1}};
    double Q[9];
    random_rotation(random, Q);
    if (round < 4) {
        memcpy(F, states[round], sizeof states[round]);
    } else if (round < 8) {
        multiply(Q, states[round - 4], F);
    } else {
        random_gradient(random, F);
    }
}

TEST(stress_is_gradient)
{
    struct random random = {2};
    for (int m = 0; m < MATERIALS; m++) {
        for (int round = 0; round < 50; round++) {
            double F[9], P[9], h = 1e-5, scale = 1.0;
            take_state(round, &random, F);
            stress(&all[m], F, P);
            for (int i = 0; i < 9; i++) {
                scale = fmax(scale, fabs(P[i]));
            }
            for (int i = 0; i < 9; i++) {
                double at = F[i], value[4];
                for (int k = 0; k < 4; k++) {
                    F[i] = at + h * (k < 2 ? k - 2 : k - 1);
                    value[k] = energy(&all[m], F);
                }
                F[i] = at;
                NEAR_TO(P[i], (value[0] - 8.0 * value[1] + 8.0 * value[2] - value[3]) / (12.0 * h),
                        1e-7 * scale);
            }
        }
    }
}

TEST(pressure_is_derivative)
{
    for (int m = 0; m < MATERIALS; m++) {
        for (double J = 0.2; J < 3.0; J += 0.1) {
            double h = 1e-6, difference = material_volume_energy(&all[m], J + h) -
                                          material_volume_energy(&all[m], J - h);
            NEAR_TO(material_pressure(&all[m], J), difference / (2.0 * h), 1e-4);
        }
        double h = 1e-5,
               bulk = (material_pressure(&all[m], 1.0 + h) - material_pressure(&all[m], 1.0 - h)) / (2.0 * h);
        NEAR_TO(material_volume_energy(&all[m], 1.0), 0.0, 0.0);
        NEAR_TO(material_bulk(&all[m]), bulk, 1e-4);
    }
}

/* Rotating the body afterwards turns the stress with it, so that P F^T is symmetric; rotating it before, with
 * its fibres, as well. */
TEST(rotations)
{
    struct random random = {3};
    for (int m = 0; m < MATERIALS; m++) {
        for (int round = 0; round < 50; round++) {
            double F[9], Q[9], QF[9], FQ[9], P[9], turned[9], expected[9], fibre[6] = {0.0};
            struct material before = all[m];
            take_state(round, &random, F);
            random_rotation(&random, Q);
            for (int i = 0; i < 18 && before.fibre != NULL; i++) {
                fibre[i / 3] += Q[i % 3 * 3 + i / 3 % 3] * before.fibre[i / 9 * 3 + i % 3];
            }
            before.fibre = fibre;
            multiply(Q, F, QF);
            multiply(F, Q, FQ);
            double W = energy(&all[m], F);
            NEAR_TO(energy(&all[m], QF), W, 1e-11 * fabs(W) + 1e-9);
            NEAR_TO(energy(&before, FQ), W, 1e-11 * fabs(W) + 1e-9);
            stress(&all[m], F, P);
            multiply(Q, P, expected);
            stress(&all[m], QF, turned);
            ALL_NEAR(9, turned, expected, 1e-11 * fabs(W) + 1e-9);
            multiply(P, Q, expected);
            stress(&before, FQ, turned);
            ALL_NEAR(9, turned, expected, 1e-11 * fabs(W) + 1e-9);
            for (int i = 0; i < 3; i++) {
                int j = 3 * ((i + 1) % 3), k = 3 * ((i + 2) % 3);
                NEAR_TO(vector_dot(3, P + j, F + k), vector_dot(3, P + k, F + j), 1e-11 * fabs(W) + 1e-9);
            }
            /* Rotation alone makes neither stress nor energy. */
            stress(&all[m], Q, P);
            NEAR_TO(energy(&all[m], Q), 0.0, 1e-10);
            ALL_NEAR(9, P, NULL, 1e-9);
        }
    }
}

/* e : W'' e of an isochoric strain e, where fibres begin to be stretched. */
static double square_at_rest(const struct material *material, const double e[9])
{
    double a[3] = {0.8, 0.6, 0.0}, h = 1e-6, P[2][9], change[9];
    for (int side = 0; side < 2; side++) {
        double F[9];
        for (int i = 0; i < 9; i++) {
            F[i] = (i % 4 == 0) * (1.0 - 0.5e-4) + 1.5e-4 * a[i / 3] * a[i % 3] + (side == 0 ? h : -h) * e[i];
        }
        material_isochoric_stress(material, F, P[side]);
    }
    vector_subtract(9, P[0], P[1], change);
    return vector_dot(9, change, e) / (2.0 * h);
}

/* The mean of the squares of orthonormal isochoric strains is 2 mu, where fibres begin to be stretched, and
 * that of any strain is what the law says of its rest. */
TEST(moduli_at_rest)
{
    static const double basis[5][9] = {{0, 1, 0, 1, 0, 0, 0, 0, 0},
                                       {0, 0, 1, 0, 0, 0, 1, 0, 0},
                                       {0, 0, 0, 0, 0, 1, 0, 1, 0},
                                       {1, 0, 0, 0, -1, 0, 0, 0, 0},
                                       {1, 0, 0, 0, 1, 0, 0, 0, -2}};
    struct random random = {5};
    for (int m = 0; m < MATERIALS; m++) {
        struct material_rest rest = material_at_rest(&all[m]);
        double sum = 0.0, mu = all[m].shear_modulus;
        for (int k = 0; k < 5; k++) {
            sum += square_at_rest(&all[m], basis[k]) / vector_dot(9, basis[k], basis[k]);
        }
        for (int trial = 0; trial < 8 && material_bulk(&all[m]) > 0.0; trial++) {
            double e[9] = {0.0};
            for (int k = 0; k < 5; k++) {
                add_scaled(9, uniform(&random, -1.0, 1.0), basis[k], e);
            }
            double expected = 2.0 * rest.shear * vector_dot(9, e, e);
            for (int f = 0; f < rest.families; f++) {
                double *a = rest.direction[f], ea[3];
                for (int i = 0; i < 3; i++) {
                    ea[i] = vector_dot(3, e + 3 * i, a);
                }
                double stretch2 = pow(vector_dot(3, a, ea), 2);
                expected += 4.0 * (rest.along - rest.shear) * (vector_dot(3, ea, ea) - stretch2) +
                            3.0 * rest.fibre[f] * stretch2;
            }
            NEAR_TO(sum / 10.0, mu, 2e-3 * mu);
            NEAR_TO(square_at_rest(&all[m], e), expected, 5e-3 * expected);
        }
    }
}

/* P = lambda tr(e) I + 2 mu e for small e, whatever the law without fibres. */
TEST(small_strain)
{
    struct random random = {4};
    static const double ratios[] = {-0.2, 0.0, 0.3, 0.49, 0.499};
    for (int r = 0; r < 5; r++) {
        double mu = 3000.0 / 2.0 / (1.0 + ratios[r]);
        double lambda = 3000.0 * ratios[r] / (1.0 + ratios[r]) / (1.0 - 2.0 * ratios[r]);
        for (int m = 0; m < MATERIALS; m++) {
            double F[9], P[9], strain = 1e-7;
            if (all[m].fibre != NULL) {
                continue;
            }
            struct material law = all[m];
            material_set_moduli(&law, 3000.0, ratios[r]);
            NEAR_TO(material_wave_modulus(&law), lambda + 2.0 * mu, 1e-8 * (lambda + 2.0 * mu));
            for (int i = 0; i < 9; i++) {
                F[i] = (i % 4 == 0) + strain * uniform(&random, -1.0, 1.0);
            }
            stress(&law, F, P);
            double trace = F[0] + F[4] + F[8] - 3.0;
            for (int i = 0; i < 9; i++) {
                double e = 0.5 * (F[i] + F[i % 3 * 3 + i / 3]) - (i % 4 == 0);
                double expected = 2.0 * mu * e + (i % 4 == 0 ? lambda * trace : 0.0);
                NEAR_TO(P[i], expected, 2e-5 * strain * (lambda + 2.0 * mu));
            }
        }
    }
}

/* Models that contain each other. */
TEST(special_cases)
{
    struct random random = {5};
    struct material hooke = make("neo-hookean"), ogden = make("ogden"), mooney = make("mooney-rivlin");
    struct material second = ogden, yeoh = make("yeoh");
    double ratio = 0.0;
    ogden.parameters = (double[LAW_NUMBERS]){1.0, [6] = 2.0};
    second.parameters = (double[LAW_NUMBERS]){0.25, 0.75, [6] = -2.0, -2.0};
    yeoh.parameters = (double[LAW_NUMBERS]){0.5};
    mooney.parameters = &ratio;
    for (int round = 0; round < 50; round++) {
        double F[9], P[9], Q[9];
        random_gradient(&random, F);
        stress(&hooke, F, P);
        stress(&ogden, F, Q);
        NEAR_TO(energy(&ogden, F), energy(&hooke, F), 1e-8);
        ALL_NEAR(9, Q, P, 1e-8);
        stress(&yeoh, F, Q);
        ALL_NEAR(9, Q, P, 1e-8);
        stress(&mooney, F, Q);
        NEAR_TO(energy(&mooney, F), energy(&hooke, F), 1e-9);
        ALL_NEAR(9, Q, P, 1e-9);
        /* C01 alone is Ogden's law of exponent -2: I2' is the sum of the inverse squares. */
        ratio = 1e100;
        NEAR_TO(energy(&second, F), energy(&mooney, F), 1e-7);
        ratio = 0.0;
    }
}

/* First Piola stress along axis 0 at that stretch with free sides; *lateral is the stretch of the sides. */
static double unconfined(const struct material *material, double stretch, double *lateral)
{
    double low = 0.3, high = 3.0, P[9], F[9] = {stretch, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int i = 0; i < 200; i++) { /* the stress on the sides grows with their stretch */
        F[4] = F[8] = 0.5 * (low + high);
        stress(material, F, P);
        *(P[4] > 0.0 ? &high : &low) = F[4];
    }
    *lateral = F[4];
    return P[0];
}

/* Figures for E = 3000 Pa, nu = .49; those of compression are also what CalculiX
 * gives for *HYPERELASTIC, NEO HOOKE. */
TEST(unconfined_compression)
{
    static const double expected[][3] = {{0.8, -763.26922, 5e-6},
                                         {0.5, -3503.55836, 5e-6},
                                         {0.3, -10796.20005, 5e-5},
                                         {1.2, 504.78406, 5e-6},
                                         {1.5, 1050.71532, 5e-6}};
    struct material material = make("neo-hookean");
    NEAR_TO(material.shear_modulus, 1006.7114, 5e-5);
    NEAR_TO(material.bulk_modulus, 50000.0, 1e-9);
    NEAR_TO(material_wave_modulus(&material), 51342.28, 5e-3);
    for (int i = 0; i < 5; i++) {
        double lateral, P = unconfined(&material, expected[i][0], &lateral);
        NEAR_TO(P, expected[i][1], expected[i][2]);
        if (i == 0) {
            double F[9] = {0.8, 0, 0, 0, lateral, 0, 0, 0, lateral};
            NEAR_TO(lateral, 1.11574668, 5e-9);
            NEAR_TO(energy(&material, F), 70.051447, 5e-7);
        }
    }
}

/* Cauchy stress along axis k of an incompressible solid of one law, fibres along axis 0, free across. */
static double uniaxial(const char *name, const double *numbers, int k, double s0, double s1, double s2)
{
    static const double fibre[6] = {1.0};
    struct law_input input = {.given = {1, 1, 1, 1}};
    struct law_fault fault;
    double parameters[LAW_NUMBERS], P[9], F[9] = {s0, 0, 0, 0, s1, 0, 0, 0, s2};
    struct material material = {.model = law_find(name), .parameters = parameters, .fibre = fibre};
    memcpy(input.number, numbers, 5 * sizeof *numbers);
    material.shear_modulus = law_prepare(material_laws[material.model], &input, parameters, &fault);
    material_isochoric_stress(&material, F, P);
    int side = k == 0 ? 4 : 0;
    NEAR_TO(P[side] * F[side], P[8] * F[8], 1e-5);
    return P[4 * k] * F[4 * k] - P[8] * F[8];
}

/* Closed forms of uniaxial stress: Weiss's law with c1 = c3 = c4 = 1; Guccione's with 2 kPa, 8, 2, 4, along
 * and across; that of Holzapfel, Gasser and Ogden with both families along the axis. */
TEST(fibres)
{
    static const double weiss[5] = {1, 0, 1, 1}, guccione[5] = {2, 8, 2, 4}, c = 2, k1 = 3, k2 = 4, d = 0.1;
    static const double expected[3][3] = {{1.1, .70699, 2.42069}, {1.2, 1.43474, 8.09652}, {1.5, 3.81539, 0}};
    for (int i = 0; i < 3; i++) {
        double l = expected[i][0], s = 1.0 / sqrt(l),
               E = d * (l * l + 2.0 / l - 3.0) + (1 - 3 * d) * (l * l - 1.0);
        NEAR_TO(uniaxial("trans-iso", weiss, 0, l, s, s), expected[i][1], 5e-6);
        if (i < 2) {
            NEAR_TO(uniaxial("guccione", guccione, 0, l, s, s), expected[i][2], 5e-6);
        }
        NEAR_TO(uniaxial("holzapfel-gasser-ogden", (double[5]){c, k1, k2, d, 0}, 0, l, s, s),
                c * (l * l - 1.0 / l) +
                    4.0 * k1 * E * exp(k2 * E * E) * (d * (l * l - 1.0 / l) + (1.0 - 3.0 * d) * l * l),
                1e-9 * exp(k2 * E * E));
    }
    NEAR_TO(uniaxial("guccione", guccione, 1, .983760, 1.1, .924098), .78445, 1e-5);
    NEAR_TO(uniaxial("guccione", guccione, 1, .973817, 1.2, .855740), 1.90477, 2e-5);
}

/* Ogden's law with equal, nearly equal and widely different stretches, whatever their directions. */
TEST(principal_stretches)
{
    struct random random = {6};
    static const double stretches[][3] = {{1, 1, 1},       {1.3, 1, 1},
                                          {1.3, 1.3, 0.7}, {1.2, 1.2 + 1e-9, 0.8},
                                          {4, 0.2, 1.1},   {0.3, 0.3, 0.3 + 1e-13}};
    struct material material = make("ogden");
    double mu = material.shear_modulus, alpha = -4.7;
    for (int round = 0; round < 60; round++) {
        const double *l = stretches[round % 6];
        double F[9] = {l[0], 0, 0, 0, l[1], 0, 0, 0, l[2]}, Q[9], R[9], QF[9], P[9], D[9] = {0}, QD[9];
        double expected[9], root = cbrt(l[0] * l[1] * l[2]), mean = 0.0, largest = 0.0;
        random_rotation(&random, Q);
        random_rotation(&random, R);
        multiply(Q, F, QF);
        multiply(QF, R, F);
        for (int a = 0; a < 3; a++) {
            mean += pow(l[a] / root, alpha) / 3.0;
        }
        for (int a = 0; a < 3; a++) {
            D[4 * a] = 2.0 * mu / alpha * (pow(l[a] / root, alpha) - mean) / l[a];
            largest = fmax(largest, fabs(D[4 * a]));
        }
        multiply(Q, D, QD);
        multiply(QD, R, expected);
        material_isochoric_stress(&material, F, P);
        ALL_NEAR(9, P, expected, 1e-9 * (largest + mu));
    }
}

/* A point turned inside out has no energy. */
TEST(inverted)
{
    for (int m = 0; m < MATERIALS; m++) {
        assert_true(isnan(material_isochoric_energy(&all[m], (double[]){-0.1, 0, 0, 0, 1, 0, 0, 0, 1})));
        assert_true(isnan(material_isochoric_energy(&all[m], (double[]){0, 0, 0, 0, 1, 0, 0, 0, 1})));
    }
}

/* St. Venant-Kirchhoff on two axes, the third free: by the acoustic tensor of each direction, at nu = .49 up
 * to about .863. The neo-Hookean law is elliptic at every state. */
TEST(ellipticity)
{
    struct material stiff = make("st-venant-kirchhoff"), neo = make("neo-hookean");
    for (int i = 0; i < 2; i++) {
        double l = i == 0 ? 0.87 : 0.855, lambda = stiff.bulk_modulus - 2.0 / 3.0 * stiff.shear_modulus;
        double free2 = 1.0 - 2.0 * lambda * (l * l - 1.0) / (lambda + 2.0 * stiff.shear_modulus);
        const double F[9] = {l, 0.0, 0.0, 0.0, l, 0.0, 0.0, 0.0, sqrt(free2)};
        assert_int_equal(material_is_elliptic(&stiff, 0.0, 3, F), i == 0);
        assert_true(material_is_elliptic(&neo, 0.0, 3, F));
        neo.fibre = (double[6]){0.6, 0.8};
        assert_true(material_is_elliptic(&neo, 2000.0, 3, F) && !material_is_elliptic(&neo, -2000.0, 3, F));
    }
}

/* The moduli of laws by the keys of a scene: the parameters of each, and the volume by each of its keys. */
TEST(moduli_of_scenes)
{
    static const struct {
        const char *keys;
        double shear, bulk, parameter;
    } cases[] = {
        {"E = 3000\nkappa = 50000\n", 3000 / 2.98, 50000, 0},
        {"mu = 3\nnu = 0.25\n", 3, 5, 0},
        {"model = st-venant-kirchhoff\nmu = 3\nD = 0.5\n", 3, 4, 0},
        {"model = mooney-rivlin\nc1 = 2\nc2 = 3\nkappa = 7\n", 10, 7, 1.5},
        {"model = mooney-rivlin\nratio = 3\nE = 9\nnu = 0\n", 4.5, 3, 3},
        {"model = ogden\nmu = 1, 2, 5\nalpha = 2, -3, .5\nkappa = 7\n", 8, 7, .125},
        {"model = yeoh\nc1 = 2\nc3 = 1\nkappa = 7\n", 4, 7, .5},
        {"model = trans-iso\nc1 = 1\nc3 = 5\nc4 = 6\nfibre = 3, 4\nkappa = 7\n", 4, 7, .25},
        {"model = guccione\nC = 2\nbf = 8\nbt = 2\nbfs = 4\nfibre = 1, 0\nkappa = 7\n", 3.6, 7, 2 / 3.6},
        {"model = holzapfel-gasser-ogden\nc = 1\nk1 = 15\nk2 = 2\nfibre = 1, 0\nkappa = 7\n", 9, 7, 1. / 9}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        FREED_BY(scene_free) struct scene scene = {0};
        char path[32];
        int file = memfd_create("scene", 0);
        snprintf(path, sizeof path, "/proc/self/fd/%d", file);
        assert_true(dprintf(file, "[scene]\ndim = 2\nanalysis = quasi-static\n[material m]\nregion = r\n%s",
                            cases[i].keys) > 0);
        GOOD(scene_read(path, &scene, &error));
        close(file);
        NEAR_TO(scene.materials[0].material.shear_modulus, cases[i].shear, 1e-9);
        NEAR_TO(scene.materials[0].material.bulk_modulus, cases[i].bulk, 1e-9);
        NEAR_TO(scene.materials[0].parameters[0], cases[i].parameter, 1e-15);
    }
}

RUN_TESTS(make_all, NULL)
