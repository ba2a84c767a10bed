/* The stabilisation of smoothed cells against parameters that the field does not show, equation (10a) of
 * lib/README.md. The offset of node n is the difference a_n - u_h(x_n) of its parameter and the field there.
 * Where parameters alternate between neighbours on a regular cloud, the values of the field at nodes and
 * edges are next to zero, and with them the energy of the cells. The energy sum_n k_n |offset|^2 / 2 is not.
 * It is zero for all fields that the shape functions reproduce, and does not change in rotations.
 *
 * What a process needs of it are its own nodes, their rows, and the rows that it sums (body_share.h). */
#pragma once

#include "base/status.h"

struct body;
struct body_input;

/* body->cells.offset_stiffness. Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status nodal_offsets_build(const struct body_input *input, struct body *body,
                                           struct error *error);

/* Inside a parallel region, by all its threads: add the forces of the offsets at the last evaluation to those
 * on the rows summed here, and to body->force of own nodes. */
void nodal_offsets_push_rows(struct body *body);
void nodal_offsets_push_nodes(struct body *body);

/* Their energy at the last evaluation, J (2D: J/m). Collective. */
double nodal_offsets_energy(struct body *body);
