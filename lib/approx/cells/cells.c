#include "approx/cells/cells.h"

#include "approx/cells/face_edges.h"
#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* The vertex opposite face number `face` of a cell. */
static int opposite(int dim, int64_t face)
{
    static const int of_triangle[3] = {2, 0, 1}, of_tetrahedron[4] = {3, 2, 0, 1};
    return dim == 2 ? of_triangle[face] : of_tetrahedron[face];
}

double cell_volume(const struct cells *cells, int64_t cell)
{
    const int32_t *v = cells->node + cell * (cells->dim + 1);
    double e[3][3], w[3];
    for (int k = 0; k < cells->dim; k++) {
        vector_subtract(cells->dim, cells->x + (int64_t)v[1 + k] * cells->dim,
                        cells->x + (int64_t)v[0] * cells->dim, e[k]);
    }
    if (cells->dim == 2) {
        return 0.5 * (e[0][0] * e[1][1] - e[0][1] * e[1][0]);
    }
    vector_cross(e[0], e[1], w);
    return (w[0] * e[2][0] + w[1] * e[2][1] + w[2] * e[2][2]) / 6.0;
}

void cell_centroid(const struct cells *cells, int64_t cell, double *centroid)
{
    int dim = cells->dim;
    const int32_t *v = cells->node + cell * (dim + 1);
    for (int a = 0; a < dim; a++) {
        double sum = 0.0;
        for (int k = 0; k <= dim; k++) {
            sum += cells->x[(int64_t)v[k] * dim + a];
        }
        centroid[a] = sum / (dim + 1);
    }
}

void cell_face(const struct cells *cells, int64_t cell, int vertex, int32_t *face)
{
    simplex_face(cells->dim, cells->node + cell * (cells->dim + 1), vertex, face);
}

void cell_barycentric(const struct cells *cells, int64_t cell, const double *x, double *coordinate)
{
    int dim = cells->dim;
    double moved_x[12];
    const int32_t *v = cells->node + cell * (dim + 1);
    static const int32_t in_order[4] = {0, 1, 2, 3};
    struct cells one = {.dim = dim, .node_count = dim + 1, .x = moved_x, .count = 1, .node = in_order};
    double volume = cell_volume(cells, cell);
    for (int k = 0; k <= dim; k++) {
        for (int i = 0; i <= dim; i++) {
            for (int a = 0; a < dim; a++) {
                moved_x[i * dim + a] = i == k ? x[a] : cells->x[(int64_t)v[i] * dim + a];
            }
        }
        coordinate[k] = cell_volume(&one, 0) / volume;
    }
}

bool cell_contains(const struct cells *cells, int64_t cell, const double *x, double least)
{
    double coordinate[4];
    bool within = true;
    cell_barycentric(cells, cell, x, coordinate);
    for (int k = 0; k <= cells->dim; k++) {
        within = within && coordinate[k] > least;
    }
    return within;
}

void face_area_vector(int dim, const double *x, const int32_t *face, double *vector)
{
    double u[3], v[3];
    vector_subtract(dim, x + (int64_t)face[1] * dim, x + (int64_t)face[0] * dim, u);
    if (dim == 2) {
        vector[0] = u[1];
        vector[1] = -u[0];
        return;
    }
    vector_subtract(dim, x + (int64_t)face[2] * dim, x + (int64_t)face[0] * dim, v);
    vector_cross(u, v, vector);
    for (int a = 0; a < 3; a++) {
        vector[a] *= 0.5;
    }
}

/* Barycentric coordinates of the projection of x on the plane through corner[0 .. order], by Cramer's rule on
 * the Gram matrix of the edges; false where these are linearly dependent. */
