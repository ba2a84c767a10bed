#include "solid/assembly/assembly.h"

#include "base/memory.h"

#include <stdlib.h>

/* (*junction)[node_count], to be freed: nodes of edges of these kinds, where faces with at least `least`
 * prescribed directions end. */
static enum status find_junctions(const struct assembly *input, int kinds, int least, bool **junction,
                                  struct error *error)
{
    SCRATCH bool *held = NULL, *constrained = NULL;
    RETURN_IF_ERROR(assembly_held_faces(input, least, &held, error));
    RETURN_IF_ERROR(assembly_held_faces(input, 1, &constrained, error));
    RETURN_IF_ERROR(NEW_ARRAY(junction, input->cells.node_count, error));
    return boundary_find_junctions(&input->face_table, kinds, held, constrained, *junction, error);
}

/* Of several nodes of a cell that which has the fewest cells so far. */
enum status assembly_junction_cells(const struct assembly *input, int32_t **part, struct error *error)
{
    const struct cells *cells = &input->cells;
    int corners = cells->dim + 1;
    SCRATCH bool *junction = NULL;
    RETURN_IF_ERROR(find_junctions(input, BOUNDARY_JUNCTION_SMOOTH, 1, &junction, error));
    NEW_SCRATCH(int32_t, size, cells->node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(part, cells->count, error));
    for (int64_t c = 0; c < cells->count; c++) {
        int32_t least = -1;
        for (int k = 0; k < corners; k++) {
            int32_t node = cells->node[c * corners + k];
            least = junction[node] && (least < 0 || size[node] < size[least]) ? node : least;
        }
        (*part)[c] = least;
        if (least >= 0) {
            size[least]++;
        }
    }
    return STATUS_OK;
}

/* An edge between a clamped side and one that slides is not singular: it may be at a plane of symmetry. A
 * side that may come into contact counts as free: the treatment of edges does not change a uniform pressure.
 */
enum status assembly_edge_nodes(const struct assembly *input, bool **at_edge, struct error *error)
{
    bool found = false;
    *at_edge = NULL;
    RETURN_IF_ERROR(find_junctions(input, BOUNDARY_JUNCTION_SHARP | BOUNDARY_REENTRANT, input->cells.dim,
                                   at_edge, error));
    for (int64_t n = 0; n < input->cells.node_count; n++) {
        found = found || (*at_edge)[n];
    }
    if (!found) {
        free(*at_edge);
        *at_edge = NULL;
    }
    return STATUS_OK;
}
