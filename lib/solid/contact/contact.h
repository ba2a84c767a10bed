/* Contact of a boundary with a rigid surface, or with another part of the boundary (contact_between.h),
 * finite sliding, by an augmented Lagrangian: equations (19) and (20) of lib/README.md. Friction: friction.h.
 *
 * Contact points are quadrature points of the facets, with multipliers lambda_a at the boundary nodes;
 * without nodal averages each point has a multiplier of its own, and may itself be a boundary average. With
 * the penalty k_p and P(y), the position in front of the surface that is closest to y,
 *
 *     lambda_p = sum_a N_a(p) lambda_a,   y_p = x_p - lambda_p / k_p,   t_p = k_p (P(y_p) - y_p).
 *
 * The force on the parameters, Phi_pj A_p t_p, is minus the gradient of contact_energy. The gap of a node is
 * the mean gap of the points in the support of its hat function, weighted by it. Augmentations make it vanish
 * at nodes in contact.
 *
 * Contact begins where a point goes through the surface. A point that passes an open rim and is then behind
 * the surface by more than half its own width stays free until it is in front again.
 *
 * An evaluation changes no state: the same parameters give the same forces, whatever was evaluated between.
 * Two functions change it, contact_accept at a step that is taken and contact_augment. The surface may move:
 * positions and multipliers are kept in the frame in which it rests. */
#pragma once

#include "approx/shape/boundary.h"
#include "base/state.h"
#include "solid/constraint/average.h"
#include "solid/rigid/rigid.h"
#include "solid/rigid/rigid_motion.h"

/* A point in the last evaluation. */
struct contact_view {
    double x[3];      /* x_p in the surface's frame, m */
    double sought[3]; /* y_p in the surface's frame, m: its closest point is searched for */
    bool searched;    /* false: the surface is too far away for a pressure; else by the search: */
    bool behind;      /* as in the state */
    bool turned;      /* pressed by an edge or a vertex, or by another facet of a rigid surface than at the
                       * last step */
    double distance;  /* as checked_distance */
    double normal[3]; /* as checked_normal */
    /* Between facets of the body: */
    int64_t facet;    /* opposite the point; -1: none, or not searched for */
    double weight[3]; /* of its corners */
    double free_way;  /* as checked_free */
    bool led;         /* the facet's points press on the point, not the point on it */
};

struct contact_between;
struct contact_friction;

struct contact {
    int dim;
    int64_t count;                            /* points */
    const struct boundary_averages *points;   /* the caller's, as the averages; must outlive the contact */
    const struct boundary_averages *averages; /* at the nodes; their samples are the points; NULL: none */
    struct rigid_surface surface;             /* owned; at rest */
    struct contact_between *between;          /* owned: facets of the body instead of the surface; or NULL */
    struct contact_friction *friction;        /* owned; NULL: none */
    struct rigid_motion motion;               /* of the surface */
    struct rigid_place place;                 /* placement of the surface: see contact_move */
    int32_t section;                          /* the caller's label */
    int sign; /* of the total force: 1 that on the points, -1 that on the opposite facets, 0 their sum */
    double *stiffness; /* count: k_p, Pa/m, > 0 */
    double modulus;    /* k_p by the width there at first, Pa; 0: k_p is stated */
    double *rest;      /* count * dim: x_p at u = 0, so raised, m */
    /* The state, all that a checkpoint holds. The search is repeated for a point only when it may have moved
     * from checked_x by the surface's distance there. */
    double *multiplier;       /* dim for each contact node: lambda_a, Pa, in the surface's frame */
    double deepest;           /* largest t_p / k_p at accepted steps, m; 0: no point has pressed */
    bool *behind;             /* count: reached the back of the surface without going through it */
    double *checked_x;        /* count * dim: y_p at the last search, m */
    double *checked_distance; /* count: distance of the surface then, m; negative: minus the penetration */
    double *checked_normal;   /* count * dim: of the surface there, in its frame */
    double *before;           /* count * dim: y_p at the last step, m; whether searched or not */
    double *held;             /* count * dim: sum_a N_a(p) lambda_a, Pa; follows from the multipliers */
    /* Of the last evaluation. */
    double *gap; /* count: of x_p along the normal, m; INFINITY beyond a rim; where the surface is too far
                    away, that of y_p at the last search */
    double *pressure;          /* count: |t_p|, Pa */
    double *normal;            /* count * dim: unit, of t_p; 0 where it was never searched for */
    struct contact_view *view; /* count */
};

/* Takes over `surface`, which becomes empty, also on failure. It is at rest unless the caller sets
 * contact->motion, whose factors must be 0 at the start. X: nodes, m. The facets are chords of a curved
 * boundary: the points are raised to it by the normals at the nodes. `averages`: of the same facets, or NULL.
 * STATUS_INPUT when a point starts behind the surface by more than half its width, or behind or on it and
 * facing away from it: the surface's side is the wrong one. */
MUST_CHECK enum status contact_build(const struct boundary_averages *points,
                                     const struct boundary_averages *averages, const double *X, int dim,
                                     struct rigid_surface *surface, double stiffness, struct contact *contact,
                                     struct error *error);
void contact_free(struct contact *contact);

/* Steps shared with contact_between.c: allocate the arrays of a contact whose dim, count, points and averages
 * are set; place point p at parameters u, and let it have the gap of its last search and no pressure; and set
 * the pressure, unless it does not press, and the gap of x_p, by that of y_p. */
