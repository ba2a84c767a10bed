/* Constraint penalties of a system, and springs of measured points, which are kept among them. */
#include "solid/system.h"

#include "base/memory.h"

enum status system_append_penalty(struct solid_system *system, const struct average *average,
                                  const double *direction, double target, int32_t curve, int32_t section,
                                  int32_t node, double stiffness, struct error *error)
{
    struct constraint_rows *penalties = &system->penalties;
    enum status status = constraint_rows_add(penalties, average->length, average->idx, average->phi,
                                             direction, target, curve, section, node, error);
    if (status != STATUS_OK) {
        return status;
    }
    double *grown = array_grow(system->penalty_stiffness, penalties->count, sizeof *grown);
    system->penalty_stiffness = grown != NULL ? grown : system->penalty_stiffness;
    double *pull = array_grow(system->penalty_force, penalties->count, sizeof *pull);
    system->penalty_force = pull != NULL ? pull : system->penalty_force;
    if (grown == NULL || pull == NULL) {
        return fail_memory(error, "springs");
    }
    grown[penalties->count - 1] = stiffness;
    return STATUS_OK;
}

double system_penalty_force(const struct solid_system *system, int64_t r, const double *u)
{
    const struct constraint_rows *penalties = &system->penalties;
    return system->penalty_stiffness[r] * (penalties->target[r] * system->factor[penalties->curve[r]] -
                                           constraint_rows_value(penalties, r, u));
}

void system_add_penalties(struct solid_system *system, const double *u, double *force)
{
    const struct constraint_rows *penalties = &system->penalties;
    double *pull = system->penalty_force;
    constraint_rows_values(penalties, u, pull);
    for (int64_t r = 0; r < penalties->count; r++) {
        double target = penalties->target[r] * system->factor[penalties->curve[r]];
        pull[r] = system->penalty_stiffness[r] * (target - pull[r]);
    }
    constraint_rows_spread(penalties, pull, NULL, force);
}

double system_penalty_energy(const struct solid_system *system, const double *u)
{
    double energy = 0.0;
    for (int64_t r = 0; r < system->penalties.count; r++) {
        double pull = system_penalty_force(system, r, u);
        energy += 0.5 * pull * pull / system->penalty_stiffness[r];
    }
    return energy;
}
