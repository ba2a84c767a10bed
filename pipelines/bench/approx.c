/* Neighbour lists, shape functions and the smoothing of smoothed cells: default MLS (MMLS, quadratic), on a
 * jittered cloud in which a support holds about 40 nodes in 3D, 14 in 2D. Then the same cube from 1e3 to 1e6
 * nodes, points at the nodes: what a pair costs and a node holds as problems grow. */
#include "bench.h"
#include "problem.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

static enum status run_search(void *context, struct error *error)
{
    struct problem *problem = context;
    problem->options.widen = false;
    enum status status = problem_support(context, error);
    problem->options.widen = true;
    return status;
}

/* One kernel; `reals` are read or written per pair, beside the index. */
static void bench(struct problem *problem, const char *kernel, enum status (*run)(void *, struct error *),
                  int reals, int threads, double seconds)
{
    struct bench_times times;
    char size[96];
    int dim = problem->cells.dim;
    omp_set_num_threads(threads);
    bench_repeat(threads == 1 ? BENCH_CPU : BENCH_WALL, seconds, run, problem, &times);
    double pairs = (double)problem->lists.ptr[problem->point_count];
    snprintf(size, sizeof size, "%dD %lld nodes %lld points %.0f neighbours", dim,
             (long long)problem->cloud.node_count, (long long)problem->point_count,
             pairs / (double)problem->point_count);
    struct bench_row row = {.kernel = kernel,
                            .size = size,
                            .threads = threads,
                            .pairs = pairs,
                            .bytes = pairs * (4.0 + 8.0 * reals),
                            .rate = (double)problem->point_count,
                            .unit = "points/s",
                            .memory_per_node =
                                (problem_heap_bytes() - problem->heap) / (double)problem->cloud.node_count};
    bench_print(&row, &times);
}

static int most_threads(void)
{
    return omp_get_num_procs() > 1 ? 2 : 1;
}

static void bench_points(struct problem *problem, double seconds)
{
    int dim = problem->cells.dim;
    for (int threads = 1; threads <= most_threads(); threads++) {
        bench(problem, "neighbours", run_search, 0, threads, seconds);
        bench(problem, "support", problem_support, 0, threads, seconds);
        bench(problem, "shapefn", problem_gradients, 1 + dim, threads, seconds);
        bench(problem, "shapefn-values", problem_values, 1, threads, seconds);
    }
}

static void bench_cells(struct problem *problem, double seconds)
{
    struct error error;
    bench_check(problem_support(problem, &error), &error);
    for (int threads = 1; threads <= most_threads(); threads++) {
        bench(problem, "shapefn-edges", problem_values, 1, threads, seconds);
    }
}

static void bench_growth(struct problem *problem, double seconds)
{
    bench(problem, "growth-support", problem_support, 0, 1, seconds);
    bench(problem, "growth-shapefn", problem_gradients, 4, 1, seconds);
}

/* bench-approx [SECONDS]: time spent on each row. */
int main(int argc, char *argv[])
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1.0;
    problem_sweep(bench_points, bench_cells, bench_growth, seconds);
    return 0;
}
