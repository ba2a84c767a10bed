/* Facets of the deforming body against which points of a contact press, on another part of the boundary or on
 * the same one.
 *
 * Their corners are at X_a + sum_j Phi_aj u_j with the values of boundary_corners_build, so that the surface
 * is continuous, and follows the field by the boundary's own quadrature. The closest point of it to a contact
 * point is sought among the facets that are not turned away from it. It counts if the facets there face the
 * point: their normals are opposed, by more than a right angle, of facets of one body that do not press yet
 * by more than 120 degrees. The point is behind them by no more than it may be. Where the nearest facet does
 * not face the point, the sign of the distance to others says nothing, and the point is in front.
 *
 * Facets that face it through the body are excluded by the reference state: facets of the same body that were
 * near there, each behind the other. A facet that shares a corner with the point's own facet is always near,
 * whether the point has penetrated it or not. It counts only if the point came from its front. */
#pragma once

#include "approx/shape/boundary.h"
#include "solid/constraint/average.h"
#include "solid/rigid/rigid.h"

struct opposite {
    bool itself;                   /* the points are on the same facets */
    struct rigid_surface surface;  /* its vertices are the corners, where they are now */
    struct boundary_averages rows; /* values at the vertices */
    double *stiffness;             /* vertices: a bound of the penalty stiffness at each, Pa/m */
    double *rest;                  /* vertices * dim, m */
    double *rest_normal;           /* facets * dim */
    double *middle;                /* facets * dim: at rest, m */
    double *width;                 /* facets: at rest, m */
    int32_t *part;                 /* facets: the connected body of each; -1: not known */
    int64_t *across;               /* facets * dim: the slot (rigid_ridge_slot) beyond a ridge; -1: a rim */
    double *load;                  /* vertices * dim: scratch */
};

/* The facets of a set; part[table->node_count]: the body of each node, -1: not known. STATUS_INPUT when a
 * facet is no face of the table. */
MUST_CHECK enum status opposite_build(const struct face_table *table, const struct facet_set *set,
                                      const int32_t *part, bool itself, struct opposite *opposite,
                                      struct error *error);
void opposite_free(struct opposite *opposite);

/* Move the facets to parameters u. */
void opposite_move(struct opposite *opposite, const double *u);

/* A point of a facet, whose closest opposite facet is searched for. */
struct seeker {
    const double *x;           /* now, m */
    const double *rest;        /* m */
    const double *rest_normal; /* outward, of its facet */
    const double *normal;      /* outward, now */
    double width, depth;       /* width of its facet; how far it may be behind another one, m */
    int32_t part;              /* its body */
    const int32_t *corner;     /* dim: nodes of its facet */
    struct average average;    /* its displacement */
    const double *last_u;      /* parameters at the last step, m; NULL: it was behind a facet that faced it */
    double began;              /* how far behind a facet it was at rest, m */
};
/* The closest place of the opposite facets within reach. *free_way: relative motion of the point and the
 * facets that do not face it now, until one of them, within reach, may face it, m. */
struct rigid_contact opposite_closest(const struct opposite *opposite, const struct seeker *seeker,
                                      double reach, double *free_way);

/* Whether the points of a facet with this normal at rest press on facet f, and not the points of f on it:
 * where a boundary touches itself, each pair of facets must count once. */
bool opposite_leads(const struct opposite *opposite, const double *rest_normal, int64_t own_facet, int64_t f);
