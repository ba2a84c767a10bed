#include "model.h"

#include "io/surface.h"

#include <math.h>
#include <stdlib.h>

/* Corner coordinates, m, of a rigid surface's facets: consecutive points of each polyline, or triangles. */
static enum status rigid_corners(const struct scene_contact *section, const struct table *table, int dim,
                                 double **corners, int64_t *count, struct error *error)
{
    enum status status;
    *count = 0;
    TRY(NEW_ARRAY(corners, table->rows * (dim == 2 ? 4 : 9), error));
    if (dim == 3) {
        for (int64_t i = 0; i < table->rows * 9; i++) {
            (*corners)[i] = table->values[i] * section->rigid_unit;
        }
        *count = table->rows;
        return STATUS_OK;
    }
    for (int64_t b = 0; b < table->block_count; b++) {
        for (int64_t r = table->block_ptr[b]; r + 1 < table->block_ptr[b + 1]; r++) {
            for (int i = 0; i < 4; i++) {
                (*corners)[*count * 4 + i] = table->values[r * 2 + i] * section->rigid_unit;
            }
            ++*count;
        }
    }
done:
    return status;
}

/* By the shear modulus: that of pressure waves at Poisson's ratio .49. */
static const double penalty_factor = 50.0;

/* Penalty of about the stiffness of a layer of cells: as stiff as the critical step allows without loss. */
static double default_stiffness(const struct model_input *input, const struct solid_system *system,
                                const struct boundary_averages *averages)
{
    double modulus = penalty_factor * model_largest_shear(system), area = 0.0;
    for (int64_t a = 0; a < averages->count; a++) {
        area += averages->area[a];
    }
    area /= (double)averages->count;
    return modulus / (input->cells.dim == 2 ? area : sqrt(area));
}

static enum status add_contact(const struct model_input *input, const struct scene_contact *section,
                               struct solid_system *system, struct error *error)
{
    enum status status;
    struct facet_set set;
    struct rigid_surface surface = {0};
    struct table table = {0};
    double *corners = NULL;
    int32_t *owned = NULL;
    int64_t count;
    struct boundary_averages *averages = &system->contact_averages[system->contact_count];
    TRY(model_facets(input, &section->label, &section->facets, &set, &owned, error));
    TRY(boundary_averages_build(&input->face_table, &set, averages, error));
    TRY(surface_read(section->rigid, system->dim, &table, error));
    TRY(rigid_corners(section, &table, system->dim, &corners, &count, error));
    bool flip = section->side == SCENE_LEFT || section->side == SCENE_BACK;
    TRY(rigid_build(system->dim, count, corners, flip, &surface, error));
    double stiffness =
        section->stiffness > 0.0 ? section->stiffness : default_stiffness(input, system, averages);
    TRY(contact_build(averages, system->X, system->dim, &surface, stiffness,
                      &system->contacts[system->contact_count], error));
    system->contact_count++;
    averages = NULL;
done:
    if (averages != NULL) {
        boundary_averages_free(averages);
    }
    free(owned);
    free(corners);
    table_free(&table);
    return status;
}

enum status model_add_contacts(const struct model_input *input, struct solid_system *system,
                               struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&system->contacts, input->scene->contact_count, error));
    TRY(NEW_ARRAY(&system->contact_averages, input->scene->contact_count, error));
    for (int64_t i = 0; i < input->scene->contact_count; i++) {
        TRY(add_contact(input, &input->scene->contacts[i], system, error));
    }
done:
    return status;
}
