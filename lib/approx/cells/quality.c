#include "approx/cells/quality.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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

/* ---- thin parts ---- */

/* Most cells that a ray passes: round-off might lead it in a circle. */
enum { MOST_CELLS = 1000 };

/* Add to C[dim * dim] weight times the covariance of the places within a cell, m2. */
static void add_covariance(const struct cells *cells, int64_t cell, double weight, double *C)
{
    int dim = cells->dim, corners = dim + 1;
    double centre[3];
    cell_centroid(cells, cell, centre);
    for (int k = 0; k < corners; k++) {
        double offset[3];
        vector_subtract(dim, cells->x + (int64_t)cells->node[cell * corners + k] * dim, centre, offset);
        for (int a = 0; a < dim; a++) {
            add_scaled(dim, weight * offset[a] / (corners * (corners + 1)), offset, C + a * dim);
        }
    }
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

/* The thickness at a facet of a cell, opposite its vertex `face`, m, and in C[dim * dim] the mean covariance
 * of the cells on the ray; INFINITY where 12 times its trace is less than `bound` times the square of that.
 */
static double thickness(const struct cells *cells, const int32_t *across, int64_t cell, int face,
                        const double *middle, const double *inward, double bound, double C[9])
{
    int dim = cells->dim, corners = dim + 1, out = face;
    double before = 0.0, sum[9] = {0.0};
    for (int step = 0; step < MOST_CELLS; step++) {
        double normal[3], trace = 0.0;
        double distance = leave_cell(cells, cell, face, middle, inward, &out, normal);
        add_covariance(cells, cell, distance - before, sum);
        for (int i = 0; i < dim * dim; i++) {
            C[i] = sum[i] / distance;
            trace += i % corners == 0 ? C[i] : 0.0;
        }
        if (!(12.0 * trace > bound * distance * distance)) {
            return INFINITY;
        }
        int32_t next = across[cell * corners + out];
        if (next < 0) {
            bool faces = vector_dot(dim, normal, inward) > SAME_DIRECTION * vector_length(dim, normal);
            return faces ? distance : INFINITY;
        }
        for (face = 0; across[(int64_t)next * corners + face] != cell; face++) {
        }
        cell = next;
        before = distance;
    }
    return INFINITY;
}

/* The largest variance of C[dim * dim] along directions orthogonal to the unit vector n. */
static double largest_across(int dim, const double *C, const double *n)
{
    double first[9], projected[9], values[3], vectors[9], largest = 0.0;
    for (int i = 0; i < dim * dim; i++) { /* (I - n n^T) C */
        int a = i / dim, b = i % dim;
        first[i] = C[i];
        for (int k = 0; k < dim; k++) {
            first[i] -= n[a] * n[k] * C[k * dim + b];
        }
    }
    for (int i = 0; i < dim * dim; i++) {
        projected[i] = first[i] - vector_dot(dim, first + i / dim * dim, n) * n[i % dim];
    }
    eigen_symmetric(dim, projected, values, vectors);
    for (int k = 0; k < dim; k++) {
        largest = fmax(largest, values[k]);
    }
    return largest;
}

/* excess[2]: see struct thin_report, with the thickness and the covariance C of the cells. */
static void bending_excess(int dim, double thickness, const double *C, const double *inward, double excess[2])
{
    double along = largest_across(dim, C, inward) / (thickness * thickness), normal = 0.0;
    for (int a = 0; a < dim; a++) {
        normal += inward[a] * vector_dot(dim, C + a * dim, inward) / (thickness * thickness);
    }
    excess[0] = 6.0 * (along - normal);
    excess[1] = 6.0 * (2.0 * along - normal);
}

enum status cells_find_thin(const struct cells *cells, double bound, struct thin_report *report,
                            struct error *error)
{
    int dim = cells->dim, corners = dim + 1;
    double whole = 0.0, thin = 0.0;
    *report = (struct thin_report){0};
    NEW_SCRATCH(int32_t, across, cells->count * corners, error);
    RETURN_IF_ERROR(cells_across(cells, across, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        int64_t cell = i / corners;
        int face = (int)(i % corners);
        if (across[i] >= 0) {
            continue;
        }
        int32_t node[3];
        double area[3], middle[3], inward[3], C[9], excess[2] = {0.0, 0.0};
        cell_face(cells, cell, face, node);
        face_area_vector(dim, cells->x, node, area);
        double size = vector_length(dim, area);
        vector_middle(dim, cells->x, dim, node, middle);
        for (int a = 0; a < dim; a++) {
            inward[a] = -area[a] / size;
        }
        double across_part = thickness(cells, across, cell, face, middle, inward, bound, C);
        whole += size;
        if (across_part < INFINITY) {
            bending_excess(dim, across_part, C, inward, excess);
        }
        double worst = fmax(fabs(excess[0]), fabs(excess[1]));
        thin += worst > bound ? size : 0.0;
        if (worst > fmax(fabs(report->excess[0]), fabs(report->excess[1]))) {
            memcpy(report->excess, excess, sizeof excess);
            memcpy(report->place, middle, (size_t)dim * sizeof *middle);
            report->thickness = across_part;
        }
    }
    report->share = whole > 0.0 ? thin / whole : 0.0;
    return STATUS_OK;
}
