/* Volume changes and pressures of nodal volumes, equations (13) to (16) of lib/README.md; private to
 * lib/solid.
 *
 * A background node a owns the nodal volume V_a = sum_q N_a(q) w_q, where N_a is its linear hat function and
 * w_q the volume of point q (average nodal pressure: Bonet and Burton 1998). The volumetric energy of a
 * material is U(J) = kappa / 2 y(J)^2 (material.h). Of kappa a part s, of the order of mu, acts on the y of
 * the points; the rest, k = kappa - s, on nodal pressures pi, by the mixed energy
 *
 *   sum_q w_q s_q / 2 y_q^2  +  max_pi ( b . pi - pi . A pi / 2 ),        b_a = sum_q N_a(q) w_q y_q,
 *   A_ab = sum_q w_q ( delta_ab N_a(q) / k_q + epsilon / mu_q C_ab ),
 *   C_ab = ( delta_ab N_a(q) - N_a(q) N_b(q) ) / (d + 2),
 * so that pi = A^-1 b. With one point in the middle of a cell C is the mean over the cell of (N_a - mean of
 * N_a) (N_b - mean of N_b): the pressure projection of Dohrmann and Bochev 2004. For smooth pressures the
 * modulus is k; for pressures that vary from node to node it is of the order of mu / epsilon, as C grows up
 * to N / (d + 2). Without C spurious pressure modes lock the body; with it the error is of the order of the
 * spacing squared (Bochev, Dohrmann and Gunzburger 2006). A body with kappa <= s does not lock and has no
 * nodal pressures.
 *
 * A change of volume of wave number k on nodes at distance h has about the stiffness
 *
 *   k^2 / (1 / kappa + epsilon k^2 h^2 / (20 mu))  <  20 / epsilon  mu / h^2:
 * so a critical step by mu and h is stable for any kappa.
 *
 * The pressure at point q, the derivative of the energy by J_q per volume, is
 *
 *   p_q = ( sum_a N_a(q) pi_a + s_q y_q ) y'(J_q).
 *
 * At edges between clamped and free sides, and at re-entrant ones such as the tip of a slit, the pressure is
 * singular. A nodal pressure cannot approximate it: the body would be too stiff. Nodes at such edges own no
 * nodal volume: the other nodes of their cells share it, with N_a scaled to the sum 1, as multipliers of
 * mortar methods are constant in the last element of an interface (Bernardi, Maday and Patera 1994). If a
 * nodal volume has a cell at an edge, s acts on the volume as a whole, not on its points: with theta_a = 1
 * for these volumes and 0 for others, the first term of the energy is
 *
 *   sum_q w_q s_q / 2 sum_a (1 - theta_a) N_a(q) y_q^2  +  sum_a theta_a S_a / 2 Y_a^2,
 *   S_a = sum_q N_a(q) w_q s_q,    Y_a = sum_q N_a(q) w_q s_q y_q / S_a,
 * and p_q has s_q sum_a N_a(q) (theta_a Y_a + (1 - theta_a) y_q) in place of s_q y_q. The modulus of a
 * uniform change of volume is kappa at edges as elsewhere, also for a body that contacts enclose. Cells
 * without other nodes are not changed.
 *
 * Groups of materials do not share nodal volumes, since the pressure jumps between them. */
#pragma once

#include "solid/body/body.h"

/* Build the nodal volumes of a body whose points are laid out. */
MUST_CHECK enum status nodal_volumes_build(const struct body_input *input, struct body *body,
                                           struct error *error);
void nodal_volumes_free(struct nodal_volumes *volumes);

/* Set y of the points of block b from body->J. */
void nodal_volumes_strain(struct body *body, int64_t b);

/* Set b and pi from y. Called by all threads of a parallel region together. */
void nodal_volumes_evaluate(struct body *body);

/* The part s of the bulk modulus, Pa. */
double nodal_volume_modulus(const struct material *material);

/* Pressure p_q at the last evaluation, Pa; negative in compression. */
double nodal_volume_pressure(const struct body *body, int64_t point);

/* Volumetric energy of a point per volume at the last evaluation, Pa. */
double nodal_volume_energy(const struct body *body, int64_t point);

/* ---- nodal_pressure.c: the solution of A pi = b ---- */

/* Build A for nodal volumes whose points and shares are set. */
MUST_CHECK enum status nodal_pressures_build(struct body *body, struct error *error);
void nodal_pressures_free(struct nodal_pressures *pressures);

/* body->volumes.pressure = A^-1 content, by all threads of a parallel region together. With several
 * processes, each needs the content of its own volumes, and gets the pressures of these and at its own
 * points. */
void nodal_pressures_solve(struct body *body);

/* The part k of the bulk modulus, Pa, and epsilon / mu, 1/Pa. */
double nodal_pressure_modulus(const struct material *material);
double nodal_pressure_compliance(const struct material *material);
