/* What surrounds a body. Supports: springs at the quadrature points of facets, which are penalties with
 * target 0, and dashpots. And membranes. */
#include "solid/assembly/assembly.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* axis[dim * dim]: the normal n, then unit vectors orthogonal to it and to each other. */
static void axes_of_normal(int dim, const double *n, double *axis)
{
    double across[3] = {0.0, 0.0, 0.0};
    memcpy(axis, n, (size_t)dim * sizeof *axis);
    if (dim == 2) {
        axis[2] = -n[1];
        axis[3] = n[0];
        return;
    }
    int least = 0;
    for (int a = 1; a < 3; a++) {
        least = fabs(n[a]) < fabs(n[least]) ? a : least;
    }
    across[least] = 1.0;
    vector_cross(n, across, axis + 3);
    double length = vector_length(3, axis + 3);
    for (int a = 0; a < 3; a++) {
        axis[3 + a] /= length;
    }
    vector_cross(n, axis + 3, axis + 6);
}

/* The springs of one point. Of rows of one average the stiffest comes first: the preconditioner takes the
 * average to be supported by that in all directions. */
static enum status add_springs(const struct assembly *input, int64_t number,
                               const struct boundary_averages *points, int64_t p, struct solid_system *system,
                               struct error *error)
{
    const struct support_condition *support = &input->supports[number];
    struct average average = average_of_boundary(points, p);
    int dim = system->dim;
    double axis[9];
    bool across_first = support->tangential > support->normal;
    axes_of_normal(dim, points->normal + p * dim, axis);
    for (int i = 0; i < dim; i++) {
        int k = across_first ? (i + 1) % dim : i;
        double stiffness = points->area[p] * (k == 0 ? support->normal : support->tangential);
        if (stiffness > 0.0) {
            RETURN_IF_ERROR(system_append_penalty(system, &average, axis + k * dim, 0.0, support->curve,
                                                  (int32_t)(input->condition_count + number), points->node[p],
                                                  stiffness, 0.0, error));
            system->spring_count++;
        }
    }
    return STATUS_OK;
}

/* Lump the dashpots of the facets as the mass: each facet shares its own equally among its nodes. */
static enum status add_dashpots(const struct support_condition *support,
                                const struct boundary_averages *points, struct solid_system *system,
                                struct error *error)
{
    const struct facet_set *set = &support->facets;
    int64_t each = points->count / (set->count > 0 ? set->count : 1);
    int dim = system->dim;
    if (system->dashpot == NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&system->dashpot, system->node_count, error));
    }
    for (int64_t p = 0; p < points->count; p++) {
        for (int k = 0; k < dim; k++) {
            system->dashpot[set->facet[p / each * dim + k]] += support->damping * points->area[p] / dim;
        }
    }
    return STATUS_OK;
}

static enum status add_support(const struct assembly *input, int64_t number, struct solid_system *system,
                               struct error *error)
{
    const struct support_condition *support = &input->supports[number];
    FREED_BY(boundary_averages_free) struct boundary_averages points = {0};
    RETURN_IF_ERROR(fail_in(error,
                            boundary_points_build(&input->face_table, &support->facets, &points, error), "%s",
                            support->where));
    for (int64_t p = 0; p < points.count; p++) {
        RETURN_IF_ERROR(add_springs(input, number, &points, p, system, error));
    }
    return support->damping > 0.0 ? add_dashpots(support, &points, system, error) : STATUS_OK;
}

static enum status add_membrane(const struct assembly *input, const struct membrane_condition *section,
                                struct solid_system *system, struct error *error)
{
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->membranes, system->membrane_count + 1, error));
    struct membrane *added = &system->membranes[system->membrane_count++];
    return fail_in(
        error,
        membrane_build(&input->face_table, &section->facets, &system->rows, &section->law, added, error),
        "%s", section->where);
}

enum status assembly_add_supports(const struct assembly *input, struct solid_system *system,
                                  struct error *error)
{
    for (int64_t i = 0; i < input->support_count; i++) {
        RETURN_IF_ERROR(add_support(input, i, system, error));
    }
    for (int64_t i = 0; i < input->membrane_count; i++) {
        RETURN_IF_ERROR(add_membrane(input, &input->membranes[i], system, error));
    }
    return STATUS_OK;
}
