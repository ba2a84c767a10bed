/* The closest point of a rigid surface, by its tree of boxes; see rigid.h. */
#include "base/round_off.h"
#include "solid/rigid/rigid_private.h"

#include <math.h>
#include <string.h>

/* Where on a facet the closest point lies; edge k goes from corner k to corner k + 1. */
enum feature { ON_FACE, ON_CORNER_0, ON_CORNER_1, ON_CORNER_2, ON_EDGE_0, ON_EDGE_1, ON_EDGE_2 };

enum { MOST_DEPTH = 64 }; /* of the tree: INT32_MAX facets are halved 31 times */

struct nearest {
    int64_t facet;    /* -1: none yet */
    double distance2; /* INFINITY: none yet */
    double point[3], weight[3];
    enum feature feature;
    bool rim;
};

static const double *corner_of(const struct rigid_surface *surface, int64_t f, int k)
{
    return surface->vertex + (int64_t)surface->facet[f * surface->dim + k] * surface->dim;
}

static enum feature corner_feature(int k, double weight[3])
{
    weight[k] = 1.0;
    return (enum feature)(ON_CORNER_0 + k);
}

/* On the edge from corner k to the next, at part s of the way. */
static enum feature edge_feature(int k, double s, double weight[3])
{
    weight[k] = 1.0 - s;
    weight[(k + 1) % 3] = s;
    return (enum feature)(ON_EDGE_0 + k);
}

/* weight[3], zeros: becomes the barycentric coordinates of the closest point. */
static enum feature closest_on_segment(const double *a, const double *b, const double *x, double weight[3])
{
    double ab[2], ax[2];
    vector_subtract(2, b, a, ab);
    vector_subtract(2, x, a, ax);
    double s = vector_dot(2, ab, ax) / vector_dot(2, ab, ab);
    if (s <= 0.0) {
        return corner_feature(0, weight);
    }
    if (s >= 1.0) {
        return corner_feature(1, weight);
    }
    weight[0] = 1.0 - s;
    weight[1] = s;
    return ON_FACE;
}

/* Ericson, Real-Time Collision Detection (2005), 5.1.5: by the Voronoi regions of corners, edges, face. */
static enum feature closest_on_triangle(const double *a, const double *b, const double *c, const double *x,
                                        double weight[3])
{
    double ab[3], ac[3], ax[3], bx[3], cx[3];
    vector_subtract(3, b, a, ab);
    vector_subtract(3, c, a, ac);
    vector_subtract(3, x, a, ax);
    vector_subtract(3, x, b, bx);
    vector_subtract(3, x, c, cx);
    double d1 = vector_dot(3, ab, ax), d2 = vector_dot(3, ac, ax), d3 = vector_dot(3, ab, bx),
           d4 = vector_dot(3, ac, bx), d5 = vector_dot(3, ab, cx), d6 = vector_dot(3, ac, cx);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (d1 <= 0.0 && d2 <= 0.0) {
        return corner_feature(0, weight);
    }
    if (d3 >= 0.0 && d4 <= d3) {
        return corner_feature(1, weight);
    }
    if (d6 >= 0.0 && d5 <= d6) {
        return corner_feature(2, weight);
    }
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        return edge_feature(0, d1 / (d1 - d3), weight);
    }
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        return edge_feature(2, d6 / (d6 - d2), weight);
    }
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
        return edge_feature(1, (d4 - d3) / ((d4 - d3) + (d5 - d6)), weight);
    }
    weight[1] = vb / (va + vb + vc);
    weight[2] = vc / (va + vb + vc);
    weight[0] = 1.0 - weight[1] - weight[2];
    return ON_FACE;
}

static bool on_rim(const struct rigid_surface *surface, int64_t f, enum feature feature)
{
    if (feature == ON_FACE) {
        return false;
    }
    if (feature < ON_EDGE_0) {
        return surface->is_rim[surface->facet[f * surface->dim + (int)feature - ON_CORNER_0]];
    }
    return surface->edge_is_rim[f * 3 + (int)feature - ON_EDGE_0];
}

