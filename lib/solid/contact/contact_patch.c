#include "solid/contact/contact_patch.h"

#include "approx/field/field.h"
#include "base/memory.h"

#include <math.h>

struct marks {
    double *force;    /* node_count: contact force of the node, N */
    bool *presses;    /* node_count: one of its contact nodes presses */
    bool *surrounded; /* node_count: it presses, and so do all its neighbours */
    bool *near;       /* node_count: it presses, and it or a neighbour of it is surrounded */
};

static void mark_nodes(int dim, const struct facet_set *set, int64_t node_count, struct marks *marks)
{
    for (int64_t n = 0; n < node_count; n++) {
        marks->near[n] = marks->surrounded[n] = marks->presses[n];
    }
    for (int64_t f = 0; f < set->count; f++) {
        const int32_t *node = set->facet + f * dim;
        bool all = true;
        for (int k = 0; k < dim; k++) {
            all = all && marks->presses[node[k]];
        }
        for (int k = 0; k < dim && !all; k++) {
            marks->surrounded[node[k]] = marks->near[node[k]] = false;
        }
    }
    for (int64_t f = 0; f < set->count; f++) {
        const int32_t *node = set->facet + f * dim;
        bool any = false;
        for (int k = 0; k < dim; k++) {
            any = any || marks->surrounded[node[k]];
        }
        for (int k = 0; k < dim && any; k++) {
            marks->near[node[k]] = true; /* all nodes of this facet press, and one is surrounded */
        }
    }
}

/* The vertex of the surface that lies in a cell of the body, farthest from the contact's facets. */
static enum status find_inside(const struct contact *contact, const struct facet_set *set,
                               const struct cells *cells, struct contact_patch *patch, struct error *error)
{
    int dim = contact->dim;
    int64_t count = contact->surface.vertex_count;
    FREED_BY(rigid_free) struct rigid_surface facets = {0};
    NEW_SCRATCH(double, place, count * dim, error);
    NEW_SCRATCH(bool, outside, count, error);
    for (int64_t v = 0; v < count; v++) {
        rigid_place_from_rest(&contact->place, dim, contact->surface.vertex + v * dim, place + v * dim);
    }
    NEW_SCRATCH(double, spacing, cells->node_count, error);
    RETURN_IF_ERROR(field_spacing(cells, spacing, error));
    RETURN_IF_ERROR(field_outside(cells, spacing, 0.0, count, place, outside, error));
    NEW_SCRATCH(double, corners, set->count * dim * dim, error);
    for (int64_t i = 0; i < set->count * dim; i++) {
        for (int a = 0; a < dim; a++) {
            corners[i * dim + a] = cells->x[(int64_t)set->facet[i] * dim + a];
        }
    }
    RETURN_IF_ERROR(rigid_build(dim, set->count, corners, false, &facets, error));
    for (int64_t v = 0; v < count; v++) {
        double depth = outside[v] ? 0.0 : rigid_closest(&facets, place + v * dim, INFINITY).distance;
        if (depth > patch->inside) {
            patch->inside = depth;
            for (int a = 0; a < dim; a++) {
                patch->place[a] = place[v * dim + a];
            }
        }
    }
    return STATUS_OK;
}

enum status contact_patch_find(const struct contact *contact, const struct facet_set *set,
                               const struct cells *cells, struct contact_patch *patch, struct error *error)
{
    enum status status;
    int64_t node_count = cells->node_count;
    struct marks marks = {0};
    const struct boundary_averages *nodes = contact_nodes(contact);
    double resolved = 0.0, largest = 0.0, area = 0.0;
    *patch = (struct contact_patch){.node = -1};
    TRY(NEW_ARRAY(&marks.force, node_count, error));
    TRY(NEW_ARRAY(&marks.presses, node_count, error));
    TRY(NEW_ARRAY(&marks.surrounded, node_count, error));
    TRY(NEW_ARRAY(&marks.near, node_count, error));
    for (int64_t a = 0; a < nodes->count; a++) {
        struct contact_node node = contact_node(contact, a);
        marks.force[nodes->node[a]] += node.pressure * nodes->area[a];
        marks.presses[nodes->node[a]] |= node.pressed > 0.5;
        area += nodes->area[a];
    }
    area /= (double)nodes->count;
    patch->width = contact->dim == 2 ? area : sqrt(area);
    mark_nodes(contact->dim, set, node_count, &marks);
    for (int64_t n = 0; n < node_count; n++) {
        patch->pressing += marks.presses[n];
        patch->force += marks.force[n];
        resolved += marks.near[n] ? marks.force[n] : 0.0;
        if (!marks.near[n] && marks.force[n] > largest) {
            largest = marks.force[n];
            patch->node = (int32_t)n;
        }
    }
    if (patch->force > 0.0) {
        patch->thin = 1.0 - resolved / patch->force;
    } else if (contact->between == NULL) {
        status = find_inside(contact, set, cells, patch, error);
    }
done:
    FREE_ALL(marks.force, marks.presses, marks.surrounded, marks.near);
    return status;
}
