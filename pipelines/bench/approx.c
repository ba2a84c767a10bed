/* Neighbour lists and shape functions: points per second of support_build and shape_table, default MLS (MMLS,
 * quadratic) with gradients, on a jittered cloud in which a support holds about 40 nodes in 3D, 14 in 2D. */
#include "bench.h"

#include "approx/cells.h"
#include "approx/cloud.h"
#include "approx/shape.h"
#include "approx/support.h"
#include "base/memory.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

struct problem {
    struct support_options options;
    struct cloud cloud;
    double *radius, *points, *phi, *dphi;
    int64_t point_count;
    struct support_lists lists;
};

/* Lists as the tool support makes them: the grid belongs to it. */
static enum status run_support(void *context, struct error *error)
{
    enum status status;
    struct problem *problem = context;
    struct point_grid grid = {0};
    support_free(&problem->lists);
    TRY(point_grid_build(&grid, problem->cloud.dim, problem->cloud.node_count, problem->cloud.x,
                         problem->radius, error));
    TRY(support_build(&problem->options, &grid, problem->point_count, problem->points, "points.x",
                      &problem->lists, error));
done:
    point_grid_free(&grid);
    return status;
}

static enum status run_search(void *context, struct error *error)
{
    struct problem *problem = context;
    problem->options.widen = false;
    enum status status = run_support(context, error);
    problem->options.widen = true;
    return status;
}

static enum status run_shape(struct problem *problem, double *dphi, struct error *error)
{
    struct neighbours lists = {problem->point_count, problem->lists.ptr, problem->lists.idx,
                               problem->lists.widen};
    return shape_table(&problem->options.mls, problem->cloud.x, problem->radius, &lists, problem->points,
                       "points.x", problem->phi, dphi, error);
}

static enum status run_gradients(void *context, struct error *error)
{
    struct problem *problem = context;
    return run_shape(problem, problem->dphi, error);
}

static enum status run_values(void *context, struct error *error)
{
    return run_shape(context, NULL, error);
}

static enum status set_up(struct problem *problem, int dim, int64_t per_axis, double factor,
                          struct error *error)
{
    enum status status;
    struct cloud_options wanted = {.kind = CLOUD_JITTERED, .dim = dim, .jitter = dim == 2 ? 0.3 : 0.12};
    *problem = (struct problem){.options = support_defaults(dim)};
    for (int a = 0; a < dim; a++) {
        wanted.count[a] = per_axis;
        wanted.high[a] = 0.1;
    }
    TRY(cloud_make(&wanted, &problem->cloud, error));
    struct cells cells = {dim, problem->cloud.node_count, problem->cloud.x, problem->cloud.cell_count,
                          problem->cloud.cells};
    problem->point_count = cells.count;
    problem->options.radius = factor * 0.1 / (double)(per_axis - 1);
    TRY(NEW_ARRAY(&problem->radius, cells.node_count, error));
    TRY(NEW_ARRAY(&problem->points, cells.count * dim, error));
    TRY(support_radii(&problem->options, cells.node_count, NULL, problem->radius, error));
    for (int64_t c = 0; c < cells.count; c++) {
        cell_centroid(&cells, c, problem->points + c * dim);
    }
    TRY(run_support(problem, error));
    TRY(NEW_ARRAY(&problem->phi, problem->lists.ptr[problem->point_count], error));
    TRY(NEW_ARRAY(&problem->dphi, problem->lists.ptr[problem->point_count] * dim, error));
done:
    return status;
}

static void tear_down(struct problem *problem)
{
    cloud_free(&problem->cloud);
    support_free(&problem->lists);
    free(problem->radius);
    free(problem->points);
    free(problem->phi);
    free(problem->dphi);
}

static void bench(int dim, int64_t per_axis, double factor, double seconds)
{
    static const struct {
        const char *name;
        enum status (*run)(void *context, struct error *error);
        int reals; /* written per pair: 8 bytes each, beside the index */
    } kernels[] = {{"neighbours", run_search, 0},
                   {"support", run_support, 0},
                   {"shapefn", run_gradients, 4},
                   {"shapefn-values", run_values, 1}};
    struct problem problem;
    struct error error;
    bench_check(set_up(&problem, dim, per_axis, factor, &error), &error);
    double pairs = (double)problem.lists.ptr[problem.point_count], nodes = (double)problem.cloud.node_count;
    char size[96];
    snprintf(size, sizeof size, "%dD %lld nodes %lld points %.0f neighbours", dim,
             (long long)problem.cloud.node_count, (long long)problem.point_count,
             pairs / (double)problem.point_count);
    int most = omp_get_num_procs();
    for (size_t k = 0; k < sizeof kernels / sizeof *kernels; k++) {
        for (int threads = 1; threads <= (most > 1 ? 2 : 1); threads++) {
            struct bench_times times;
            double reals = kernels[k].reals > 1 ? 1 + dim : kernels[k].reals;
            omp_set_num_threads(threads);
            bench_repeat(seconds, kernels[k].run, &problem, &times);
            struct bench_row row = {.kernel = kernels[k].name,
                                    .size = size,
                                    .threads = threads,
                                    .precision = "double",
                                    .pairs = pairs,
                                    .bytes = pairs * (4.0 + 8.0 * reals),
                                    .rate = (double)problem.point_count,
                                    .unit = "points/s",
                                    .memory_per_node = pairs * (4.0 + 8.0 * reals) / nodes};
            bench_print(&row, &times);
        }
    }
    tear_down(&problem);
}

/* bench-approx [SECONDS]: time spent on each row. */
int main(int argc, char *argv[])
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1.0;
    bench(2, 27, 2.12, seconds);
    bench(3, 10, 2.12, seconds);
    bench(3, 38, 2.12, seconds);
    return 0;
}
