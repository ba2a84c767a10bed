/* Moving least squares at scattered points: the properties of its shape functions, whatever the basis, the
 * weight function, the unit and the place; gradients; the limits of the modified basis; convergence. */
#include "approx_fixture.h"

#include "approx/mls/mls_vector.h"

static void weigh_by(int w, double r2, double *value, double *slope_over_r)
{
    (w == WEIGHT_QUARTIC ? weight_quartic : weight_regularised)(r2, value, slope_over_r);
}

TEST(weights)
{
    for (int w = 0; w < WEIGHT_COUNT; w++) {
        double value, slope, before = 1.0;
        weigh_by(w, 0.0, &value, &slope);
        AT_MOST(fabs(value - 1.0), 1e-14);
        assert_true(isfinite(slope) && slope <= 0.0);
        for (double r = 0.01; r < 1.0; r += 0.0137) {
            double h = 1e-6, plus, minus, unused;
            weigh_by(w, r * r, &value, &slope);
            weigh_by(w, (r + h) * (r + h), &plus, &unused);
            weigh_by(w, (r - h) * (r - h), &minus, &unused);
            assert_true(value > 0.0 && value <= before);
            before = value;
            AT_MOST(fabs(slope * r - (plus - minus) / (2.0 * h)), 1e-6);
        }
        weigh_by(w, 1.0 - 1e-9, &value, &slope);
        AT_MOST(fabs(value), 1e-9);
    }
}

/* All bases, weights, dimensions and places. */
TEST_IN_EACH_DIM(reproduction)
{
    for (int p = 0; p < PLACE_COUNT; p++) {
        FREED_BY(scattered_free)
        struct scattered cloud = scatter(dim, dim == 2 ? 12 : 6, 100, &places[p], 0.3, 7);
        for (int b = 0; b < BASIS_COUNT; b++) {
            for (int w = 0; w < WEIGHT_COUNT; w++) {
                struct support_options options = options_for(dim, (enum basis)b, (enum weight_function)w);
                FREED_BY(table_free) struct table table = {0};
                GOOD(tabulate(&options, cloud.count, cloud.x, 100, cloud.points, &table, &error));
                struct defects worst = table_defects(&table, dim, cloud.x, cloud.points, 2.0 * cloud.spacing);
                AT_MOST(worst.unity, 1e-12);
                AT_MOST(worst.position, 1e-12);
                AT_MOST(worst.gradient_sum, 1e-12);
                AT_MOST(worst.gradient_position, 1e-12);
            }
        }
    }
}

/* A full quadratic in coordinates from the body's corner in units of its size, and its gradient there. */
static double quadratic(int dim, const double *x, double offset, double size, double *gradient)
{
    static const double linear[] = {2.0, -3.0, 4.0};
    static const double second[3][3] = {{1.0, -0.5, 0.25}, {-0.5, 3.0, -1.0}, {0.25, -1.0, 2.0}};
    double value = 1.0;
    for (int a = 0; a < dim; a++) {
        double xa = (x[a] - offset) / size;
        gradient[a] = linear[a];
        value += linear[a] * xa;
        for (int b = 0; b < dim; b++) {
            double xb = (x[b] - offset) / size;
            value += second[a][b] * xa * xb;
            gradient[a] += 2.0 * second[a][b] * xb;
        }
        gradient[a] /= size;
    }
    return value;
}

TEST_IN_EACH_DIM(quadratic_reproduction)
{
    for (int p = 0; p < PLACE_COUNT; p++) {
        FREED_BY(scattered_free)
        struct scattered cloud = scatter(dim, dim == 2 ? 12 : 6, 100, &places[p], 0.3, 11);
        struct support_options options = options_for(dim, BASIS_QUADRATIC, WEIGHT_QUARTIC);
        FREED_BY(table_free) struct table table = {0};
        GOOD(tabulate(&options, cloud.count, cloud.x, 100, cloud.points, &table, &error));
        for (int64_t q = 0; q < 100; q++) {
            double value = 0.0, slope[3] = {0.0}, expected[3], unused[3];
            for (int64_t i = table.lists.ptr[q]; i < table.lists.ptr[q + 1]; i++) {
                double nodal = quadratic(dim, cloud.x + (int64_t)table.lists.idx[i] * dim, places[p].offset,
                                         cloud.size, unused);
                value += table.phi[i] * nodal;
                for (int a = 0; a < dim; a++) {
                    slope[a] += table.dphi[i * dim + a] * nodal;
                }
            }
            value -= quadratic(dim, cloud.points + q * dim, places[p].offset, cloud.size, expected);
            AT_MOST(fabs(value), 1e-11);
            for (int a = 0; a < dim; a++) {
                AT_MOST(fabs(slope[a] - expected[a]) * cloud.size, 1e-9);
            }
        }
    }
}

