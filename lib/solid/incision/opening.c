/* Opening the faces on the blade: nodes doubled, faces of the cut; see incision.h. */
#include "solid/incision/incision_private.h"

#include "base/sets.h"

#include <stdlib.h>
#include <string.h>

/* Whether face i, with the next one, is opened: it is within the border, not all on it. */
static bool is_opened(const struct cut *cut, const struct near_faces *faces, int64_t i)
{
    bool within = false;
    for (int k = 0; k < cut->body->dim; k++) {
        double extent = cut->value[LEVEL_EXTENT][faces->keyed[i].key[k]];
        if (!(extent <= 0.0)) {
            return false;
        }
        within = within || extent < 0.0;
    }
    return within && cut_parts(cut, faces, i);
}

struct opening {
    struct cut *cut;
    const struct near_faces *faces;
    int8_t
        *opened; /* faces->count: the side, 1 or -1, of the cell of a face that is opened with the next one */
    bool *touched; /* node_count: node of an opened face */
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
    const struct near_faces *faces = opening->faces;
    const struct division *body = opening->cut->body;
    RETURN_IF_ERROR(NEW_ARRAY(&opening->opened, faces->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opening->touched, body->node_count, error));
    for (int64_t i = 0, end; i < faces->count; i = end) {
        end = keyed_end(faces->count, faces->keyed, i);
        if (end - i != 2 || !is_opened(opening->cut, faces, i)) {
            continue;
        }
        opening->opened[i] = (int8_t)cut_side(opening->cut, faces->keyed[i].item / (body->dim + 1));
        ++*count;
        for (int k = 0; k < body->dim; k++) {
            opening->touched[faces->keyed[i].key[k]] = true;
        }
    }
    return STATUS_OK;
}

/* Join the corners of touched nodes across the faces that are not opened. */
static enum status join_corners(struct opening *opening, struct error *error)
{
    const struct near_faces *faces = opening->faces;
    const struct division *body = opening->cut->body;
    int64_t corners = body->cell_count * (body->dim + 1);
    if (corners > INT32_MAX) {
        return fail(error, STATUS_INPUT, "more than %d corners of cells", INT32_MAX);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&opening->first, corners, error));
    for (int64_t i = 0; i < corners; i++) {
        opening->first[i] = (int32_t)i;
    }
    for (int64_t i = 0, end; i < faces->count; i = end) {
        end = keyed_end(faces->count, faces->keyed, i);
        for (int k = 0; k < body->dim && end - i == 2 && opening->opened[i] == 0; k++) {
            int32_t node = faces->keyed[i].key[k];
            if (opening->touched[node]) {
                set_join(opening->first, corner_at(body, faces->keyed[i].item / (body->dim + 1), node),
                         corner_at(body, faces->keyed[i + 1].item / (body->dim + 1), node));
            }
        }
    }
    return STATUS_OK;
}

/* A facet at touched nodes, and the corner opposite it. */
struct carried {
    int64_t facet, corner;
};

/* Find the cells of the facets with touched nodes. */
static enum status list_carried(const struct opening *opening, struct carried **carried, int64_t *count,
                                struct error *error)
{
    const struct division *body = opening->cut->body;
    int64_t room = 0;
    for (int64_t f = 0; f < body->facet_count; f++) {
        bool touched = false;
        int32_t key[3];
        for (int k = 0; k < body->dim; k++) {
            touched = touched || opening->touched[body->facet[f * body->dim + k]];
        }
        face_key(body->dim, body->facet + f * body->dim, key);
        int64_t found = touched ? keyed_find(opening->faces->count, opening->faces->keyed, key) : -1;
        if (found >= 0) {
            RETURN_IF_ERROR(GROW_ARRAY(carried, *count + 1, &room, error));
            (*carried)[(*count)++] = (struct carried){f, opening->faces->keyed[found].item};
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

/* Facet f: the face opposite a corner, whose cell may have got other nodes, in the order that the facet had.
 */
static void carry_facet(struct division *body, const struct carried *carried)
{
    int dim = body->dim;
    int64_t cell = carried->corner / (dim + 1);
    for (int k = 0; k < dim; k++) {
        int32_t *node = &body->facet[carried->facet * dim + k];
        for (int c = 0; c <= dim; c++) {
            int32_t other = body->node[cell * (dim + 1) + c];
            const int32_t *parent = &body->parent[2 * (int64_t)other];
            if (other == *node || (parent[0] == *node && parent[1] == *node)) {
                *node = other;
                break;
            }
        }
    }
}

static enum status add_lips(struct opening *opening, int32_t front, int32_t back, struct error *error)
{
    struct division *body = opening->cut->body;
    int corners = body->dim + 1;
    for (int64_t i = 0; i < opening->faces->count; i++) {
        for (int k = 0; k < 2 && opening->opened[i] != 0; k++) {
            int64_t item = opening->faces->keyed[i + k].item, cell = item / corners;
            int32_t face[3];
            simplex_face(body->dim, body->node + cell * corners, (int)(item % corners), face);
            bool in_front = (opening->opened[i] > 0) == (k == 0);
            RETURN_IF_ERROR(division_add_facet(body, face, in_front ? front : back, error));
        }
    }
    return STATUS_OK;
}

enum status cut_open(struct cut *cut, const struct near_faces *faces, int32_t front, int32_t back,
                     int64_t *count, struct error *error)
{
    FREED_BY(opening_free) struct opening opening = {.cut = cut, .faces = faces};
    SCRATCH struct carried *carried = NULL;
    int64_t carried_count = 0;
    *count = 0;
    RETURN_IF_ERROR(mark_opened(&opening, count, error));
    RETURN_IF_ERROR(join_corners(&opening, error));
    RETURN_IF_ERROR(list_carried(&opening, &carried, &carried_count, error));
    RETURN_IF_ERROR(double_nodes(&opening, error));
    for (int64_t i = 0; i < carried_count; i++) {
        carry_facet(cut->body, &carried[i]);
    }
    return add_lips(&opening, front, back, error);
}
