#include "approx/cells/thin.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* A facet is opposite if the scalar product of its normal and the ray is larger than this. */
static const double facing = 0.5;
/* Most cells that a ray passes: round-off might lead it in a circle. */
enum { MOST_CELLS = 1000 };

/* Mean length of the edges of a facet or cell of `count` nodes. */
static double mean_edge(int dim, const double *x, int count, const int32_t *node)
{
    double sum = 0.0;
    for (int k = 0; k < count; k++) {
        for (int l = 0; l < k; l++) {
            sum += vector_distance(dim, x + (int64_t)node[k] * dim, x + (int64_t)node[l] * dim);
        }
    }
    return 2.0 * sum / (count * (count - 1));
}

/* The distance at which the ray from x along `ray` leaves a cell, through the face opposite vertex *face; the
 * face by which it entered does not count. normal[]: area vector of this face, outward. */
static double leave_cell(const struct cells *cells, int64_t cell, int entered, const double *x,
                         const double *ray, int *face, double *normal)
{
    int dim = cells->dim, corners = dim + 1;
    double nearest = INFINITY;
    for (int k = 0; k < corners; k++) {
        int32_t side[3];
        double area[3], to_face[3];
        cell_face(cells, cell, k, side);
        face_area_vector(dim, cells->x, side, area);
        vector_subtract(dim, cells->x + (int64_t)side[0] * dim, x, to_face);
        double slope = vector_dot(dim, area, ray), distance = vector_dot(dim, area, to_face) / slope;
        if (k != entered && slope > 0.0 && distance < nearest) {
            nearest = distance;
            *face = k;
            memcpy(normal, area, (size_t)dim * sizeof *area);
        }
    }
    return nearest;
}

/* The thickness at a facet of a cell, opposite its vertex `face`, m; INFINITY unless it is less than `bound`
 * times the facet's width and `bound` times the mean edge of the cells on the ray. */
static double thickness(const struct cells *cells, const int32_t *across, int64_t cell, int face,
                        const double *middle, const double *inward, double bound, double width)
{
    int dim = cells->dim, corners = dim + 1, out = face;
    double edges = 0.0;
    for (int step = 0; step < MOST_CELLS; step++) {
        double normal[3];
        double distance = leave_cell(cells, cell, face, middle, inward, &out, normal);
        edges += mean_edge(dim, cells->x, corners, cells->node + cell * corners);
        if (!(distance < bound * width)) {
            return INFINITY;
        }
        int32_t next = across[cell * corners + out];
        if (next < 0) {
            bool faces = vector_dot(dim, normal, inward) > facing * vector_length(dim, normal);
            return faces && distance < bound * edges / (step + 1) ? distance : INFINITY;
        }
        for (face = 0; across[(int64_t)next * corners + face] != cell; face++) {
        }
        cell = next;
    }
    return INFINITY;
}

enum status cells_find_thin(const struct cells *cells, double bound, struct thin_report *report,
                            struct error *error)
{
    int dim = cells->dim, corners = dim + 1;
    double whole = 0.0, thin = 0.0;
    *report = (struct thin_report){.least = bound};
    NEW_SCRATCH(int32_t, across, cells->count * corners, error);
    RETURN_IF_ERROR(cells_across(cells, across, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        int64_t cell = i / corners;
        int face = (int)(i % corners);
        if (across[i] >= 0) {
            continue;
        }
        int32_t node[3];
        double area[3], middle[3], inward[3];
        cell_face(cells, cell, face, node);
        face_area_vector(dim, cells->x, node, area);
        double size = vector_length(dim, area);
        vector_middle(dim, cells->x, dim, node, middle);
        for (int a = 0; a < dim; a++) {
            inward[a] = -area[a] / size;
        }
        double width = mean_edge(dim, cells->x, dim, node);
        double ratio = thickness(cells, across, cell, face, middle, inward, bound, width) / width;
        whole += size;
        thin += ratio < bound ? size : 0.0;
        if (ratio < report->least) {
            report->least = ratio;
            memcpy(report->place, middle, (size_t)dim * sizeof *middle);
        }
    }
    report->share = whole > 0.0 ? thin / whole : 0.0;
    return STATUS_OK;
}
