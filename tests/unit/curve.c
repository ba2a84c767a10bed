/* Load curves: end values, smoothness, monotone interpolation. */
#include "unit.h"

#include "solid/system/curve.h"

/* The derivative agrees with central differences of the value. */
static void rate_is_derivative(const struct load_curve *curve)
{
    const double h = 1e-5;
    for (double s = .07; s < 1; s += .0937) {
        double difference = (curve_value(curve, s + h) - curve_value(curve, s - h)) / (2 * h);
        NEAR_TO(curve_rate(curve, s), difference, 1e-4);
    }
}

TEST(held_outside)
{
    static const double points[] = {-1, 5, 0, 1, 2, 3, 3, 9};
    FREED_BY(curve_free) struct load_curve table = {0};
    GOOD(curve_tabulate(&table, 4, points, 2, true, &error));
    for (int kind = CURVE_SMOOTH; kind <= CURVE_TABLE; kind++) {
        struct load_curve curve = kind < CURVE_TABLE ? curve_of_kind((enum curve_kind)kind) : table;
        NEAR_TO(curve_value(&curve, -.5), curve_value(&curve, 0), 0);
        NEAR_TO(curve_value(&curve, 7), curve_value(&curve, 1), 0);
        NEAR_TO(curve_rate(&curve, -.5), 0, 0);
        NEAR_TO(curve_rate(&curve, 7), 0, 0);
    }
    NEAR_TO(curve_value(&table, 0), 1, 1e-15);
    NEAR_TO(curve_value(&table, 1), 3, 1e-15);
}

/* Every point is taken; between two of them the factor stays between theirs, also beside a kink. */
TEST(tabulated)
{
    static const double points[] = {0, 0, .2, 0, .3, 1, .5, 1, 1.2, -.5, 2, -.5, 4, 7};
    FREED_BY(curve_free) struct load_curve curve = {0};
    GOOD(curve_tabulate(&curve, 7, points, 4, true, &error));
    for (int i = 0; i < 7; i++) {
        NEAR_TO(curve_value(&curve, points[2 * i] / 4), points[2 * i + 1], 1e-14);
    }
    for (int i = 0; i < 6; i++) {
        double low = fmin(points[2 * i + 1], points[2 * i + 3]);
        double high = fmax(points[2 * i + 1], points[2 * i + 3]);
        for (double part = 0; part <= 1; part += .05) {
            double time = points[2 * i] + part * (points[2 * i + 2] - points[2 * i]);
            double value = curve_value(&curve, time / 4);
            assert_true(value >= low - 1e-14 && value <= high + 1e-14);
        }
    }
    rate_is_derivative(&curve);
    curve_free(&curve);
    GOOD(curve_tabulate(&curve, 7, points, 4, false, &error)); /* straight lines */
    NEAR_TO(curve_value(&curve, .25 / 4), .5, 1e-14);
    NEAR_TO(curve_value(&curve, .75), 3.25, 1e-14);
}

/* Points where the factor turns, or begins or ends to be constant. */
TEST(turns)
{
    static const double points[] = {0, 0, 1, 2, 2, 3, 4, 3, 5, 3, 6, -1, 7, 0, 8, 1};
    static const double at[] = {2, 5, 6};
    FREED_BY(curve_free) struct load_curve curve = {0};
    GOOD(curve_tabulate(&curve, 8, points, 8, false, &error));
    double s = -1;
    for (int i = 0; i < 3; i++) {
        s = curve_next_turn(&curve, s);
        NEAR_TO(s, at[i] / 8, 1e-15);
    }
    assert_true(isinf(curve_next_turn(&curve, s)));
    struct load_curve smooth = curve_of_kind(CURVE_SMOOTH);
    assert_true(isinf(curve_next_turn(&smooth, 0)));
}

RUN_TESTS(NULL, NULL)
