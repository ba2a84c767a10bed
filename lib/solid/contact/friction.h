/* Coulomb's law at the points of a contact, equation (20d) of lib/README.md.
 *
 * The traction across the normal is that of a spring from the point to its anchor, a place that the opposite
 * surface carries along, up to the yield: the coefficient times the pressure. Beyond it the point slips, and
 * the anchor follows when an increment is accepted (friction_slide). At rest, normals, yields and the
 * opposite place are constant between two accepted steps, so that the traction is minus the gradient of a
 * convex energy. */
#pragma once

#include "solid/contact/contact.h"

struct contact_friction {
    double coefficient;
    bool follows;      /* dynamics: yields and normals are those of each evaluation */
    double *stiffness; /* count: of the spring, Pa/m */
                       /* The state. */
    double *yield;     /* count: the largest traction, Pa: that by the pressure at the last accepted step, */
    double *lag;       /* count: and how much more that is than in the model of the step, Pa; */
    double share;      /* the part of it that the next model takes, see friction_relax; */
    bool lags;         /* both are known in this increment */
    double
        *anchor; /* count * dim: its place in the frame of a rigid surface, m, from which only the part across
                    the normal counts; or the weights of the corners of a facet, which may be negative */
    int64_t *facet; /* count: opposite facet that carries the anchor, + 1; 0: none; NULL: a rigid surface */
    int64_t *place_facet; /* count: opposite facet at the last accepted step, + 1; 0: none; NULL */
    double *place_weight; /* count * dim: weights of its corners, */
    double *ahead;        /* count * dim: and from that place to the anchor then, m */
    bool *slips;          /* count: it slipped in the last increment, */
    double *before;       /* count * dim: after which slip was this, m */
    double dissipated;    /* since the start, J (2D: J/m) */
    bool sticks;          /* no point that presses slips: friction_hold */
                          /* Until a step is accepted while that is false, and otherwise 0: */
    double *passed;       /* count * dim: the slip that a prediction does not take back, m */
                          /* Of the last evaluation. */
    double *slip;         /* count * dim: from the anchor across the normal, m, in the surface's frame */
};

/* Give a contact, whose stiffness is set, friction; stiffer: the stiffness of the springs, by that. */
MUST_CHECK enum status friction_build(struct contact *contact, double coefficient, double stiffer,
                                      bool follows, struct error *error);

/* The functions below do nothing for a contact without friction. */
void friction_free(struct contact *contact);
MUST_CHECK enum status friction_state(struct contact *contact, const char *prefix, const struct state *state,
                                      struct error *error);

/* Whether there can be a traction at point p; and that of the last evaluation on the body, Pa. */
bool friction_acts(const struct contact *contact, int64_t p);
void friction_traction(const struct contact *contact, int64_t p, double traction[3]);

/* Called by contact_measure and contact_accept, at the end. */
void friction_measure(struct contact *contact);
void friction_accept(struct contact *contact);

/* Energy at the last evaluation, of springs and, since the last increment, of slip, J (2D: J/m). */
double friction_energy(const struct contact *contact);

/* load[opposite vertices * dim] -= what acts on the corners opposite to points, N (2D: N/m). */
void friction_load(const struct contact *contact, double *load);

/* Accept the last evaluation as the end of an increment: points that slip take their anchors along. */
void friction_slide(struct contact *contact);

/* Until a step is accepted, points hold where they are, up to twice their yield, and those that touch without
 * pressing do not slip; with `sticks` none that touches does: a body that only friction holds would otherwise
 * be free while its pressures grow. */
void friction_predict(struct contact *contact, bool sticks);

/* Before a step from the last accepted one: yields of its model and those by its pressures, mixed. */
void friction_relax(struct contact *contact);

/* Let no point that presses or touches slip, in any step from the last evaluation on; or let them again. */
void friction_hold(struct contact *contact, bool sticks);

/* Whether friction holds point p, at the last evaluation. */
bool friction_sticks(const struct contact *contact, int64_t p);