/* phi of one point on given neighbours, and its gradient unless NULL. */
static void evaluate(const struct mls *mls, const struct scattered *cloud, const struct table *table,
                     int64_t p, const double *x, double *phi, double *dphi)
{
    FREED_BY(mls_work_free) struct mls_work work = {0};
    enum mls_verdict verdict;
    struct mls_support support = {.x = x,
                                  .nodes = cloud->x,
                                  .supports = {.radius = table->radius, .stretch = table->stretch},
                                  .widen = table->lists.widen[p],
                                  .neighbours = table->lists.idx + table->lists.ptr[p],
                                  .count = table->lists.ptr[p + 1] - table->lists.ptr[p]};
    GOOD(mls_evaluate(mls, &support, &work, phi, dphi, &verdict, &error));
    assert_int_equal(verdict, MLS_GOOD);
}

enum { MOST = 1000 };

/* Full gradients against central differences; nodes that leave or enter the support between the two points
 * have weights of zero to third order. */
TEST_IN_EACH_DIM(gradients)
{
    FREED_BY(scattered_free)
    struct scattered cloud = scatter(dim, dim == 2 ? 10 : 6, 20, &places[2], 0.3, 3);
    struct random random = {6};
    double *stretch = zeros(cloud.count * dim * dim, sizeof *stretch);
    for (int64_t i = 0; i < cloud.count * dim * dim; i++) { /* of each node another one */
        bool diagonal = i / dim % dim == i % dim;
        stretch[i] = diagonal ? uniform(&random, 1.3, 1.6) : 0.1 * (double)(1 + i / (dim * dim) % 3);
    }
    for (int b = 0; b < 2 * BASIS_COUNT; b++) {
        for (int w = 0; w < WEIGHT_COUNT; w++) {
            struct support_options options = options_for(dim, (enum basis)(b / 2), (enum weight_function)w);
            options.factor *= b % 2 == 0 ? 1.0 : 1.6;
            FREED_BY(table_free) struct table table = {.stretch = b % 2 == 0 ? NULL : stretch};
            GOOD(tabulate(&options, cloud.count, cloud.x, 20, cloud.points, &table, &error));
            double h = 1e-5 * cloud.spacing;
            for (int64_t p = 0; p < 20; p++) {
                double plus[MOST], minus[MOST], x[3], largest = 0.0;
                int64_t first = table.lists.ptr[p], count = table.lists.ptr[p + 1] - first;
                assert_true(count <= MOST);
                for (int64_t i = first * dim; i < (first + count) * dim; i++) {
                    largest = fmax(largest, fabs(table.dphi[i]));
                }
                for (int a = 0; a < dim; a++) {
                    memcpy(x, cloud.points + p * dim, (size_t)dim * sizeof *x);
                    double up = x[a] + h, down = x[a] - h;
                    x[a] = up;
                    evaluate(&options.mls, &cloud, &table, p, x, plus, NULL);
                    x[a] = down;
                    evaluate(&options.mls, &cloud, &table, p, x, minus, NULL);
                    for (int64_t i = 0; i < count; i++) {
                        double difference = (plus[i] - minus[i]) / (up - down);
                        AT_MOST(fabs(table.dphi[(first + i) * dim + a] - difference) / largest, 3e-5);
                    }
                }
            }
        }
    }
}

