#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "base/memory.h"
#include "solid/assembly/assembly.h"

/* Read the integration points. */
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
                              int64_t rows, int64_t node_count, struct neighbours *lists, const double **phi,
                              struct error *error)
{
    const struct section *section;
    RETURN_IF_ERROR(stream_view(stream, values, &section, error));
    RETURN_IF_ERROR(stream_neighbours(stream, prefix, rows, node_count, lists, error));
    *phi = section->data;
    return STATUS_OK;
}

/* Read the tables of points or faces, of the boundary, and of the nodes. */
static enum status read_tables(const struct stream *stream, struct assembly *input, struct error *error)
{
    int64_t nodes = input->cells.node_count, points = input->point_count;
    RETURN_IF_ERROR(stream_faces(stream, &input->cells, &input->faces, error));
    if (input->smoothed) {
        RETURN_IF_ERROR(read_table(stream, "edge", "edge.phi", face_row_count(&input->faces), nodes,
                                   &input->lists, &input->phi, error));
    } else {
        RETURN_IF_ERROR(
            read_table(stream, "nbr", "shape.phi", points, nodes, &input->lists, &input->phi, error));
        RETURN_IF_ERROR(
            read_table(stream, "nbr", "shape.dphi", points, nodes, &input->lists, &input->dphi, error));
    }
    RETURN_IF_ERROR(read_table(stream, "boundary", "boundary.phi", face_boundary_points(&input->faces), nodes,
                               &input->boundary_lists, &input->boundary_phi, error));
    return read_table(stream, "node", "node.phi", nodes, nodes, &input->node_lists, &input->node_phi, error);
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
