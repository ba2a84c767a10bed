/* The side of a closed surface by its winding number; see rigid.h. */
#include "solid/rigid/rigid_private.h"

#include <math.h>

/* The solid angle (2D: the angle) of a facet at x, as a share of all: positive if its normal points away
 * (van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30, 1983). */
static double share_of_angle(const struct rigid_surface *surface, int64_t f, const double *x)
{
    int dim = surface->dim;
    const int32_t *corner = surface->facet + f * dim;
    double to[3][3] = {{0}}, area[3], length[3], cross[3];
    for (int k = 0; k < dim; k++) {
        vector_subtract(dim, surface->vertex + (int64_t)corner[k] * dim, x, to[k]);
        length[k] = vector_length(dim, to[k]);
    }
    face_area_vector(dim, surface->vertex, corner, area);
    double way = vector_dot(dim, area, surface->normal + f * dim) < 0 ? -1 : 1;
    if (dim == 2) {
        double size = fabs(to[0][0] * to[1][1] - to[0][1] * to[1][0]);
        double away = vector_dot(2, to[0], surface->normal + f * dim) < 0 ? -1 : 1;
        return away * atan2(size, vector_dot(2, to[0], to[1])) / (2 * M_PI);
    }
    vector_cross(to[1], to[2], cross);
    double volume = vector_dot(3, to[0], cross);
    double scale = length[0] * length[1] * length[2] + vector_dot(3, to[0], to[1]) * length[2] +
                   vector_dot(3, to[1], to[2]) * length[0] + vector_dot(3, to[2], to[0]) * length[1];
    return way * atan2(volume, scale) / (2 * M_PI);
}

bool rigid_is_behind(const struct rigid_surface *surface, const double *x)
{
    double turns = 0, volume = 0, middle[3];
    int dim = surface->dim;
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        if (surface->is_rim[v]) {
            return rigid_closest(surface, x, INFINITY).gap < 0;
        }
    }
    for (int64_t f = 0; f < surface->facet_count; f++) {
        double area[3];
        face_area_vector(dim, surface->vertex, surface->facet + f * dim, area);
        vector_middle(dim, surface->vertex, dim, surface->facet + f * dim, middle);
        vector_subtract(dim, middle, surface->vertex, middle);
        volume += vector_length(dim, area) * vector_dot(dim, middle, surface->normal + f * dim);
        turns += share_of_angle(surface, f, x);
    }
    return volume > 0 ? turns > 0.5 : turns > -0.5; /* normals point outward; inward */
}
