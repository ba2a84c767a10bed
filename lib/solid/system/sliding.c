#include "solid/system/sliding.h"

#include "approx/cells/cells.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void sliding_free(struct sliding *sliding)
{
    FREE_ALL(sliding->row, sliding->facet);
    *sliding = (struct sliding){0};
}

enum status sliding_add_row(struct sliding *sliding, int64_t row, struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&sliding->row, sliding->row_count + 1, &sliding->row_room, error));
    sliding->row[sliding->row_count++] = row;
    return STATUS_OK;
}

enum status sliding_add_facet(struct sliding *sliding, const struct sliding_facet *facet, struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&sliding->facet, sliding->facet_count + 1, &sliding->facet_room, error));
    sliding->facet[sliding->facet_count++] = *facet;
    return STATUS_OK;
}

static int compare_facets(const void *left, const void *right)
{
    const struct sliding_facet *a = left, *b = right;
    return a->side != b->side ? (a->side < b->side ? -1 : 1) : compare_numbers(3, a->node, b->node);
}

void sliding_sort(struct sliding *sliding, int64_t first, int64_t sides)
{
    if (sliding->facet_count > first) {
        qsort(sliding->facet + first, (size_t)(sliding->facet_count - first), sizeof *sliding->facet,
              compare_facets);
    }
    sliding->side_count += (int32_t)sides;
}

/* The gradients along a facet of the linear functions of its corners; nu: its unit normal, area: its size. */
static void facet_gradients(int dim, const double *X, const int32_t *node, const double *nu, double area,
                            double gradient[3][3])
{
    for (int k = 0; k < dim; k++) {
        const double *from = X + (int64_t)node[(k + 1) % dim] * dim;
        const double *to = X + (int64_t)node[(k + 2) % dim] * dim;
        double edge[3];
        if (dim == 2) { /* from the other corner to this one */
            vector_subtract(dim, to, from, gradient[k]);
            area = vector_length(dim, gradient[k]);
            gradient[k][0] /= area * area;
            gradient[k][1] /= area * area;
        } else {
            vector_subtract(dim, to, from, edge);
            vector_cross(nu, edge, gradient[k]);
            for (int a = 0; a < dim; a++) {
                gradient[k][a] /= 2.0 * area;
            }
        }
    }
}

/* How far a facet is from the surface, m; normal: sums of area vectors at the nodes. *slide: by how much it
 * slides, m; *area: its size. */
static double leaves(int dim, const double *X, const int32_t *node, const double *normal, const double *u,
                     double *slide, double *area)
{
    double nu[3], s[3], gradient[3][3], sum = 0.0;
    face_area_vector(dim, X, node, nu);
    *area = vector_length(dim, nu);
    vector_normalise(dim, nu);
    vector_middle(dim, u, dim, node, s);
    add_scaled(dim, -vector_dot(dim, s, nu), nu, s);
    facet_gradients(dim, X, node, nu, *area, gradient);
    for (int k = 0; k < dim; k++) {
        double n[3];
        memcpy(n, normal + (int64_t)node[k] * dim, (size_t)dim * sizeof *n);
        vector_normalise(dim, n);
        sum += vector_dot(dim, s, n) * vector_dot(dim, s, gradient[k]);
    }
    *slide = vector_length(dim, s);
    return 0.5 * fabs(sum);
}

/* normal[node_count * dim] = the sums of the area vectors of the facets [first, last) at their nodes. */
static void sum_normals(const struct sliding_facet *facet, int64_t first, int64_t last, int dim,
                        const double *X, double *normal)
{
    for (int64_t i = first * dim; i < last * dim; i++) {
        memset(normal + (int64_t)facet[i / dim].node[i % dim] * dim, 0, (size_t)dim * sizeof *normal);
    }
    for (int64_t f = first; f < last; f++) {
        double area[3];
        face_area_vector(dim, X, facet[f].node, area);
        for (int k = 0; k < dim; k++) {
            add_scaled(dim, 1.0, area, normal + (int64_t)facet[f].node[k] * dim);
        }
    }
}

enum status sliding_measure(const struct sliding *sliding, int dim, int64_t node_count, const double *X,
                            const double *u, struct sliding_error *worst, struct error *error)
{
    const struct sliding_facet *facet = sliding->facet;
    NEW_SCRATCH(double, normal, node_count * dim, error);
    struct sliding_error own = {.section = -1};
    double distances = 0.0, slides = 0.0;
    *worst = (struct sliding_error){.section = -1};
    for (int64_t first = 0, f = 0; f < sliding->facet_count; f++) {
        double slide, area;
        if (f == 0 || facet[f].side != facet[f - 1].side) {
            for (first = f; first < sliding->facet_count && facet[first].side == facet[f].side; first++) {
            }
            sum_normals(facet, f, first, dim, X, normal);
        }
        if (facet[f].section != own.section) {
            own = (struct sliding_error){.section = facet[f].section};
            distances = slides = 0.0;
        }
        double distance = leaves(dim, X, facet[f].node, normal, u, &slide, &area);
        distances += area * distance;
        slides += area * slide;
        if (distance > own.distance) {
            own.distance = distance;
            own.slide = slide;
            vector_middle(dim, X, dim, facet[f].node, own.place);
        }
        bool last = f + 1 == sliding->facet_count || facet[f + 1].section != own.section;
        own.share = slides > 0.0 ? distances / slides : 0.0;
        if (last && (worst->section < 0 || own.share > worst->share)) {
            *worst = own;
        }
    }
    return STATUS_OK;
}
