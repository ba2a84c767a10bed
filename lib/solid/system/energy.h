/* Energies of a run and their balance: kinetic + internal + contact + dissipated = external work + energy at
 * the start. */
#pragma once

#include "solid/system/system.h"

/* Energies at one time: J, in 2D J/m. A row of ENERGY_COLUMNS numbers. */
struct energy {
    double time;       /* s */
    double kinetic;    /* 1/2 v- M v+, of the velocities half a step before and after */
    double internal;   /* elastic, of the body, its membranes and springs */
    double contact;    /* of the contacts' penalties */
    double work;       /* of loads and prescribed motion, since the start */
    double dissipated; /* by damping and viscoelastic materials, since the start */
    double error;      /* of the balance, relative to the largest energy so far */
};
enum { ENERGY_COLUMNS = 7 };

struct energy_log {
    int64_t count, capacity;
    struct energy *rows; /* count, in order of time */
};

MUST_CHECK enum status energy_log_add(struct energy_log *log, const struct energy *row, struct error *error);
void energy_log_free(struct energy_log *log);
MUST_CHECK enum status energy_log_state(struct energy_log *log, const struct state *state,
                                        struct error *error);

/* The balance of a run by central differences. Works are summed by the trapezium rule over the displacement
 * of each step. With the kinetic energy 1/2 v- M v+, the balance of a linear system then holds to round-off;
 * otherwise its error is that of the time step. */
struct energy_balance {
    double start;            /* energy at the start */
    double work, dissipated; /* since then */
    double largest;          /* energy so far; initially a bound below which energies are round-off */
    double worst;            /* largest |error| so far */
};

struct energy_balance energy_balance_begin(const struct solid_system *system);

/* Set work and error of a row, and add to dissipated, which is set to that of the materials; `first`: it is
 * the row of the start. */
void energy_balance_complete(struct energy_balance *balance, bool first, struct energy *row);

/* 1/2 v M w, J (2D: J/m). */
double energy_kinetic(const struct solid_system *system, const double *v, const double *w);

/* Energy of the body, its membranes and springs at u and system->factor. */
double energy_internal(struct solid_system *system, const double *u);

/* acts[curve_count]: whether an active stress or the prestress of a membrane is multiplied by a load factor;
 * returns whether any is. */
bool energy_find_prestress(const struct solid_system *system, bool *acts);

/* The derivative of energy_internal by such a factor, J (2D: J/m), at u, which was evaluated last. */
double energy_of_prestress(struct solid_system *system, const double *u, int32_t curve);

/* contact_energy of all contacts. */
double energy_contact(const struct solid_system *system);
