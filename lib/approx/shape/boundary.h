/* Boundary averages: means of a field over the facets around a boundary node, weighted by its linear hat
 * function. Constraints and contact act on them. The average at a boundary node a is Phi_a u = integral(N_a
 * u_h ds) / integral(N_a ds) over the facets of a set, equation (17) of lib/README.md. Where the boundary
 * turns sharply at a node, or an interface at which supports stop meets it, there is one average for each
 * side, so that the multipliers can carry a traction that jumps there. With the quadrature of the smoothed
 * cells, the linear patch test then holds to round-off. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/shape/shape.h"

/* Facets of a set: facet[count * dim] node indices, oriented outward. */
struct facet_set {
    int64_t count;
    const int32_t *facet;
};

/* The faces of a body with the values of the shape functions at their quadrature points. */
struct face_table {
    int dim;
    int64_t node_count;
    const double *x; /* nodes, m */
    const struct faces *faces;
    int per_face;                   /* quadrature points of each face */
    const struct neighbours *lists; /* of the points of the faces */
    const double *phi;
    const int32_t
        *cell_side; /* of each cell, the side of the interfaces at which supports stop; NULL: none */
};

/* One boundary average per node and side. */
struct boundary_averages {
    int64_t count;
    int32_t *node;         /* count: the boundary node a */
    double *area;          /* count: integral of N_a, m or m2 */
    double *normal;        /* count * dim: mean outward unit normal */
    double *position;      /* count * dim: integral(N_a X) / integral(N_a), m */
    int64_t *ptr;          /* count + 1 */
    int32_t *idx;          /* neighbours, ascending */
    double *phi;           /* their weights, sum 1 */
    int64_t *sample_ptr;   /* count + 1: quadrature points (samples) of each average */
    double *sample_x;      /* sample_ptr[count] * dim, m */
    double *sample_share;  /* their shares, sum 1 for each average */
    int64_t *sample_point; /* of boundary averages: the index of each sample among the points of
                              boundary_points_build of the same set */
};

/* Build the averages of a facet set, ordered by node, then by facet. STATUS_INPUT if a facet is not a face of
 * the table. */
MUST_CHECK enum status boundary_averages_build(const struct face_table *table, const struct facet_set *set,
                                               struct boundary_averages *averages, struct error *error);

/* As boundary_averages_build, followed by one average over each whole side of the set. A side is a part of
 * the set within which facets that share an edge (2D: a node) turn by less than 45 degrees. With `split` a
 * node on an edge between two sides has a boundary average for each side; without it, one for both. The sides
 * and the averages are to be freed, also on failure. */
struct boundary_sides {
    int64_t node_average_count; /* averages before this one are boundary averages, the others sides */
    int64_t group_count;
    int64_t *group;       /* averages.count: with `split` the side of each average, else the piece of the set,
                             connected by nodes, that contains it */
    int64_t *facet_group; /* of each facet of the set */
    bool *flat;           /* averages.count: all of its facets have the same normal, to a thousandth */
};
MUST_CHECK enum status boundary_sides_build(const struct face_table *table, const struct facet_set *set,
                                            bool split, struct boundary_averages *averages,
                                            struct boundary_sides *sides, struct error *error);
void boundary_sides_free(struct boundary_sides *sides);

/* Values at the nodes, extrapolated from the quadrature points of the facets: the mean over the facets of the
 * set at a node, weighted by their size, of the linear function through a facet's quadrature points. The
 * surface with these corners is continuous and follows a linear field exactly. It distributes a uniform
 * traction over the nodes like the quadrature of (17). One entry per node; areas and normals as above. */
MUST_CHECK enum status boundary_corners_build(const struct face_table *table, const struct facet_set *set,
                                              struct boundary_averages *averages, struct error *error);

/* Node values, Phi_a u = u_h(x_a), from a table at the nodes: one entry per node of the set, also where the
 * boundary turns sharply; areas and normals as above. */
MUST_CHECK enum status boundary_nodes_build(const struct face_table *table, const struct facet_set *set,
                                            const struct neighbours *node_lists, const double *node_phi,
                                            struct boundary_averages *averages, struct error *error);

/* Node values at nodes[count], anywhere in the body: one entry with one sample for each; areas and normals
 * are 0. x, lists and phi are those of all nodes. */
MUST_CHECK enum status boundary_list_build(int dim, const double *x, const int32_t *nodes, int64_t count,
                                           const struct neighbours *lists, const double *phi,
                                           struct boundary_averages *averages, struct error *error);

/* As boundary_averages_build, with the values at the quadrature points of the facets: one entry per point,
 * `area` its weight, `node` the first node of its facet. */
MUST_CHECK enum status boundary_points_build(const struct face_table *table, const struct facet_set *set,
                                             struct boundary_averages *averages, struct error *error);

/* By how much the facets around boundary node a are stretched: their area with nodes at x[table->node_count *
 * dim], m, by that at rest; weighted as the average. boundary_averages_build made `averages` of `set`. */
double boundary_stretch(const struct boundary_averages *averages, const struct face_table *table,
                        const struct facet_set *set, int64_t a, const double *x);

/* Edges of the boundary (2D: nodes) at which the stress is singular. Junctions of the prescribed and the free
 * boundary: smooth, where it turns by less than 45 degrees; sharp, where it turns by more. Re-entrant edges,
 * such as the tip of a slit: it turns inwards by more. */
enum boundary_junction {
    BOUNDARY_JUNCTION_SMOOTH = 1,
    BOUNDARY_JUNCTION_SHARP = 2,
    BOUNDARY_REENTRANT = 4,
};

/* Set junction[table->node_count] at the nodes of edges of these kinds, one or the sum of several; others are
 * left as they are.
 * held[table->faces->count]: the prescribed faces; constrained[table->faces->count]: these and all others
 * that are not free. */
MUST_CHECK enum status boundary_find_junctions(const struct face_table *table, int kinds, const bool *held,
                                               const bool *constrained, bool *junction, struct error *error);

void boundary_averages_free(struct boundary_averages *averages);
