/* Constraint penalties of a system, and springs of measured points and supports, which are stored with them;
 * and its membranes. */
#include "solid/system/system.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "solid/body/body_share.h"

#include <math.h>
#include <stdlib.h>

/* Modulus of a penalty that a pressure p needs, by p^2 / mu: see system_stiffen_penalties; with a margin. */
static const double by_square = 5.0;

enum status system_append_penalty(struct solid_system *system, const struct average *average,
                                  const double *direction, double target, int32_t curve, int32_t section,
                                  int32_t node, double stiffness, double unit, struct error *error)
{
    struct constraint_rows *penalties = &system->penalties.rows;
    RETURN_IF_ERROR(constraint_rows_add(penalties, average->length, average->idx, average->phi, direction,
                                        target, curve, section, node, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->penalties.stiffness, penalties->count, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->penalties.unit, penalties->count, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->penalties.force, penalties->count, error));
    system->penalties.stiffness[penalties->count - 1] = stiffness;
    system->penalties.unit[penalties->count - 1] = unit;
    return STATUS_OK;
}

/* Find the nodal volume at the node of each penalty: one of them, if there are several. */
static enum status find_volumes(struct solid_system *system, struct error *error)
{
    const struct body *body = &system->body;
    const struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    NEW_SCRATCH(int32_t, at_node, body->node_count, error); /* 1 more than the volume; 0: none */
    RETURN_IF_ERROR(NEW_ARRAY(&system->penalties.volume, system->penalties.rows.count, error));
    for (int64_t a = 0; body->smoothed && a < volumes->count; a++) {
        int64_t slot = volumes->slot[volumes->ptr[a]];
        int32_t place = smoothed_cells_node(body, slot / vertices, (int)(slot % vertices));
        at_node[body->order.nodes[place]] = (int32_t)a + 1;
    }
    for (int64_t r = 0; r < system->penalties.rows.count; r++) {
        system->penalties.volume[r] = at_node[system->penalties.rows.node[r]] - 1;
    }
    return STATUS_OK;
}

/* In the second variation of the energy a pressure p on a side that slides does the work 2 p integral(u_n div
 * u_t), for parts of the normal and tangential displacements, u_n and u_t, that boundary averages do not see.
 * Against k_p u_n^2 / 2 of the penalty and mu h (div u_t)^2 / 2 of a layer of cells that is indefinite where
 * h k_p < 4 p^2 / mu: the side then buckles between its nodes. */
bool system_stiffen_penalties(struct solid_system *system)
{
    struct body *body = &system->body;
    const double *pressure = body->volumes.pressure;
    bool stiffer = false;
    double shear = 0.0;
    if (body->averaged && system->penalties.rows.count > system->penalties.spring_count) {
        body_share_collect_pressures(body);
    }
    for (int64_t m = 0; m < body->material_count; m++) {
        shear = fmax(shear, body->materials[m].shear_modulus);
    }
    for (int64_t r = 0; body->averaged && r < system->penalties.rows.count; r++) {
        if (system->penalties.volume[r] >= 0) {
            double p = pressure[system->penalties.volume[r]];
            double stiffness = by_square * p * p / shear * system->penalties.unit[r];
            stiffer = stiffer || stiffness > system->penalties.stiffness[r];
            system->penalties.stiffness[r] = fmax(system->penalties.stiffness[r], stiffness);
        }
    }
    return stiffer;
}

enum status system_share_penalties(struct solid_system *system, struct error *error)
{
    const struct body *body = &system->body;
    SCRATCH bool *own = NULL;
    RETURN_IF_ERROR(find_volumes(system, error));
    if (body->share.ranks != NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&own, body->node_count, error));
        for (int64_t p = body->share.begin_node; p < body->share.end_node; p++) {
            own[body->order.nodes[p]] = true;
        }
    }
    return constraint_nodes_build(&system->penalties.rows, body->node_count, NULL, own,
                                  &system->penalties.nodes, error);
}

double system_penalty_force(const struct solid_system *system, int64_t r, const double *u)
{
    const struct constraint_rows *penalties = &system->penalties.rows;
    return system->penalties.stiffness[r] * (penalties->target[r] * system->factor[penalties->curve[r]] -
                                             constraint_rows_value(penalties, r, u));
}

void system_add_penalties(struct solid_system *system, const double *u, double *force)
{
    const struct constraint_rows *penalties = &system->penalties.rows;
    double *pull = system->penalties.force;
    if (penalties->count == 0) {
        return;
    }
    struct chunks chunks = chunks_for_threads(penalties->list_count, penalties->list_count, LISTS_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        for (int64_t l = chunks_begin(&chunks, c); l < chunks_begin(&chunks, c + 1); l++) {
            if (!system->penalties.nodes.used[l]) {
                continue;
            }
            constraint_rows_take(penalties, l, l + 1, u, pull);
            for (int64_t r = penalties->first[l]; r < penalties->first[l + 1]; r++) {
                double target = penalties->target[r] * system->factor[penalties->curve[r]];
                pull[r] = system->penalties.stiffness[r] * (target - pull[r]);
            }
        }
    }
    constraint_nodes_spread(&system->penalties.nodes, pull, force);
}

/* The energy of the penalties from `first` on. */
static double energy_from(const struct solid_system *system, int64_t first, const double *u)
{
    double energy = 0.0;
    for (int64_t r = first; r < system->penalties.rows.count; r++) {
        double pull = system_penalty_force(system, r, u);
        energy += 0.5 * pull * pull / system->penalties.stiffness[r];
    }
    return energy;
}

double system_penalty_energy(const struct solid_system *system, const double *u)
{
    return energy_from(system, 0, u);
}

double system_spring_energy(const struct solid_system *system, const double *u)
{
    return energy_from(system, system->penalties.rows.count - system->penalties.spring_count, u);
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