/* Largest difference of phi and of grad phi times spacing between two settings on the same supports. */
static double apart(const struct mls *one, const struct mls *two, const struct scattered *cloud,
                    const struct table *table)
{
    double worst = 0.0;
    int dim = cloud->dim;
    for (int64_t p = 0; p < cloud->point_count; p++) {
        double phi[2][MOST], dphi[2][3 * MOST];
        int64_t count = table->lists.ptr[p + 1] - table->lists.ptr[p];
        assert_true(count <= MOST);
        evaluate(one, cloud, table, p, cloud->points + p * dim, phi[0], dphi[0]);
        evaluate(two, cloud, table, p, cloud->points + p * dim, phi[1], dphi[1]);
        for (int64_t i = 0; i < count; i++) {
            worst = worse(worst, phi[0][i] - phi[1][i]);
        }
        for (int64_t i = 0; i < count * dim; i++) {
            worst = worse(worst, (dphi[0][i] - dphi[1][i]) * cloud->spacing);
        }
    }
    return worst;
}

static struct mls with_mu(struct mls mls, double mu)
{
    for (int k = 0; k < MLS_MAX_SECOND; k++) {
        mls.mu[k] = mu;
    }
    return mls;
}

static void turn(int dim, int64_t count, double *x)
{
    for (double *at = x; at < x + count * dim; at += dim) {
        double old = at[0];
        at[0] = 0.8 * old - 0.6 * at[1];
        at[1] = 0.6 * old + 0.8 * at[1];
    }
}

/* An absolute mu is the dimensionless mu s^4; one mu for each monomial acts on that one. */
TEST_IN_EACH_DIM(units_of_mu)
{
    FREED_BY(scattered_free)
    struct scattered cloud = scatter(dim, dim == 2 ? 10 : 6, 30, &places[1], 0.3, 6);
    struct support_options options = options_for(dim, BASIS_MODIFIED, WEIGHT_QUARTIC);
    options.radius = 2.1 * cloud.spacing;
    options.widen = false;
    FREED_BY(table_free) struct table table = {0};
    GOOD(tabulate(&options, cloud.count, cloud.x, 30, cloud.points, &table, &error));
    double s4 = pow(options.radius, 4.0);
    struct mls relative = with_mu(options.mls, 1e-3), absolute = with_mu(options.mls, 1e-3 * s4);
    absolute.mu_absolute = true;
    AT_MOST(apart(&relative, &absolute, &cloud, &table), 1e-10);
    for (int k = 0; k < mls_second_order_count(dim); k++) {
        struct mls one = relative;
        one.mu[k] = 1.0;
        assert_true(apart(&relative, &one, &cloud, &table) > 1e-4);
        relative.mu[k] = 1e4 * mls_default(dim).mu[k];
    }
    /* The default is the same along any axes. */
    for (int64_t p = 0; p < 30; p++) {
        double before[MOST], after[MOST];
        evaluate(&relative, &cloud, &table, p, cloud.points + p * dim, before, NULL);
        turn(dim, cloud.count, cloud.x);
        turn(dim, 30, cloud.points);
        evaluate(&relative, &cloud, &table, p, cloud.points + p * dim, after, NULL);
        for (int64_t j = 0; j < table.lists.ptr[p + 1] - table.lists.ptr[p]; j++) {
            AT_MOST(fabs(after[j] - before[j]), 1e-9);
        }
    }
}

/* What the normal equations decide agrees with the orthogonal factorisation to round-off. */
TEST(normal_equations)
{
    enum { STRIDE = MOST + MLS_PADDING };
    static double phi[2][MOST], dphi[2][3 * MOST];
    SCRATCH double *scratch = aligned_alloc(64, STRIDE * MLS_ROWS * sizeof *scratch);
    int64_t decided = 0, left = 0;
    assert_non_null(scratch);
    for (int dim = 2; dim <= 3; dim++) {
        FREED_BY(scattered_free)
        struct scattered cloud = scatter(dim, dim == 2 ? 10 : 6, 100, &places[2], 0.4, 12);
        for (int b = 0; b < BASIS_COUNT; b++) {
            for (int w = 0; w < WEIGHT_COUNT; w++) {
                struct support_options options = options_for(dim, (enum basis)b, (enum weight_function)w);
                FREED_BY(table_free) struct table table = {0};
                GOOD(tabulate(&options, cloud.count, cloud.x, 100, cloud.points, &table, &error));
                for (int64_t p = 0; p < 100; p++) {
                    struct mls_support support = {.x = cloud.points + p * dim,
                                                  .nodes = cloud.x,
                                                  .supports.radius = table.radius,
                                                  .widen = table.lists.widen[p],
                                                  .neighbours = table.lists.idx + table.lists.ptr[p],
                                                  .count = table.lists.ptr[p + 1] - table.lists.ptr[p]};
                    assert_true(support.count <= MOST);
                    bool served = mls_kernel(&options.mls, &support, scratch, STRIDE, phi[0], dphi[0]);
                    decided += served;
                    left += !served;
                    assert_int_equal(mls_orthogonal(&options.mls, &support, scratch, STRIDE, phi[1], dphi[1]),
                                     MLS_GOOD);
                    double most = 0.0;
                    for (int64_t i = 0; i < support.count * dim; i++) {
                        most = fmax(most, fabs(dphi[1][i]));
                    }
                    for (int64_t i = 0; served && i < support.count; i++) {
                        AT_MOST(fabs(phi[0][i] - phi[1][i]), 1e-11);
                        for (int a = 0; a < dim; a++) {
                            double gradient = dphi[1][i * dim + a];
                            AT_MOST(fabs(dphi[0][i * dim + a] - gradient) / most, 1e-10);
                        }
                    }
                }
            }
        }
    }
    assert_true(decided > 3 * left && left > 0);
}

