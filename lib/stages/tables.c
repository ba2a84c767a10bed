#include "stages/tables.h"

#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "base/memory.h"

/* Read the integration points. */
static enum status read_points(const struct stream *stream, struct assembly *input, struct error *error)
{
    const struct section *points, *weight, *cell;
    RETURN_IF_ERROR(stream_need(stream, "points.x", TYPE_F8, input->cells.dim, "ipoints", &points, error));
    RETURN_IF_ERROR(stream_need(stream, "points.weight", TYPE_F8, 1, "ipoints", &weight, error));
    RETURN_IF_ERROR(stream_need(stream, "points.cell", TYPE_I4, 1, "ipoints", &cell, error));
    input->smoothed = points_are_smoothed(points);
    input->point_count = points->rows;
    input->x = points->data;
    input->weight = weight->data;
    input->point_cell = cell->data;
    if (weight->rows != points->rows || cell->rows != points->rows ||
        (input->smoothed && points->rows != input->cells.count)) {
        return fail(error, STATUS_INPUT,
                    "points.x, points.weight, points.cell: do not fit: run ipoints again");
    }
    for (int64_t q = 0; q < input->point_count; q++) {
        int32_t of_point = input->point_cell[q];
        if (of_point < 0 || of_point >= input->cells.count) {
            return fail(error, STATUS_INPUT,
                        "points.cell: row %lld: no cell %d: an evaluation lattice cannot be integrated over",
                        (long long)q, of_point);
        }
    }
    return STATUS_OK;
}

/* A table of shapefn: sections PREFIX.ptr and .idx, and values or gradients on these lists. */
static enum status read_table(const struct stream *stream, const char *prefix, const char *values, int cols,
                              int64_t rows, int64_t node_count, struct neighbours *lists, const double **phi,
                              struct error *error)
{
    const struct section *section;
    RETURN_IF_ERROR(stream_need(stream, values, TYPE_F8, cols, "shapefn", &section, error));
    RETURN_IF_ERROR(stream_neighbours(stream, prefix, rows, node_count, lists, error));
    if (section->rows != lists->ptr[rows]) {
        return fail(error, STATUS_INPUT, "%s: does not fit %s.idx: run shapefn again", values, prefix);
    }
    *phi = section->data;
    return STATUS_OK;
}

/* Read the tables of points or faces, of the boundary, and of the nodes. */
static enum status read_tables(const struct stream *stream, struct assembly *input, struct error *error)
{
    int dim = input->cells.dim;
    int64_t nodes = input->cells.node_count, points = input->point_count;
    RETURN_IF_ERROR(stream_faces(stream, &input->cells, &input->faces, error));
    if (input->smoothed) {
        RETURN_IF_ERROR(read_table(stream, "edge", "edge.phi", 1, face_row_count(&input->faces), nodes,
                                   &input->lists, &input->phi, error));
    } else {
        RETURN_IF_ERROR(
            read_table(stream, "nbr", "shape.phi", 1, points, nodes, &input->lists, &input->phi, error));
        RETURN_IF_ERROR(
            read_table(stream, "nbr", "shape.dphi", dim, points, nodes, &input->lists, &input->dphi, error));
    }
    RETURN_IF_ERROR(read_table(stream, "boundary", "boundary.phi", 1, face_boundary_points(&input->faces),
                               nodes, &input->boundary_lists, &input->boundary_phi, error));
    return read_table(stream, "node", "node.phi", 1, nodes, nodes, &input->node_lists, &input->node_phi,
                      error);
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
