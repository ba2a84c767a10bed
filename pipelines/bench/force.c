/* The force loop: one evaluation of the internal forces, in cache in 2D and with a table larger than the
 * caches in 3D, then the same cube from 1e3 to 1e6 nodes, points at the nodes. A row's bytes are those of its
 * table, once. */
#include "bench.h"
#include "problem.h"

#include "base/memory.h"
#include "solid/body.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A body on a problem's table, and a displacement field that strains it by some percent. */
struct loop {
    struct problem *problem;
    struct body body;
    double *u, *force;
    double heap; /* bytes that the body holds */
};

static enum status run_force(void *context, struct error *error)
{
    struct loop *loop = context;
    struct deformation deformation = body_force(&loop->body, loop->u, loop->force);
    if (!(deformation.least_jacobian > 0.0)) {
        return fail(error, STATUS_VERDICT, "force: point %lld is inverted", (long long)deformation.point);
    }
    return STATUS_OK;
}

/* Each cell's volume to its point; nodes share theirs. */
static enum status make_loop(struct loop *loop, struct problem *problem, bool averaged, struct error *error)
{
    enum status status;
    const struct cells *cells = &problem->cells;
    int dim = cells->dim, corners = dim + 1;
    int64_t count = problem->point_count;
    double *weight = NULL, *hat_value = NULL;
    int32_t *material_of = NULL;
    struct material material = {.model = MATERIAL_NEO_HOOKEAN, .density = 1000.0};
    *loop = (struct loop){.problem = problem};
    material_set_moduli(&material, 3000.0, 0.49);
    TRY(NEW_ARRAY(&weight, count, error));
    TRY(NEW_ARRAY(&material_of, count, error));
    TRY(NEW_ARRAY(&hat_value, count * corners, error));
    for (int64_t q = 0; q < count; q++) {
        weight[q] = count == cells->count ? cell_volume(cells, q) : 1e-3 / (double)count;
    }
    for (int64_t i = 0; i < count * corners; i++) {
        hat_value[i] = 1.0 / corners;
    }
    struct body_input input = {.dim = dim,
                               .node_count = cells->node_count,
                               .point_count = count,
                               .x = problem->points,
                               .weight = weight,
                               .ptr = problem->lists.ptr,
                               .idx = problem->lists.idx,
                               .dphi = problem->dphi,
                               .materials = &material,
                               .material = material_of,
                               .material_count = 1,
                               .hat_node = averaged ? cells->node : NULL,
                               .hat_value = hat_value,
                               .pointwise_share = 0.05,
                               .share_growth = 20.0};
    double before = problem_heap_bytes();
    TRY(body_build(&input, &loop->body, error));
    loop->heap = problem_heap_bytes() - before;
    TRY(NEW_ARRAY(&loop->u, cells->node_count * dim, error));
    TRY(NEW_ARRAY(&loop->force, cells->node_count * dim, error));
    for (int64_t i = 0; i < cells->node_count * dim; i++) {
        double x = cells->x[i];
        loop->u[i] = 0.03 * x + 0.2 * x * x;
    }
done:
    free(weight);
    free(material_of);
    free(hat_value);
    return status;
}

static void free_loop(struct loop *loop)
{
    body_free(&loop->body);
    free(loop->u);
    free(loop->force);
}

static void bench(struct problem *problem, const char *kernel, bool averaged, int threads, double seconds)
{
    struct bench_times times;
    struct error error;
    struct loop loop;
    char size[96];
    int dim = problem->cells.dim;
    omp_set_num_threads(threads);
    bench_check(make_loop(&loop, problem, averaged, &error), &error);
    bench_repeat(threads == 1 ? BENCH_CPU : BENCH_WALL, seconds, run_force, &loop, &times);
    double pairs = (double)loop.body.pair_count, nodes = (double)problem->cells.node_count;
    snprintf(size, sizeof size, "%dD %.0f nodes %lld points %.0f neighbours", dim, nodes,
             (long long)problem->point_count, pairs / (double)problem->point_count);
    struct bench_row row = {.kernel = kernel,
                            .size = size,
                            .threads = threads,
                            .precision = "double",
                            .pairs = pairs,
                            .bytes = pairs * (2.0 + 8.0 * dim),
                            .rate = 1.0,
                            .unit = "steps/s",
                            .memory_per_node = loop.heap / nodes};
    bench_print(&row, &times);
    free_loop(&loop);
}

static void bench_body(int dim, int64_t per_axis, double seconds)
{
    struct problem problem;
    struct error error;
    bench_check(problem_make(&problem, dim, per_axis, 2.12, dim == 2 ? 0.3 : 0.12, &error), &error);
    bench_check(problem_points_in_cells(&problem, &error), &error);
    bench_check(problem_support(&problem, &error), &error);
    bench_check(problem_gradients(&problem, &error), &error);
    for (int threads = 1; threads <= 2; threads++) {
        bench(&problem, "force", false, threads, seconds);
        bench(&problem, "force-nodal-volume", true, threads, seconds);
    }
    problem_free(&problem);
}

static void bench_growth(int64_t per_axis, double seconds)
{
    struct problem problem;
    struct error error;
    bench_check(problem_make(&problem, 3, per_axis, 2.12, 0.3, &error), &error);
    bench_check(problem_points_at_nodes(&problem, &error), &error);
    bench_check(problem_support(&problem, &error), &error);
    bench_check(problem_gradients(&problem, &error), &error);
    bench(&problem, "growth-force", false, 1, seconds);
    problem_free(&problem);
}

/* bench-force [SECONDS]: time spent on each row. */
int main(int argc, char *argv[])
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1.0;
    bench_body(2, 27, seconds);
    bench_body(3, 38, seconds);
    static const int64_t per_axis[] = {10, 22, 46, 100};
    for (int i = 0; i < 4; i++) {
        bench_growth(per_axis[i], seconds);
    }
    return 0;
}
