/* The stiffness of the coarse space: that of the body, by differences; and its factor. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/memory.h"
#include "base/round_off.h"

#include <stdlib.h>
#include <string.h>

/* By its diagonal: added to the stiffness of the coarse space, so that modes without stiffness have a mass.
 */
static const double kept = 1e-6;
enum { MOST_ATTEMPTS = 12 }; /* with ten times as much each time, until the stiffness is positive definite */

/* The values of A: body + contacts + keep weight. */
static void sum_stiffness(struct preconditioner *p, const struct solid_system *system, double keep)
{
    memcpy(p->stiffness_factor, p->body, (size_t)p->profile.size * sizeof *p->body);
    for (int64_t k = 0; k < p->size; k++) {
        *profile_entry(&p->profile, k, k, p->stiffness_factor) += keep * p->weight[k / p->dim];
    }
    preconditioner_add_contacts(p, system, p->stiffness_factor);
}

void preconditioner_factorise(struct preconditioner *p, const struct solid_system *system)
{
    double keep = kept;
    p->measured = false;
    p->uses_coarse = false;
    /* Of an unstable body the stiffness is indefinite. */
    for (int attempt = 0; attempt < MOST_ATTEMPTS && p->size > 0 && !p->uses_coarse; attempt++) {
        sum_stiffness(p, system, keep);
        p->uses_coarse = profile_factorise(&p->profile, p->stiffness_factor);
        keep *= 10.0;
    }
}

/* The stiffness of the body, by the change of its forces at u along each field; u is evaluated last. */
static enum status measure_by_differences(struct preconditioner *p, struct solid_system *system,
                                          const double *u, struct error *error)
{
    int64_t values = p->node_count * p->dim;
    double epsilon = DIFFERENCE_STEP * system_node_spacing(system), *one = p->amount;
    NEW_SCRATCH(double, at_u, values, error);
    NEW_SCRATCH(double, moved, values, error);
    NEW_SCRATCH(double, force, values, error);
    system_resist(system, u, at_u);
    for (int64_t k = 0; k < p->size; k++) {
        memset(one, 0, (size_t)p->size * sizeof *one);
        one[k] = 1.0;
        memset(moved, 0, (size_t)values * sizeof *moved);
        coarse_space_prolongate(&p->coarse, one, moved);
        preconditioner_project(p, moved);
        for (int64_t i = 0; i < values; i++) {
            moved[i] = u[i] + epsilon * moved[i];
        }
        system_resist(system, moved, force);
        for (int64_t i = 0; i < values; i++) {
            force[i] = (force[i] - at_u[i]) / epsilon;
        }
        preconditioner_project(p, force);
        coarse_space_restrict(&p->coarse, force, one);
        memcpy(profile_entry(&p->profile, k, 0, p->body), one, (size_t)(k + 1) * sizeof *one);
    }
    system_resist(system, u, at_u);
    return STATUS_OK;
}

enum status preconditioner_measure(struct preconditioner *p, struct solid_system *system, const double *u,
                                   int64_t *evaluations, struct error *error)
{
    if (p->size == 0 && p->rotation == NULL) {
        return STATUS_OK;
    }
    if (system->body.smoothed) {
        body_share_collect(&system->body);
    }
    if (p->rotation != NULL) {
        RETURN_IF_ERROR(preconditioner_find_rotations(p, &system->body, error));
    }
    if (p->size > 0 && system->body.smoothed) {
        RETURN_IF_ERROR(preconditioner_assemble(p, system, error));
    } else if (p->size > 0) {
        RETURN_IF_ERROR(measure_by_differences(p, system, u, error));
        *evaluations += p->size + 2;
    }
    p->measured = true;
    return STATUS_OK;
}
