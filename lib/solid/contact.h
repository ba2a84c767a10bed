/* Frictionless contact of a boundary with a rigid surface, finite sliding, by an augmented Lagrangian:
 * equations (19) and (20) of lib/README.md.
 *
 * Contact points are quadrature points of the facets. Point p is at x_p = sum_j Phi_pj (X_j + u_j). It must
 * stay in the set C of places in front of the surface. The multiplier is a vector, the traction that the
 * surface holds against the point, and the energy is the Moreau envelope of this condition (Moreau 1965;
 * Rockafellar and Wets 1998, 11.57): with the penalty k_p and the closest place P(y) of C,
 *
 *     held_p = sum_a N_a(p) lambda_a,   y_p = x_p - held_p / k_p,   t_p = k_p (P(y_p) - y_p),
 *
 * with multipliers lambda_a at the boundary nodes and the hat functions N_a of the facets, as in mortar
 * methods. The force on the parameters is Phi_pj A_p t_p, minus the gradient of contact_energy. Where the
 * surface is flat about the point, of normal n and gap g_p, that is the usual
 *
 *     t_p = max(0, held_p . n - k_p g_p) n.
 *
 * In a crease that is concave as the body sees it, C is convex: P is unique, t_p is a continuous function of
 * x_p, and points between the normals of all facets there, as what balances a node that lies in the crease
 * must. On a ridge the nearest facet alone counts.
 *
 * What is pressed on is linear in the gap from both sides, so that only points at the end of a patch open and
 * close. The gap of a node is the mean of those of the points beneath its hat function; multipliers make it
 * vanish where they press. Without hat functions each point has a multiplier of its own; such points may be
 * boundary averages.
 *
 * Contact begins where a point goes through the surface. One that comes round an open rim to the back, deeper
 * than half its own width, stays free until it is in front again.
 *
 * An evaluation changes no state: the same parameters give the same forces, whatever was evaluated between.
 * Two functions change it, contact_accept at a step that is taken and contact_augment. The surface may move:
 * places and multipliers are kept in the frame in which it rests. */
#ifndef SOLID_CONTACT_H
#define SOLID_CONTACT_H

#include "approx/boundary.h"
#include "base/state.h"
#include "solid/average.h"
#include "solid/rigid.h"
#include "solid/rigid_motion.h"

/* What an evaluation sees of a point. */
struct contact_view {
    double x[3];      /* where it is, in the surface's frame, m */
    double sought[3]; /* y_p, whose closest place is looked for, in the surface's frame, m */
    bool looked;      /* the surface was looked for; else it is too far away for a pressure, and these are: */
    bool behind;      /* as in the state */
    bool turned;      /* pressed by an edge or a vertex, or by another facet than at the last step */
    double distance;  /* as checked_distance */
    double normal[3]; /* as checked_normal */
};

struct contact {
    int dim;
    int64_t count;                          /* points */
    const struct boundary_averages *points; /* the caller's, as the hats; must outlive the contact */
    const struct boundary_averages *hats;   /* of the nodes, whose samples the points are; NULL: none */
    struct rigid_surface surface;           /* owned; at rest */
    struct rigid_motion motion;             /* of the surface */
    struct rigid_place place;               /* where the surface is: see contact_move */
    int32_t section;                        /* the caller's label */
    double *stiffness;                      /* count: k_p, Pa/m, > 0 */
    double *rest;                           /* count * dim: x_p at u = 0, so raised, m */
    /* The state, all that a checkpoint holds. A point is not looked at again before it has moved from
     * checked_x as far as the surface was away. */
    double *multiplier;       /* lambda_a * dim, Pa, in the surface's frame: of the nodes, or count */
    bool *behind;             /* count: came to the back without going through */
    double *checked_x;        /* count * dim: where y_p was when it was last looked for, m */
    double *checked_distance; /* count: how far the surface was away then, m; negative: how deep it was */
    double *checked_normal;   /* count * dim: of the surface there, in its frame */
    double *held;             /* count * dim: sum_a N_a(p) lambda_a, Pa; follows from the multipliers */
    /* Of the last evaluation. */
    double *gap; /* count: of x_p along the normal, m; INFINITY beyond a rim; where the surface is too far
                    away, that of y_p when last looked for */
    double *pressure;          /* count: |t_p|, Pa */
    double *normal;            /* count * dim: unit, of t_p; 0 where the surface was never looked for */
    struct contact_view *view; /* count */
};

