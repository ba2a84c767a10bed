/* Small bodies for tests of whole systems: a box of lattice cells with its table of shape functions, supports
 * and loads on its sides, built through lib/approx and solid/assembly.h as the tools do it. */
#ifndef TESTS_LATTICE_FIXTURE_H
#define TESTS_LATTICE_FIXTURE_H

#include "cell_table.h"
#include "unit.h"

#include "approx/cloud.h"
#include "approx/quadrature.h"
#include "approx/support.h"
#include "solid/assembly.h"

/* What to build. Sides of the box are numbered 2 * axis, + 1 at the high end. */
struct lattice_options {
    int dim;
    int64_t count[3]; /* nodes along each axis */
    double size[3];   /* m, from the origin */
    double jitter;
    int gauss_points; /* 0: smoothed cells */
    bool nodal_volume;
    double youngs_modulus, poisson_ratio, density;
};

struct lattice {
    struct lattice_options options;
    struct cloud cloud;
    struct cells cells;
    struct faces faces;
    double *radius, *face_x, *point_x, *weight;
    int32_t *point_cell;
    struct point_grid grid;
    struct support_lists face_lists, node_lists, point_lists;
    double *face_phi, *node_phi, *point_phi, *point_dphi;
    struct face_averages averages;
    struct cell_table smoothed;
    struct assembly assembly;
    struct solid_system system;
};

/* The base material of the hard cases, on a box of `n` nodes along each axis of 0.1 m. */
static inline struct lattice_options lattice_defaults(int dim, int64_t n)
{
    return (struct lattice_options){.dim = dim,
                                    .count = {n, n, n},
                                    .size = {0.1, 0.1, 0.1},
                                    .nodal_volume = true,
                                    .youngs_modulus = 3000.0,
                                    .poisson_ratio = 0.49,
                                    .density = 1000.0};
}

/* Values of phi at points; gradients too unless *dphi is to stay NULL. */
static inline void lattice_tabulate(struct lattice *l, int64_t count, const double *x,
                                    struct support_lists *lists, double **phi, double **dphi)
{
    struct error error;
    struct support_options options = support_defaults(l->options.dim);
    GOOD(support_build(&options, &l->grid, count, x, "points", lists, &error));
    struct neighbours neighbours = support_view(lists);
    ARRAY(*phi, lists->ptr[count]);
    if (dphi != NULL) {
        ARRAY(*dphi, lists->ptr[count] * l->options.dim);
    }
    GOOD(shape_table(&options.mls, l->cells.x, l->radius, &neighbours, x, "points", *phi,
                     dphi != NULL ? *dphi : NULL, &error));
}

/* Shape functions on the faces, and their averages of smoothed cells. */
static inline void lattice_faces(struct lattice *l)
{
    struct error error;
    int dim = l->options.dim;
    struct support_options support = support_defaults(dim);
    GOOD(faces_build(&l->cells, l->options.gauss_points > 0, &l->faces, &error));
    int64_t count = face_row_point(&l->faces, l->faces.row_count);
    ARRAY(l->face_x, count * dim);
    face_rows_points(&l->faces, l->cells.x, l->face_x);
    lattice_tabulate(l, count, l->face_x, &l->face_lists, &l->face_phi, NULL);
    struct neighbours lists = support_view(&l->face_lists);
    GOOD(shape_average_faces(&support.mls, l->cells.x, l->radius, &lists, l->face_x, "faces", &l->faces,
                             &l->averages, &error));
    if (l->options.gauss_points == 0) {
        l->smoothed = cell_table_make(&l->cells, &l->faces, &l->averages);
    }
}

/* Integration points: one for each smoothed cell, or Gauss points with gradients. */
static inline int64_t lattice_points(struct lattice *l)
{
    struct error error;
    int dim = l->options.dim, each = l->options.gauss_points > 0 ? l->options.gauss_points : 1;
    int64_t count = l->cells.count * each;
    struct quadrature_rule rule;
    GOOD(quadrature_cell_rule(dim, each, &rule, &error));
    ARRAY(l->point_x, count * dim);
    ARRAY(l->weight, count);
    ARRAY(l->point_cell, count);
    for (int64_t c = 0; c < l->cells.count; c++) {
        quadrature_positions(&rule, dim, l->cells.x, l->cells.node + c * (dim + 1),
                             l->point_x + c * each * dim);
        for (int64_t q = c * each; q < (c + 1) * each; q++) {
            l->weight[q] = cell_volume(&l->cells, c) * rule.weight[q - c * each];
            l->point_cell[q] = (int32_t)c;
        }
    }
    if (l->options.gauss_points > 0) {
        lattice_tabulate(l, count, l->point_x, &l->point_lists, &l->point_phi, &l->point_dphi);
    }
    return count;
}

