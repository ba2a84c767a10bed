/* Volumes averaged over hat functions, see struct volume_hats in body.h; private to lib/solid. */
#ifndef SOLID_HATS_H
#define SOLID_HATS_H

#include "solid/body.h"

/* Of a body whose points are laid out. */
MUST_CHECK enum status hats_build(const struct body_input *input, struct body *body, struct error *error);
void hats_free(struct volume_hats *hats);

/* Pressure and slope of hat a from body->J. */
void hats_set_pressure(struct body *body, int64_t a);

/* Volumetric energy of all hats, J (2D: J/m). */
double hats_energy(const struct body *body);

#endif
