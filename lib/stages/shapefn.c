#include "stages/stages.h"

#include "approx/cells/face_rows.h"
#include "base/memory.h"
#include "io/stream/sections.h"

#include <math.h>
#include <string.h>

/* Check the numbers of a section from any source: coordinates are finite, radii and factors positive. */
static enum status check_numbers(const struct section *section, bool positive, struct error *error)
{
    const double *values = section->data;
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        if (!isfinite(values[i]) || (positive && !(values[i] > 0.0))) {
            return fail(error, STATUS_INPUT, "%s: row %lld: %g is not a %s", section->name,
                        (long long)(i / section->cols), values[i],
                        positive ? "positive length" : "finite coordinate");
        }
    }
    return STATUS_OK;
}

/* The points of one section, and their lists of one prefix. */
struct tabulated {
    int64_t node_count;
    const double *nodes, *radius, *x;
    const char *section;
    struct neighbours lists;
};

static enum status view_points(const struct stream *stream, const char *section, const char *prefix,
                               struct tabulated *of, struct error *error)
{
    int dim;
    const struct section *points, *radius;
    RETURN_IF_ERROR(stream_nodes(stream, &dim, &of->node_count, &of->nodes, error));
    RETURN_IF_ERROR(stream_need(stream, section, TYPE_F8, dim, "ipoints", &points, error));
    RETURN_IF_ERROR(stream_need(stream, "support.radius", TYPE_F8, 1, "support", &radius, error));
    RETURN_IF_ERROR(stream_neighbours(stream, prefix, points->rows, of->node_count, &of->lists, error));
    if (radius->rows != of->node_count || of->lists.widen == NULL) {
        return fail(error, STATUS_INPUT, "support.radius, %s.widen: do not fit: run support again", prefix);
    }
    RETURN_IF_ERROR(check_numbers(points, false, error));
    RETURN_IF_ERROR(check_numbers(radius, true, error));
    for (int64_t p = 0; p < points->rows; p++) {
        if (!(of->lists.widen[p] >= 1.0) || !isfinite(of->lists.widen[p])) {
            return fail(error, STATUS_INPUT, "%s.widen: row %lld: %g is no factor", prefix, (long long)p,
                        of->lists.widen[p]);
        }
    }
    of->x = points->data;
    of->radius = radius->data;
    of->section = section;
    return STATUS_OK;
}

/* Tabulate phi, and gradients, at the points of one section on the lists of one prefix. */
static enum status tabulate(struct stream *stream, const struct mls *mls, const char *section,
                            const char *prefix, const char *phi_name, bool gradients, struct error *error)
{
    struct tabulated of;
    SCRATCH double *phi = NULL, *dphi = NULL;
    char attributes[64];
    RETURN_IF_ERROR(view_points(stream, section, prefix, &of, error));
    int64_t pairs = of.lists.ptr[of.lists.count];
    RETURN_IF_ERROR(NEW_ARRAY(&phi, pairs, error));
    if (gradients) {
        RETURN_IF_ERROR(NEW_ARRAY(&dphi, pairs * mls->dim, error));
    }
    RETURN_IF_ERROR(shape_table(mls, of.nodes, of.radius, &of.lists, of.x, section, phi, dphi, error));
    RETURN_IF_ERROR(stream_put(stream, phi_name, TYPE_F8, pairs, 1, "", array_take(&phi), true, error));
    if (gradients) {
        RETURN_IF_ERROR(stream_put(stream, "shape.dphi", TYPE_F8, pairs, mls->dim,
                                   vector_attributes(mls->dim, "1/m", attributes), array_take(&dphi), true,
                                   error));
    }
    return STATUS_OK;
}

/* Put a table of `rows` rows as sections PREFIX.ptr, .idx and .phi; the stream takes the arrays. */
static enum status put_table(struct stream *stream, const char *prefix, int64_t rows, int64_t **ptr,
                             int32_t **idx, double **phi, struct error *error)
{
    int64_t pairs = (*ptr)[rows];
    RETURN_IF_ERROR(stream_put_member(stream, prefix, "ptr", TYPE_I8, rows + 1, 1, "", ptr, error));
    RETURN_IF_ERROR(stream_put_member(stream, prefix, "idx", TYPE_I4, pairs, 1, "", idx, error));
    return stream_put_member(stream, prefix, "phi", TYPE_F8, pairs, 1, "", phi, error);
}

/* Put the values at points on the boundary, and the averages over faces of smoothed cells. The points of
 * faces and their lists are then removed. */
static enum status put_faces(struct stream *stream, const struct mls *mls, bool smoothed, struct error *error)
{
    struct cells cells;
    struct faces faces;
    struct tabulated of;
    FREED_BY(face_averages_free) struct face_averages averages = {0};
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    RETURN_IF_ERROR(stream_faces(stream, &cells, &faces, error));
    RETURN_IF_ERROR(view_points(stream, "facepoints.x", "facepoint", &of, error));
    if (of.lists.count != face_row_point(&faces, faces.row_count)) {
        return fail(error, STATUS_INPUT, "facepoints.x: does not fit faces.row: run ipoints again");
    }
    RETURN_IF_ERROR(
        shape_average_faces(mls, of.nodes, of.radius, &of.lists, of.x, of.section, &faces, &averages, error));
    if (smoothed) {
        RETURN_IF_ERROR(
            put_table(stream, "face", faces.row_count, &averages.ptr, &averages.idx, &averages.phi, error));
    }
    int64_t rows = face_row_point(&faces, faces.boundary_count), pairs = of.lists.ptr[rows];
    RETURN_IF_ERROR(NEW_ARRAY(&ptr, rows + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&idx, pairs, error));
    memcpy(ptr, of.lists.ptr, (size_t)(rows + 1) * sizeof *ptr);
    memcpy(idx, of.lists.idx, (size_t)pairs * sizeof *idx);
    RETURN_IF_ERROR(put_table(stream, "boundary", rows, &ptr, &idx, &averages.boundary_phi, error));
    for (int64_t s = stream->section_count - 1; s >= 0; s--) {
        if (strncmp(stream->sections[s].name, "facepoint", strlen("facepoint")) == 0) {
            stream_remove(stream, stream->sections[s].name);
        }
    }
    return STATUS_OK;
}

enum status stage_shapefn(struct stream *stream, const struct mls *mls, struct error *error)
{
    const struct section *points;
    sections_remove(stream, MADE_WITH_SHAPES, MADE_WITH_SHAPES);
    RETURN_IF_ERROR(stream_need(stream, "points.x", TYPE_F8, mls->dim, "ipoints", &points, error));
    bool smoothed = points_are_smoothed(points);
    if (stream_find(stream, "faces") != NULL || smoothed) {
        RETURN_IF_ERROR(put_faces(stream, mls, smoothed, error));
    }
    if (!smoothed) {
        RETURN_IF_ERROR(tabulate(stream, mls, "points.x", "nbr", "shape.phi", true, error));
    }
    return tabulate(stream, mls, "nodes.x", "node", "node.phi", false, error);
}