/* The system, of one material and without conditions. */
static inline void lattice_system(struct lattice *l, int64_t point_count)
{
    struct error error, note;
    struct material_list list = {.count = 1};
    ARRAY(list.items, 1);
    ARRAY(list.of_point, point_count);
    ARRAY(list.of_cell, l->cells.count);
    ARRAY(list.section, 1);
    list.items[0] = (struct material){.model = MATERIAL_NEO_HOOKEAN, .density = l->options.density};
    material_set_moduli(&list.items[0], l->options.youngs_modulus, l->options.poisson_ratio);
    bool smoothed = l->options.gauss_points == 0;
    struct neighbours averages = {.count = l->averages.count, .ptr = l->averages.ptr, .idx = l->averages.idx};
    l->assembly = (struct assembly){.cells = l->cells,
                                    .faces = l->faces,
                                    .smoothed = smoothed,
                                    .point_count = point_count,
                                    .x = l->point_x,
                                    .weight = l->weight,
                                    .point_cell = l->point_cell,
                                    .lists = smoothed ? averages : support_view(&l->point_lists),
                                    .boundary_lists = support_view(&l->face_lists),
                                    .node_lists = support_view(&l->node_lists),
                                    .phi = smoothed ? l->averages.phi : l->point_phi,
                                    .dphi = l->point_dphi,
                                    .boundary_phi = l->face_phi,
                                    .node_phi = l->node_phi,
                                    .materials = list,
                                    .pointwise_volume = !l->options.nodal_volume};
    assembly_complete(&l->assembly);
    GOOD(assembly_build(&l->assembly, &l->system, &note, &error));
}

static inline void lattice_build(struct lattice *l, const struct lattice_options *options)
{
    struct error error;
    int dim = options->dim;
    double *spacing;
    *l = (struct lattice){.options = *options};
    struct cloud_options cloud = {.kind = options->jitter > 0.0 ? CLOUD_JITTERED : CLOUD_REGULAR,
                                  .dim = dim,
                                  .count = {options->count[0], options->count[1], options->count[2]},
                                  .high = {options->size[0], options->size[1], options->size[2]},
                                  .jitter = options->jitter,
                                  .seed = 1};
    GOOD(cloud_make(&cloud, &l->cloud, &error));
    assert_true(l->cloud.cell_count > 0);
    l->cells = (struct cells){.dim = dim,
                              .node_count = l->cloud.node_count,
                              .x = l->cloud.x,
                              .count = l->cloud.cell_count,
                              .node = l->cloud.cells};
    struct support_options support = support_defaults(dim);
    support.factor = 1.8; /* wider ones need the springs that back conditions, which are not here */
    ARRAY(spacing, l->cells.node_count);
    ARRAY(l->radius, l->cells.node_count);
    GOOD(cells_node_spacing(&l->cells, spacing, &error));
    GOOD(support_radii(&support, l->cells.node_count, spacing, l->radius, &error));
    free(spacing);
    GOOD(point_grid_build(&l->grid, dim, l->cells.node_count, l->cells.x, l->radius, &error));
    lattice_faces(l);
    lattice_tabulate(l, l->cells.node_count, l->cells.x, &l->node_lists, &l->node_phi, NULL);
    lattice_system(l, lattice_points(l));
}

static inline void lattice_free(struct lattice *l)
{
    system_free(&l->system);
    material_list_free(&l->assembly.materials);
    face_averages_free(&l->averages);
    cell_table_free(&l->smoothed);
    support_free(&l->face_lists);
    support_free(&l->node_lists);
    support_free(&l->point_lists);
    point_grid_free(&l->grid);
    faces_free(&l->faces);
    cloud_free(&l->cloud);
    free(l->radius);
    free(l->face_x);
    free(l->point_x);
    free(l->weight);
    free(l->point_cell);
    free(l->face_phi);
    free(l->node_phi);
    free(l->point_phi);
    free(l->point_dphi);
}

