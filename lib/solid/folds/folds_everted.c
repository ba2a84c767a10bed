/* The search for bodies that are turned inside out. */
#include "solid/folds/folds_private.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"

#include <math.h>

enum status folds_find_surfaces(struct folds *folds, struct error *error)
{
    const struct fold_input *input = &folds->input;
    int dim = input->dim;
    NEW_SCRATCH(int32_t, parent, input->node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&folds->surface, input->facet_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->enclosed, 2 * input->node_count, error));
    set_join_cells(input->node_count, input->facet_count, dim, input->facet, parent);
    for (int64_t f = 0; f < input->facet_count; f++) {
        folds->surface[f] = set_first(parent, input->facet[f * dim]);
    }
    return STATUS_OK;
}

/* The part of a facet in the volume that its surface encloses at positions x, times dim. */
static double facet_part(const struct folds *folds, const double *x, int64_t f)
{
    int dim = folds->input.dim;
    const int32_t *node = folds->input.facet + f * dim;
    double middle[3], area[3];
    vector_middle(dim, x, dim, node, middle);
    add_scaled(dim, -1.0, x + (int64_t)folds->surface[f] * dim, middle);
    face_area_vector(dim, x, node, area);
    return vector_dot(dim, middle, area);
}

void folds_find_everted(const struct folds *folds, struct fold *fold)
{
    const struct fold_input *input = &folds->input;
    double *rest = folds->enclosed, *now = folds->enclosed + input->node_count;
    double least = ROUND_OFF * pow(folds->extent, input->dim);
    for (int64_t f = 0; f < input->facet_count; f++) {
        rest[folds->surface[f]] = now[folds->surface[f]] = 0.0;
    }
    for (int64_t f = 0; f < input->facet_count; f++) {
        rest[folds->surface[f]] += facet_part(folds, input->x, f);
        now[folds->surface[f]] += facet_part(folds, folds->y, f);
    }
    for (int64_t f = 0; f < input->facet_count; f++) {
        int32_t s = folds->surface[f];
        if (rest[s] > least && now[s] < 0.0 && fold->count++ == 0) {
            fold_name_facets(input, f, -1, fold);
            fold->kind = FOLD_EVERTED;
        }
    }
}
