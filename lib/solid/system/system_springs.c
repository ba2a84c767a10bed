/* Springs of measured points and supports, and membranes of a system. */
#include "solid/system/system.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "solid/body/body_share.h"

#include <stdlib.h>

enum status system_append_spring(struct solid_system *system, const struct average *average,
                                 const double *direction, double target, int32_t curve, int32_t section,
                                 int32_t node, double stiffness, struct error *error)
{
    struct constraint_rows *springs = &system->springs.rows;
    RETURN_IF_ERROR(constraint_rows_add(springs, average->length, average->idx, average->phi, direction,
                                        target, curve, section, node, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->springs.stiffness, springs->count, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->springs.force, springs->count, error));
    system->springs.stiffness[springs->count - 1] = stiffness;
    return STATUS_OK;
}

enum status system_share_springs(struct solid_system *system, struct error *error)
{
    const struct body *body = &system->body;
    SCRATCH bool *own = NULL;
    if (body->share.ranks != NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&own, body->node_count, error));
        for (int64_t p = body->share.begin_node; p < body->share.end_node; p++) {
            own[body->order.nodes[p]] = true;
        }
    }
    return constraint_nodes_build(&system->springs.rows, body->node_count, NULL, own, &system->springs.nodes,
                                  error);
}

double system_spring_force(const struct solid_system *system, int64_t r, const double *u)
{
    const struct constraint_rows *springs = &system->springs.rows;
    return system->springs.stiffness[r] *
           (springs->target[r] * system->factor[springs->curve[r]] - constraint_rows_value(springs, r, u));
}

void system_add_springs(struct solid_system *system, const double *u, double *force)
{
    const struct constraint_rows *springs = &system->springs.rows;
    double *pull = system->springs.force;
    if (springs->count == 0) {
        return;
    }
    struct chunks chunks = chunks_for_threads(springs->list_count, springs->list_count, LISTS_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        for (int64_t l = chunks_begin(&chunks, c); l < chunks_begin(&chunks, c + 1); l++) {
            if (!system->springs.nodes.used[l]) {
                continue;
            }
            constraint_rows_take(springs, l, l + 1, u, pull);
            for (int64_t r = springs->first[l]; r < springs->first[l + 1]; r++) {
                double target = springs->target[r] * system->factor[springs->curve[r]];
                pull[r] = system->springs.stiffness[r] * (target - pull[r]);
            }
        }
    }
    constraint_nodes_spread(&system->springs.nodes, pull, force);
}

double system_spring_energy(const struct solid_system *system, const double *u)
{
    double energy = 0.0;
    for (int64_t r = 0; r < system->springs.rows.count; r++) {
        double pull = system_spring_force(system, r, u);
        energy += 0.5 * pull * pull / system->springs.stiffness[r];
    }
    return energy;
}

double system_pull_membranes(const struct solid_system *system, const double *u, double *force)
{
    double energy = 0.0;
    for (int64_t i = 0; i < system->acting.membrane_count; i++) {
        const struct membrane *membrane = &system->acting.membranes[i];
        energy += membrane_pull(membrane, system->X, system->factor[membrane->curve], u, force);
    }
    return energy;
}
