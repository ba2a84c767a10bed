/* Frictionless contact of boundary averages with a rigid surface, finite sliding, by an augmented Lagrangian:
 * equations (19) and (20) of lib/README.md.
 *
 * The gap of contact node a is that of its averaged position x_a = sum_j Phi_aj (X_j + u_j). On a curved
 * boundary that position lies below the node, by an offset that is computed at rest and added along the
 * normal. The pressure is p_a = max(0, lambda_a - k g_a): a penalty k, made exact by the multiplier
 * lambda_a (augmented Lagrangian), and the force on the parameters is Phi_aj p_a A_a n: transferred by the
 * same averages that measure the gap, so that the total force on the body is sum_a p_a A_a n. There is no
 * projection, so that contact nodes do not chatter.
 *
 * The surface may move: gaps are evaluated in the frame in which it rests, and all that is kept of a contact
 * node from one evaluation to the next is kept in that frame.
 *
 * Contact begins where a node goes through the surface. One that comes round an open rim to the back, deeper
 * than half its own size, stays free until it is in front again. */
#ifndef SOLID_CONTACT_H
#define SOLID_CONTACT_H

#include "approx/boundary.h"
#include "base/state.h"
#include "solid/average.h"
#include "solid/rigid.h"
#include "solid/rigid_motion.h"

struct contact {
    int dim;
    int64_t count;
    const struct boundary_averages *averages; /* the caller's; must outlive the contact */
    struct rigid_surface surface;             /* owned; at rest */
    struct rigid_motion motion;               /* of the surface */
    struct rigid_place place;                 /* where the surface is: see contact_move */
    int32_t section;                          /* the caller's label */
    bool penalty_only;                        /* no multipliers: see contact_build_points */
    const struct contact *points;             /* of the same facets and surface; NULL: none */
    double stiffness;                         /* k, Pa/m, > 0 */
    double *rest;                             /* count * dim: x_a at u = 0, so raised, m */
    double *multiplier;                       /* count: lambda_a, Pa, >= 0 */
    double *gap;                              /* count: when last looked at, m; INFINITY beyond a rim */
    double *pressure;                         /* count: p_a, Pa */
    double *normal;                           /* count * dim: unit, on the body; 0 beyond a rim */
    bool *behind;                             /* count: came to the back without going through */
    /* A contact node is not looked at again before it has moved, in the surface's frame, as far as the
     * surface was away. */
    double *checked_x;        /* count * dim: position when it was last looked at, in that frame */
    double *checked_distance; /* count */
};

/* Takes over `surface` (also on failure: it becomes empty), which stays where it is unless the caller sets
 * contact->motion, whose factors must be 0 at the begin. X: nodes, m. STATUS_INPUT when a contact node starts
 * behind the surface, deeper than half its size or facing away from it: the surface's side is the wrong one.
 */
MUST_CHECK enum status contact_build(const struct boundary_averages *averages, const double *X, int dim,
                                     struct rigid_surface *surface, double stiffness, struct contact *contact,
                                     struct error *error);
/* The same for the values at the quadrature points of the facets, whose variation within an average the
 * averages do not constrain. Under a pressure of some ten shear moduli it grows; a penalty at the points
 * alone, with a multiple of the stiffness of the averages, keeps it small and vanishes where the contact of
 * the averages is met. The points are taken where they are, on the chords of a curved boundary, and there is
 * no wrong side. */
MUST_CHECK enum status contact_build_points(const struct boundary_averages *points, int dim,
                                            struct rigid_surface *surface, double stiffness,
                                            struct contact *contact, struct error *error);
void contact_free(struct contact *contact);

/* What a contact keeps from one evaluation to the next; `prefix` goes in front of the names. */
MUST_CHECK enum status contact_state(struct contact *contact, const char *prefix, const struct state *state,
                                     struct error *error);

/* Evaluate gaps and pressures at parameters u and add the contact forces on the body to
 * force[node_count * dim], N (2D: N/m). They act along the surface's smooth normals: - grad_u of
 * contact_energy on flat surfaces; on curved ones, but for the facets' turning from it by parts of their
 * angle, which cancels along each facet. */
void contact_force(struct contact *contact, const double *u, double *force);

/* Move the surface to its place at these values of the load curves; for the evaluations that follow. */
void contact_move(struct contact *contact, const double *factor);

/* The same without forces: gaps and pressures at parameters u. Only with `all` are gaps those of u also where
 * the surface is too far away for a pressure. */
void contact_measure(struct contact *contact, const double *u, bool all);

/* Augment: lambda_a = p_a of the last evaluation, unless there is the penalty only. Pressures that the
 * penalty alone makes of a penetration of no more than `allowed`, m, need no multiplier and get none. Returns
 * the largest penetration seen then, m. */
double contact_augment(struct contact *contact, double allowed);

/* Energy of the penalty at the last evaluation, sum A_a (p_a^2 - lambda_a^2) / (2 k), J (2D: J/m). */
double contact_energy(const struct contact *contact);

/* Total force on the body at the last evaluation, total[dim], N (2D: N/m). */
void contact_total(const struct contact *contact, double *total);

/* Moment on the body about point[dim] at the last evaluation, N m (2D: N): that of the forces on the
 * parameters where their nodes' parameters have moved to. In 2D moment[2] alone is not 0. */
void contact_moment(const struct contact *contact, const double *point, double moment[3]);

/* What the surface does on the body, by the pressures of the last evaluation, while it goes from its place at
 * one set of factors to that at another. */
struct contact_work {
    double work; /* sum p A n . w, w the way of the surface's point under each contact node, J (2D: J/m) */
    double unresolved; /* sum k A w^2 over the contact nodes that touch: what the penalty makes of the way,
                        * J (2D: J/m). A contact node that is first touched within a step has its work wrong
                        * by an eighth of that at the most */
};
struct contact_work contact_work(const struct contact *contact, const double *factor_from,
                                 const double *factor_to);

#endif
