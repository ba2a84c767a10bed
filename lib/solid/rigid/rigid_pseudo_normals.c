/* Where the facets of a rigid surface meet: normals at vertices and edges, and rims. */
#include "base/lists.h"
#include "base/memory.h"
#include "solid/rigid/rigid_private.h"

#include <stdlib.h>
#include <string.h>

/* The error of two facets that meet and traverse their common edge (2D: node) in the same direction. */
static enum status fail_sides(int64_t one, int64_t other, struct error *error)
{
    return fail(error, STATUS_INPUT,
                "rigid surface: facets %lld and %lld meet but disagree on the side: turn one around",
                (long long)(one + 1), (long long)(other + 1));
}

/* The error of a repeated facet: it would have twice the weight in normals, and hide rims. */
static enum status fail_twice(int64_t one, int64_t other, struct error *error)
{
    return fail(error, STATUS_INPUT, "rigid surface: facets %lld and %lld are the same: remove one",
                (long long)(one + 1), (long long)(other + 1));
}

/* 2D: check that no segment is repeated. */
static enum status check_segments(const struct rigid_surface *surface, struct error *error)
{
    SCRATCH struct placed *segments = NULL; /* each by its two vertices as one number */
    RETURN_IF_ERROR(NEW_ARRAY(&segments, surface->facet_count, error));
    for (int64_t f = 0; f < surface->facet_count; f++) {
        int64_t first = surface->facet[2 * f], second = surface->facet[2 * f + 1];
        segments[f] = (struct placed){(double)(first * surface->vertex_count + second), f};
    }
    qsort(segments, (size_t)surface->facet_count, sizeof *segments, compare_placed);
    for (int64_t i = 1; i < surface->facet_count; i++) {
        if (!(segments[i].place > segments[i - 1].place)) {
            return fail_twice(segments[i - 1].item, segments[i].item, error);
        }
    }
    return STATUS_OK;
}

/* 2D: normals and rims at the vertices. */
static enum status join_segments(struct rigid_surface *surface, struct error *error)
{
    SCRATCH struct meeting {
        int64_t count, last;
        int turn; /* segments that end here less those that begin here */
    } *meetings = NULL;
    RETURN_IF_ERROR(check_segments(surface, error));
    RETURN_IF_ERROR(NEW_ARRAY(&meetings, surface->vertex_count, error));
    for (int64_t f = 0; f < surface->facet_count; f++) {
        for (int k = 0; k < 2; k++) {
            int32_t v = surface->facet[2 * f + k];
            add_scaled(2, 1.0, surface->normal + 2 * f, surface->vertex_normal + 2 * (int64_t)v);
            meetings[v].count++;
            meetings[v].turn += k == 0 ? -1 : 1;
            if (meetings[v].count == 2 && meetings[v].turn != 0) {
                return fail_sides(meetings[v].last, f, error);
            }
            meetings[v].last = f;
        }
    }
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        surface->is_rim[v] = meetings[v].count == 1;
    }
    return STATUS_OK;
}

static int compare_edges(const void *left, const void *right)
{
    const struct half_edge *a = left, *b = right;
    if (a->low != b->low) {
        return a->low < b->low ? -1 : 1;
    }
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    if (a->opposite != b->opposite) {
        return a->opposite < b->opposite ? -1 : 1;
    }
    if (a->upward != b->upward) {
        return b->upward ? -1 : 1;
    }
    return (a->slot > b->slot) - (a->slot < b->slot);
}

void rigid_list_edges(const struct rigid_surface *surface, struct half_edge *edges)
{
    int64_t count = surface->facet_count * 3;
    for (int64_t slot = 0; slot < count; slot++) {
        int32_t from = surface->facet[slot], to = surface->facet[slot / 3 * 3 + (slot + 1) % 3];
        bool upward = from < to;
        edges[slot] = (struct half_edge){.low = upward ? from : to,
                                         .high = upward ? to : from,
                                         .opposite = surface->facet[slot / 3 * 3 + (slot + 2) % 3],
                                         .upward = upward,
                                         .slot = slot};
    }
    qsort(edges, (size_t)count, sizeof *edges, compare_edges);
}

