/* Bounds on gradients: never below what they bound, and left open where nothing can be said. */
#include "approx_fixture.h"

#include "approx/steep_bound.h"
#include "approx/steep_kernel.h"

enum { GROUP = 13 }; /* points of a group: more than go together, and not a multiple */

/* A group of points somewhere in a cloud, in a box of half a support radius. */
struct group {
    struct scattered cloud;
    double *radius, points[GROUP * 3], bound[GROUP];
    struct point_grid grid;
    struct candidates candidates;
    struct steep_work work;
};

static void group_begin(struct group *group, int dim, const struct place *place, double factor, double jitter,
                        unsigned long seed)
{
    struct error error;
    *group = (struct group){.cloud = scatter(dim, dim == 2 ? 12 : 7, GROUP, place, jitter, seed)};
    struct scattered *cloud = &group->cloud;
    group->radius = malloc((size_t)cloud->count * sizeof *group->radius);
    assert_non_null(group->radius);
    for (int64_t n = 0; n < cloud->count; n++) {
        group->radius[n] = factor * cloud->spacing * (1.0 + 0.2 * (double)(n % 7) / 7.0);
    }
    double extent = 0.5 * factor * cloud->spacing;
    for (int p = 0; p < GROUP; p++) {
        for (int a = 0; a < dim; a++) {
            double offset = (cloud->points[p * dim + a] - place->offset) / cloud->size * extent;
            group->points[p * dim + a] = cloud->points[a] + offset;
        }
    }
    good(point_grid_build(&group->grid, dim, cloud->count, cloud->x, group->radius, &error), &error);
}

static void group_bound(struct group *group, const struct mls *mls)
{
    struct error error;
    double low[3], high[3];
    for (int a = 0; a < mls->dim; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (int p = 0; p < GROUP; p++) {
            low[a] = fmin(low[a], group->points[p * mls->dim + a]);
            high[a] = fmax(high[a], group->points[p * mls->dim + a]);
        }
    }
    good(candidates_find(&group->candidates, &group->grid, low, high, 1.0, &error), &error);
    good(steep_bounds(mls, &group->candidates, GROUP, group->points, &group->work, group->bound, &error),
         &error);
}

static void group_end(struct group *group)
{
    scattered_free(&group->cloud);
    free(group->radius);
    point_grid_free(&group->grid);
    candidates_free(&group->candidates);
    steep_work_free(&group->work);
}

/* How many points have a bound; each is compared with the largest gradient. */
static int compare(struct group *group, const struct mls *mls)
{
    struct mls_work work = {0};
    struct index_list list = {0};
    struct error error;
    int bounded = 0;
    for (int p = 0; p < GROUP; p++) {
        const double *x = group->points + p * mls->dim;
        double steepest;
        enum mls_verdict verdict;
        list.count = 0;
        good(candidates_within(&group->candidates, x, &list, &error), &error);
        struct mls_support support = {x, group->cloud.x, group->radius, 1.0, list.index, list.count, NULL};
        good(mls_steepest(mls, &support, &work, &steepest, &verdict, &error), &error);
        if (isfinite(group->bound[p])) {
            bounded++;
            assert_int_equal(verdict, MLS_GOOD);
            at_most(steepest, group->bound[p], "largest gradient");
        }
    }
    free(list.index);
    mls_work_free(&work);
    return bounded;
}

/* Clouds from lattices to almost random ones, within and at the boundary; most supports are good ones. */
static void bounds_hold(void **state)
{
    (void)state;
    static const double jitters[] = {0.0, 0.1, 0.3, 0.8};
    for (int dim = 2; dim <= 3; dim++) {
        for (int b = 0; b < BASIS_COUNT; b++) {
            int bounded = 0;
            for (int i = 0; i < 96; i++) {
                struct group group;
                struct mls mls = mls_default(dim);
                mls.basis = (enum basis)b;
                group_begin(&group, dim, &places[i % PLACE_COUNT], 1.4 + 0.1 * (i % 8), jitters[i / 8 % 4],
                            (unsigned long)i + 1);
                group_bound(&group, &mls);
                bounded += compare(&group, &mls);
                group_end(&group);
            }
            print_message("# %dD %s: %d of %d bounded\n", dim, basis_names[b], bounded, 96 * GROUP);
            assert_true(bounded > 96 * GROUP / 2);
        }
    }
}

static int finite_bounds(struct group *group, const struct mls *mls)
{
    int bounded = 0;
    group_bound(group, mls);
    for (int p = 0; p < GROUP; p++) {
        bounded += isfinite(group->bound[p]);
    }
    return bounded;
}

/* Nothing is said of other weights, of H that matters, of very different radii, of nodes on a plane, nor of
 * points without nodes. */
static void left_open(void **state)
{
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        struct group group;
        struct mls mls = mls_default(dim);
        group_begin(&group, dim, &places[1], 2.2, 0.1, 5);
        assert_true(finite_bounds(&group, &mls) > 0);
        mls.weight = WEIGHT_CUBIC;
        assert_int_equal(finite_bounds(&group, &mls), 0);
        mls.weight = WEIGHT_QUARTIC;
        mls.mu[1] = 0.1;
        assert_int_equal(finite_bounds(&group, &mls), 0);
        mls.mu_absolute = true; /* in millimetres that is little */
        mls.mu[1] = 1e-3;
        assert_true(finite_bounds(&group, &mls) > 0);
        mls = mls_default(dim);
        for (int64_t n = 0; n < group.cloud.count; n++) {
            group.cloud.x[n * dim] = group.points[0];
        }
        point_grid_free(&group.grid);
        struct error error;
        good(point_grid_build(&group.grid, dim, group.cloud.count, group.cloud.x, group.radius, &error),
             &error);
        assert_int_equal(finite_bounds(&group, &mls), 0);
        for (int i = 0; i < GROUP * dim; i++) {
            group.points[i] += 10.0 * group.cloud.size;
        }
        assert_int_equal(finite_bounds(&group, &mls), 0);
        assert_int_equal(group.candidates.list.count, 0);
        group_end(&group);
        group_begin(&group, dim, &places[1], 2.2, 0.1, 5);
        for (int64_t n = 0; n < group.cloud.count; n += 2) {
            group.radius[n] *= 11.0;
        }
        point_grid_free(&group.grid);
        good(point_grid_build(&group.grid, dim, group.cloud.count, group.cloud.x, group.radius, &error),
             &error);
        assert_int_equal(finite_bounds(&group, &mls), 0);
        group_end(&group);
    }
}

/* Each instruction set gives the same bits. */
static void instruction_sets(void **state)
{
    (void)state;
    static const char *const names[] = {"plain", "avx2", "avx512"};
    for (int dim = 2; dim <= 3; dim++) {
        for (int b = 0; b < BASIS_COUNT; b++) {
            struct group group;
            struct mls mls = mls_default(dim);
            double expected[GROUP];
            mls.basis = (enum basis)b;
            group_begin(&group, dim, &places[0], 2.1, 0.2, 8);
            for (int i = 0; i < 3; i++) {
                group.work.kernels = steep_kernels_named(names[i]);
                if (group.work.kernels == NULL) {
                    print_message("# not on this processor: %s\n", names[i]);
                    continue;
                }
                assert_true(finite_bounds(&group, &mls) > 0);
                if (i == 0) {
                    memcpy(expected, group.bound, sizeof expected);
                }
                assert_memory_equal(group.bound, expected, sizeof expected);
            }
            group_end(&group);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_hold),
        cmocka_unit_test(left_open),
        cmocka_unit_test(instruction_sets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
