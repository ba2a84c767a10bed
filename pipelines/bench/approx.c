/* Neighbour lists, shape functions and the smoothing of conforming cells: default MLS (MMLS, quadratic), on a
 * jittered cloud in which a support holds about 40 nodes in 3D, 14 in 2D. Then the same cube from 1e3 to 1e6
 * nodes, points at the nodes: what a pair costs and a node holds as problems grow. */
#include "bench.h"

#include "approx/cells.h"
#include "approx/cloud.h"
#include "approx/quadrature.h"
#include "approx/shape.h"
#include "approx/support.h"
#include "base/memory.h"

#include <malloc.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct problem {
    struct support_options options;
    struct cloud cloud;
    struct cells cells;
    struct faces faces;
    struct smoothed_table smoothed;
    double *radius, *points, *phi, *dphi;
    int64_t point_count;
    struct support_lists lists;
    double heap; /* bytes in use before any list or table */
};

/* Bytes that the program has allocated. */
static double heap_bytes(void)
{
    struct mallinfo2 info = mallinfo2();
    return (double)info.uordblks + (double)info.hblkhd;
}

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

static struct neighbours view_of(const struct problem *problem)
{
    return (struct neighbours){problem->point_count, problem->lists.ptr, problem->lists.idx,
                               problem->lists.widen};
}

/* The table, allocated with the first run. */
static enum status run_shape(struct problem *problem, bool gradients, struct error *error)
{
    enum status status;
    int64_t pairs = problem->lists.ptr[problem->point_count];
    struct neighbours lists = view_of(problem);
    if (problem->phi == NULL) {
        TRY(NEW_ARRAY(&problem->phi, pairs, error));
    }
    if (gradients && problem->dphi == NULL) {
        TRY(NEW_ARRAY(&problem->dphi, pairs * problem->cloud.dim, error));
    }
    TRY(shape_table(&problem->options.mls, problem->cloud.x, problem->radius, &lists, problem->points,
                    "points.x", problem->phi, gradients ? problem->dphi : NULL, error));
done:
    return status;
}

static enum status run_gradients(void *context, struct error *error)
{
    return run_shape(context, true, error);
}

static enum status run_values(void *context, struct error *error)
{
    return run_shape(context, false, error);
}

static enum status run_smooth(void *context, struct error *error)
{
    struct problem *problem = context;
    struct neighbours lists = view_of(problem);
    smoothed_table_free(&problem->smoothed);
    return shape_smooth(&problem->cells, &problem->faces, quadrature_face_rule(problem->cells.dim).points,
                        &lists, problem->phi, &problem->smoothed, error);
}

/* A cube (square) of that many nodes along each axis, support radius = factor times its spacing. */
static enum status make_body(struct problem *problem, int dim, int64_t per_axis, double factor, double jitter,
                             struct error *error)
{
    enum status status;
    struct cloud_options wanted = {.kind = CLOUD_JITTERED, .dim = dim, .jitter = jitter};
    *problem = (struct problem){.options = support_defaults(dim), .heap = heap_bytes()};
    for (int a = 0; a < dim; a++) {
        wanted.count[a] = per_axis;
        wanted.high[a] = 0.1;
    }
    TRY(cloud_make(&wanted, &problem->cloud, error));
    problem->cells = (struct cells){dim, problem->cloud.node_count, problem->cloud.x,
                                    problem->cloud.cell_count, problem->cloud.cells};
    problem->options.radius = factor * 0.1 / (double)(per_axis - 1);
    TRY(NEW_ARRAY(&problem->radius, problem->cells.node_count, error));
    TRY(support_radii(&problem->options, problem->cells.node_count, NULL, problem->radius, error));
done:
    return status;
}

static enum status points_in_cells(struct problem *problem, struct error *error)
{
    int dim = problem->cells.dim;
    problem->point_count = problem->cells.count;
    enum status status = NEW_ARRAY(&problem->points, problem->point_count * dim, error);
    for (int64_t c = 0; status == STATUS_OK && c < problem->point_count; c++) {
        cell_centroid(&problem->cells, c, problem->points + c * dim);
    }
    return status;
}

