/* Operations on all contacts of a system. */
#include "solid/system/system.h"

#include "base/clock.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

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
    double started = clock_seconds();
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_move(&system->contacts[c], system->factor);
        contact_measure(&system->contacts[c], u, all);
    }
    system->cost.contact += clock_seconds() - started;
}

void system_accept(struct solid_system *system)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_accept(&system->contacts[c]);
    }
}

void system_augment_contacts(struct solid_system *system, bool steady)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_augment(&system->contacts[c], steady);
    }
}

bool system_stiffen_contacts(struct solid_system *system)
{
    bool stiffer = false;
    for (int64_t c = 0; c < system->contact_count; c++) {
        stiffer = contact_stiffen(&system->contacts[c]) || stiffer;
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
