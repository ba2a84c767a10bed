#include "solid/assembly/assembly.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Set node[node_count] at junctions of these kinds, where faces with at least `least` prescribed directions
 * are held. */
static enum status mark_junctions(const struct assembly *input, int kinds, int least, bool *node,
                                  struct error *error)
{
    SCRATCH bool *held = NULL, *constrained = NULL;
    RETURN_IF_ERROR(assembly_held_faces(input, least, false, &held, error));
    RETURN_IF_ERROR(assembly_held_faces(input, 1, false, &constrained, error));
    return boundary_find_junctions(&input->face_table, kinds, held, constrained, node, error);
}

enum status assembly_junction_cells(const struct assembly *input, bool **at_junction, struct error *error)
{
    int corners = input->cells.dim + 1;
    SCRATCH bool *held = NULL;
    NEW_SCRATCH(bool, junction, input->cells.node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(at_junction, input->cells.count, error));
    RETURN_IF_ERROR(mark_junctions(input, BOUNDARY_JUNCTION_SMOOTH, 1, junction, error));
    for (int64_t i = 0; i < input->cells.count * corners; i++) {
        (*at_junction)[i / corners] = (*at_junction)[i / corners] || junction[input->cells.node[i]];
    }
    RETURN_IF_ERROR(assembly_held_faces(input, 1, false, &held, error));
    for (int64_t f = 0; f < input->boundary.count; f++) {
        if (held[f]) {
            (*at_junction)[input->boundary.cell[2 * f]] = false;
        }
    }
    return STATUS_OK;
}

/* A sharp edge between a clamped side and one that slides is not singular: it may be at a plane of symmetry.
 * A side that may come into contact counts as free: the treatment of edges does not change a uniform
 * pressure. */
enum status assembly_edge_nodes(const struct assembly *input, bool **at_edge, struct error *error)
{
    int64_t count = input->cells.node_count;
    RETURN_IF_ERROR(NEW_ARRAY(at_edge, count, error));
    RETURN_IF_ERROR(mark_junctions(input, BOUNDARY_JUNCTION_SMOOTH, 1, *at_edge, error));
    RETURN_IF_ERROR(mark_junctions(input, BOUNDARY_JUNCTION_SHARP | BOUNDARY_REENTRANT, input->cells.dim,
                                   *at_edge, error));
    if (memchr(*at_edge, true, (size_t)count * sizeof **at_edge) == NULL) {
        free(*at_edge);
        *at_edge = NULL;
    }
    return STATUS_OK;
}
