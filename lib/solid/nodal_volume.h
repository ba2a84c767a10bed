/* Volume ratios averaged over nodal volumes; private to lib/solid.
 *
 * A background node a owns the nodal volume V_a = sum_q N_a(q) w_q, where N_a is its linear hat function and
 * w_q the volume of point q (average nodal pressure: Bonet and Burton 1998). The volume ratios J of the
 * points are averaged to the nodal volumes and back to the points:
 *
 *   theta_a = (1 / V_a) sum_q N_a(q) w_q J_q,        Jbar_q = sum_a N_a(q) theta_a,
 *
 * in short Jbar = T J; equations (13) to (16) of lib/README.md. T keeps constants, and w T is symmetric. Of
 * the bulk modulus, a part s acts on J and the rest on the averages. The volumetric energy is
 *
 *   sum_q w_q ( U(Jbar_q) - s_q / 2 (Jbar_q - 1)^2 + s_q / 2 (J_q - 1)^2 ),      s = min(kappa, 2 mu).
 *
 * Where J is smooth that is U(J). The averages resist only those variations of J that they resolve, so that
 * the body does not lock. The part s, of the order of mu, resists the others, so that single cells do not
 * collapse (pressure projection: Dohrmann and Bochev 2004; stabilisation with limited moduli: Puso, Chen,
 * Zywicz and Elmer 2008). A body with kappa <= 2 mu does not lock, and has the pointwise law. The pressure
 * that acts at point q follows from the derivative of the energy:
 *
 *   p_q = sum_a N_a(q) pi_a + s_q (J_q - 1),
 *   pi_a = (1 / V_a) sum_q N_a(q) w_q ( U'(Jbar_q) - s_q (Jbar_q - 1) ).
 *
 * Groups of materials do not share nodal volumes, since the pressure jumps between them. */
#ifndef SOLID_NODAL_VOLUME_H
#define SOLID_NODAL_VOLUME_H

#include "solid/body.h"

/* Of a body whose points are laid out. */
MUST_CHECK enum status nodal_volumes_build(const struct body_input *input, struct body *body,
                                           struct error *error);
void nodal_volumes_free(struct nodal_volumes *volumes);

/* Set body->volumes from body->J. To be called by all threads of a parallel region together. */
void nodal_volumes_evaluate(struct body *body);

/* The part s of the bulk modulus, Pa. */
double nodal_volume_modulus(const struct material *material);

/* Pressure p_q at the last evaluation, Pa; negative in compression. */
double nodal_volume_pressure(const struct body *body, int64_t point);

/* Volumetric energy of a point per volume at the last evaluation, Pa. */
double nodal_volume_energy(const struct body *body, int64_t point);

#endif
