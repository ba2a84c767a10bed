/* Contact of points with facets of the body itself (opposite.h) in place of a rigid surface: two bodies, two
 * faces of a slit, or a boundary that touches itself. Equation (20a) of lib/README.md.
 *
 * Let q be the place of the opposite facets closest to y_p = x_p - lambda_p / k_p, M_b the weights of the
 * corners there, n the normal and g_p the gap of y_p. The traction
 *
 *     t_p = max(0, - k_p g_p) n
 *
 * acts on the point, and - M_b t_p on the corners. These are minus the gradient of the energy (contact.h), so
 * their sum is zero. They have a moment where lambda_p is not along n, since the line of t_p goes through y_p
 * and q. In a crease of the opposite facets t_p does not jump where the closest facet changes. Where two
 * curved boundaries face each other, gaps are those of the boundaries, not of their chords
 * (contact_rest.h). A point that starts behind a facet has its gap measured from there.
 *
 * Where a boundary touches itself, only one of two facets that face each other has points that press
 * (opposite_leads); the points of the other are led. Augmentations leave out points that are led. */
#pragma once

#include "solid/contact/contact.h"
#include "solid/contact/opposite.h"

struct contact_between {
    struct opposite opposite;
    int per_facet;     /* points of each facet, facet by facet */
    int64_t values;    /* length of u */
    double leverage;   /* largest relative motion of a point and an opposite place, by the largest motion of a
                          parameter */
    double mean_width; /* of the facets that have points, m */
    int32_t *part;     /* points: the body of each */
    double *begin;     /* points: the gap of the facets where that of the boundaries is 0, m; less where it is
                          less at rest */
                       /* The state. */
    double *before;    /* values: u of the last accepted step, m */
    double way;        /* sum over all steps of the bounds of the relative motion, m */
    double *checked_way;  /* points: `way` at the last search, m */
    double *checked_free; /* points: relative motion from there until other facets may face the point, m */
    int64_t *taken_facet; /* points: facet of contact_between_take + 1; 0: none */
    double *taken_weight; /* points * 3: weights of its corners */
    /* Of the last evaluation. */
    double *now;  /* values: u */
    double moved; /* to be added to way, m */
};

/* As contact_build. Takes over `opposite`, which becomes empty, also on failure. The points are `per_facet`
 * on each facet, placed as its corners are; part[node_count]: the body of each node; sign: as above.
 * own[points] and other[points of the opposite facets]: heights of the boundaries above the facets
 * (contact_rest_heights), m; NULL: none. *any receives whether at rest some facet faces some point; `far`:
 * also one that is too far away to touch soon. */
MUST_CHECK enum status contact_between_build(const struct boundary_averages *points,
                                             const struct boundary_averages *averages, int dim,
                                             int64_t node_count, int per_facet, struct opposite *opposite,
                                             const int32_t *part, int sign, double stiffness,
                                             const double *own, const double *other, bool far,
                                             struct contact *contact, bool *any, struct error *error);

/* Called by the functions of contact.h; these do nothing if there is a rigid surface. */
void contact_between_free(struct contact *contact);
MUST_CHECK enum status contact_between_state(struct contact *contact, const char *prefix,
                                             const struct state *state, struct error *error);
void contact_between_stiffen(struct contact *contact, double modulus);
void contact_between_measure(struct contact *contact, const double *u, bool all);
void contact_between_accept(struct contact *contact);
void contact_between_react(struct contact *contact, double *force);

/* Let contact_between_part refer to the places opposite the points at the last evaluation; and whether these
 * lie on other facets than those it refers to. */
void contact_between_take(struct contact *contact);
bool contact_between_moves(const struct contact *contact);

/* The gap of contact node a varies with the mean of the field there minus a weighted sum of the field at
 * opposite corners. Gives the average that moves corner i of these, and its weight, which may be 0; false
 * behind the last one. */
bool contact_between_part(const struct contact *contact, int64_t a, int64_t i, struct average *average,
                          double *weight);

/* mass[node_count] += a bound of the diagonal of the contact's stiffness, N/m (2D: N/m2): whatever touches;
 * or not `all`, between facets of the body, of points near an opposite facet. */
void contact_add_to_bound(const struct contact *contact, bool all, double *mass);