static enum status points_on_faces(struct problem *problem, struct error *error)
{
    enum status status;
    int dim = problem->cells.dim;
    struct quadrature_rule rule = quadrature_face_rule(dim);
    TRY(faces_build(&problem->cells, false, &problem->faces, error));
    problem->point_count = problem->faces.count * rule.points;
    TRY(NEW_ARRAY(&problem->points, problem->point_count * dim, error));
    for (int64_t f = 0; f < problem->faces.count; f++) {
        quadrature_positions(&rule, dim, problem->cells.x, problem->faces.node + f * dim,
                             problem->points + f * rule.points * dim);
    }
done:
    return status;
}

static enum status points_at_nodes(struct problem *problem, struct error *error)
{
    size_t size = (size_t)(problem->cells.node_count * problem->cells.dim);
    problem->point_count = problem->cells.node_count;
    enum status status = NEW_ARRAY(&problem->points, (int64_t)size, error);
    if (status == STATUS_OK) {
        memcpy(problem->points, problem->cells.x, size * sizeof *problem->points);
    }
    return status;
}

static void tear_down(struct problem *problem)
{
    cloud_free(&problem->cloud);
    faces_free(&problem->faces);
    support_free(&problem->lists);
    smoothed_table_free(&problem->smoothed);
    free(problem->radius);
    free(problem->points);
    free(problem->phi);
    free(problem->dphi);
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
                            .precision = "double",
                            .pairs = pairs,
                            .bytes = pairs * (4.0 + 8.0 * reals),
                            .rate = (double)problem->point_count,
                            .unit = "points/s",
                            .memory_per_node =
                                (heap_bytes() - problem->heap) / (double)problem->cloud.node_count};
    bench_print(&row, &times);
}

static int most_threads(void)
{
    return omp_get_num_procs() > 1 ? 2 : 1;
}

static void bench_body(int dim, int64_t per_axis, double seconds)
{
    struct problem problem;
    struct error error;
    bench_check(make_body(&problem, dim, per_axis, 2.12, dim == 2 ? 0.3 : 0.12, &error), &error);
    bench_check(points_in_cells(&problem, &error), &error);
    for (int threads = 1; threads <= most_threads(); threads++) {
        bench(&problem, "neighbours", run_search, 0, threads, seconds);
        bench(&problem, "support", run_support, 0, threads, seconds);
        bench(&problem, "shapefn", run_gradients, 1 + dim, threads, seconds);
        bench(&problem, "shapefn-values", run_values, 1, threads, seconds);
    }
    tear_down(&problem);
}

/* Face points of a conforming body: about twelve times its nodes. */
static void bench_smooth(int dim, int64_t per_axis, double seconds)
{
    struct problem problem;
    struct error error;
    bench_check(make_body(&problem, dim, per_axis, 2.12, dim == 2 ? 0.3 : 0.12, &error), &error);
    bench_check(points_on_faces(&problem, &error), &error);
    bench_check(run_support(&problem, &error), &error);
    bench_check(run_values(&problem, &error), &error);
    for (int threads = 1; threads <= most_threads(); threads++) {
        bench(&problem, "shapefn-smooth", run_smooth, 1, threads, seconds);
    }
    tear_down(&problem);
}

static void bench_growth(int64_t per_axis, double seconds)
{
    struct problem problem;
    struct error error;
    bench_check(make_body(&problem, 3, per_axis, 2.12, 0.3, &error), &error);
    bench_check(points_at_nodes(&problem, &error), &error);
    bench(&problem, "growth-support", run_support, 0, 1, seconds);
    bench(&problem, "growth-shapefn", run_gradients, 4, 1, seconds);
    tear_down(&problem);
}

/* bench-approx [SECONDS]: time spent on each row. */
int main(int argc, char *argv[])
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1.0;
    bench_body(2, 27, seconds);
    bench_body(3, 38, seconds);
    bench_smooth(2, 27, seconds);
    bench_smooth(3, 25, seconds);
    static const int64_t per_axis[] = {10, 22, 46, 100};
    for (int i = 0; i < 4; i++) {
        bench_growth(per_axis[i], seconds);
    }
    return 0;
}