static bool project(int dim, int order, const double *const *corner, const double *x, double *place)
{
    double edge[3][3], from[3], gram[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, right[3] = {0.0, 0.0, 0.0};
    double cofactor[3][3];
    vector_subtract(dim, x, corner[0], from);
    for (int k = 0; k < order; k++) {
        vector_subtract(dim, corner[k + 1], corner[0], edge[k]);
    }
    for (int k = 0; k < order; k++) {
        right[k] = vector_dot(dim, edge[k], from);
        for (int l = 0; l < order; l++) {
            gram[k][l] = vector_dot(dim, edge[k], edge[l]);
        }
    }
    for (int k = 0; k < 3; k++) {
        vector_cross(gram[(k + 1) % 3], gram[(k + 2) % 3], cofactor[k]);
    }
    double determinant = vector_dot(3, gram[0], cofactor[0]);
    place[0] = 1.0;
    for (int k = 0; k < order; k++) {
        place[k + 1] = vector_dot(3, cofactor[k], right) / determinant;
        place[0] -= place[k + 1];
    }
    return determinant > 0.0;
}

/* The nearest point is in the simplex if the projection of x is; else it is in a face beyond which the
 * projection lies. */
double simplex_distance2(int dim, int order, const double *const *corner, const double *x)
{
    double place[4] = {1.0}, least = INFINITY, nearest[3] = {0.0};
    bool projected = order == 0 || project(dim, order, corner, x, place);
    for (int k = 0; k <= order; k++) {
        if (!projected || place[k] < -1e-9) {
            const double *face[3];
            for (int l = 0; l < order; l++) {
                face[l] = corner[l + (l >= k)];
            }
            least = fmin(least, simplex_distance2(dim, order - 1, face, x));
        }
    }
    if (isinf(least)) {
        for (int i = 0; i < (order + 1) * dim; i++) {
            nearest[i % dim] += place[i / dim] * corner[i / dim][i % dim];
        }
        least = vector_distance2(dim, nearest, x);
    }
    return least;
}

void cell_corners(const struct cells *cells, int64_t cell, const double *corner[4])
{
    const int32_t *node = cells->node + cell * (cells->dim + 1);
    for (int k = 0; k <= cells->dim; k++) {
        corner[k] = cells->x + (int64_t)node[k] * cells->dim;
    }
}

enum status cells_check(const struct cells *cells, struct error *error)
{
    int vertices = cells->dim + 1;
    for (int64_t c = 0; c < cells->count; c++) {
        for (int k = 0; k < vertices; k++) {
            int32_t node = cells->node[c * vertices + k];
            if (node < 0 || node >= cells->node_count) {
                return fail(error, STATUS_INPUT, "cells: row %lld: no node %d", (long long)c, node);
            }
        }
        double volume = cell_volume(cells, c);
        if (!(volume > 0.0) || !isfinite(volume)) {
            return fail(error, STATUS_INPUT, "cells: row %lld: inverted or of no volume (%g)", (long long)c,
                        volume);
        }
    }
    return STATUS_OK;
}

/* partner[source]: the source of the same face in the other cell, or -1. */
static enum status match_faces(const struct cells *cells, int64_t *partner, struct error *error)
{
    int corners = cells->dim + 1;
    int64_t total = cells->count * corners;
    NEW_SCRATCH(struct keyed, keyed, total, error);
    for (int64_t s = 0; s < total; s++) {
        int32_t node[3];
        cell_face(cells, s / corners, opposite(cells->dim, s % corners), node);
        face_key(cells->dim, node, keyed[s].key);
        keyed[s].item = s;
        partner[s] = -1;
    }
    keyed_sort(total, keyed);
    for (int64_t i = 0, end; i < total; i = end) {
        end = keyed_end(total, keyed, i);
        if (end - i > 2) {
            return fail(error, STATUS_INPUT, "cells: row %lld: a face is shared by more than two cells",
                        (long long)(keyed[i + 2].item / corners));
        }
        if (end - i == 2) {
            partner[keyed[i].item] = keyed[i + 1].item;
            partner[keyed[i + 1].item] = keyed[i].item;
        }
    }
    return STATUS_OK;
}

/* Append face s of the cells, with the cell `beyond` it, or -1. */
static void add_face(const struct cells *cells, int64_t s, int64_t beyond, struct faces *faces)
{
    int corners = cells->dim + 1;
    cell_face(cells, s / corners, opposite(cells->dim, s % corners), faces->node + faces->count * cells->dim);
    faces->cell[faces->count * 2] = (int32_t)(s / corners);
    faces->cell[faces->count * 2 + 1] = (int32_t)beyond;
    faces->count++;
}

enum status faces_build(const struct cells *cells, bool boundary_only, struct faces *faces,
                        struct error *error)
{
    int dim = cells->dim;
    int64_t total = cells->count * (dim + 1);
    *faces = (struct faces){.dim = dim};
    NEW_SCRATCH(int64_t, partner, total, error);
    RETURN_IF_ERROR(match_faces(cells, partner, error));
    int64_t count = 0;
    for (int64_t s = 0; s < total; s++) {
        faces->boundary_count += partner[s] < 0;
        count += partner[s] < 0 || (!boundary_only && partner[s] > s);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&faces->node, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&faces->cell, count * 2, error));
    for (int64_t s = 0; s < total; s++) {
        if (partner[s] < 0) {
            add_face(cells, s, -1, faces);
        }
    }
    for (int64_t s = 0; s < total && !boundary_only; s++) {
        if (partner[s] > s) {
            add_face(cells, s, partner[s] / (dim + 1), faces);
        }
    }
    if (boundary_only) {
        return STATUS_OK;
    }
    return face_edges_number(cells->node_count, faces, error);
}