/* RMSE of the paper's test function (1 - r^2) exp(-r^2 / 2) on 81 x 81 points from 18 x 18 nodes over [-4,
 * 4]^2, quartic weight, at most the 20 nearest nodes; infinity where singular. */
static double paper_error(enum basis basis, double mu, double radius)
{
    double x[324 * 2], values[324], sum = 0.0;
    double *points = zeros(6561 * 2, sizeof *points);
    FREED_BY(table_free) struct table table = {0};
    struct error error;
    for (int n = 0; n < 324; n++) {
        x[2 * n] = -4.0 + 8.0 * (n % 18) / 17.0;
        x[2 * n + 1] = -4.0 + 8.0 * (n / 18) / 17.0;
        double r2 = x[2 * n] * x[2 * n] + x[2 * n + 1] * x[2 * n + 1];
        values[n] = (1.0 - r2) * exp(-0.5 * r2);
    }
    for (int p = 0; p < 6561; p++) {
        points[2 * p] = -4.0 + 0.1 * (p % 81);
        points[2 * p + 1] = -4.0 + 0.1 * (p / 81);
    }
    struct support_options options = {.radius = radius, .most = 20, .mls = mls_default(2)};
    options.mls = with_mu(options.mls, mu);
    options.mls.basis = basis;
    options.mls.mu_absolute = true;
    enum status status = tabulate(&options, 324, x, 6561, points, &table, &error);
    assert_true(status == STATUS_OK || status == STATUS_VERDICT);
    for (int p = 0; p < 6561 && status == STATUS_OK; p++) {
        double r2 = points[2 * p] * points[2 * p] + points[2 * p + 1] * points[2 * p + 1];
        double value = -(1.0 - r2) * exp(-0.5 * r2);
        for (int64_t i = table.lists.ptr[p]; i < table.lists.ptr[p + 1]; i++) {
            value += table.phi[i] * values[table.lists.idx[i]];
        }
        sum += value * value;
    }
    return status == STATUS_OK ? sqrt(sum / 6561.0) : INFINITY;
}

/* Table 1 of the paper, regular cloud, R = 2.0, 1.5, 0.8. */
TEST(paper_table)
{
    static const struct {
        enum basis basis;
        double mu, rmse[3];
    } rows[] = {
        {BASIS_LINEAR, 0.0, {0.0817, 0.0636, 0.0218}},    {BASIS_QUADRATIC, 0.0, {0.0146, 0.0100, INFINITY}},
        {BASIS_MODIFIED, 1e-1, {0.0220, 0.0223, 0.0203}}, {BASIS_MODIFIED, 1e-2, {0.0153, 0.0114, 0.0139}},
        {BASIS_MODIFIED, 1e-3, {0.0147, 0.0101, 0.0072}}, {BASIS_MODIFIED, 1e-4, {0.0146, 0.0100, 0.0059}}};
    static const double radii[] = {2.0, 1.5, 0.8};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        for (int c = 0; c < 3; c++) {
            double rmse = paper_error(rows[r].basis, rows[r].mu, radii[c]);
            AT_MOST(isinf(rows[r].rmse[c]) ? !isinf(rmse) : fabs(rmse - rows[r].rmse[c]), 1.5e-4);
        }
    }
}

RUN_TESTS(NULL, NULL)
