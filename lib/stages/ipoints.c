#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "approx/cells/quadrature.h"
#include "base/box.h"
#include "base/memory.h"
#include "io/stream/sections.h"

#include <stdio.h>
#include <string.h>

static enum status new_points(int64_t count, int dim, struct adaptive_points *points, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&points->x, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->weight, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->cell, count, error));
    points->count = count;
    return STATUS_OK;
}

/* One point for each smoothed cell, or those of a rule. */
static enum status cell_points(const struct cells *cells, int per_cell, struct adaptive_points *points,
                               struct error *error)
{
    struct quadrature_rule rule;
    int dim = cells->dim;
    RETURN_IF_ERROR(quadrature_cell_rule(dim, per_cell, &rule, error));
    RETURN_IF_ERROR(new_points(cells->count * per_cell, dim, points, error));
    for (int64_t c = 0; c < cells->count; c++) {
        double volume = cell_volume(cells, c);
        quadrature_positions(&rule, dim, cells->x, cells->node + c * (dim + 1),
                             points->x + c * per_cell * dim);
        for (int q = 0; q < per_cell; q++) {
            points->weight[c * per_cell + q] = rule.weight[q] * volume;
            points->cell[c * per_cell + q] = (int32_t)c;
        }
    }
    return STATUS_OK;
}

/* A lattice of points, at least 2 along each axis, over the box of the nodes, x fastest; weights of the
 * trapezium rule. */
static enum status lattice_points(const struct cells *nodes, const int64_t n[3],
                                  struct adaptive_points *points, struct error *error)
{
    int dim = nodes->dim;
    int64_t count = 1;
    double step[3];
    struct box box = box_of(dim, nodes->node_count, nodes->x);
    for (int a = 0; a < dim; a++) {
        if (__builtin_mul_overflow(count, n[a], &count) || count > INT32_MAX) {
            return fail(error, STATUS_INPUT, "--lattice: more than %d points", INT32_MAX);
        }
    }
    RETURN_IF_ERROR(new_points(count, dim, points, error));
    for (int a = 0; a < dim; a++) {
        step[a] = (box.high[a] - box.low[a]) / (double)(n[a] - 1);
    }
    for (int64_t p = 0; p < count; p++) {
        int64_t rest = p;
        points->weight[p] = 1.0;
        points->cell[p] = -1;
        for (int a = 0; a < dim; a++) {
            int64_t i = rest % n[a];
            rest /= n[a];
            points->x[p * dim + a] = box.low[a] + step[a] * (double)i;
            points->weight[p] *= i == 0 || i == n[a] - 1 ? 0.5 * step[a] : step[a];
        }
    }
    return STATUS_OK;
}

/* With the radii recorded in the stream, unless options give others. */
static enum status adaptive_cell_points(const struct stream *stream, const struct ipoints_options *options,
                                        const struct cells *cells, struct adaptive_points *points,
                                        struct error *error)
{
    const struct section *recorded = stream_find(stream, "support.radius");
    FREED_BY(supports_free) struct supports made = {0};
    struct supports supports;
    if (recorded == NULL || options->given_radius) {
        RETURN_IF_ERROR(
            stage_sizes(stream, &options->refinement.support, cells->node_count, cells->x, &made, error));
        supports = made;
    } else {
        RETURN_IF_ERROR(stream_supports(stream, "support", &supports, error));
    }
    return adaptive_points_build(&options->refinement, cells, supports, points, error);
}

static enum status put_points(struct stream *stream, int dim, const char *rule,
                              struct adaptive_points *points, struct error *error)
{
    char vector[64], attributes[96];
    int64_t count = points->count;
    snprintf(attributes, sizeof attributes, "%s rule=%s", vector_attributes(dim, "m", vector), rule);
    RETURN_IF_ERROR(
        stream_put(stream, "points.x", TYPE_F8, count, dim, attributes, array_take(&points->x), true, error));
    RETURN_IF_ERROR(stream_put(stream, "points.weight", TYPE_F8, count, 1, dim == 2 ? "unit=m2" : "unit=m3",
                               array_take(&points->weight), true, error));
    return stream_put(stream, "points.cell", TYPE_I4, count, 1, "", array_take(&points->cell), true, error);
}

enum status stage_face_points(struct stream *stream, struct error *error)
{
    struct cells cells;
    struct faces faces;
    char attributes[64];
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    RETURN_IF_ERROR(stream_faces(stream, &faces, error));
    NEW_SCRATCH(double, x, face_point_count(&faces) * cells.dim, error);
    face_points(&faces, cells.x, x);
    return stream_put(stream, "facepoints.x", TYPE_F8, face_point_count(&faces), cells.dim,
                      vector_attributes(cells.dim, "m", attributes), array_take(&x), true, error);
}

static enum status put_faces(struct stream *stream, const struct cells *cells, bool boundary_only,
                             struct error *error)
{
    int dim = cells->dim;
    FREED_BY(faces_free) struct faces faces = {0};
    RETURN_IF_ERROR(faces_build(cells, boundary_only, &faces, error));
    int64_t count = faces.count;
    RETURN_IF_ERROR(
        stream_put(stream, "faces", TYPE_I4, count, dim, "", array_take(&faces.node), true, error));
    RETURN_IF_ERROR(
        stream_put(stream, "faces.cell", TYPE_I4, count, 2, "", array_take(&faces.cell), true, error));
    if (faces.edge != NULL) {
        RETURN_IF_ERROR(stream_put(stream, "faces.edge", TYPE_I4, count, FACE_EDGES(dim), "",
                                   array_take(&faces.edge), true, error));
    }
    return stage_face_points(stream, error);
}

enum status stage_ipoints(struct stream *stream, const struct ipoints_options *options, int64_t *unresolved,
                          struct error *error)
{
    struct cells cells;
    FREED_BY(adaptive_points_free) struct adaptive_points points = {0};
    bool lattice = options->lattice[0] > 0;
    int per_cell = options->smoothed ? 1 : options->gauss_points;
    char rule[32];
    *unresolved = 0;
    RETURN_IF_ERROR(lattice ? stream_nodes(stream, &cells.dim, &cells.node_count, &cells.x, error)
                            : stream_cells(stream, true, &cells, error));
    if (lattice) {
        snprintf(rule, sizeof rule, "lattice");
        RETURN_IF_ERROR(lattice_points(&cells, options->lattice, &points, error));
    } else if (options->adaptive) {
        snprintf(rule, sizeof rule, "adaptive");
        RETURN_IF_ERROR(adaptive_cell_points(stream, options, &cells, &points, error));
        *unresolved = points.unresolved;
    } else {
        snprintf(rule, sizeof rule, options->smoothed ? "conforming" : "gauss%d", per_cell);
        RETURN_IF_ERROR(cell_points(&cells, per_cell, &points, error));
    }
    /* Sections made from other points are void. */
    sections_remove(stream, MADE_WITH_POINTS, MADE_WITH_SHAPES);
    RETURN_IF_ERROR(put_points(stream, cells.dim, rule, &points, error));
    if (!lattice) {
        RETURN_IF_ERROR(put_faces(stream, &cells, !options->smoothed, error));
    }
    return STATUS_OK;
}
