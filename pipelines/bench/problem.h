/* Bodies that the kernels are timed on: a jittered square or cube, default MLS (MMLS, quadratic) supports. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/points/cloud.h"
#include "approx/shape/shape.h"
#include "approx/support/support.h"

struct problem {
    struct support_options options;
    struct cloud cloud;
    struct cells cells;
    struct faces faces;
    double *radius, *points, *phi, *dphi;
    int64_t point_count;
    struct neighbours lists;      /* of the points, */
    struct neighbours node_lists; /* and of the nodes with their values, by problem_nodes */
    double *node_phi;
    double heap; /* bytes in use before any list or table */
};

/* Bytes that the program has allocated. */
double problem_heap_bytes(void);

/* Where the points are: one in each cell, those of the faces' quadrature, or at the nodes. */
enum bench_points { BENCH_CELLS, BENCH_FACES, BENCH_NODES };

/* The stages; the context is the struct problem. Lists as the tool support makes them, tables of values with
 * gradients or without, allocated with the first run. */
MUST_CHECK enum status problem_support(void *context, struct error *error);
MUST_CHECK enum status problem_gradients(void *context, struct error *error);
MUST_CHECK enum status problem_values(void *context, struct error *error);

/* The lists and values of the field at the nodes. */
MUST_CHECK enum status problem_nodes(struct problem *problem, struct error *error);

/* Makes the bodies that kernels are timed on, one after the other: with a point in each cell, in 2D and 3D;
 * with points on the faces of smoothed cells (about twelve times the nodes), in 2D and 3D; and cubes of 1e3
 * to 1e6 nodes with points at the nodes, which tell how things grow. A failure ends the program. */
typedef void bench_function(struct problem *problem, double seconds);
void problem_sweep(bench_function *points, bench_function *cells, bench_function *growth, double seconds);

/* The cube with a million points in cells: its table does not fit caches of hundreds of
 * megabytes. */
void problem_large(bench_function *points, double seconds);
