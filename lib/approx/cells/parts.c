#include "approx/cells/parts.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/sets.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Number the sets of parent[] by decreasing size: part[item] = the number of the item's set. */
static enum status number_parts(int64_t items, int32_t parent[], const double size[], int32_t *part,
                                int32_t *count, struct error *error)
{
    SCRATCH struct placed *parts = NULL; /* by the negative of their size */
    SCRATCH int32_t *place = NULL; /* of the first item of a set: its place in parts[], then its number */
    *count = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&parts, items, error));
    RETURN_IF_ERROR(NEW_ARRAY(&place, items, error));
    for (int64_t i = 0; i < items; i++) {
        int32_t root = set_first(parent, (int32_t)i);
        if (root == i) {
            place[i] = *count;
            parts[(*count)++].item = root;
        }
        parts[place[root]].place -= size[i];
    }
    qsort(parts, (size_t)*count, sizeof *parts, compare_placed);
    for (int32_t p = 0; p < *count; p++) {
        place[parts[p].item] = p;
    }
    for (int64_t i = 0; i < items; i++) {
        part[i] = place[set_first(parent, (int32_t)i)];
    }
    return STATUS_OK;
}

static enum status parts_begin(int64_t items, int32_t **parent, double **size, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(parent, items, error));
    RETURN_IF_ERROR(NEW_ARRAY(size, items, error));
    for (int64_t i = 0; i < items; i++) {
        (*parent)[i] = (int32_t)i;
    }
    return STATUS_OK;
}

enum status cells_parts(const struct cells *cells, int32_t *part, int32_t *count, struct error *error)
{
    int corners = cells->dim + 1;
    SCRATCH int32_t *parent = NULL;
    SCRATCH double *volume = NULL;
    NEW_SCRATCH(int32_t, across, cells->count * corners, error);
    RETURN_IF_ERROR(parts_begin(cells->count, &parent, &volume, error));
    RETURN_IF_ERROR(cells_across(cells, across, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        if (across[i] >= 0) {
            set_join(parent, (int32_t)(i / corners), across[i]);
        }
    }
    for (int64_t c = 0; c < cells->count; c++) {
        volume[c] = cell_volume(cells, c);
    }
    return number_parts(cells->count, parent, volume, part, count, error);
}

enum status nodes_parts(const struct cells *cells, const int32_t *of_cell, int32_t *part, struct error *error)
{
    int corners = cells->dim + 1;
    NEW_SCRATCH(bool, seen, cells->node_count, error);
    memset(part, -1, (size_t)cells->node_count * sizeof *part);
    for (int64_t i = 0; i < cells->count * corners; i++) {
        int32_t node = cells->node[i], here = of_cell[i / corners];
        part[node] = !seen[node] || part[node] == here ? here : -1;
        seen[node] = true;
    }
    return STATUS_OK;
}

/* ---- sides ---- */

static int compare_ridges(const void *left, const void *right)
{
    const struct ridge *a = left, *b = right;
    int order = compare_numbers(2, a->node, b->node);
    return order != 0 ? order : (a->facet > b->facet) - (a->facet < b->facet);
}

void ridges_list(int dim, int64_t count, const int32_t *node, struct ridge *ridge)
{
    for (int64_t i = 0; i < count * dim; i++) {
        const int32_t *of = node + i / dim * dim;
        int k = (int)(i % dim);
        int32_t a = of[(k + 1) % dim], b = dim == 3 ? of[(k + 2) % dim] : -1;
        bool turned = b >= 0 && b < a;
        ridge[i] = (struct ridge){.node = {turned ? b : a, turned ? a : b},
                                  .facet = (int32_t)(i / dim),
                                  .opposite = of[k],
                                  .corner = (int8_t)k,
                                  .upward = dim == 2 ? k == 0 : !turned};
    }
    qsort(ridge, (size_t)(count * dim), sizeof *ridge, compare_ridges);
}

int64_t ridges_end(int64_t count, const struct ridge *ridge, int64_t first)
{
    int64_t end = first + 1;
    while (end < count && compare_numbers(2, ridge[end].node, ridge[first].node) == 0) {
        end++;
    }
    return end;
}

enum status boundary_sides(const double *x, const struct faces *boundary, double degrees, int32_t *part,
                           int32_t *count, struct error *error)
{
    int dim = boundary->dim;
    int64_t ridge_count = boundary->count * dim;
    double least = cos(degrees * acos(-1) / 180) - 1e-12;
    SCRATCH int32_t *parent = NULL;
    SCRATCH double *area = NULL;
    RETURN_IF_ERROR(parts_begin(boundary->count, &parent, &area, error));
    NEW_SCRATCH(double, normal, boundary->count * dim, error);
    NEW_SCRATCH(struct ridge, ridges, ridge_count, error);
    for (int64_t f = 0; f < boundary->count; f++) {
        face_area_vector(dim, x, &boundary->node[f * dim], &normal[f * dim]);
        area[f] = vector_length(dim, normal + f * dim);
    }
    ridges_list(dim, boundary->count, boundary->node, ridges);
    for (int64_t first = 0, end; first < ridge_count; first = end) {
        end = ridges_end(ridge_count, ridges, first);
        int32_t a = ridges[first].facet;
        int32_t b = ridges[end - 1].facet;
        double product = vector_dot(dim, normal + (int64_t)a * dim, normal + (int64_t)b * dim);
        if (end - first == 2 && product / (area[a] * area[b]) >= least) {
            set_join(parent, a, b);
        }
    }
    return number_parts(boundary->count, parent, area, part, count, error);
}

/* ---- rings ---- */

/* node_chosen[] = the nodes of chosen items. */
static void mark_nodes(int64_t count, int corners, const int32_t *item, const bool *chosen, bool *node_chosen)
{
    for (int64_t i = 0; i < count; i++) {
        for (int k = 0; k < corners && chosen[i]; k++) {
            node_chosen[item[i * corners + k]] = true;
        }
    }
}

/* chosen[] = items with a chosen node. */
static void mark_items(int64_t count, int corners, const int32_t *item, const bool *node_chosen, bool *chosen)
{
    for (int64_t i = 0; i < count; i++) {
        for (int k = 0; k < corners; k++) {
            chosen[i] = chosen[i] || node_chosen[item[i * corners + k]];
        }
    }
}

/* To shrink a selection is to grow its complement. */
static void invert(int64_t count, bool *chosen)
{
    for (int64_t i = 0; i < count; i++) {
        chosen[i] = !chosen[i];
    }
}

/* Extend the selection alternately from items to their nodes and from nodes to their items, starting with
 * either. */
enum status choice_grow(int64_t count, int corners, const int32_t *item, int64_t node_count,
                        int64_t edge_count, const int32_t *edge, int rings, bool of_items, bool *chosen,
                        struct error *error)
{
    NEW_SCRATCH(bool, other, of_items ? node_count : count, error);
    bool *items = of_items ? chosen : other, *nodes = of_items ? other : chosen;
    if (rings < 0) {
        invert(of_items ? count : node_count, chosen);
    }
    for (int step = 0; step < 2 * abs(rings); step++) {
        if ((step % 2 == 0) == of_items) {
            mark_nodes(count, corners, item, items, nodes);
            for (int64_t i = 0; i < edge_count && rings < 0; i++) {
                nodes[edge[i]] = true;
            }
        } else {
            mark_items(count, corners, item, nodes, items);
        }
    }
    if (rings < 0) {
        invert(of_items ? count : node_count, chosen);
    }
    return STATUS_OK;
}