MUST_CHECK enum status contact_allocate(struct contact *contact, double stiffness, struct error *error);
void contact_place_point(struct contact *contact, int64_t p, const double *u);
void contact_keep_point(struct contact *contact, int64_t p);
void contact_press_point(struct contact *contact, int64_t p, double gap, bool presses);

/* The width of the facets at point p, m; and the largest depth, by that, at which a point that is found
 * behind the surface counts as having gone through it. */
#define CONTACT_MOST_DEPTH 0.5
double contact_width(const struct contact *contact, int64_t p);
double contact_most_depth(const struct contact *contact, int64_t p);

/* Between facets of the body: how far a step of the parameters moves a point past what was opposite it at the
 * last evaluation, or may, where nothing was, by the larger of its width and the mean width: the largest. 0
 * with a rigid surface. */
double contact_passes(const struct contact *contact, const double *step);

/* Whether a point has gone through the rigid surface, at the last evaluation. */
bool contact_is_through(const struct contact *contact);

/* Depths of point p below this count as zero, m. */
double contact_round_off(const struct contact *contact, int64_t p);

/* Whether a force acts on point p at the last evaluation, pressure and friction; and the force, N (2D: N/m).
 */
bool contact_acts(const struct contact *contact, int64_t p);
void contact_point_force(const struct contact *contact, int64_t p, double force[3]);

/* k_p = modulus / width of the facets there: the stiffness of a layer of cells. */
void contact_set_stiffness(struct contact *contact, double modulus);

/* Set the penalty of points by the multipliers p there, as they are now, whatever they were before: a
 * boundary of shear modulus `shear` mu (Pa) under p, which acts at a distance of p / k, buckles between its
 * nodes where k times their distance is about p^2 / mu. Returns whether any has changed. */
bool contact_stiffen(struct contact *contact, double shear);

/* Visit the state of a contact; the names begin with `prefix`. */
MUST_CHECK enum status contact_state(struct contact *contact, const char *prefix, const struct state *state,
                                     struct error *error);

/* Evaluate gaps and pressures at parameters u and add the contact forces on the body, - grad_u of
 * contact_energy, to force[node_count * dim], N (2D: N/m). */
void contact_force(struct contact *contact, const double *u, double *force);

/* Place the surface as at these values of the load curves, for the evaluations that follow. */
void contact_move(struct contact *contact, const double *factor);

/* The same without forces: gaps and pressures at parameters u. With `all` the surface is searched for also
 * where it is too far away for a pressure. */
void contact_measure(struct contact *contact, const double *u, bool all);

/* Accept the step that was evaluated last: the searches of that evaluation become the state. */
void contact_accept(struct contact *contact);

/* Augment by the last evaluation, equation (20). */
void contact_augment(struct contact *contact);

/* lambda_p at the points, from the multipliers. */
void contact_spread_multipliers(struct contact *contact);

/* Penetration or opening of contact nodes that the multipliers do not yet hold, at the last evaluation, m:
 * the largest change of a multiplier in an augmentation, divided by the penalty stiffness. */
double contact_miss(const struct contact *contact);

/* Work of the contact tractions along the penetration that remains, equation (20c), J (2D: J/m): to first
 * order the error of the energy. */
double contact_missing_work(const struct contact *contact);

/* The contact nodes: those of the nodal averages, or the points if there are none. A contact_node holds the
 * last evaluation: means over the points, weighted by the node's hat function. */
const struct boundary_averages *contact_nodes(const struct contact *contact);

/* Sample i of contact node a: a point, and its weight in the node's means; false behind the last one. */
bool contact_sample(const struct contact *contact, int64_t a, int64_t i, int64_t *p, double *share);
struct contact_node {
    double gap;         /* m, over the points that have one; INFINITY: none has */
    double pressure;    /* Pa */
    double pressed;     /* weight of the points that press, 0 to 1 */
    double stiffness;   /* of the penalty, Pa/m */
    bool turned;        /* as contact_view, for any of the points */
    double normal[3];   /* unit; 0 where the surface was never searched for */
    double friction[3]; /* traction on the body, Pa */
    double sticks;      /* weight of the points that friction holds, 0 to 1; */
    double slips;       /* of those that slipped in the last increment */
};
struct contact_node contact_node(const struct contact *contact, int64_t a);

/* Energy of the penalty at the last evaluation, sum A_p (|t_p|^2 - |lambda_p|^2) / (2 k_p), and of friction,
 * J (2D: J/m). */
double contact_energy(const struct contact *contact);

/* total[dim] = total force on the body at the last evaluation, N (2D: N/m). Between facets of the body it is
 * that on the points, on the opposite facets, or 0: `sign`. */
void contact_total(const struct contact *contact, double *total);

/* moment[3] = moment of this force about point[dim], N m (2D: N, and only moment[2] is not 0). The forces on
 * parameters act at X_j + u_j. */
void contact_moment(const struct contact *contact, const double *point, double moment[3]);

/* Work of the moving surface on the body, with the pressures of the last evaluation, between two placements
 * given by factors of the load curves. */
struct contact_work {
    double work;       /* sum p A n . w, w the displacement of the surface under each point, J (2D: J/m) */
    double unresolved; /* sum k_p A w^2 over the points that press, J (2D: J/m). The error of the work of a
                          point that is first touched within a step is at most an eighth of its term */
};
struct contact_work contact_work(const struct contact *contact, const double *factor_from,
                                 const double *factor_to);
