#include "solid/assembly.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Where a held part of the boundary ends, the stress is singular, which cells of finite size do not resolve:
 * the body is too stiff, everywhere. Softer cells at the end take the error away elsewhere (energy
 * correction: Egger, Ruede and Wohlmuth 2014; for incompressible media John, Pustejovska, Ruede and Wohlmuth
 * 2018).
 *
 * Smooth ends: the side goes on beyond the end, and the displacement grows with the square root of the
 * distance. Cells there have less of their moduli. Those beneath the held facets stay as they are, as the
 * field under an end is held by averages only.
 *
 * The value: with .76 the force on a bonded punch on a strip is that of a mesh with fine cells at its ends,
 * in the mean over 20 meshes of 11 to 25 cells under the punch, at nu = .3 and at .49. At the ends themselves
 * the largest difference then grows: .85, which leaves a third of the error, is where that of the brain
 * section of 707 nodes, of the calibration set, begins to. */
static const double end_stiffness = 0.85;

/* Sharp ends, in three dimensions: a clamped side meets a free one at an edge, and not one that slides, as a
 * plane of symmetry does: there the clamped side goes on beyond it. What is singular is most of all the
 * pressure, the more so the less the body is compressible: at nu = .3 the forces on clamped bodies are right
 * to .2 %, at .49 they are some per cent too large. There the bulk modulus is at most so many shear moduli. A
 * side in contact counts as free, whether it touches or not: in a volume that contacts close such cells give
 * way.
 *
 * The value: with 15 the force on a slab in plane strain, clamped between plates .1 m apart and pressed by 10
 * % at nu = .49, is 2.3 to 2.4 % above that of fine triangles on gmsh's tetrahedra of 11 to 15.5 mm, and .1
 * to .4 % below it on prisms that are cut; without the limit 2.1 to 3.3 % and .6 % above. Triangles of the
 * same size are right to .2 % as they are. */
static const double edge_bulk = 15.0;

/* The kinds of end that a cell has a node on, as bits; and how many sets of them there are. */
enum { AT_SMOOTH_END = 1, AT_EDGE = 2, KIND_SETS = 4 };

/* Set the bit `at` of the cells that have a node on an end of this kind. Cells beneath held facets do not get
 * the bit of smooth ends. */
static enum status mark_cells(const struct assembly *input, enum boundary_end kind, int at, int *end_kinds,
                              struct error *error)
{
    enum status status;
    int dim = input->cells.dim, corners = dim + 1;
    bool *held = NULL, *touched = NULL, *end = NULL;
    TRY(assembly_held_faces(input, kind == BOUNDARY_END_SHARP ? dim : 1, &held, error));
    TRY(assembly_held_faces(input, 1, &touched, error));
    TRY(NEW_ARRAY(&end, input->cells.node_count, error));
    TRY(boundary_find_ends(&input->face_table, kind, held, touched, end, error));
    for (int64_t c = 0; c < input->cells.count; c++) {
        for (int k = 0; k < corners; k++) {
            end_kinds[c] |= end[input->cells.node[c * corners + k]] ? at : 0;
        }
    }
    for (int64_t f = 0; f < input->boundary.count; f++) {
        if (held[f] && kind == BOUNDARY_END_SMOOTH) {
            end_kinds[input->boundary.cell[2 * f]] &= ~at;
        }
    }
done:
    free(held);
    free(touched);
    free(end);
    return status;
}

/* Append the material m with the moduli of cells at these kinds of end. */
static void add_softened(struct material_list *list, int32_t m, int end_kinds)
{
    struct material *material = &list->items[list->count];
    *material = list->items[m];
    if (end_kinds & AT_SMOOTH_END) {
        material->shear_modulus *= end_stiffness;
        material->bulk_modulus *= end_stiffness;
    }
    if (end_kinds & AT_EDGE) {
        material->bulk_modulus = fmin(material->bulk_modulus, edge_bulk * material->shear_modulus);
    }
    list->section[list->count++] = list->section[m];
}

enum status assembly_soften_ends(const struct assembly *input, struct material_list *list,
                                 struct error *error)
{
    enum status status;
    const int32_t *cell = input->point_cell;
    int *end_kinds = NULL;
    int64_t *softened =
        NULL; /* of each material and set of kinds: its softened material, 0 if there is none yet */
    struct material *items = array_grow(list->items, KIND_SETS * list->count, sizeof *items);
    list->items = items != NULL ? items : list->items;
    int32_t *section = array_grow(list->section, KIND_SETS * list->count, sizeof *section);
    list->section = section != NULL ? section : list->section;
    if (items == NULL || section == NULL) {
        return fail_memory(error, "materials");
    }
    TRY(NEW_ARRAY(&end_kinds, input->cells.count, error));
    TRY(NEW_ARRAY(&softened, KIND_SETS * list->count, error));
    TRY(mark_cells(input, BOUNDARY_END_SMOOTH, AT_SMOOTH_END, end_kinds, error));
    if (input->cells.dim == 3) {
        TRY(mark_cells(input, BOUNDARY_END_SHARP, AT_EDGE, end_kinds, error));
    }
    for (int64_t q = 0; q < input->point_count; q++) {
        int32_t m = list->of_point[q];
        int64_t variant = (int64_t)KIND_SETS * m + end_kinds[cell[q]];
        if (end_kinds[cell[q]] == 0) {
            continue;
        }
        if (softened[variant] == 0) {
            softened[variant] = list->count;
            add_softened(list, m, end_kinds[cell[q]]);
        }
        list->of_point[q] = (int32_t)softened[variant];
    }
done:
    free(end_kinds);
    free(softened);
    return status;
}
