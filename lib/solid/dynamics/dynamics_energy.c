/* The works and energies of explicit dynamics, and their balance. */
#include "base/vector.h"
#include "solid/dynamics/dynamics_private.h"

#include <math.h>

void dynamics_add_work(struct dynamics *d, const double *velocity, double step, const double *factor_from,
                       const double *factor_to)
{
    const struct solid_system *system = d->system;
    const struct constraint_rows *rows = &system->rows;
    double work = 0.0, unresolved = 0.0;
    if (d->loads != NULL) {
        work += step * vector_dot(d->size, d->loads, velocity);
    }
    for (int64_t i = 0; d->stored != NULL && i < system->curve_count; i++) {
        work += d->stored[i] * (factor_to[i] - factor_from[i]);
    }
    for (int64_t r = 0; r < rows->count; r++) {
        double path = rows->target[r] * (factor_to[rows->curve[r]] - factor_from[rows->curve[r]]);
        work += d->constraint.multiplier[r] * path;
    }
    work += prescribed_values_work(&d->system->body, factor_from, factor_to);
    const struct constraint_rows *springs = &system->springs.rows;
    for (int64_t r = 0; r < springs->count; r++) {
        double path = springs->target[r] * (factor_to[springs->curve[r]] - factor_from[springs->curve[r]]);
        if (path != 0.0) {
            work += system_spring_force(system, r, d->u) * path;
        }
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        struct contact_work done = contact_work(&system->contacts[c], factor_from, factor_to);
        work += done.work;
        unresolved += done.unresolved;
    }
    /* When a surface moves onto a body at rest, the balance misses up to an eighth of `unresolved` in the
     * first step with contact. The largest energy is at least so large that this does not count as drift. */
    d->balance.largest = fmax(d->balance.largest, unresolved / (8.0 * DYNAMICS_MOST_DRIFT));
    d->balance.work += 0.5 * work;
    if (d->drag != NULL) {
        d->balance.dissipated += 0.5 * step * vector_dot(d->size, d->drag, velocity);
    }
    if (d->options->damping > 0.0) {
        double speed =
            energy_kinetic(system, d->before, velocity) + energy_kinetic(system, d->after, velocity);
        d->balance.dissipated += 0.5 * step * d->options->damping * speed;
    }
}

bool dynamics_sample(struct dynamics *d, double contact, struct error *error)
{
    bool is_first = d->report->steps == 0;
    struct energy row = {.time = is_first ? 0.0 : dynamics_time_now(d),
                         .kinetic = energy_kinetic(d->system, d->before, d->after),
                         .internal = energy_internal(d->system, d->u),
                         .contact = contact};
    row.dissipated = d->system->body.prony.dissipated + system_friction_work(d->system);
    d->report->force_evaluations++;
    energy_balance_complete(&d->balance, is_first, &row);
    d->report->last_drift = fabs(row.error);
    d->report->largest_drift = d->balance.worst;
    d->failure = d->log != NULL ? energy_log_add(d->log, &row, error) : STATUS_OK;
    return d->failure == STATUS_OK && d->balance.worst <= DYNAMICS_MOST_DRIFT;
}
