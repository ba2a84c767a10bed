/* Displacements from tables of points: linear fields exactly, however few the points; quadratic ones where
 * there are enough; nothing made up across a line of points. */
#include "unit.h"

#include "approx/field/scattered_fit.h"

static double linear(const double *x, int v)
{
    return v == 0 ? 0.3 + 2.0 * x[0] - x[1] : -0.1 + x[1] * 0.5;
}

static double quadratic(const double *x, int v)
{
    return linear(x, v) + (v == 0 ? x[0] * x[0] - x[0] * x[1] : 3.0 * x[1] * x[1]);
}

/* Rows of x, y and two values, in mm. */
static struct scattered_fit table(double *row, int64_t count, double (*field)(const double *x, int v))
{
    for (int64_t i = 0; i < count; i++) {
        for (int v = 0; v < 2; v++) {
            row[4 * i + 2 + v] = field(row + 4 * i, v);
        }
    }
    struct scattered_fit fit = {
        .dim = 2, .value_count = 2, .count = count, .row_size = 4, .row = row, .unit = 1e-3};
    GOOD(scattered_fit_build(&fit, &error));
    return fit;
}

static double worst(const struct scattered_fit *fit, double (*field)(const double *x, int v))
{
    double largest = 0.0;
    for (int k = 0; k < 50; k++) {
        double mm[2] = {0.1 + 0.8 * fabs(sin(3.0 * k)), 0.1 + 0.8 * fabs(cos(5.0 * k))};
        double x[2] = {1e-3 * mm[0], 1e-3 * mm[1]}, value[2], distance, spacing;
        GOOD(scattered_fit_evaluate(fit, 0, x, value, &distance, &spacing, &error));
        for (int v = 0; v < 2; v++) {
            largest = fmax(largest, fabs(value[v] * 1e3 - field(mm, v)));
        }
    }
    return largest;
}

TEST(few_points_give_linear_fields)
{
    double row[6 * 4] = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0.5, 0.4, 0, 0, 0.2, 0.7, 0, 0};
    for (int64_t count = 3; count <= 6; count++) {
        FREED_BY(scattered_fit_free) struct scattered_fit fit = table(row, count, linear);
        AT_MOST(worst(&fit, linear), 1e-12);
    }
}

TEST(enough_points_give_quadratic_fields)
{
    double row[25 * 4];
    for (int i = 0; i < 25; i++) {
        row[4 * i] = 0.25 * (i % 5) + 0.01 * sin(i);
        row[4 * i + 1] = 0.25 * (double)(i / 5) + 0.01 * cos(i);
    }
    FREED_BY(scattered_fit_free) struct scattered_fit fit = table(row, 25, quadratic);
    AT_MOST(worst(&fit, quadratic), 1e-11);
}

/* On a line nothing is known of what changes across it. */
TEST(a_line_is_extended_across)
{
    double row[9 * 4] = {0};
    for (int i = 0; i < 9; i++) {
        row[4 * i] = 0.125 * i;
    }
    FREED_BY(scattered_fit_free) struct scattered_fit fit = table(row, 9, quadratic);
    double x[2] = {0.4e-3, 0.05e-3}, on[2] = {0.4, 0.0}, value[2], distance, spacing;
    GOOD(scattered_fit_evaluate(&fit, 0, x, value, &distance, &spacing, &error));
    AT_MOST(fabs(value[0] * 1e3 - quadratic(on, 0)), 1e-12);
    AT_MOST(fabs(value[1] * 1e3 - quadratic(on, 1)), 1e-12);
}

/* The nearest of many points, by the grid as by looking at all; far from the points as well. */
TEST(nearest_by_the_grid)
{
    enum { COUNT = 400 };
    double row[COUNT * 4];
    for (int i = 0; i < COUNT; i++) {
        row[4 * i] = 10.0 * fabs(sin(1.7 * i));
        row[4 * i + 1] = row[4 * i] * fabs(cos(2.3 * i)); /* unevenly */
    }
    FREED_BY(scattered_fit_free) struct scattered_fit fit = table(row, COUNT, linear);
    for (int k = 0; k < 40; k++) {
        double mm[2] = {(k % 4 == 0 ? 1e4 : 12.0) * sin(k), 7.0 * cos(3.0 * k)}, nearest = INFINITY;
        double x[2] = {1e-3 * mm[0], 1e-3 * mm[1]}, value[2], distance, spacing;
        for (int i = 0; i < COUNT; i++) {
            nearest = fmin(nearest, hypot(row[4 * i] - mm[0], row[4 * i + 1] - mm[1]));
        }
        GOOD(scattered_fit_evaluate(&fit, 0, x, value, &distance, &spacing, &error));
        AT_MOST(fabs(distance * 1e3 / nearest - 1.0), 1e-12);
    }
}

RUN_TESTS(NULL, NULL)
