#include "problem.h"

#include "bench.h"
#include "approx/cells/face_edges.h"
#include "base/memory.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

/* Bytes that the program has allocated. */
double problem_heap_bytes(void)
{
    struct mallinfo2 info = mallinfo2();
    return (double)info.uordblks + (double)info.hblkhd;
}

/* Lists by distance, as the tool support makes them; the space belongs to it. */
static enum status build_lists(const struct problem *problem, int64_t count, const double *x,
                               const char *name, struct neighbours *lists, struct error *error)
{
    struct support_options options = problem->options;
    FREED_BY(visibility_free) struct visibility space = {0};
    options.visibility = VISIBILITY_DISTANCE;
    support_free(lists);
    RETURN_IF_ERROR(visibility_build(&problem->cells, (struct supports){.radius = problem->radius},
                                     options.visibility, options.side, &space, error));
    return support_build(&options, &space, NULL, count, x, name, lists, error);
}

enum status problem_support(void *context, struct error *error)
{
    struct problem *problem = context;
    return build_lists(problem, problem->point_count, problem->points, "points.x", &problem->lists, error);
}

enum status problem_nodes(struct problem *problem, struct error *error)
{
    int64_t count = problem->cells.node_count;
    const double *x = problem->cells.x;
    RETURN_IF_ERROR(build_lists(problem, count, x, "nodes.x", &problem->node_lists, error));
    RETURN_IF_ERROR(NEW_ARRAY(&problem->node_phi, problem->node_lists.ptr[count], error));
    struct neighbours lists = problem->node_lists;
    return shape_table(&problem->options.mls, x, (struct supports){.radius = problem->radius}, &lists, x,
                       "nodes.x", problem->node_phi, NULL, error);
}

/* The table, allocated with the first run. */
static enum status run_shape(struct problem *problem, bool gradients, struct error *error)
{
    int64_t pairs = problem->lists.ptr[problem->point_count];
    struct neighbours lists = problem->lists;
    if (problem->phi == NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&problem->phi, pairs, error));
    }
    if (gradients && problem->dphi == NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&problem->dphi, pairs * problem->cloud.dim, error));
    }
    return shape_table(&problem->options.mls, problem->cloud.x, (struct supports){.radius = problem->radius},
                       &lists, problem->points, "points.x", problem->phi, gradients ? problem->dphi : NULL,
                       error);
}

enum status problem_gradients(void *context, struct error *error)
{
    return run_shape(context, true, error);
}

enum status problem_values(void *context, struct error *error)
{
    return run_shape(context, false, error);
}

/* A cube (square) of 0.1 m with that many nodes along each axis. The support radius is 2.12 times the
 * spacing: a support holds about 40 nodes in 3D, 14 in 2D. */
static enum status make_body(struct problem *problem, int dim, int64_t per_axis, double jitter,
                             struct error *error)
{
    struct cloud_options wanted = {.kind = CLOUD_JITTERED, .dim = dim, .jitter = jitter};
    *problem = (struct problem){.options = support_defaults(dim), .heap = problem_heap_bytes()};
    for (int a = 0; a < dim; a++) {
        wanted.count[a] = per_axis;
        wanted.high[a] = 0.1;
    }
    RETURN_IF_ERROR(cloud_make(&wanted, &problem->cloud, error));
    problem->cells = (struct cells){dim, problem->cloud.node_count, problem->cloud.x,
                                    problem->cloud.cell_count, problem->cloud.cells};
    problem->options.radius = 2.12 * 0.1 / (double)(per_axis - 1);
    RETURN_IF_ERROR(NEW_ARRAY(&problem->radius, problem->cells.node_count, error));
    return support_radii(&problem->options, problem->cells.node_count, NULL, problem->radius, error);
}

static enum status make_points(struct problem *problem, enum bench_points at, struct error *error)
{
    const struct cells *cells = &problem->cells;
    int dim = cells->dim;
    if (at == BENCH_FACES) {
        RETURN_IF_ERROR(faces_build(cells, false, &problem->faces, error));
    }
    problem->point_count = at == BENCH_CELLS   ? cells->count
                           : at == BENCH_NODES ? cells->node_count
                                               : face_point_count(&problem->faces);
    RETURN_IF_ERROR(NEW_ARRAY(&problem->points, problem->point_count * dim, error));
    if (at == BENCH_FACES) {
        face_points(&problem->faces, cells->x, problem->points);
    } else if (at == BENCH_NODES) {
        memcpy(problem->points, cells->x, (size_t)(problem->point_count * dim) * sizeof *problem->points);
    }
    for (int64_t c = 0; c < cells->count && at == BENCH_CELLS; c++) {
        cell_centroid(cells, c, problem->points + c * dim);
    }
    return STATUS_OK;
}

static void problem_free(struct problem *problem)
{
    cloud_free(&problem->cloud);
    faces_free(&problem->faces);
    support_free(&problem->lists);
    support_free(&problem->node_lists);
    free(problem->radius);
    free(problem->points);
    free(problem->phi);
    free(problem->node_phi);
    free(problem->dphi);
}

static void time_on(int dim, int64_t per_axis, double jitter, enum bench_points at, bench_function *run,
                    double seconds)
{
    struct problem problem;
    struct error error;
    bench_check(make_body(&problem, dim, per_axis, jitter, &error), &error);
    bench_check(make_points(&problem, at, &error), &error);
    run(&problem, seconds);
    problem_free(&problem);
}

void problem_large(bench_function *points, double seconds)
{
    time_on(3, 56, 0.12, BENCH_CELLS, points, seconds);
}

void problem_sweep(bench_function *points, bench_function *cells, bench_function *growth, double seconds)
{
    static const int64_t per_axis[] = {10, 22, 46, 100};
    time_on(2, 27, 0.3, BENCH_CELLS, points, seconds);
    time_on(3, 38, 0.12, BENCH_CELLS, points, seconds);
    time_on(2, 27, 0.3, BENCH_FACES, cells, seconds);
    time_on(3, 25, 0.12, BENCH_FACES, cells, seconds);
    for (int i = 0; i < 4; i++) {
        time_on(3, per_axis[i], 0.3, BENCH_NODES, growth, seconds);
    }
}
