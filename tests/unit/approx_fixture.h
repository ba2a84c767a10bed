/* What the tests of lib/approx share: scattered clouds in several units and places, and the defects of a
 * table of shape functions against the properties that it must have. */
#pragma once

#include "unit.h"

#include "approx/shape/shape.h"
#include "approx/support/support.h"

#include <gsl/gsl_rng.h>

/* The same body in metres, in millimetres, and a metre away from the origin. */
struct place {
    const char *name;
    double size, offset;
};
static const struct place places[] = {{"m", 0.1, 0.0}, {"mm", 100.0, 0.0}, {"offset 1 m", 0.1, 1.0}};
enum { PLACE_COUNT = 3 };

/* A jittered lattice of per_axis^dim nodes over a square or cube, and points within it. */
struct scattered {
    int dim;
    int64_t count, point_count;
    double size, spacing; /* mean */
    double *x, *points;
};

static inline struct scattered scatter(int dim, int per_axis, int64_t point_count, const struct place *place,
                                       double jitter, unsigned long seed)
{
    struct scattered cloud = {.dim = dim,
                              .count = dim == 2 ? per_axis * per_axis : per_axis * per_axis * per_axis,
                              .point_count = point_count,
                              .size = place->size,
                              .spacing = place->size / (per_axis - 1)};
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    gsl_rng_set(random, seed);
    cloud.x = malloc((size_t)(cloud.count * dim) * sizeof(double));
    cloud.points = malloc((size_t)(point_count * dim) * sizeof(double));
    assert_non_null(random);
    assert_non_null(cloud.x);
    assert_non_null(cloud.points);
    for (int64_t n = 0; n < cloud.count; n++) {
        int64_t rest = n;
        for (int a = 0; a < dim; a++) {
            double at = (double)(rest % per_axis) + jitter * (2.0 * gsl_rng_uniform(random) - 1.0);
            cloud.x[n * dim + a] = place->offset + at * cloud.spacing;
            rest /= per_axis;
        }
    }
    for (int64_t i = 0; i < point_count * dim; i++) {
        cloud.points[i] = place->offset + place->size * gsl_rng_uniform(random);
    }
    gsl_rng_free(random);
    return cloud;
}

static inline void scattered_free(struct scattered *cloud)
{
    free(cloud->x);
    free(cloud->points);
}

/* Supports that are balls. */
#define BALLS(radii) ((struct supports){.radius = (radii)})

/* Supports, with the stretch given beforehand, and shape functions of all points of a cloud. */
struct table {
    double *stretch;
    double *radius, *phi, *dphi;
    struct visibility space;
    struct neighbours lists;
};

static inline void table_free(struct table *table)
{
    free(table->radius);
    free(table->phi);
    free(table->dphi);
    support_free(&table->lists);
    visibility_free(&table->space);
}

/* As far as it goes: the status tells. Radii from nodes_spacing unless options->radius. */
static inline enum status tabulate(const struct support_options *options, int64_t count, const double *x,
                                   int64_t point_count, const double *points, struct table *table,
                                   struct error *error)
{
    int dim = options->mls.dim;
    SCRATCH double *spacing = calloc((size_t)count, sizeof *spacing);
    *table = (struct table){table->stretch, .radius = calloc((size_t)count, sizeof(double))};
    enum status status = options->radius > 0.0 ? STATUS_OK : nodes_spacing(dim, count, x, spacing, error);
    if (status == STATUS_OK) {
        status = support_radii(options, count, spacing, table->radius, error);
    }
    if (status == STATUS_OK) {
        const struct cells none = {.dim = dim, .node_count = count, .x = x};
        status =
            visibility_build(&none, (struct supports){.radius = table->radius, .stretch = table->stretch},
                             options->visibility, options->side, &table->space, error);
    }
    if (status == STATUS_OK) {
        status = support_build(options, &table->space, NULL, point_count, points, "points.x", &table->lists,
                               error);
    }
    if (status == STATUS_OK) {
        int64_t pairs = table->lists.ptr[point_count];
        table->phi = malloc((size_t)pairs * sizeof(double));
        table->dphi = malloc((size_t)(pairs * dim) * sizeof(double));
        struct neighbours lists = table->lists;
        status = shape_table(&options->mls, x,
                             (struct supports){.radius = table->radius, .stretch = table->stretch}, &lists,
                             points, "points.x", table->phi, table->dphi, error);
    }
    return status;
}

/* Largest violations over all points of: sum phi = 1; sum phi (x_j - x) = 0; sum grad phi = 0; sum grad phi
 * (x_j - x)^T = I; lengths relative to `length`, sums relative to their largest term where that exceeds 1
 * (the regularised weight has gradients of hundreds per support radius). NaN counts as infinity. */
struct defects {
    double unity, position, gradient_sum, gradient_position;
};

static inline double worse(double worst, double defect)
{
    return fabs(defect) <= worst ? worst : isnan(defect) ? INFINITY : fabs(defect);
}

static inline struct defects table_defects(const struct table *table, int dim, const double *x,
                                           const double *points, double length)
{
    struct defects worst = {0};
    for (int64_t p = 0; p < table->lists.count; p++) {
        double sum = 0.0, first[3] = {0}, slope[3] = {0}, tensor[3][3] = {{0}};
        double value = 1.0, steepest = 1.0;
        for (int64_t i = table->lists.ptr[p]; i < table->lists.ptr[p + 1]; i++) {
            const double *xj = x + (int64_t)table->lists.idx[i] * dim;
            sum += table->phi[i];
            value = fmax(value, fabs(table->phi[i]));
            for (int a = 0; a < dim; a++) {
                first[a] += table->phi[i] * (xj[a] - points[p * dim + a]) / length;
                slope[a] += table->dphi[i * dim + a] * length;
                steepest = fmax(steepest, fabs(table->dphi[i * dim + a] * length));
                for (int b = 0; b < dim; b++) {
                    tensor[a][b] += table->dphi[i * dim + a] * (xj[b] - points[p * dim + b]);
                }
            }
        }
        worst.unity = worse(worst.unity, (sum - 1.0) / value);
        for (int a = 0; a < dim; a++) {
            worst.position = worse(worst.position, first[a] / value);
            worst.gradient_sum = worse(worst.gradient_sum, slope[a] / steepest);
            for (int b = 0; b < dim; b++) {
                worst.gradient_position =
                    worse(worst.gradient_position, (tensor[a][b] - (a == b)) / steepest);
            }
        }
    }
    return worst;
}

/* Options for a basis that admits all its supports: k = 1.8 for linear and modified bases, 2.6 for mls2. */
static inline struct support_options options_for(int dim, enum basis basis, enum weight_function weight)
{
    struct support_options options = support_defaults(dim);
    options.mls.basis = basis;
    options.mls.weight = weight;
    options.factor = basis == BASIS_QUADRATIC ? 2.6 : 1.8;
    return options;
}
