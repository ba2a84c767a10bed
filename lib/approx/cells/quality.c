#include "approx/cells/quality.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

/* With S the sum of the sizes of the faces: in 2D q = 2 r / R, r = 2 A / S, R = a b c / (4 A); in 3D q = 3 r
 * / R, r = 3 V / S, R = sqrt(p (p - a)(p - b)(p - c)) / (6 V), where a, b, c are the products of opposite
 * edges, and p is half their sum. */
double cell_quality(const struct cells *cells, int64_t cell, double angles[2])
{
    int dim = cells->dim;
    double volume = cell_volume(cells, cell), normal[4][3], face[4], sum = 0, product = 1, edges[3], p = 0;
    double least = 2, most = -2; /* cosines of angles */
    const double *x[4];
    cell_corners(cells, cell, x);
    for (int k = 0; k <= dim; k++) {
        int32_t node[3];
        cell_face(cells, cell, k, node);
        face_area_vector(dim, cells->x, node, normal[k]);
        face[k] = vector_length(dim, normal[k]);
        sum += face[k];
        for (int l = 0; l < k; l++) { /* the angle between faces is 180 degrees less that of their normals */
            double cosine = -vector_dot(dim, normal[k], normal[l]) / (face[k] * face[l]);
            least = fmin(least, cosine);
            most = fmax(most, cosine);
        }
    }
    for (int k = 0; k < 3; k++) {
        edges[k] = dim == 2 ? face[k]
                            : vector_distance(3, x[0], x[k + 1]) *
                                  vector_distance(3, x[(k + 1) % 3 + 1], x[(k + 2) % 3 + 1]);
        p += edges[k] / 2;
    }
    for (int k = 0; k < 3; k++) {
        product *= dim == 2 ? edges[k] : p - edges[k];
    }
    if (angles != NULL) {
        bool has = volume > 0 && least >= -1 && most <= 1;
        angles[0] = has ? acos(most) * 180 / M_PI : 0;
        angles[1] = has ? acos(least) * 180 / M_PI : 180;
    }
    double quality = dim == 2 ? volume * fabs(volume) * 16 / (sum * product)
                              : 54 * volume * fabs(volume) / (sum * sqrt(fmax(p * product, 0)));
    return isfinite(quality) ? quality : 0;
}

enum status cells_find_thin(const struct cells *cells, struct thin_report *report, struct error *error)
{
    int dim = cells->dim, corners = dim + 1;
    double whole = 0.0, thin = 0.0, largest = 0.0, area[3];
    int32_t node[3];
    *report = (struct thin_report){0};
    NEW_SCRATCH(int32_t, across, cells->count * corners, error);
    NEW_SCRATCH(double, normal, cells->node_count * dim, error); /* outward: of the facets at each node */
    RETURN_IF_ERROR(cells_across(cells, across, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        cell_face(cells, i / corners, (int)(i % corners), node);
        face_area_vector(dim, cells->x, node, area);
        for (int k = 0; k < dim && across[i] < 0; k++) {
            add_scaled(dim, 1.0, area, normal + (int64_t)node[k] * dim);
        }
    }
    for (int64_t i = 0; i < cells->count * corners; i++) {
        if (across[i] >= 0) {
            continue;
        }
        const double *opposite = normal + (int64_t)cells->node[i] * dim;
        cell_face(cells, i / corners, (int)(i % corners), node);
        face_area_vector(dim, cells->x, node, area);
        double size = vector_length(dim, area);
        bool faces = vector_dot(dim, opposite, area) < -SAME_DIRECTION * size * vector_length(dim, opposite);
        whole += size;
        thin += faces ? size : 0.0;
        if (faces && size > largest) {
            largest = size;
            vector_middle(dim, cells->x, dim, node, report->place);
        }
    }
    report->share = whole > 0.0 ? thin / whole : 0.0;
    return STATUS_OK;
}
