/* The preconditioner M of a search for equilibrium, equation (23) of lib/README.md.
 *
 * With a diagonal mass D that bounds the stiffness of each node, a load spreads by about one support in a
 * step, and the modes of the lowest frequencies determine the number of steps. On a few smooth fields Z
 * (coarse_space.h) the mass is therefore the stiffness itself: with the projection P onto motions that
 * satisfy the homogeneous conditions, and A made of the stiffness Z^T K Z (below equation (25)),
 *
 *   M^-1 = P (B + Z A^-1 Z^T) P
 *
 * with the orthogonal projection P onto motions that meet the homogeneous conditions: P f = f - G^T (G
 * G^T)^-1 G f with the rows G. With smoothed cells B = R L^T D^-1 L R^T, with the factor L of
 * inverse_stiffness.h, the rotations R of the nodes since rest, and D by how much the stiffness around each
 * node has changed since; otherwise B = D^-1. For linear systems this is a two-level additive preconditioner
 * with deflated constraints. Any positive definite A is admissible.
 */
#pragma once

#include "base/profile.h"
#include "base/state.h"
#include "solid/preconditioner/coarse_rows.h"
#include "solid/preconditioner/inverse_stiffness.h"
#include "solid/system/system.h"

struct preconditioner {
    int dim;
    int64_t node_count;
    double *stiffness;            /* node_count: that D was set from, N/m (2D: N/m2), */
    double *at_rest;              /* and with an inverse factor what it is at rest */
    double *rotation;             /* with an inverse factor, node_count * dim * dim: R of each node */
    double *mass;                 /* node_count: D, N/m (2D: N/m2); with an inverse factor a number */
    struct inverse_factor factor; /* node_count 0: none */
    double *vector, *force;       /* node_count * dim: scratch */
    struct constraint constraint; /* P, */
    struct sparse turns;          /* and those of the system, which it leaves out; the system's to free */
    struct coarse_space coarse;   /* count 0: none, M = B^-1 */
    int64_t size;                 /* coarse.count * dim: rows and columns of the coarse matrices */
    /* The stiffness along the coarse fields of body, springs and conditions, and the Cholesky factor of A,
     * to which the contact nodes that A counts in add; N/m (2D: N/m2). */
    struct profile profile; /* of blocks by groups */
    double *body, *stiffness_factor;
    double *weight; /* coarse.count: diagonal of Z^T D Z with D = `stiffness`, the same in each direction */
    bool has_rigid_mode; /* system->floats */
    int64_t contact_node_count;
    /* What A counts in at the contact nodes of all contacts: contact_node_count stiffnesses along the
     * surface's normals, dim times as many for these, and stiffnesses across, of friction (NULL: there is
     * none), N/m (2D: N/m2). */
    double *along, *normal, *across;
    struct coarse_rows rows; /* scratch */
    bool measured;           /* the stiffness is newer than its factor */
    bool uses_coarse;        /* it exists; else M = B^-1 */
    double *amount;          /* size: scratch */
    double *turned;          /* a number for each of `turns`: scratch */
};

/* Allocate; build the coarse fields and the inverse factor for a system. `coarse` false: neither, M = D. */
MUST_CHECK enum status preconditioner_build(struct solid_system *system, bool coarse,
                                            struct preconditioner *preconditioner, struct error *error);
void preconditioner_free(struct preconditioner *preconditioner);

/* Set D from system_relaxation_mass at the system's last evaluation. With coarse fields
 * preconditioner_measure comes next. */
void preconditioner_set_mass(struct preconditioner *preconditioner, const double *stiffness);

/* Take the stiffness along the coarse fields at u, where the body was evaluated last: of smoothed cells it is
 * assembled; else it is measured by differences, from size + 2 evaluations, whose number is added to
 * *evaluations. preconditioner_follow comes next. */
MUST_CHECK enum status preconditioner_measure(struct preconditioner *preconditioner,
                                              struct solid_system *system, const double *u,
                                              int64_t *evaluations, struct error *error);

/* Let A follow the stiffness that was measured, and the contacts' last evaluation where that changes their
 * stiffness or what is opposite: nodes that are pressed count in; of a body with free rigid-body modes all
 * do, as it may come to rest on any. */
void preconditioner_follow(struct preconditioner *preconditioner, const struct solid_system *system);

/* x := P x, in two passes: of nearly dependent rows one pass leaves 1e-6 of what it takes. Conditions do not
 * hold indifferent rotations. */
void preconditioner_project(struct preconditioner *preconditioner, double *x);

/* acceleration = M^-1 force. */
void preconditioner_apply(struct preconditioner *preconditioner, const double *force, double *acceleration);

/* row_force[rows of the conditions] = their forces, which balance a residual along them, N (2D: N/m).
 * scratch: node_count * dim. */
MUST_CHECK enum status preconditioner_row_forces(struct preconditioner *preconditioner,
                                                 const double *residual, double *scratch, double *row_force,
                                                 struct error *error);

/* x . D x with D = `stiffness` */
double preconditioner_square_diagonal(struct preconditioner *preconditioner, const double *x);

/* The state for checkpoints, see base/state.h. Afterwards, in a run that was restored,
 * preconditioner_factorise. */
MUST_CHECK enum status preconditioner_state(struct preconditioner *preconditioner, const struct state *state,
                                            struct error *error);

/* The Cholesky factor of A, of what body and contacts are. */
void preconditioner_factorise(struct preconditioner *preconditioner, const struct solid_system *system);
