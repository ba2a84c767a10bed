/* Volume changes and pressures of nodal volumes, equations (13) to (16) of lib/README.md (average nodal
 * pressure: Bonet and Burton 1998; pressure projection: Dohrmann and Bochev 2004); private to lib/solid.
 *
 * A body with kappa <= s does not lock and has no nodal pressures.
 *
 * epsilon makes the projection the compliance of a bubble in each cell, as in the MINI element (Arnold,
 * Brezzi and Fortin 1984). The field a beta, with beta the product of all N_k and a free vector a, does not
 * change the volume of the cell. The pressure does the work -w mean(beta) a . grad pi on it. In a regular
 * cell its elastic energy mu |sym grad|^2 is w mu / 2 (1 + 1 / d) mean |grad beta|^2 |a|^2. The energy of
 * both is stationary at -w / (2 mu) |grad pi|^2 mean(beta)^2 / ((1 + 1 / d) mean |grad beta|^2), which is
 * minus the second term of (14) in pi . A pi / 2 with epsilon = 1/5 in 2D and 3/28 in 3D.
 *
 * A change of volume of wave number k on nodes at distance h has about the stiffness
 *
 *   k^2 / (1 / kappa + epsilon k^2 h^2 / (20 mu))  <  20 / epsilon  mu / h^2:
 * so a critical step by mu and h is stable for any kappa.
 *
 * Nodes at edges between clamped and free sides, and at re-entrant ones, own no nodal volume: the other nodes
 * of their cells share it, and s acts on whole nodal volumes there (13a). Cells without other nodes are not
 * changed. Groups of materials do not share nodal volumes, since the pressure jumps between them; the
 * materials of a group have one law. */
#pragma once

#include "solid/body/body.h"

/* Build the nodal volumes of a body whose points are laid out. */
MUST_CHECK enum status nodal_volumes_build(const struct body_input *input, struct body *body,
                                           struct error *error);
void nodal_volumes_free(struct nodal_volumes *volumes);

/* Set J - 1 of the points of block b from body->J. */
void nodal_volumes_change(struct body *body, int64_t b);

/* Set b and pi from J - 1. Called by all threads of a parallel region together. */
void nodal_volumes_evaluate(struct body *body);

/* The part of a modulus that may act on single cells without locking them, Pa; and s, that of the bulk
 * modulus. */
double nodal_volume_part(double modulus, double shear);
double nodal_volume_modulus(const struct material *material);

/* After a change of the stiffening: S_a and A. */
void nodal_volumes_renew(struct body *body);

/* Pressure p_q at the last evaluation, Pa; negative in compression. */
double nodal_volume_pressure(const struct body *body, int64_t point);

/* Volumetric energy of a point per volume at the last evaluation, Pa. */
double nodal_volume_energy(const struct body *body, int64_t point);

/* ---- nodal_pressure.c: the solution of A pi = b ---- */

/* Build A for nodal volumes whose points and shares are set. */
MUST_CHECK enum status nodal_pressures_build(struct body *body, struct error *error);
void nodal_pressures_renew(struct body *body);
void nodal_pressures_free(struct nodal_pressures *pressures);

/* body->volumes.pressure = A^-1 content, by all threads of a parallel region together. With several
 * processes, each needs the content of its own volumes, and gets the pressures of these and at its own
 * points. */
void nodal_pressures_solve(struct body *body);

/* The part k of the bulk modulus, Pa, and epsilon / ((d + 2) mu), 1/Pa. */
double nodal_pressure_modulus(const struct material *material);
double nodal_pressure_compliance(const struct material *material, int dim);
