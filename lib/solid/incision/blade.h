/* The surface along which a body is cut: in 2D curves, in 3D triangles. */
#pragma once

#include "base/status.h"
#include "solid/rigid/rigid.h"

/* A part of a blade that does not branch: facets joined across the edges (2D: points) of two facets, not
 * where more meet. */
struct sheet {
    struct rigid_surface surface;
    int64_t border_count; /* edges (2D: end points) where it ends; 0: closed */
    double *border;       /* border_count * (dim - 1) * dim, m */
};

struct blade {
    int dim;
    int64_t count;
    struct sheet *sheet; /* count */
};

/* Build from the corners of its facets, corners[facet_count * dim * dim], m. Front is where their normals
 * point to (rigid_build). STATUS_INPUT as rigid_build, and for facets that cross each other. To be freed also
 * on failure. */
MUST_CHECK enum status blade_build(int dim, int64_t facet_count, const double *corners, struct blade *blade,
                                   struct error *error);
void blade_free(struct blade *blade);

/* Whether no part of it has a border. */
bool blade_is_closed(const struct blade *blade);

/* Where a point is to a sheet, which is continued beyond its border along its tangents: */
struct sheet_place {
    double height;    /* signed distance from it, m, positive in front */
    double normal[3]; /* unit, of the sheet there */
    bool beyond;      /* beyond the border, or on it */
    double near[3];   /* the nearest point of the sheet, */
    double foot[3];   /* and of the sheet and its continuation */
};

/* False: farther than `reach`. */
bool sheet_at(const struct sheet *sheet, const double *x, double reach, struct sheet_place *place);

/* The distance of that place along the sheet from its border, m, negative within; closed: -INFINITY. */
double sheet_extent(const struct sheet *sheet, const struct sheet_place *place);
