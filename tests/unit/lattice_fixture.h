/* Small bodies for tests of whole systems: a box of lattice cells, its tables and its system as the tools
 * make them, and conditions on its sides. */
#pragma once

#include "cell_table.h"
#include "tables_fixture.h"

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
    struct stream stream;
    struct assembly assembly;   /* in view of the stream */
    struct cell_table smoothed; /* of smoothed cells: shape functions in each */
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

/* The system: of one material, and without conditions. */
static inline void lattice_build(struct lattice *l, const struct lattice_options *options)
{
    struct error note;
    struct assembly *assembly = &l->assembly;
    struct material_list *list = &assembly->materials;
    *l = (struct lattice){.options = *options};
    struct cloud_options cloud = {.kind = options->jitter > 0.0 ? CLOUD_JITTERED : CLOUD_REGULAR,
                                  .dim = options->dim,
                                  .count = {options->count[0], options->count[1], options->count[2]},
                                  .high = {options->size[0], options->size[1], options->size[2]},
                                  .jitter = options->jitter,
                                  .seed = 1};
    /* Wider supports need the penalties that back conditions, which are not here. */
    make_tables(&cloud, options->gauss_points, 1.8, &l->cloud, &l->stream, assembly);
    if (assembly->smoothed) {
        const struct cell_sources sources = {&assembly->lists, &assembly->node_lists, assembly->phi,
                                             assembly->node_phi};
        l->smoothed = cell_table_make(&assembly->cells, &assembly->faces, &sources);
    }
    list->count = 1;
    ARRAY(list->items, 1);
    ARRAY(list->of_point, assembly->point_count);
    ARRAY(list->of_cell, assembly->cells.count);
    ARRAY(list->section, 1);
    list->items[0] = (struct material){.model = MATERIAL_NEO_HOOKEAN, .density = options->density};
    material_set_moduli(&list->items[0], options->youngs_modulus, options->poisson_ratio);
    assembly->pointwise_volume = !options->nodal_volume;
    GOOD(assembly_build(assembly, &l->system, &note, &error));
}

static inline void lattice_free(struct lattice *l)
{
    system_free(&l->system);
    material_list_free(&l->assembly.materials);
    cell_table_free(&l->smoothed);
    stream_free(&l->stream);
    cloud_free(&l->cloud);
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

/* The base material on `n` jittered nodes along each axis, and a load curve, whose number it returns. */
static inline int32_t lattice_begin(struct lattice *l, int dim, int64_t n, double jitter,
                                    enum curve_kind kind)
{
    struct lattice_options options = lattice_defaults(dim, n);
    options.jitter = jitter;
    lattice_build(l, &options);
    return lattice_curve(l, curve_of_kind(kind));
}

/* The boundary averages over the sides in `sides` (bit 2 * axis, + 1 at the high end), split at corners. */
static inline struct boundary_averages lattice_averages(const struct lattice *l, unsigned sides)
{
    struct boundary_averages averages;
    int dim = l->options.dim;
    SCRATCH int32_t *facet = NULL;
    struct facet_set set = {0};
    ARRAY(facet, l->cloud.facet_count * dim);
    for (int64_t f = 0; f < l->cloud.facet_count; f++) {
        if (sides >> l->cloud.facet_set[f] & 1u) {
            memcpy(facet + set.count++ * dim, l->cloud.facets + f * dim, (size_t)dim * sizeof *facet);
        }
    }
    set.facet = facet;
    GOOD(boundary_averages_build(&l->assembly.face_table, &set, &averages, &error));
    return averages;
}

/* Prescribe u . direction = value(X) on every average of the sides; value NULL: 0. The average of a linear
 * field is its value at the average's position. */
static inline void lattice_prescribe(struct lattice *l, unsigned sides, const double direction[3],
                                     double (*value)(const double *X, const double *parameters),
                                     const double *parameters, int32_t curve)
{
    int dim = l->options.dim;
    FREED_BY(boundary_averages_free) struct boundary_averages averages = lattice_averages(l, sides);
    for (int64_t a = 0; a < averages.count; a++) {
        int64_t at = averages.ptr[a];
        double target = value != NULL ? value(averages.position + a * dim, parameters) : 0.0;
        GOOD(constraint_rows_add(&l->system.rows, averages.ptr[a + 1] - at, averages.idx + at,
                                 averages.phi + at, direction, target, curve, (int32_t)sides,
                                 averages.node[a], &error));
    }
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
    for (int64_t i = l->assembly.node_lists.ptr[node]; i < l->assembly.node_lists.ptr[node + 1]; i++) {
        sum += l->assembly.node_phi[i] * u[(int64_t)l->assembly.node_lists.idx[i] * l->options.dim + axis];
    }
    return sum;
}

/* Zeros for all parameters, for a test. */
static inline double *lattice_vector(const struct lattice *l)
{
    return zeros(l->system.node_count * l->options.dim, sizeof(double));
}
