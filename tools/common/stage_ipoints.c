#include "stages.h"

#include "approx/face_rows.h"
#include "approx/quadrature.h"
#include "base/box.h"
#include "io/sections.h"

#include <stdlib.h>
#include <string.h>

struct ipoints_options ipoints_defaults(void)
{
    return (struct ipoints_options){.smoothed = true};
}

/* Add points.x, points.weight, points.cell; the stream takes the arrays. */
static enum status put_points(struct stream *stream, int dim, int64_t count, const char *rule, double *x,
                              double *weight, int32_t *cell, struct error *error)
{
    char vector[64], attributes[96];
    snprintf(attributes, sizeof attributes, "%s rule=%s", vector_attributes(dim, "m", vector), rule);
    enum status status = stream_put(stream, "points.x", TYPE_F8, count, dim, attributes, x, true, error);
    enum status next = stream_put(stream, "points.weight", TYPE_F8, count, 1,
                                  dim == 2 ? "unit=m2" : "unit=m3", weight, true, error);
    status = status != STATUS_OK ? status : next;
    next = stream_put(stream, "points.cell", TYPE_I4, count, 1, "", cell, true, error);
    return status != STATUS_OK ? status : next;
}

static enum status put_cell_points(struct stream *stream, const struct cells *cells, int per_cell,
                                   const char *rule_name, struct error *error)
{
    enum status status;
    struct quadrature_rule rule;
    int dim = cells->dim;
    double *x = NULL, *weight = NULL;
    int32_t *cell = NULL;
    TRY(quadrature_cell_rule(dim, per_cell, &rule, error));
    TRY(NEW_ARRAY(&x, cells->count * per_cell * dim, error));
    TRY(NEW_ARRAY(&weight, cells->count * per_cell, error));
    TRY(NEW_ARRAY(&cell, cells->count * per_cell, error));
    for (int64_t c = 0; c < cells->count; c++) {
        double volume = cell_volume(cells, c);
        quadrature_positions(&rule, dim, cells->x, cells->node + c * (dim + 1), x + c * per_cell * dim);
        for (int q = 0; q < per_cell; q++) {
            weight[c * per_cell + q] = rule.weight[q] * volume;
            cell[c * per_cell + q] = (int32_t)c;
        }
    }
    return put_points(stream, dim, cells->count * per_cell, rule_name, x, weight, cell, error);
done:
    free(x);
    free(weight);
    free(cell);
    return status;
}

/* Faces, and their quadrature points. */
static enum status put_faces(struct stream *stream, const struct cells *cells, bool boundary_only,
                             struct error *error)
{
    enum status status;
    int dim = cells->dim;
    struct faces faces = {0};
    double *x = NULL;
    char attributes[64];
    TRY(faces_build(cells, boundary_only, &faces, error));
    int64_t count = faces.count, points = face_row_point(&faces, faces.row_count);
    TRY(NEW_ARRAY(&x, points * dim, error));
    face_rows_points(&faces, cells->x, x);
    status = stream_put(stream, "faces", TYPE_I4, count, dim, "", faces.node, true, error);
    faces.node = NULL;
    TRY(status);
    status = stream_put(stream, "faces.cell", TYPE_I4, count, 2, "", faces.cell, true, error);
    faces.cell = NULL;
    TRY(status);
    if (faces.row != NULL) {
        status = stream_put(stream, "faces.row", TYPE_I4, count, FACE_ROWS(dim), "", faces.row, true, error);
        faces.row = NULL;
        TRY(status);
    }
    status = stream_put(stream, "facepoints.x", TYPE_F8, points, dim, vector_attributes(dim, "m", attributes),
                        x, true, error);
    x = NULL;
done:
    faces_free(&faces);
    free(x);
    return status;
}

/* n[dim] points along each axis, from one number for all or one for each; *count receives their product. */
static enum status count_lattice(const int64_t wanted[3], int dim, int64_t n[3], int64_t *count,
                                 struct error *error)
{
    int given = 1 + (wanted[1] > 0) + (wanted[2] > 0);
    if (given != 1 && given != dim) {
        return fail(error, STATUS_INPUT, "--lattice: %d numbers of points, not 1 or %d", given, dim);
    }
    *count = 1;
    for (int a = 0; a < dim; a++) {
        n[a] = wanted[given == 1 ? 0 : a];
        if (__builtin_mul_overflow(*count, n[a], count) || *count > INT32_MAX) {
            return fail(error, STATUS_INPUT, "--lattice: more than %d points", INT32_MAX);
        }
    }
    return STATUS_OK;
}

