/* What a contact has in place of a rigid surface when its points press on facets of the body itself
 * (opposite.h): two bodies, two lips, or a boundary that touches itself.
 *
 * With the place q of the opposite facets that is closest to y_p = x_p - held_p / k_p, in front or a little
 * behind, the weights M_b of their corners there, and its normal n and gap g_p,
 *
 *     t_p = max(0, - k_p g_p) n
 *
 * acts on the point, and - t_p on the corners by M_b: minus the gradient of the energy (contact.h), so
 * without a resultant. The line of t_p goes through y_p and q, and has a moment as far as held_p is not along
 * n. In a crease of the opposite facets t_p does not jump where the closest facet changes. Points are not
 * raised from chords of a curved boundary. Those that start behind a facet, as such chords may, count their
 * gap from there.
 *
 * Of a boundary against itself, one of two places that face each other has the points that press
 * (opposite_leads), so that nothing is held twice. The augmentation leaves out points that are led. */
#pragma once

#include "solid/contact/contact.h"
#include "solid/contact/opposite.h"

struct between_view {
    int64_t facet;    /* opposite the point, -1: none, or not looked for */
    double weight[3]; /* of its corners */
    double free_way;  /* as checked_free */
    bool led;         /* the facet's points press on the point, not the point on it */
};

struct contact_between {
    struct opposite opposite;
    int per_facet;   /* points of each facet, facet by facet */
    int sign;        /* forces that count are those on the points, 1; on the opposite facets, -1; both, 0 */
    int64_t values;  /* of u */
    double leverage; /* how far a point and an opposite place move against each other, at the most, by what a
                        parameter moves */
    int32_t *part;   /* points: the body of each */
    double *begin;   /* points: the gap at rest where it is negative, else 0, m */
    /* The state. */
    double *before;       /* values: u of the last step that was taken, m */
    double way;           /* sum over all steps of how far a point and a place may have moved, m */
    double *checked_way;  /* points: at the last search, */
    double *checked_free; /* and how far things may move then before other facets face the point, m */
    int64_t *taken_facet; /* points: the places of contact_between_take, facet + 1, 0: none, */
    double *taken_weight; /* points * 3: and weights of the corners */
    /* Of the last evaluation. */
    double *now;               /* values: u */
    double moved;              /* to be added to way, m */
    struct between_view *view; /* points */
};

/* As contact_build. Takes over `opposite`, which becomes empty, also on failure. The points are `per_facet`
 * on each facet, placed as its corners are; part[node_count]: the body of each node; sign: as above. *any
 * receives whether at rest some facet faces some point; `far`: also one that is too far away to touch soon.
 */
MUST_CHECK enum status contact_between_build(const struct boundary_averages *points,
                                             const struct boundary_averages *averages, int dim,
                                             int64_t node_count, int per_facet, struct opposite *opposite,
                                             const int32_t *part, int sign, double stiffness, bool far,
                                             struct contact *contact, bool *any, struct error *error);

/* The parts of functions of contact.h; they do nothing where there is a rigid surface. */
void contact_between_free(struct contact *contact);
MUST_CHECK enum status contact_between_state(struct contact *contact, const char *prefix,
                                             const struct state *state, struct error *error);
void contact_between_stiffen(struct contact *contact, double modulus);
void contact_between_measure(struct contact *contact, const double *u, bool all);
void contact_between_accept(struct contact *contact);
void contact_between_react(struct contact *contact, double *force);
double contact_between_sign(const struct contact *contact);
bool contact_between_led(const struct contact *contact, int64_t p);

/* Take the places opposite the points at the last evaluation as those that contact_between_part gives. */
void contact_between_take(struct contact *contact);

/* The gap of contact node a grows with the mean of the field there less parts of the field at opposite
 * corners: part i of them, the corner's row of opposite.rows, and its weight; false behind the last one. */
bool contact_between_part(const struct contact *contact, int64_t a, int64_t i, int64_t *corner,
                          double *weight);

/* How many corners there may be opposite the points; 0 where there is a rigid surface. And the average that
 * moves one. */
int64_t contact_between_corners(const struct contact *contact);
struct average contact_between_corner(const struct contact *contact, int64_t corner);

/* Mark the nodes of facets that were opposite a point at the last evaluation, nearer than that share of its
 * width; and as turned those of both facets where these did not face each other at rest. */
void contact_between_mark(const struct contact *contact, double share, bool *marked, bool *turned);

/* What the penalties of a contact may add stiffness to, whatever touches: averages, and how much, N/m (2D:
 * N/m2). The points; and corners of opposite facets. */
int64_t contact_bond_count(const struct contact *contact);
struct average contact_bond(const struct contact *contact, int64_t b, double *stiffness);

/* mass[node_count] += a bound of the diagonal of what the contact adds to the stiffness; between facets of
 * the body, of the points that are near some. */
void contact_add_to_bound(const struct contact *contact, double *mass);
