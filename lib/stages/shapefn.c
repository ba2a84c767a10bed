#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "base/memory.h"
#include "solid/assembly/assembly.h"

#include <string.h>

/* Tabulate phi and, unless NULL, gradients, to be freed, at the points of one section on the lists of one
 * prefix. */
static enum status tabulate(const struct stream *stream, const struct mls *mls, const char *section,
                            const char *prefix, struct neighbours *lists, double **phi, double **dphi,
                            struct error *error)
{
    int dim;
    int64_t node_count;
    const double *nodes;
    const struct section *points;
    struct supports supports;
    RETURN_IF_ERROR(stream_nodes(stream, &dim, &node_count, &nodes, error));
    RETURN_IF_ERROR(stream_view(stream, section, &points, error));
    RETURN_IF_ERROR(stream_supports(stream, "support", &supports, error));
    RETURN_IF_ERROR(stream_neighbours(stream, prefix, points->rows, lists, error));
    if (lists->widen == NULL) {
        return fail(error, STATUS_INPUT, "no section %s.widen: run support", prefix);
    }
    int64_t pairs = lists->ptr[lists->count];
    RETURN_IF_ERROR(NEW_ARRAY(phi, pairs, error));
    RETURN_IF_ERROR(dphi != NULL ? NEW_ARRAY(dphi, pairs * dim, error) : STATUS_OK);
    return shape_table(mls, nodes, supports, lists, points->data, section, *phi, dphi != NULL ? *dphi : NULL,
                       error);
}

/* The values at the points of boundary faces, and for smoothed cells the rows of the edges. What lies at
 * the points of faces has served. */
static enum status put_faces(struct stream *stream, const struct mls *mls, bool smoothed, struct error *error)
{
    struct faces faces;
    struct neighbours lists;
    SCRATCH double *phi = NULL;
    FREED_BY(shape_rows_free) struct shape_rows edges = {0};
    RETURN_IF_ERROR(stream_faces(stream, &faces, error));
    RETURN_IF_ERROR(tabulate(stream, mls, "facepoints.x", "facepoint", &lists, &phi, NULL, error));
    if (lists.count != face_point_count(&faces)) {
        return fail(error, STATUS_INPUT, "facepoints.x: does not fit faces: run ipoints again");
    }
    if (smoothed) {
        RETURN_IF_ERROR(shape_on_edges(&lists, phi, &faces, &edges, error));
        int64_t rows = face_row_count(&faces), pairs = edges.ptr[rows];
        RETURN_IF_ERROR(
            stream_put(stream, "edge.ptr", TYPE_I8, rows + 1, 1, "", array_take(&edges.ptr), true, error));
        RETURN_IF_ERROR(
            stream_put(stream, "edge.idx", TYPE_I4, pairs, 1, "", array_take(&edges.idx), true, error));
        RETURN_IF_ERROR(
            stream_put(stream, "edge.phi", TYPE_F8, pairs, 1, "", array_take(&edges.phi), true, error));
    }
    int64_t rows = face_boundary_points(&faces), pairs = lists.ptr[rows];
    RETURN_IF_ERROR(stream_put_copy(stream, "boundary.ptr", TYPE_I8, rows + 1, 1, "", lists.ptr, error));
    RETURN_IF_ERROR(stream_put_copy(stream, "boundary.idx", TYPE_I4, pairs, 1, "", lists.idx, error));
    RETURN_IF_ERROR(stream_put_copy(stream, "boundary.phi", TYPE_F8, pairs, 1, "", phi, error));
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
    struct neighbours lists;
    SCRATCH double *phi = NULL, *dphi = NULL;
    char attributes[64];
    sections_remove(stream, MADE_WITH_SHAPES, MADE_WITH_SHAPES);
    RETURN_IF_ERROR(stream_view(stream, "points.x", &points, error));
    bool smoothed = points_are_smoothed(points);
    if (stream_find(stream, "faces") != NULL || smoothed) {
        RETURN_IF_ERROR(put_faces(stream, mls, smoothed, error));
    }
    if (!smoothed) {
        RETURN_IF_ERROR(tabulate(stream, mls, "points.x", "nbr", &lists, &phi, &dphi, error));
        int64_t pairs = lists.ptr[lists.count];
        RETURN_IF_ERROR(
            stream_put(stream, "shape.phi", TYPE_F8, pairs, 1, "", array_take(&phi), true, error));
        RETURN_IF_ERROR(stream_put(stream, "shape.dphi", TYPE_F8, pairs, mls->dim,
                                   vector_attributes(mls->dim, "1/m", attributes), array_take(&dphi), true,
                                   error));
    }
    RETURN_IF_ERROR(tabulate(stream, mls, "nodes.x", "node", &lists, &phi, NULL, error));
    return stream_put(stream, "node.phi", TYPE_F8, lists.ptr[lists.count], 1, "", array_take(&phi), true,
                      error);
}

