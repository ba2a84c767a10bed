#include "approx/ends.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* A facet and the group that it belongs to. */
struct member {
    int32_t set;
    const int32_t *facet;
};

static int compare_members(const void *left, const void *right)
{
    const struct member *a = left, *b = right;
    return (a->set > b->set) - (a->set < b->set);
}

/* Mark the nodes where a group ends. faces_at[node_count]: how many faces of the boundary each has. */
static enum status mark_ends(const struct cells *cells, const struct named_facets *facets,
                             const int64_t *faces_at, bool *is_end, struct error *error)
{
    enum status status;
    int dim = cells->dim;
    struct member *members = NULL;
    int64_t *of_group = NULL;
    TRY(NEW_ARRAY(&members, facets->count, error));
    TRY(NEW_ARRAY(&of_group, cells->node_count, error));
    for (int64_t f = 0; f < facets->count; f++) {
        members[f] = (struct member){facets->set[f], facets->facet + f * dim};
    }
    qsort(members, (size_t)facets->count, sizeof *members, compare_members);
    for (int64_t first = 0, end; first < facets->count; first = end) {
        for (end = first; end < facets->count && members[end].set == members[first].set; end++) {
            for (int k = 0; k < dim; k++) {
                of_group[members[end].facet[k]]++;
            }
        }
        for (int64_t i = first * dim; i < end * dim; i++) {
            int32_t node = members[i / dim].facet[i % dim];
            is_end[node] = is_end[node] || (of_group[node] > 0 && of_group[node] < faces_at[node]);
        }
        for (int64_t i = first * dim; i < end * dim; i++) {
            of_group[members[i / dim].facet[i % dim]] = 0;
        }
    }
done:
    free(members);
    free(of_group);
    return status;
}

/* kind[node_count]: of the ends, BESIDE_CORNER or BESIDE_END. The unit normals of two faces 45 degrees apart
 * have a mean of length cos 22.5. */
static enum status tell_corners(const struct cells *cells, const struct faces *faces, const int64_t *faces_at,
                                const bool *is_end, enum beside *kind, struct error *error)
{
    enum status status;
    int dim = cells->dim;
    double *normal = NULL;
    TRY(NEW_ARRAY(&normal, cells->node_count * 3, error));
    for (int64_t f = 0; f < faces->count; f++) {
        double area[3] = {0.0, 0.0, 0.0};
        const int32_t *v = faces->node + f * dim;
        face_area_vector(dim, cells->x, v, area);
        double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        for (int i = 0; i < dim * 3; i++) {
            normal[(int64_t)v[i / 3] * 3 + i % 3] += area[i % 3] / size;
        }
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        const double *sum = normal + 3 * n;
        double mean = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (double)faces_at[n];
        kind[n] = !is_end[n] ? BESIDE_NOTHING : mean < 0.924 ? BESIDE_CORNER : BESIDE_END;
    }
done:
    free(normal);
    return status;
}

static enum status check_facets(const struct cells *cells, const struct named_facets *facets,
                                struct error *error)
{
    for (int64_t i = 0; i < facets->count * cells->dim; i++) {
        if (facets->facet[i] < 0 || facets->facet[i] >= cells->node_count ||
            facets->set[i / cells->dim] < 0) {
            return fail(error, STATUS_INPUT, "facets: row %lld: no facet of a group",
                        (long long)(i / cells->dim));
        }
    }
    return STATUS_OK;
}

/* From the ends, kind[node_count], to the other nodes of their cells. */
static void tell_neighbours(const struct cells *cells, const enum beside *kind, enum beside *beside)
{
    int corners = cells->dim + 1;
    for (int64_t n = 0; n < cells->node_count; n++) {
        beside[n] = BESIDE_NOTHING;
    }
    for (int64_t c = 0; c < cells->count; c++) {
        const int32_t *v = cells->node + c * corners;
        enum beside most = BESIDE_NOTHING;
        for (int k = 0; k < corners; k++) {
            most = kind[v[k]] > most ? kind[v[k]] : most;
        }
        for (int k = 0; k < corners; k++) {
            beside[v[k]] = kind[v[k]] == BESIDE_NOTHING && most > beside[v[k]] ? most : beside[v[k]];
        }
    }
}

enum status cells_beside_ends(const struct cells *cells, const struct named_facets *facets,
                              enum beside *beside, struct error *error)
{
    enum status status;
    struct faces faces = {0};
    int64_t *faces_at = NULL;
    bool *is_end = NULL;
    enum beside *kind = NULL; /* of the ends */
    TRY(NEW_ARRAY(&faces_at, cells->node_count, error));
    TRY(NEW_ARRAY(&is_end, cells->node_count, error));
    TRY(NEW_ARRAY(&kind, cells->node_count, error));
    TRY(check_facets(cells, facets, error));
    TRY(faces_build(cells, true, &faces, error));
    for (int64_t i = 0; i < faces.count * cells->dim; i++) {
        faces_at[faces.node[i]]++;
    }
    TRY(mark_ends(cells, facets, faces_at, is_end, error));
    TRY(tell_corners(cells, &faces, faces_at, is_end, kind, error));
    tell_neighbours(cells, kind, beside);
done:
    faces_free(&faces);
    free(faces_at);
    free(is_end);
    free(kind);
    return status;
}
