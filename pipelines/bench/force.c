/* The force loop: one evaluation of the internal forces, in cache in 2D and with a table larger than the
 * caches in 3D, by tables of gradients at points and by means over the faces of smoothed cells; then the
 * same cube from 1e3 to 1e6 nodes, points at the nodes, and with a million points in cells. A row's bytes are
 * those of its operator, once; an evaluation reads it, and then its transpose.
 */
#include "bench.h"
#include "problem.h"

#include "base/memory.h"
#include "solid/body/body.h"

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

/* What is timed. */
struct variant {
    const char *kernel;
    bool averaged, smoothed;
};

/* Each cell's volume belongs to its point, at its centroid; points at the nodes share the body's. */
static enum status build_body(const struct problem *problem, const struct variant *variant, struct body *body,
                              struct error *error)
{
    const struct cells *cells = &problem->cells;
    int dim = cells->dim;
    int64_t count = variant->smoothed ? cells->count : problem->point_count;
    FREED_BY(shape_rows_free) struct shape_rows edges = {0};
    struct material material = {.model = MATERIAL_NEO_HOOKEAN, .density = 1000.0};
    material_set_moduli(&material, 3000.0, 0.49);
    if (variant->smoothed) {
        RETURN_IF_ERROR(shape_on_edges(&problem->lists, problem->phi, &problem->faces, &edges, error));
    }
    NEW_SCRATCH(double, weight, count, error);
    NEW_SCRATCH(int32_t, none, count, error);
    NEW_SCRATCH(int32_t, cell, count, error);
    NEW_SCRATCH(double, x, count * dim, error);
    for (int64_t q = 0; q < count; q++) {
        cell[q] = (int32_t)q;
        weight[q] = count == cells->count ? cell_volume(cells, q) : 1e-3 / (double)count;
        if (variant->smoothed) {
            cell_centroid(cells, q, x + q * dim);
        }
    }
    const struct neighbours rows = {
        .count = face_row_count(&problem->faces), .ptr = edges.ptr, .idx = edges.idx};
    struct body_input input = {.cells = *cells,
                               .faces = variant->smoothed ? &problem->faces : NULL,
                               .point_count = count,
                               .x = variant->smoothed ? x : problem->points,
                               .weight = weight,
                               .cell = variant->averaged ? cell : NULL,
                               .lists = variant->smoothed ? &rows : &problem->lists,
                               .node_lists = &problem->node_lists,
                               .dphi = problem->dphi,
                               .phi = edges.phi,
                               .node_phi = problem->node_phi,
                               .materials = &material,
                               .material = none,
                               .material_count = 1};
    return body_build(&input, body, error);
}

static enum status make_loop(struct loop *loop, struct problem *problem, const struct variant *variant,
                             struct error *error)
{
    const struct cells *cells = &problem->cells;
    *loop = (struct loop){.problem = problem};
    double before = problem_heap_bytes();
    RETURN_IF_ERROR(build_body(problem, variant, &loop->body, error));
    loop->heap = problem_heap_bytes() - before;
    RETURN_IF_ERROR(NEW_ARRAY(&loop->u, cells->node_count * cells->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&loop->force, cells->node_count * cells->dim, error));
    for (int64_t i = 0; i < cells->node_count * cells->dim; i++) {
        double x = cells->x[i];
        loop->u[i] = 0.03 * x + 0.2 * x * x;
    }
    return STATUS_OK;
}

static void free_loop(struct loop *loop)
{
    body_free(&loop->body);
    free(loop->u);
    free(loop->force);
}

/* Bytes of the operator. */
static double table_bytes(const struct body *body)
{
    const struct sparse *matrix = &body->rows.matrix;
    return (double)matrix->ptr[matrix->row_count] * (double)(sizeof *matrix->value + sizeof *matrix->idx);
}

static void bench(struct problem *problem, const struct variant *variant, int threads, double seconds)
{
    struct bench_times times;
    struct error error;
    struct loop loop;
    char size[96];
    omp_set_num_threads(threads);
    bench_check(make_loop(&loop, problem, variant, &error), &error);
    bench_repeat(threads == 1 ? BENCH_CPU : BENCH_WALL, seconds, run_force, &loop, &times);
    double pairs = (double)loop.body.pair_count, nodes = (double)problem->cells.node_count;
    snprintf(size, sizeof size, "%dD %.0f nodes %lld points %.0f neighbours", problem->cells.dim, nodes,
             (long long)loop.body.point_count, pairs / (double)loop.body.point_count);
    struct bench_row row = {.kernel = variant->kernel,
                            .size = size,
                            .threads = threads,
                            .pairs = pairs,
                            .bytes = table_bytes(&loop.body),
                            .rate = 1.0,
                            .unit = "steps/s",
                            .memory_per_node = loop.heap / nodes};
    bench_print(&row, &times);
    free_loop(&loop);
}

static void bench_all(struct problem *problem, bool smoothed, double seconds)
{
    for (int k = 0; k < 4; k++) {
        bool averaged = k % 2 == 1;
        const char *kernel = smoothed   ? averaged ? "cells-nodal-volume" : "cells"
                             : averaged ? "force-nodal-volume"
                                        : "force";
        struct variant variant = {kernel, averaged, smoothed};
        bench(problem, &variant, k / 2 + 1, seconds);
    }
}

static void bench_points(struct problem *problem, double seconds)
{
    struct error error;
    bench_check(problem_support(problem, &error), &error);
    bench_check(problem_gradients(problem, &error), &error);
    bench_all(problem, false, seconds);
}

static void bench_cells(struct problem *problem, double seconds)
{
    struct error error;
    bench_check(problem_support(problem, &error), &error);
    bench_check(problem_values(problem, &error), &error);
    bench_check(problem_nodes(problem, &error), &error);
    bench_all(problem, true, seconds);
}

static void bench_growth(struct problem *problem, double seconds)
{
    struct error error;
    static const struct variant variant = {"growth-force", false, false};
    bench_check(problem_support(problem, &error), &error);
    bench_check(problem_gradients(problem, &error), &error);
    bench(problem, &variant, 1, seconds);
}

static void bench_large(struct problem *problem, double seconds)
{
    struct error error;
    bench_check(problem_support(problem, &error), &error);
    bench_check(problem_gradients(problem, &error), &error);
    static const struct variant variant = {"force", false, false};
    bench(problem, &variant, 1, seconds);
    bench(problem, &variant, 2, seconds);
}

/* bench-force [SECONDS]: time spent on each row. */
int main(int argc, char *argv[])
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1.0;
    problem_sweep(bench_points, bench_cells, bench_growth, seconds);
    problem_large(bench_large, seconds);
    return 0;
}
