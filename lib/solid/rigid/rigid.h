/* A rigid surface: line segments in 2D, triangles in 3D. The body lies on one side of it. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* A node of a tree of boxes: the box around some facets, divided between two branches; or a leaf. */
struct rigid_branch {
    double low[3], high[3]; /* m */
    int64_t first, end;     /* its facets: in_order[first] to before in_order[end] */
    int64_t second;         /* 0: a leaf; else the other branch, the first one being the next */
};

struct rigid_surface {
    int dim;
    int64_t vertex_count, facet_count;
    double extent;         /* diagonal of the box around it, m */
    double *vertex;        /* vertex_count * dim, m; coincident corners are one vertex */
    int32_t *facet;        /* facet_count * dim */
    double *normal;        /* facet_count * dim: unit normals, pointing to the body's side */
    double *vertex_normal; /* vertex_count * dim: angle-weighted mean, for the sign at vertices */
    double *edge_normal; /* 3D: facet_count * 3 * 3, mean of the facets at the edge from corner k to k + 1 */
    bool *is_rim;        /* vertex_count: 2D an end of a curve, 3D on an edge without neighbour */
    bool *edge_is_rim;   /* 3D: facet_count * 3, no neighbour */
    double *turn;        /* vertex_count: largest angle between a facet there and the mean normal, rad */
    struct rigid_branch *branch; /* branch_count: a tree of boxes, its root first */
    int64_t branch_count;
    int32_t *in_order; /* facet_count: the facets in the order of the branches */
};

/* Build from corner coordinates: corners[facet_count * dim * dim], m. The normal of a facet is (dy, -dx) in
 * 2D, to the right of its direction, and right-handed in 3D; `flip` reverses all normals. They must then
 * point to the body's side. Corners closer than 1e-9 of the surface's extent are one vertex. STATUS_INPUT for
 * no facets, degenerate or repeated facets, coordinates that are not finite, and two facets that meet but
 * disagree on the side. */
MUST_CHECK enum status rigid_build(int dim, int64_t facet_count, const double *corners, bool flip,
                                   struct rigid_surface *surface, struct error *error);
/* The same of facets facet[facet_count * dim] between nodes x. */
MUST_CHECK enum status rigid_of_facets(int dim, const double *x, int64_t facet_count, const int32_t *facet,
                                       struct rigid_surface *surface, struct error *error);
void rigid_free(struct rigid_surface *surface);

/* About its width, across its length and, in 3D, not the least: how far its vertices spread, m. */
double rigid_width(const struct rigid_surface *surface);

/* The closest point of the surface within `reach` (INFINITY: wherever it is). */
struct rigid_contact {
    bool found;       /* false: nothing within reach, or x lies beyond an open rim, where the surface ends */
    double distance;  /* how far x may move before contact can begin: the unsigned distance to the closest
                     point; beyond a rim, the lesser of the distances to the region above the facets there and
                     to their plane; `reach` if nothing is within */
    bool on_edge;     /* the closest point is on an edge or a vertex */
    double gap;       /* signed distance: positive on the body's side, m */
    double normal[3]; /* unit, the direction in which the gap grows */
    int64_t facet;    /* facet of the closest point, */
    double weight[3]; /* and barycentric coordinates of the point */
    /* Also beyond an open rim: */
    bool within;     /* something is within reach: */
    bool on_rim;     /* the closest point is on an open rim, */
    double point[3]; /* and there, m, */
    double side[3];  /* the normal of the facet, edge or vertex, unit */
};

/* A filter of facets. `considers` is called for facets that may be within reach, then `admits` for a facet f
 * whose closest point to x is x - away; NULL: any. */
struct rigid_filter {
    bool (*considers)(void *context, int64_t f);
    bool (*admits)(void *context, int64_t f, const double *away);
    void *context;
};

/* The pseudo-normal of the closest facet, edge or vertex gives the sign of the gap, at convex and concave
 * corners alike (Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 2005).
 *
 * Behind a crease that is concave on the body's side, the closest point and `normal` are continuous functions
 * of x; the gap there is minus the distance to a convex set. */
struct rigid_contact rigid_closest(const struct rigid_surface *surface, const double *x, double reach);

/* The same among the facets that the filter admits. */
struct rigid_contact rigid_closest_among(const struct rigid_surface *surface, const double *x, double reach,
                                         const struct rigid_filter *filter);

/* Whether x lies behind the surface, not on the side that the normals point to. For a closed surface by its
 * winding number about x, which edges of four facets, and facets that pass through each other, do not deceive
 * (Jacobson, Kavan and Sorkine-Hornung, ACM Trans. Graph. 32 (2013), 33); else by the closest point. */
bool rigid_is_behind(const struct rigid_surface *surface, const double *x);
