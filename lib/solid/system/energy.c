#include "solid/system/energy.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

enum status energy_log_add(struct energy_log *log, const struct energy *row, struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&log->rows, log->count + 1, &log->capacity, error));
    log->rows[log->count++] = *row;
    return STATUS_OK;
}

enum status energy_log_state(struct energy_log *log, const struct state *state, struct error *error)
{
    _Static_assert(sizeof(struct energy) == ENERGY_COLUMNS * sizeof(double), "a row of numbers");
    const struct state_value count = {"count", STATE_COUNTS, &log->count, 1};
    RETURN_IF_ERROR(state_visit(state, "energies", &count, 1, error));
    RETURN_IF_ERROR(GROW_ARRAY(&log->rows, log->count, &log->capacity, error));
    const struct state_value rows = {"rows", STATE_NUMBERS, log->rows, log->count * ENERGY_COLUMNS};
    return state_visit(state, "energies", &rows, 1, error);
}

void energy_log_free(struct energy_log *log)
{
    free(log->rows);
    *log = (struct energy_log){0};
}

struct energy_balance energy_balance_begin(const struct solid_system *system)
{
    const struct body *body = &system->body;
    struct energy_balance balance = {0};
    for (int64_t q = 0; q < body->point_count; q++) {
        balance.largest += ROUND_OFF * body->weight[q] * body->materials[body->material[q]].shear_modulus;
    }
    return balance;
}

void energy_balance_complete(struct energy_balance *balance, bool first, struct energy *row)
{
    double stored = row->kinetic + row->internal + row->contact;
    row->work = balance->work;
    row->dissipated += balance->dissipated;
    if (first) {
        balance->start = stored + row->dissipated - balance->work;
    }
    const double parts[] = {row->kinetic, row->internal, row->contact, row->work, row->dissipated};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        balance->largest = fmax(balance->largest, fabs(parts[i]));
    }
    row->error = (stored + row->dissipated - row->work - balance->start) / balance->largest;
    if (!(fabs(row->error) <= balance->worst)) { /* NaN stays */
        balance->worst = fabs(row->error);
    }
}

double energy_kinetic(const struct solid_system *system, const double *v, const double *w)
{
    int dim = system->dim;
    double sum = 0.0;
    for (int64_t n = 0; n < system->node_count; n++) {
        sum += system->lumped_mass[n] * vector_dot(dim, v + n * dim, w + n * dim);
    }
    return 0.5 * sum;
}

double energy_internal(struct solid_system *system, const double *u)
{
    return body_energy(&system->body, u) + system_spring_energy(system, u) +
           system_pull_membranes(system, u, NULL);
}

bool energy_find_prestress(const struct solid_system *system, bool *acts)
{
    const struct body *body = &system->body;
    bool any = false;
    for (int64_t m = 0; m < body->material_count; m++) {
        if (body->materials[m].active > 0.0) {
            any = acts[body->materials[m].active_curve] = true;
        }
    }
    for (int64_t i = 0; i < system->acting.membrane_count; i++) {
        if (system->acting.membranes[i].tension > 0.0) {
            any = acts[system->acting.membranes[i].curve] = true;
        }
    }
    return any;
}

double energy_of_prestress(struct solid_system *system, const double *u, int32_t curve)
{
    double energy = body_active_energy(&system->body, curve);
    for (int64_t i = 0; i < system->acting.membrane_count; i++) {
        const struct membrane *membrane = &system->acting.membranes[i];
        if (membrane->tension > 0.0 && membrane->curve == curve) {
            energy += membrane_pull(membrane, system->X, 1.0, u, NULL) -
                      membrane_pull(membrane, system->X, 0.0, u, NULL);
        }
    }
    return energy;
}

double energy_contact(const struct solid_system *system)
{
    double sum = 0.0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        sum += contact_energy(&system->contacts[c]);
    }
    return sum;
}
