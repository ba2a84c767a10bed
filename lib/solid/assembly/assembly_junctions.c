#include "solid/assembly/assembly.h"

#include "base/memory.h"

#include <stdlib.h>

/* Moduli of cells at smooth junctions, equal to those of others times this (energy correction: Egger, Ruede
 * and Wohlmuth 2014; lib/README.md). With .76, the force on a bonded punch on a strip equals that of a mesh
 * with fine cells at the ends of the punch, but the largest error, at the junctions, is larger. With .85,
 * which leaves a third of the error of the force, it just begins to grow. */
static const double junction_stiffness = 0.85;

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

/* softer[cells.count]: cells that have a node on a smooth junction, and no prescribed facet. */
static enum status mark_cells(const struct assembly *input, bool *softer, struct error *error)
{
    int corners = input->cells.dim + 1;
    SCRATCH bool *held = NULL, *junction = NULL;
    RETURN_IF_ERROR(assembly_held_faces(input, 1, &held, error));
    RETURN_IF_ERROR(find_junctions(input, BOUNDARY_JUNCTION_SMOOTH, 1, &junction, error));
    for (int64_t i = 0; i < input->cells.count * corners; i++) {
        softer[i / corners] = softer[i / corners] || junction[input->cells.node[i]];
    }
    for (int64_t f = 0; f < input->boundary.count; f++) {
        if (held[f]) {
            softer[input->boundary.cell[2 * f]] = false;
        }
    }
    return STATUS_OK;
}

/* Append the material m with the moduli of cells at smooth junctions. */
static void add_softened(struct material_list *list, int32_t m)
{
    struct material *material = &list->items[list->count];
    *material = list->items[m];
    material->shear_modulus *= junction_stiffness;
    material->bulk_modulus *= junction_stiffness;
    list->section[list->count++] = list->section[m];
}

enum status assembly_soften_junctions(const struct assembly *input, struct material_list *list,
                                      struct error *error)
{
    const int32_t *cell = input->point_cell;
    SCRATCH int64_t *softened = NULL; /* of each material: the softened copy; 0: none yet */
    RETURN_IF_ERROR(RESIZE_ARRAY(&list->items, 2 * list->count, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&list->section, 2 * list->count, error));
    NEW_SCRATCH(bool, softer, input->cells.count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&softened, list->count, error));
    RETURN_IF_ERROR(mark_cells(input, softer, error));
    for (int64_t q = 0; q < input->point_count; q++) {
        int32_t m = list->of_point[q];
        if (!softer[cell[q]]) {
            continue;
        }
        if (softened[m] == 0) {
            softened[m] = list->count;
            add_softened(list, m);
        }
        list->of_point[q] = (int32_t)softened[m];
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
