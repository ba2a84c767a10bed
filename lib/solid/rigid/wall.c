#include "solid/rigid/wall.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Below this |axis x n| of unit vectors the direction around the axis is round-off. */
static const double least_sine = 1e-9;

/* The nearest point of a surface; `side`: its normal there, from the vertices' where the facet is known. */
static struct rigid_contact find_foot(const struct rigid_surface *surface, const double *x)
{
    struct rigid_contact foot = rigid_closest(surface, x, INFINITY);
    double normal[3] = {0.0};
    for (int k = 0; k < 3 && foot.found; k++) {
        add_scaled(3, foot.weight[k],
                   surface->vertex_normal + 3 * (int64_t)surface->facet[3 * foot.facet + k], normal);
    }
    if (vector_length(3, normal) > 0.5) {
        vector_normalise(3, normal);
        memcpy(foot.side, normal, sizeof normal);
    }
    return foot;
}

/* Turn the normal of a foot towards the other side of the wall. */
static void turn_across(const double across[3], struct rigid_contact *foot)
{
    bool against = vector_dot(3, foot->side, across) < 0.0;
    for (int i = 0; i < 3 && against; i++) {
        foot->side[i] = -foot->side[i];
    }
}

/* The depth at x, and n; false where the nearest place is the same on both surfaces. */
static bool find_across(const struct wall *wall, const double *x, double *depth, double n[3])
{
    struct rigid_contact from = find_foot(wall->from, x), to = find_foot(wall->to, x);
    double d1 = vector_distance(3, from.point, x), d2 = vector_distance(3, to.point, x);
    double across[3];
    vector_subtract(3, to.point, from.point, across);
    if (!(d1 + d2 > 0.0 && vector_length(3, across) > 0.0)) {
        return false;
    }
    turn_across(across, &from);
    turn_across(across, &to);
    *depth = d1 / (d1 + d2);
    for (int i = 0; i < 3; i++) {
        n[i] = (1.0 - *depth) * from.side[i] + *depth * to.side[i];
    }
    vector_normalise(3, n);
    return true;
}

/* c = axis x n, or the coordinate axis that is the farthest from n, made orthogonal to it; unit. */
static void find_around(const double axis[3], const double n[3], double c[3])
{
    vector_cross(axis, n, c);
    if (!(vector_length(3, c) > least_sine)) {
        int least = fabs(n[0]) <= fabs(n[1]) ? 0 : 1;
        least = fabs(n[2]) < fabs(n[least]) ? 2 : least;
        double coordinate[3] = {0.0};
        coordinate[least] = 1.0;
        memcpy(c, coordinate, sizeof coordinate);
        add_scaled(3, -n[least], n, c);
    }
    vector_normalise(3, c);
}

enum status wall_fibres(const struct wall *wall, int64_t count, const double *x, double *fibre,
                        struct error *error)
{
    static const double degree = 3.14159265358979323846 / 180.0;
    double axis[3], length = vector_length(3, wall->axis);
    if (!(length > 0.0 && isfinite(length))) {
        return fail(error, STATUS_INPUT, "the axis has no length");
    }
    memcpy(axis, wall->axis, sizeof axis);
    vector_normalise(3, axis);
    for (int64_t p = 0; p < count; p++) {
        double depth, n[3], c[3], l[3];
        if (!find_across(wall, x + 3 * p, &depth, n)) {
            return fail(
                error, STATUS_INPUT,
                "point %lld at (%.6g, %.6g, %.6g) m: the nearest place is the same on both surfaces: do "
                "they share facets?",
                (long long)p, x[3 * p], x[3 * p + 1], x[3 * p + 2]);
        }
        double a = degree * ((1.0 - depth) * wall->angles[0] + depth * wall->angles[1]);
        find_around(axis, n, c);
        vector_cross(n, c, l);
        for (int i = 0; i < 3; i++) {
            fibre[3 * p + i] = cos(a) * c[i] + sin(a) * l[i];
        }
    }
    return STATUS_OK;
}