/* Append a load curve. */
static inline int32_t lattice_curve(struct lattice *l, struct load_curve curve)
{
    int64_t count = l->system.curve_count;
    l->system.curves = realloc(l->system.curves, ((size_t)count + 1) * sizeof curve);
    l->system.factor = realloc(l->system.factor, ((size_t)count + 1) * sizeof *l->system.factor);
    assert_non_null(l->system.curves);
    assert_non_null(l->system.factor);
    l->system.factor[count] = 0.0; /* until a load is set */
    l->system.curves[count] = curve;
    l->system.curve_count++;
    return (int32_t)count;
}

/* The boundary averages over the sides in `sides` (bit 2 * axis, + 1 at the high end), split at corners. */
static inline struct boundary_averages lattice_averages(const struct lattice *l, unsigned sides)
{
    struct error error;
    struct boundary_averages averages;
    int dim = l->options.dim;
    int32_t *facet;
    struct facet_set set = {0};
    ARRAY(facet, l->cloud.facet_count * dim);
    for (int64_t f = 0; f < l->cloud.facet_count; f++) {
        if (sides >> l->cloud.facet_set[f] & 1u) {
            memcpy(facet + set.count++ * dim, l->cloud.facets + f * dim, (size_t)dim * sizeof *facet);
        }
    }
    set.facet = facet;
    GOOD(boundary_averages_build(&l->assembly.face_table, &set, &averages, &error));
    free(facet);
    return averages;
}

/* Prescribe u . direction = value(X) on every average of the sides; value NULL: 0. The average of a linear
 * field is its value at the average's position. */
static inline void lattice_prescribe(struct lattice *l, unsigned sides, const double direction[3],
                                     double (*value)(const double *X, const double *parameters),
                                     const double *parameters, int32_t curve)
{
    struct error error;
    int dim = l->options.dim;
    struct boundary_averages averages = lattice_averages(l, sides);
    for (int64_t a = 0; a < averages.count; a++) {
        int64_t at = averages.ptr[a];
        double target = value != NULL ? value(averages.position + a * dim, parameters) : 0.0;
        GOOD(constraint_rows_add(&l->system.rows, averages.ptr[a + 1] - at, averages.idx + at,
                                 averages.phi + at, direction, target, curve, (int32_t)sides,
                                 averages.node[a], &error));
    }
    boundary_averages_free(&averages);
}

/* A sliding support: the normal displacement of each of the sides is 0. */
static inline void lattice_slide(struct lattice *l, unsigned sides, int32_t curve)
{
    for (int side = 0; side < 2 * l->options.dim; side++) {
        double direction[3] = {0.0, 0.0, 0.0};
        direction[side / 2] = 1.0;
        if (sides >> side & 1u) {
            lattice_prescribe(l, 1u << side, direction, NULL, NULL, curve);
        }
    }
}

static inline double lattice_constant(const double *X, const double *parameters)
{
    (void)X;
    return parameters[0];
}

/* Displace a side along its axis by `value`, m. */
static inline void lattice_push(struct lattice *l, int side, double value, int32_t curve)
{
    double direction[3] = {0.0, 0.0, 0.0};
    direction[side / 2] = 1.0;
    lattice_prescribe(l, 1u << side, direction, lattice_constant, &value, curve);
}

/* The sum of the row forces over rows of the given sides, along their directions. */
static inline double lattice_reaction(const struct lattice *l, const double *row_force, unsigned sides)
{
    double sum = 0.0;
    for (int64_t r = 0; r < l->system.rows.count; r++) {
        sum += l->system.rows.section[r] == (int32_t)sides ? row_force[r] : 0.0;
    }
    return sum;
}

/* u_h at a node, component by component. */
static inline double lattice_field(const struct lattice *l, const double *u, int64_t node, int axis)
{
    double sum = 0.0;
    for (int64_t i = l->node_lists.ptr[node]; i < l->node_lists.ptr[node + 1]; i++) {
        sum += l->node_phi[i] * u[(int64_t)l->node_lists.idx[i] * l->options.dim + axis];
    }
    return sum;
}

static inline double *lattice_vector(const struct lattice *l)
{
    double *vector;
    ARRAY(vector, l->system.node_count * l->options.dim);
    return vector;
}

#endif
