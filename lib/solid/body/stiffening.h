/* How much stiffer a strained body is than at rest. Its moduli at rest stabilise the volume ((10), (13) and
 * (14) of lib/README.md) and precondition; a law that stiffens by far leaves them too small. So in a
 * quasi-static run they follow the work of the law's stress on its strain, from one state to the next: within
 * an evaluation they are constants, and the forces have an energy. */
#pragma once

#include "base/state.h"
#include "base/status.h"

#include <stdbool.h>

struct body;

struct stiffening {
    double *of_point; /* point_count, >= 1: that work, by the one of a neo-Hookean law of the moduli at rest;
                         1 of neo-Hookean points and of laws that are not isochoric; NULL: all are such */
    double *next, *work; /* point_count: of_point at the last evaluation, and the latter work, J (2D: J/m) */
    double *of_material; /* material_count: the mean of of_point, weighted by work; and scratch */
};

MUST_CHECK enum status stiffening_build(struct body *body, struct error *error);
void stiffening_free(struct stiffening *stiffening);

/* of_point of a point. */
double stiffening_at(const struct body *body, int64_t q);

/* Visit them, see base/state.h; after what a Prony series has left. */
MUST_CHECK enum status stiffening_state(struct body *body, const struct state *state, struct error *error);

/* Let the moduli of (10), (13) and (14) follow: by of_point, of_material, and what a Prony series has left.
 */
void stiffening_take(struct body *body);
