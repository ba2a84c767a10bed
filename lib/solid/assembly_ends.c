#include "solid/assembly.h"

#include "base/memory.h"

#include <stdlib.h>

/* Where a held part of the boundary ends on a side that goes on, the displacement grows with the square root
 * of the distance from the end, which cells of finite size do not resolve: the body is too stiff, by an error
 * of first order in the size of the cells at the end, everywhere. Softer cells at the end take the error away
 * elsewhere (energy correction: Egger, Ruede and Wohlmuth 2014). Those beneath the held facets stay as they
 * are, as the field under an end is held by averages only.
 *
 * The value: with .76 the force on a bonded punch on a strip is that of a mesh with fine cells at its ends,
 * in the mean over 20 meshes of 11 to 25 cells under the punch, at nu = .3 and at .49. At the ends themselves
 * the largest difference then grows: .85, which leaves a third of the error, is where that of the brain
 * section of 707 nodes, of the calibration set, begins to. */
static const double end_stiffness = 0.85;

/* soft[cells.count]: which cells are softened. */
static enum status find_soft_cells(const struct assembly *input, bool *soft, struct error *error)
{
    enum status status;
    int corners = input->cells.dim + 1;
    bool *held = NULL, *end = NULL;
    TRY(assembly_held_faces(input, &held, error));
    TRY(NEW_ARRAY(&end, input->cells.node_count, error));
    TRY(boundary_find_ends(&input->face_table, held, end, error));
    for (int64_t c = 0; c < input->cells.count; c++) {
        for (int k = 0; k < corners; k++) {
            soft[c] = soft[c] || end[input->cells.node[c * corners + k]];
        }
    }
    for (int64_t f = 0; f < input->boundary.count; f++) {
        if (held[f]) {
            soft[input->boundary.cell[2 * f]] = false;
        }
    }
done:
    free(held);
    free(end);
    return status;
}

/* Append the material m, softened. */
static void add_softened(struct material_list *list, int32_t m)
{
    struct material *material = &list->items[list->count];
    *material = list->items[m];
    material->shear_modulus *= end_stiffness;
    material->bulk_modulus *= end_stiffness;
    list->section[list->count++] = list->section[m];
}

enum status assembly_soften_ends(const struct assembly *input, struct material_list *list,
                                 struct error *error)
{
    enum status status;
    const int32_t *cell = input->point_cell;
    bool *soft = NULL;
    int64_t *softened = NULL; /* of each material, 0 if there is none yet */
    struct material *items = array_grow(list->items, 2 * list->count, sizeof *items);
    list->items = items != NULL ? items : list->items;
    int32_t *section = array_grow(list->section, 2 * list->count, sizeof *section);
    list->section = section != NULL ? section : list->section;
    if (items == NULL || section == NULL) {
        return fail_memory(error, "materials");
    }
    TRY(NEW_ARRAY(&soft, input->cells.count, error));
    TRY(NEW_ARRAY(&softened, list->count, error));
    TRY(find_soft_cells(input, soft, error));
    for (int64_t q = 0; q < input->point_count; q++) {
        int32_t m = list->of_point[q];
        if (!soft[cell[q]]) {
            continue;
        }
        if (softened[m] == 0) {
            softened[m] = list->count;
            add_softened(list, m);
        }
        list->of_point[q] = (int32_t)softened[m];
    }
done:
    free(soft);
    free(softened);
    return status;
}