/* A lattice of points, at least 2 along each axis, over the box of the nodes, x fastest; weights of the
 * trapezium rule. */
static enum status put_lattice(struct stream *stream, const int64_t wanted[3], struct error *error)
{
    enum status status;
    int dim;
    int64_t node_count, count = 0, n[3];
    const double *nodes;
    double step[3];
    double *x = NULL, *weight = NULL;
    int32_t *cell = NULL;
    TRY(stream_nodes(stream, &dim, &node_count, &nodes, error));
    TRY(count_lattice(wanted, dim, n, &count, error));
    struct box box = box_of(dim, node_count, nodes);
    for (int a = 0; a < dim; a++) {
        step[a] = (box.high[a] - box.low[a]) / (double)(n[a] - 1);
    }
    TRY(NEW_ARRAY(&x, count * dim, error));
    TRY(NEW_ARRAY(&weight, count, error));
    TRY(NEW_ARRAY(&cell, count, error));
    for (int64_t p = 0; p < count; p++) {
        int64_t rest = p;
        weight[p] = 1.0;
        cell[p] = -1;
        for (int a = 0; a < dim; a++) {
            int64_t i = rest % n[a];
            rest /= n[a];
            x[p * dim + a] = box.low[a] + step[a] * (double)i;
            weight[p] *= i == 0 || i == n[a] - 1 ? 0.5 * step[a] : step[a];
        }
    }
    return put_points(stream, dim, count, "lattice", x, weight, cell, error);
done:
    free(x);
    free(weight);
    free(cell);
    return status;
}

/* What the shape functions of adaptive integration are made from: the settings and radii recorded in the
 * stream, unless others were asked for. */
static enum status adaptive_radii(const struct stream *stream, const struct ipoints_options *options,
                                  const struct cells *cells, double *radius, struct error *error)
{
    const struct section *recorded = stream_find(stream, "support.radius");
    if (recorded == NULL || options->given_radius) {
        return stage_radii(stream, &options->refinement.support, cells->node_count, cells->x, radius, error);
    }
    enum status status = stream_need(stream, "support.radius", TYPE_F8, 1, "support", &recorded, error);
    if (status == STATUS_OK && recorded->rows != cells->node_count) {
        return fail(error, STATUS_INPUT, "support.radius: %lld rows for %lld nodes: run support again",
                    (long long)recorded->rows, (long long)cells->node_count);
    }
    if (status == STATUS_OK) {
        memcpy(radius, recorded->data, (size_t)recorded->rows * sizeof *radius);
    }
    return status;
}

static enum status put_adaptive_points(struct stream *stream, const struct cells *cells,
                                       const struct ipoints_options *options, const double *radius,
                                       int64_t *unresolved, struct error *error)
{
    struct adaptive_points points;
    enum status status = adaptive_points_build(&options->refinement, cells, radius, &points, error);
    if (status != STATUS_OK) {
        return status;
    }
    *unresolved = points.unresolved;
    status =
        put_points(stream, cells->dim, points.count, "adaptive", points.x, points.weight, points.cell, error);
    points.x = points.weight = NULL;
    points.cell = NULL;
    adaptive_points_free(&points);
    return status;
}

enum status stage_ipoints(struct stream *stream, const struct ipoints_options *options, int64_t *unresolved,
                          struct error *error)
{
    enum status status = STATUS_OK;
    struct cells cells;
    double *radius = NULL;
    char rule[32];
    *unresolved = 0;
    if (options->lattice[0] == 0) {
        TRY(stream_cells(stream, true, &cells, error));
    }
    if (options->adaptive) {
        TRY(NEW_ARRAY(&radius, cells.node_count, error));
        TRY(adaptive_radii(stream, options, &cells, radius, error));
    }
    /* What was made from other points is void. */
    sections_remove(stream, MADE_WITH_POINTS, MADE_WITH_SHAPES);
    if (options->lattice[0] > 0) {
        return put_lattice(stream, options->lattice, error);
    }
    if (options->adaptive) {
        TRY(put_adaptive_points(stream, &cells, options, radius, unresolved, error));
    } else {
        int per_cell = options->smoothed ? 1 : options->gauss_points;
        snprintf(rule, sizeof rule, options->smoothed ? "conforming" : "gauss%d", per_cell);
        TRY(put_cell_points(stream, &cells, per_cell, rule, error));
    }
    TRY(put_faces(stream, &cells, !options->smoothed, error));
done:
    free(radius);
    return status;
}