int64_t rigid_edge_end(const struct half_edge *edges, int64_t first, int64_t count)
{
    int64_t end = first + 1;
    while (end < count && edges[end].low == edges[first].low && edges[end].high == edges[first].high) {
        end++;
    }
    return end;
}

/* 3D: normals and rims of the `count` half-edges that lie on one edge. */
static enum status join_edge(struct rigid_surface *surface, const struct half_edge *edges, int64_t count,
                             struct error *error)
{
    double normal[3] = {0.0, 0.0, 0.0};
    for (int64_t i = 1; i < count; i++) {
        if (edges[i].opposite == edges[i - 1].opposite && edges[i].upward == edges[i - 1].upward) {
            return fail_twice(edges[i - 1].slot / 3, edges[i].slot / 3, error);
        }
    }
    if (count == 2 && edges[0].upward == edges[1].upward) {
        int64_t one = edges[0].slot / 3, other = edges[1].slot / 3;
        return fail_sides(one < other ? one : other, one < other ? other : one, error);
    }
    for (int64_t i = 0; i < count; i++) {
        add_scaled(3, 1.0, surface->normal + edges[i].slot / 3 * 3, normal);
    }
    vector_normalise(3, normal);
    for (int64_t i = 0; i < count; i++) {
        memcpy(surface->edge_normal + edges[i].slot * 3, normal, sizeof normal);
        surface->edge_is_rim[edges[i].slot] = count == 1;
    }
    if (count == 1) {
        surface->is_rim[edges[0].low] = true;
        surface->is_rim[edges[0].high] = true;
    }
    return STATUS_OK;
}

static enum status join_edges(struct rigid_surface *surface, struct error *error)
{
    int64_t count = surface->facet_count * 3;
    SCRATCH struct half_edge *edges = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&edges, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->edge_normal, count * 3, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->edge_is_rim, count, error));
    rigid_list_edges(surface, edges);
    for (int64_t first = 0, last; first < count; first = last) {
        last = rigid_edge_end(edges, first, count);
        RETURN_IF_ERROR(join_edge(surface, edges + first, last - first, error));
    }
    return STATUS_OK;
}

/* 3D: the angle of facet f at its corner k. */
static double corner_angle(const struct rigid_surface *surface, int64_t f, int k)
{
    const int32_t *corner = surface->facet + f * 3;
    const double *x = surface->vertex + (int64_t)corner[k] * 3;
    const double *next = surface->vertex + (int64_t)corner[(k + 1) % 3] * 3;
    const double *previous = surface->vertex + (int64_t)corner[(k + 2) % 3] * 3;
    double one[3], other[3];
    vector_subtract(3, next, x, one);
    vector_subtract(3, previous, x, other);
    double lengths = sqrt(vector_dot(3, one, one) * vector_dot(3, other, other));
    return acos(fmin(fmax(vector_dot(3, one, other) / lengths, -1.0), 1.0));
}

enum status rigid_make_pseudo_normals(struct rigid_surface *surface, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&surface->vertex_normal, surface->vertex_count * surface->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->is_rim, surface->vertex_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->turn, surface->vertex_count, error));
    if (surface->dim == 2) {
        RETURN_IF_ERROR(join_segments(surface, error));
    } else {
        RETURN_IF_ERROR(join_edges(surface, error));
        for (int64_t slot = 0; slot < surface->facet_count * 3; slot++) {
            add_scaled(3, corner_angle(surface, slot / 3, (int)(slot % 3)), surface->normal + slot / 3 * 3,
                       surface->vertex_normal + (int64_t)surface->facet[slot] * 3);
        }
    }
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        vector_normalise(surface->dim, surface->vertex_normal + v * surface->dim);
    }
    for (int64_t c = 0; c < surface->facet_count * surface->dim; c++) {
        int64_t vertex = surface->facet[c];
        const double *mean = surface->vertex_normal + vertex * surface->dim;
        const double *normal = surface->normal + c / surface->dim * surface->dim;
        double half = 0.5 * vector_distance(surface->dim, mean, normal);
        surface->turn[vertex] = fmax(surface->turn[vertex], 2.0 * asin(fmin(half, 1.0)));
    }
    return STATUS_OK;
}
