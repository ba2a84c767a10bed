/* Functions shared by the files of the preconditioner; see preconditioner.h. */
#pragma once

#include "solid/preconditioner/preconditioner.h"

/* matrix += the stiffness along the coarse fields of the contact nodes that A counts in; and the profile is
 * widened to hold it wherever points touch. */
void preconditioner_add_contacts(struct preconditioner *preconditioner, const struct solid_system *system,
                                 double *matrix);
void preconditioner_widen_by_contacts(struct preconditioner *preconditioner,
                                      const struct solid_system *system);

/* Lay out the profile of the stiffness along the coarse fields. */
MUST_CHECK enum status preconditioner_lay_out(struct preconditioner *preconditioner,
                                              const struct solid_system *system, struct error *error);

/* Set the stiffness of body, springs and conditions along the coarse fields, as it is at the last
 * evaluation of a body of smoothed cells. */
MUST_CHECK enum status preconditioner_assemble(struct preconditioner *preconditioner,
                                               struct solid_system *system, struct error *error);

/* Set the rotations of the nodes: those of the mean of F over the cells around each, at the last evaluation
 * of a body of smoothed cells. */
MUST_CHECK enum status preconditioner_find_rotations(struct preconditioner *preconditioner,
                                                     const struct body *body, struct error *error);

/* y = R x at each node, or `back` R^T x; x may be y. */
void preconditioner_turn(const struct preconditioner *preconditioner, bool back, const double *x, double *y);
