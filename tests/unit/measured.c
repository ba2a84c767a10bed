/* Measured points: the energy scale of their springs, pairs that contradict each other, conditions that
 * follow from others. */
#include "unit.h"

#include "solid/constraint/measured.h"

static const double pi = 3.14159265358979323846;

/* A point alone in three dimensions: the ball that a node stands for, by Stokes' law. */
TEST(energy_of_one)
{
    const double x[] = {0.1, 0.2, 0.3}, u[] = {1e-3, NAN, 0}, deviation[] = {5e-4};
    struct measured measured = {3, 1, x, u, deviation};
    struct measured_region region = {
        .shear_modulus = 1000, .volume = 4e-6, .body_size = 0.1, .model_error = 2e-3, .nodes = 20};
    double radius = cbrt(3 * 4e-6 / 4 / pi);
    NEAR_TO(measured_energy(&measured, &region), 6 * pi * 1000 * radius * 4e-6, 1e-12);
    measured.dim = 2;
    radius = sqrt(4e-6 / pi);
    NEAR_TO(measured_energy(&measured, &region), 4 * pi * 1000 / log(0.1 / radius) * 4e-6, 1e-12);
    const double exact[] = {0};
    measured.deviation = exact;
    NEAR_TO(measured_energy(&measured, &region), 0, 1e-30);
}

/* Many points within a ball: its radius; shared by the points, or by the nodes where these are fewer. */
TEST(energy_of_a_ball)
{
    enum { SIDE = 21 };
    static double x[SIDE * SIDE * SIDE * 3], u[SIDE * SIDE * SIDE * 3], deviation[SIDE * SIDE * SIDE];
    int64_t count = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        double p[3] = {i % SIDE - 10, i / SIDE % SIDE - 10, i / SIDE / SIDE - 10};
        if (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] < 100) {
            for (int a = 0; a < 3; a++) {
                x[count * 3 + a] = 5 + 0.01 * p[a];
            }
            deviation[count++] = 1e-3;
        }
    }
    struct measured measured = {3, count, x, u, deviation};
    struct measured_region region = {
        .shear_modulus = 1000, .volume = 1e-6, .body_size = 1, .model_error = 1, .nodes = count};
    double k = 6 * pi * 1000 * 0.1;
    NEAR_TO(measured_energy(&measured, &region) * (double)count / k, 1,
            0.02); /* a lattice is not quite a ball */
    double all = measured_energy(&measured, &region);
    region.nodes = 10;
    NEAR_TO(measured_energy(&measured, &region), all * (double)count / 10, 1e-9);
}

TEST(pairs)
{
    /* 1 contradicts 0; 3 says what 2 says, and so does 4 of what both know; 6 is too far from 5 for its
     * noise, 7 is not */
    const double x[] = {0, 0, 0.1, 0, 5, 5, 5, 5, 5, 5, 9, 9, 9, 9.1, 9, 9.2, 7, 7, 7, 7};
    const double u[] = {0, 0, 0, 0.2, 1, 2, 1, 2, NAN, 2, 0, 0, 1, 0, 0.5, 0, 0, NAN, NAN, 1};
    const double deviation[] = {0, 0, 0, 0, 0, 0.1, 0.1, 0.1, 0, 0};
    struct measured measured = {2, 10, x, u, deviation};
    struct measured_pair exact, others, repeated;
    GOOD(measured_compare(&measured, 1e-9, &exact, &others, &repeated, &error));
    assert_int_equal(exact.count, 1);
    assert_int_equal(exact.first, 0);
    assert_int_equal(exact.second, 1);
    NEAR_TO(exact.distance, 0.1, 1e-15);
    NEAR_TO(exact.apart, 0.2, 1e-15);
    assert_int_equal(others.count, 1);
    assert_int_equal(others.first, 5);
    assert_int_equal(others.second, 6);
    assert_int_equal(repeated.count, 3);
    assert_int_equal(repeated.first, 2);
    assert_int_equal(repeated.second, 3);
}

/* Rows over the same nodes: the third follows from two but for a part of itself. */
TEST(dependence)
{
    const int32_t nodes[] = {0, 1, 2};
    const double one[] = {1, 0, 0}, two[] = {0, 1, 0}, along[] = {1, 0}, across[] = {0, 1};
    for (int k = 0; k < 2; k++) {
        double part = k == 0 ? 0.05 : 0.2; /* of its length */
        double side = sqrt((1 - part * part) / 2);
        const double third[] = {side, side, part};
        FREED_BY(constraint_rows_free) struct constraint_rows rows = {0};
        bool dependent[4];
        constraint_rows_init(&rows, 2);
        GOOD(constraint_rows_add(&rows, 3, nodes, one, along, 0, 0, 0, 0, &error));
        GOOD(constraint_rows_add(&rows, 3, nodes, two, along, 0, 0, 0, 0, &error));
        GOOD(constraint_rows_add(&rows, 3, nodes, third, along, 0, 0, 0, 0, &error));
        GOOD(constraint_rows_add(&rows, 3, nodes, third, across, 0, 0, 0, 0, &error));
        GOOD(measured_dependent(&rows, 3, dependent, &error));
        assert_int_equal(dependent[0] + dependent[1] + dependent[2], k == 0);
        assert_false(dependent[3]);
    }
}

RUN_TESTS(NULL, NULL)
