/* Opening the faces on the blade: nodes doubled, faces of the cut; see incision.h. */
#include "solid/incision/incision_private.h"

#include "base/sets.h"

/* Whether face i, with the next one, is opened: it is within the border, not all on it. */
static bool is_opened(const struct cut *cut, int64_t i)
{
    bool within = false;
    for (int k = 0; k < cut->body->dim; k++) {
        double extent = cut->value[LEVEL_EXTENT][cut->face[i].key[k]];
        if (!(extent <= 0.0)) {
            return false;
        }
        within = within || extent < 0.0;
    }
    return within && cut_parts(cut, i);
}

struct opening {
    struct cut *cut;
    int8_t *opened; /* cut->face_count: the side, 1 or -1, of the cell of a face that is opened with the next
                       one */
    bool *touched;  /* node_count: node of an opened face */
    int32_t
        *first; /* of each corner, cell * (dim + 1) + k: the first of its node's that stay connected to it */
};

static void opening_free(struct opening *opening)
{
    FREE_ALL(opening->opened, opening->touched, opening->first);
}

static int32_t corner_at(const struct division *body, int64_t cell, int32_t node)
{
    int corners = body->dim + 1, k = 0;
    while (k < corners - 1 && body->node[cell * corners + k] != node) {
        k++;
    }
    return (int32_t)(cell * corners + k);
}

static enum status mark_opened(struct opening *opening, int64_t *count, struct error *error)
{
    const struct cut *cut = opening->cut;
    const struct division *body = cut->body;
    RETURN_IF_ERROR(NEW_ARRAY(&opening->opened, cut->face_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opening->touched, body->node_count, error));
    for (int64_t i = 0, end; i < cut->face_count; i = end) {
        end = keyed_end(cut->face_count, cut->face, i);
        if (end - i != 2 || !is_opened(cut, i)) {
            continue;
        }
        opening->opened[i] = (int8_t)cut_side(cut, cut->face[i].item / (body->dim + 1));
        ++*count;
        for (int k = 0; k < body->dim; k++) {
            opening->touched[cut->face[i].key[k]] = true;
        }
    }
    return STATUS_OK;
}

/* Join the corners of touched nodes across the faces that are not opened. */
static enum status join_corners(struct opening *opening, struct error *error)
{
    const struct cut *cut = opening->cut;
    const struct division *body = cut->body;
    int64_t corners = body->cell_count * (body->dim + 1);
    if (corners > INT32_MAX) {
        return fail(error, STATUS_INPUT, "more than %d corners of cells", INT32_MAX);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&opening->first, corners, error));
    for (int64_t i = 0; i < corners; i++) {
        opening->first[i] = (int32_t)i;
    }
    for (int64_t i = 0, end; i < cut->face_count; i = end) {
        end = keyed_end(cut->face_count, cut->face, i);
        for (int k = 0; k < body->dim && end - i == 2 && opening->opened[i] == 0; k++) {
            int32_t node = cut->face[i].key[k];
            if (opening->touched[node]) {
                set_join(opening->first, corner_at(body, cut->face[i].item / (body->dim + 1), node),
                         corner_at(body, cut->face[i + 1].item / (body->dim + 1), node));
            }
        }
    }
    return STATUS_OK;
}

/* Give the corners of each touched node that are not connected to its first one copies of it. */
static enum status double_nodes(struct opening *opening, struct error *error)
{
    struct division *body = opening->cut->body;
    int64_t corners = body->cell_count * (body->dim + 1), before = body->node_count;
    NEW_SCRATCH(bool, met, before, error);
    NEW_SCRATCH(int32_t, own, corners, error); /* the node of the first corner of each set */
    for (int64_t i = 0; i < corners; i++) {
        int32_t node = body->node[i], first;
        if (!opening->touched[node]) {
            continue;
        }
        first = set_first(opening->first, (int32_t)i);
        if (first == i) {
            own[i] = node;
            if (met[node]) {
                RETURN_IF_ERROR(division_double(body, node, &own[i], error));
            }
            met[node] = true;
        }
    }
    for (int64_t i = 0; i < corners; i++) {
        if (opening->touched[body->node[i]]) {
            body->node[i] = own[set_first(opening->first, (int32_t)i)];
        }
    }
    return STATUS_OK;
}

/* Give the facets with touched nodes the nodes that their cells have got, in the order that they had. */
static void carry_facets(struct opening *opening)
{
    const struct cut *cut = opening->cut;
    struct division *body = cut->body;
    int dim = body->dim;
    for (int64_t f = 0; f < body->facet_count; f++) {
        int32_t key[3], *node = body->facet + f * dim;
        face_key(dim, node, key);
        bool touched = opening->touched[key[0]] || opening->touched[key[1]] || opening->touched[key[dim - 1]];
        int64_t found = touched ? keyed_find(cut->face_count, cut->face, key) : -1;
        const int32_t *cell =
            found >= 0 ? body->node + cut->face[found].item / (dim + 1) * (dim + 1) : body->node;
        for (int i = 0; i < dim * (dim + 1) && found >= 0; i++) {
            int32_t other = cell[i % (dim + 1)];
            const int32_t *parent = &body->parent[2 * (int64_t)other];
            if (parent[0] == node[i / (dim + 1)] && parent[1] == parent[0]) {
                node[i / (dim + 1)] = other;
            }
        }
    }
}

static enum status add_lips(struct opening *opening, int32_t front, int32_t back, struct error *error)
{
    const struct cut *cut = opening->cut;
    struct division *body = cut->body;
    int corners = body->dim + 1;
    for (int64_t i = 0; i < cut->face_count; i++) {
        for (int k = 0; k < 2 && opening->opened[i] != 0; k++) {
            int64_t item = cut->face[i + k].item, cell = item / corners;
            int32_t face[3];
            simplex_face(body->dim, body->node + cell * corners, (int)(item % corners), face);
            bool in_front = (opening->opened[i] > 0) == (k == 0);
            RETURN_IF_ERROR(division_add_facet(body, face, in_front ? front : back, error));
        }
    }
    return STATUS_OK;
}

enum status cut_open(struct cut *cut, int32_t front, int32_t back, int64_t *count, struct error *error)
{
    FREED_BY(opening_free) struct opening opening = {.cut = cut};
    *count = 0;
    RETURN_IF_ERROR(mark_opened(&opening, count, error));
    RETURN_IF_ERROR(join_corners(&opening, error));
    RETURN_IF_ERROR(double_nodes(&opening, error));
    carry_facets(&opening);
    return add_lips(&opening, front, back, error);
}