/* ---- the tables of a stream, for mtled ---- */

static enum status read_points(const struct stream *stream, struct assembly *input, struct error *error)
{
    const struct section *points, *weight, *cell;
    RETURN_IF_ERROR(stream_view(stream, "points.x", &points, error));
    RETURN_IF_ERROR(stream_view(stream, "points.weight", &weight, error));
    RETURN_IF_ERROR(stream_view(stream, "points.cell", &cell, error));
    input->smoothed = points_are_smoothed(points);
    input->point_count = points->rows;
    input->x = points->data;
    input->weight = weight->data;
    input->point_cell = cell->data;
    if (input->smoothed && points->rows != input->cells.count) {
        return fail(error, STATUS_INPUT, "points.x: does not fit cells: run ipoints again");
    }
    return section_check_indices(cell, 0, input->cells.count, "cell",
                                 ": an evaluation lattice cannot be integrated over", error);
}

/* A table of shapefn: sections PREFIX.ptr and .idx, and values or gradients on these lists. */
static enum status read_table(const struct stream *stream, const char *prefix, const char *values,
                              int64_t rows, struct neighbours *lists, const double **phi, struct error *error)
{
    const struct section *section;
    RETURN_IF_ERROR(stream_view(stream, values, &section, error));
    RETURN_IF_ERROR(stream_neighbours(stream, prefix, rows, lists, error));
    *phi = section->data;
    return STATUS_OK;
}

static enum status read_tables(const struct stream *stream, struct assembly *input, struct error *error)
{
    int64_t nodes = input->cells.node_count, points = input->point_count;
    RETURN_IF_ERROR(stream_faces(stream, &input->faces, error));
    if (input->smoothed) {
        RETURN_IF_ERROR(read_table(stream, "edge", "edge.phi", face_row_count(&input->faces), &input->lists,
                                   &input->phi, error));
    } else {
        RETURN_IF_ERROR(read_table(stream, "nbr", "shape.phi", points, &input->lists, &input->phi, error));
        RETURN_IF_ERROR(read_table(stream, "nbr", "shape.dphi", points, &input->lists, &input->dphi, error));
    }
    RETURN_IF_ERROR(read_table(stream, "boundary", "boundary.phi", face_boundary_points(&input->faces),
                               &input->boundary_lists, &input->boundary_phi, error));
    return read_table(stream, "node", "node.phi", nodes, &input->node_lists, &input->node_phi, error);
}

enum status stage_tables(const struct stream *stream, struct assembly *input, struct error *error)
{
    RETURN_IF_ERROR(stream_cells(stream, true, &input->cells, error));
    RETURN_IF_ERROR(read_points(stream, input, error));
    RETURN_IF_ERROR(read_tables(stream, input, error));
    RETURN_IF_ERROR(stage_sides(stream, "support", &input->cell_side, error));
    assembly_complete(input);
    return STATUS_OK;
}