/* Take the closest point of facet f if it is closer than the nearest so far. */
static void consider(const struct rigid_surface *surface, int64_t f, const double *x,
                     const struct rigid_filter *filter, struct nearest *nearest)
{
    struct nearest here = {.facet = f};
    int dim = surface->dim;
    double away[3] = {0.0, 0.0, 0.0}, *weight = here.weight;
    const double *a = corner_of(surface, f, 0), *b = corner_of(surface, f, 1);
    if (filter != NULL && !filter->considers(filter->context, f)) {
        return;
    }
    here.feature = dim == 2 ? closest_on_segment(a, b, x, weight)
                            : closest_on_triangle(a, b, corner_of(surface, f, 2), x, weight);
    /* Relative to the first corner, so that an offset of the origin costs no digits. */
    memcpy(here.point, a, (size_t)dim * sizeof *a);
    for (int k = 1; k < dim; k++) {
        double side[3] = {0.0, 0.0, 0.0};
        vector_subtract(dim, corner_of(surface, f, k), a, side);
        add_scaled(dim, weight[k], side, here.point);
    }
    here.rim = on_rim(surface, f, here.feature);
    vector_subtract(dim, x, here.point, away);
    here.distance2 = vector_dot(dim, away, away);
    if ((here.distance2 < nearest->distance2 * (1.0 - ROUND_OFF) ||
         (here.distance2 <= nearest->distance2 * (1.0 + ROUND_OFF) && nearest->rim && !here.rim)) &&
        (filter == NULL || filter->admits == NULL || filter->admits(filter->context, f, away))) {
        *nearest = here;
    }
}

/* Squared distance from x to the box of a branch. */
static double box_distance2(int dim, const struct rigid_branch *branch, const double *x)
{
    double sum = 0.0;
    for (int a = 0; a < dim; a++) {
        double below = branch->low[a] - x[a], above = x[a] - branch->high[a];
        double out = below > above ? below : above;
        sum += out > 0.0 ? out * out : 0.0;
    }
    return sum;
}

/* The nearest point of a facet within reach. The tree is searched depth first, the nearer of two branches
 * first; branches whose boxes are further away than the point found are skipped. */
static struct nearest find_nearest(const struct rigid_surface *surface, const double *x, double reach,
                                   const struct rigid_filter *filter)
{
    struct nearest nearest = {.facet = -1, .distance2 = INFINITY};
    int64_t waiting[MOST_DEPTH] = {0};
    for (int count = 1; count > 0;) {
        int64_t at = waiting[--count];
        const struct rigid_branch *branch = &surface->branch[at];
        double away2 = box_distance2(surface->dim, branch, x);
        if (away2 > nearest.distance2 * (1.0 + ROUND_OFF) || away2 > reach * reach) {
            continue;
        }
        if (branch->second == 0) {
            for (int64_t i = branch->first; i < branch->end; i++) {
                consider(surface, surface->in_order[i], x, filter, &nearest);
            }
            continue;
        }
        bool swap = box_distance2(surface->dim, &surface->branch[branch->second], x) <
                    box_distance2(surface->dim, branch + 1, x);
        waiting[count++] = swap ? at + 1 : branch->second;
        waiting[count++] = swap ? branch->second : at + 1;
    }
    return nearest;
}

/* The normal that decides the sign at the nearest point. */
static const double *pseudo_normal(const struct rigid_surface *surface, const struct nearest *nearest)
{
    int dim = surface->dim;
    const double *normal = surface->normal + nearest->facet * dim;
    const double *joint = normal;
    if (nearest->feature >= ON_EDGE_0) {
        joint = surface->edge_normal + (nearest->facet * 3 + (int)nearest->feature - ON_EDGE_0) * 3;
    } else if (nearest->feature != ON_FACE) {
        joint = surface->vertex_normal +
                (int64_t)surface->facet[nearest->facet * dim + (int)nearest->feature - ON_CORNER_0] * dim;
    }
    /* Facets folded onto each other have no mean normal. */
    return vector_dot(dim, joint, joint) > 0.5 ? joint : normal;
}

