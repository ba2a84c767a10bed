/* Operations on all contacts of a system. */
#include "solid/system/system.h"

#include "base/memory.h"
#include "solid/contact/friction.h"

#include <omp.h>
#include <math.h>
#include <stdlib.h>

/* Limits of the penetration at an equilibrium: of its depth, by the largest displacement; and of the work of
 * the contact forces along it, by the energy of the body, as a multiple of the tolerance and at least. */
static const double penetration_share = 1e-3, missing_tolerances = 10.0, least_missing = 1e-5;

void system_free_contacts(struct solid_system *system)
{
    for (int64_t i = 0; i < system->contact_count; i++) {
        contact_free(&system->contacts[i]);
        boundary_averages_free(&system->contact_points[i]);
        if (system->contact_averages != NULL) {
            boundary_averages_free(&system->contact_averages[i]);
        }
    }
    FREE_ALL(system->contacts, system->contact_points, system->contact_averages);
    system->contacts = NULL;
    system->contact_points = system->contact_averages = NULL;
    system->contact_count = 0;
}

void system_measure_contacts(struct solid_system *system, const double *u, bool all)
{
    double started = omp_get_wtime();
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_move(&system->contacts[c], system->factor);
        contact_measure(&system->contacts[c], u, all);
    }
    system->cost.contact += omp_get_wtime() - started;
}

void system_accept(struct solid_system *system)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_accept(&system->contacts[c]);
    }
}

bool system_has_friction(const struct solid_system *system)
{
    bool any = false;
    for (int64_t c = 0; c < system->contact_count; c++) {
        any = any || system->contacts[c].friction != NULL;
    }
    return any;
}

bool system_held_by_friction(const struct solid_system *system)
{
    return system->floats && system_has_friction(system);
}

void system_predict_friction(struct solid_system *system, bool sticks)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        friction_predict(&system->contacts[c], sticks);
    }
}

void system_relax_friction(struct solid_system *system)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        friction_relax(&system->contacts[c]);
    }
}

void system_hold_friction(struct solid_system *system, bool sticks)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        friction_hold(&system->contacts[c], sticks);
    }
}

void system_slide(struct solid_system *system)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        friction_slide(&system->contacts[c]);
    }
}

double system_friction_work(const struct solid_system *system)
{
    double work = 0.0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        work += system->contacts[c].friction != NULL ? system->contacts[c].friction->dissipated : 0.0;
    }
    return work;
}

void system_augment_contacts(struct solid_system *system)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_augment(&system->contacts[c]);
    }
}

bool system_stiffen(struct solid_system *system)
{
    bool stiffer = false;
    double shear = INFINITY;
    for (int64_t m = 0; m < system->body.material_count; m++) {
        shear = fmin(shear, system->body.materials[m].shear_modulus);
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        stiffer = contact_stiffen(&system->contacts[c], shear) || stiffer;
    }
    return stiffer;
}

double system_contact_miss(const struct solid_system *system)
{
    double miss = 0.0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        miss = fmax(miss, contact_miss(&system->contacts[c]));
    }
    return miss;
}

double system_missing_work(const struct solid_system *system)
{
    double work = 0.0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        work += contact_missing_work(&system->contacts[c]);
    }
    return work;
}

double system_penetration_allowed(double move)
{
    return penetration_share * move;
}

bool system_contacts_give_way(struct solid_system *system, const double *u, double move, double tolerance)
{
    double miss = system_contact_miss(system);
    double missing_share = fmax(least_missing, missing_tolerances * tolerance);
    return miss > system_penetration_allowed(move) ||
           (miss > tolerance * move &&
            system_missing_work(system) > missing_share * body_energy(&system->body, u));
}

bool system_has_touched(const struct solid_system *system)
{
    bool touched = false;
    for (int64_t c = 0; c < system->contact_count; c++) {
        touched = touched || system->contacts[c].deepest > 0.0;
    }
    return touched;
}
