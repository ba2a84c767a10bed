#include "model_prescription.h"

#include <math.h>
#include <string.h>

enum status prescription_value(const struct prescription *p, int32_t node, const double *x, double *value,
                               struct error *error)
{
    double distance, spacing;
    struct error why;
    char place[96];
    enum status status = scattered_fit_evaluate(&p->fit, node, x, value, &distance, &spacing, &why);
    if (status != STATUS_OK) {
        point_text(p->input->cells.dim, x, place);
        return scene_fail(error, status, p->input->scene, &p->section->label, "table %s: at %s: %s",
                          p->section->table, place, why.text);
    }
    if (p->table.rows > 1 && !(distance <= fmin(8.0 * spacing, p->input->extent))) {
        point_text(p->input->cells.dim, x, place);
        return scene_fail(
            error, STATUS_INPUT, p->input->scene, &p->section->label,
            "table %s: its nearest point is %.3g m from the boundary at %s, its points are %.3g m "
            "apart: wrong unit or wrong place",
            p->section->table, distance, place, spacing);
    }
    return STATUS_OK;
}

/* Mean of the table over the samples of one average. */
static enum status average_of_table(const struct prescription *p, const struct boundary_averages *averages,
                                    int64_t a, double *mean, struct error *error)
{
    int dim = p->input->cells.dim;
    for (int i = 0; i < dim; i++) {
        mean[i] = 0.0;
    }
    for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
        double value[3];
        enum status status =
            prescription_value(p, averages->node[a], averages->sample_x + s * dim, value, error);
        if (status != STATUS_OK) {
            return status;
        }
        for (int i = 0; i < dim; i++) {
            mean[i] += averages->sample_share[s] * value[i];
        }
    }
    return STATUS_OK;
}

bool prescription_is_free(const struct scene_displacement *section, int i)
{
    return section->kind == SCENE_COMPONENTS && section->is_free[i];
}

int prescription_directions(const struct scene_displacement *section, int dim)
{
    int count = 0;
    for (int i = 0; i < dim; i++) {
        count += !prescription_is_free(section, i);
    }
    return section->kind == SCENE_NORMAL ? 1 : count;
}

bool prescription_is_full(const struct prescription *p)
{
    return prescription_directions(p->section, p->input->cells.dim) == p->input->cells.dim;
}

enum status prescription_demand(const struct prescription *p, const struct boundary_averages *averages,
                                int64_t a, struct demand *demand, struct error *error)
{
    int dim = p->input->cells.dim;
    const struct scene_displacement *section = p->section;
    double value[3] = {section->components[0], section->components[1], section->components[2]};
    *demand = (struct demand){.count = 0};
    if (section->kind == SCENE_NORMAL) {
        memcpy(demand->direction, averages->normal + a * dim, (size_t)dim * sizeof *demand->direction);
        demand->value[demand->count++] = section->normal;
        return STATUS_OK;
    }
    if (section->kind == SCENE_TABLE) {
        enum status status = average_of_table(p, averages, a, value, error);
        if (status != STATUS_OK) {
            return status;
        }
    }
    for (int i = 0; i < dim; i++) {
        if (!prescription_is_free(section, i)) {
            demand->direction[demand->count * dim + i] = 1.0;
            demand->value[demand->count++] = value[i];
        }
    }
    return STATUS_OK;
}