/* For a nearest point on a rim: how far x is beyond the rim, and its least distance from the region above the
 * surface and from the surface's plane. */
static double beyond_rim(const struct rigid_surface *surface, const struct nearest *nearest,
                         const double *away, double *least_distance)
{
    int dim = surface->dim;
    /* At a corner of triangles, use the plane of the mean normal; the planes of the facets turn from it by at
     * most `turn`. At the end of a segment and on an edge, use the plane of the facet. */
    bool corner = dim == 3 && nearest->feature < ON_EDGE_0;
    const double *normal = corner ? pseudo_normal(surface, nearest) : surface->normal + nearest->facet * dim;
    double aside[3] = {away[0], away[1], away[2]}, height = vector_dot(dim, away, normal);
    add_scaled(dim, -height, normal, aside);
    double beyond = vector_length(dim, aside);
    double over = beyond, level = fabs(height);
    if (corner) {
        int64_t vertex = surface->facet[nearest->facet * dim + (int)nearest->feature - ON_CORNER_0];
        double c = cos(surface->turn[vertex]), s = sin(surface->turn[vertex]);
        over = beyond * c - fabs(height) * s;
        level = fabs(height) * c - beyond * s;
    }
    *least_distance = fmax(0.0, fmin(over, level));
    return beyond;
}

struct rigid_contact rigid_closest(const struct rigid_surface *surface, const double *x, double reach)
{
    return rigid_closest_among(surface, x, reach, NULL);
}

struct rigid_contact rigid_closest_among(const struct rigid_surface *surface, const double *x, double reach,
                                         const struct rigid_filter *filter)
{
    int dim = surface->dim;
    struct rigid_contact contact = {.distance = reach};
    struct nearest nearest = find_nearest(surface, x, reach, filter);
    if (nearest.facet < 0 || !(nearest.distance2 < reach * reach)) {
        contact.distance = isnan(vector_dot(dim, x, x)) ? 0.0 : reach;
        return contact;
    }
    double away[3] = {0.0, 0.0, 0.0};
    const double *normal = pseudo_normal(surface, &nearest);
    vector_subtract(dim, x, nearest.point, away);
    contact.distance = sqrt(nearest.distance2);
    contact.within = true;
    contact.on_rim = nearest.rim;
    memcpy(contact.point, nearest.point, sizeof contact.point);
    memcpy(contact.side, normal, (size_t)dim * sizeof *normal);
    if (nearest.rim) {
        double least_distance, beyond = beyond_rim(surface, &nearest, away, &least_distance);
        if (beyond > ROUND_OFF * surface->extent) {
            contact.distance = least_distance;
            return contact;
        }
    }
    contact.found = true;
    contact.facet = nearest.facet;
    memcpy(contact.weight, nearest.weight, sizeof contact.weight);
    contact.on_edge = nearest.feature != ON_FACE;
    if (nearest.feature == ON_FACE) {
        /* Measured from a corner, the gap has no cancellation. */
        vector_subtract(dim, x, corner_of(surface, nearest.facet, 0), away);
        contact.gap = vector_dot(dim, away, normal);
        contact.distance = fabs(contact.gap);
        memcpy(contact.normal, normal, (size_t)dim * sizeof *normal);
    } else {
        double sign = vector_dot(dim, away, normal) < 0.0 ? -1.0 : 1.0;
        contact.gap = sign * contact.distance;
        if (contact.distance > 1e3 * ROUND_OFF * surface->extent) {
            add_scaled(dim, sign / contact.distance, away, contact.normal);
        } else {
            memcpy(contact.normal, normal, (size_t)dim * sizeof *normal);
        }
    }
    return contact;
}
