/* Rigid moves that the conditions of a system leave free. */
#ifndef SOLID_FREEDOM_H
#define SOLID_FREEDOM_H

#include "solid/system.h"

/* Whether the body can move as a whole without meeting a condition; contacts and springs do not count. */
bool system_floats(const struct solid_system *system);

#endif