enum status faces_find(const struct faces *faces, int64_t count, const int32_t *facet, int64_t *found,
                       struct error *error)
{
    int dim = faces->dim;
    int64_t known = 0;
    NEW_SCRATCH(struct keyed, keyed, faces->count, error);
    for (int64_t f = 0; f < faces->count; f++) {
        if (faces->cell[2 * f + 1] < 0) {
            face_key(dim, faces->node + f * dim, keyed[known].key);
            keyed[known++].item = f;
        }
    }
    keyed_sort(known, keyed);
    for (int64_t i = 0; i < count; i++) {
        int32_t key[3];
        face_key(dim, facet + i * dim, key);
        int64_t same = keyed_find(known, keyed, key);
        found[i] = same >= 0 ? keyed[same].item : -1;
    }
    return STATUS_OK;
}

enum status faces_mark(const struct faces *faces, int64_t count, const int32_t *facet, bool *marked,
                       struct error *error)
{
    NEW_SCRATCH(int64_t, found, count, error);
    RETURN_IF_ERROR(faces_find(faces, count, facet, found, error));
    for (int64_t i = 0; i < count; i++) {
        if (found[i] >= 0) {
            marked[found[i]] = true;
        }
    }
    return STATUS_OK;
}

enum status cells_across(const struct cells *cells, int32_t *across, struct error *error)
{
    int corners = cells->dim + 1;
    NEW_SCRATCH(int64_t, partner, cells->count * corners, error);
    RETURN_IF_ERROR(match_faces(cells, partner, error));
    for (int64_t s = 0; s < cells->count * corners; s++) {
        across[s / corners * corners + opposite(cells->dim, s % corners)] =
            partner[s] < 0 ? -1 : (int32_t)(partner[s] / corners);
    }
    return STATUS_OK;
}

void faces_free(struct faces *faces)
{
    FREE_ALL(faces->node, faces->cell, faces->edge);
    *faces = (struct faces){0};
}

enum status cells_node_spacing(const struct cells *cells, const double *stretch, double *spacing,
                               struct error *error)
{
    int dim = cells->dim;
    NEW_SCRATCH(int64_t, visits, cells->node_count, error);
    for (int64_t n = 0; n < cells->node_count; n++) {
        spacing[n] = 0.0;
    }
    /* An edge counts once for each of its cells, so that interior edges have a larger weight than boundary
     * edges. */
    for (int64_t c = 0; c < cells->count; c++) {
        const int32_t *v = cells->node + c * (dim + 1);
        for (int i = 0; i <= dim; i++) {
            for (int k = i + 1; k <= dim; k++) {
                double edge[3];
                vector_subtract(dim, cells->x + (int64_t)v[k] * dim, cells->x + (int64_t)v[i] * dim, edge);
                for (int end = i; end <= k; end += k - i) {
                    const double *A = stretch != NULL ? stretch + (int64_t)v[end] * dim * dim : NULL;
                    spacing[v[end]] += sqrt(vector_square(dim, A, edge));
                }
                visits[v[i]]++;
                visits[v[k]]++;
            }
        }
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        spacing[n] = visits[n] > 0 ? spacing[n] / (double)visits[n] : 0.0;
    }
    return STATUS_OK;
}

/* ---- order in memory ---- */

struct sort_key {
    uint64_t place;
    int64_t index;
    int32_t group;
};

static int compare_keys(const void *left, const void *right)
{
    const struct sort_key *a = left, *b = right;
    int groups = compare_int32(&a->group, &b->group);
    int places = (a->place > b->place) - (a->place < b->place);
    return groups != 0 ? groups : places != 0 ? places : compare_int64(&a->index, &b->index);
}

/* The Morton code of a point: the bits of its coordinates, interleaved. */
static uint64_t morton(int dim, const double *x, const double *low, double extent)
{
    uint64_t place = 0, cell[3];
    const int bits = 20;
    for (int a = 0; a < dim; a++) {
        cell[a] = (uint64_t)((x[a] - low[a]) / extent * ((1 << bits) - 1));
    }
    for (int b = bits - 1; b >= 0; b--) {
        for (int a = 0; a < dim; a++) {
            place = place << 1 | (cell[a] >> b & 1);
        }
    }
    return place;
}

enum status renumber_morton(int dim, int64_t count, const double *x, const int32_t *group, int64_t *order,
                            struct error *error)
{
    struct box box = box_of(dim, count, x);
    double extent = fmax(1e-300, box_side(&box));
    NEW_SCRATCH(struct sort_key, keys, count, error);
    for (int64_t i = 0; i < count; i++) {
        keys[i] =
            (struct sort_key){morton(dim, x + i * dim, box.low, extent), i, group != NULL ? group[i] : 0};
    }
    qsort(keys, (size_t)count, sizeof *keys, compare_keys);
    for (int64_t i = 0; i < count; i++) {
        order[i] = keys[i].index;
    }
    return STATUS_OK;
}