/* Takes over `surface` (also on failure: it becomes empty), which stays where it is unless the caller sets
 * contact->motion, whose factors must be 0 at the begin. X: nodes, m. The facets are chords of a curved
 * boundary: the points are raised to where that is, by the normals at the nodes. STATUS_INPUT when a point
 * starts behind the surface, deeper than half its width, or behind or on it and facing away from it: the
 * surface's side is the wrong one. */
MUST_CHECK enum status contact_build(const struct boundary_averages *points,
                                     const struct boundary_averages *hats, const double *X, int dim,
                                     struct rigid_surface *surface, double stiffness, struct contact *contact,
                                     struct error *error);
void contact_free(struct contact *contact);

/* k_p = modulus / width of the facets there: that of a layer of cells. */
void contact_set_stiffness(struct contact *contact, double modulus);

/* The state of a contact; `prefix` goes in front of the names. */
MUST_CHECK enum status contact_state(struct contact *contact, const char *prefix, const struct state *state,
                                     struct error *error);

/* Evaluate gaps and pressures at parameters u and add the contact forces on the body, - grad_u of
 * contact_energy, to force[node_count * dim], N (2D: N/m). */
void contact_force(struct contact *contact, const double *u, double *force);

/* Move the surface to its place at these values of the load curves; for the evaluations that follow. */
void contact_move(struct contact *contact, const double *factor);

/* The same without forces: gaps and pressures at parameters u. With `all` the surface is looked for also
 * where it is too far away for a pressure. */
void contact_measure(struct contact *contact, const double *u, bool all);

/* The step whose state was evaluated last is taken: points are where they were seen then. */
void contact_accept(struct contact *contact);

/* Augment by the last evaluation: a step up the gradient of the augmented Lagrangian, which is concave in the
 * multipliers, as long as the penalties allow without an overshoot:
 *
 *     lambda_a <- lambda_a + sum_p N_a A_p (t_p - held_p) / k_p / sum_p N_a A_p / k_p,
 *
 * or 0 where that would pull, against the mean normal. On a flat, where all points beneath the hat function
 * press, that is lambda_a - k g_a n, g_a being their mean gap. */
void contact_augment(struct contact *contact);

/* The tractions held at the points, from the multipliers. */
void contact_spread_multipliers(struct contact *contact);

/* What contact nodes penetrate, or are kept away from the surface, at the last evaluation: the largest change
 * that an augmentation would make of a multiplier, as the way that the penalty gives for it, m. */
double contact_miss(const struct contact *contact);

/* The boundary nodes of a contact, or its points where it has no hats; and what the last evaluation says of
 * one: means over its hat function. */
const struct boundary_averages *contact_nodes(const struct contact *contact);
struct contact_node {
    double gap;       /* m, of the points that have one; INFINITY: none has */
    double pressure;  /* Pa */
    double pressed;   /* part of the hat function above points that press, 0 to 1 */
    double stiffness; /* Pa/m, of the penalty */
    bool turned;      /* as contact_view, of one of the points */
    double normal[3]; /* unit; 0 where the surface was never looked for */
};
struct contact_node contact_node(const struct contact *contact, int64_t a);

/* Energy of the penalty at the last evaluation, sum A_p (|t_p|^2 - |held_p|^2) / (2 k_p), J (2D: J/m). */
double contact_energy(const struct contact *contact);

/* Total force on the body at the last evaluation, total[dim], N (2D: N/m). */
void contact_total(const struct contact *contact, double *total);

/* Moment on the body about point[dim] at the last evaluation, N m (2D: N): that of the forces on the
 * parameters where their nodes' parameters have moved to. In 2D moment[2] alone is not 0. */
void contact_moment(const struct contact *contact, const double *point, double moment[3]);

/* What the surface does on the body, by the pressures of the last evaluation, while it goes from its place at
 * one set of factors to that at another. */
struct contact_work {
    double work;       /* sum p A n . w, w the way of the surface under each point, J (2D: J/m) */
    double unresolved; /* sum k_p A w^2 over the points that touch: what the penalty makes of the way,
                        * J (2D: J/m). A point that is first touched within a step has its work wrong
                        * by an eighth of that at the most */
};
struct contact_work contact_work(const struct contact *contact, const double *factor_from,
                                 const double *factor_to);

#endif
