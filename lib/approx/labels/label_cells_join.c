/* Places where parts of the body share only a node or an edge. */
#include "approx/labels/label_cells_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Number the groups of cells at a node that are connected by faces at it; returns the number of groups. */
static int32_t find_groups(struct label_body *body, int64_t node)
{
    int32_t count = 0;
    for (int64_t i = body->star.ptr[node]; i < body->star.ptr[node + 1]; i++) {
        if (body->wanted[body->star.cell[i]] && body->group[body->star.cell[i]] < 0) {
            label_cells_flood(body, body->star.cell[i], count++, node);
        }
    }
    return count;
}

static void forget_groups(struct label_body *body, int64_t node)
{
    for (int64_t i = body->star.ptr[node]; i < body->star.ptr[node + 1]; i++) {
        body->group[body->star.cell[i]] = -1;
    }
}

static int32_t count_groups(struct label_body *body, int64_t node)
{
    int32_t count = find_groups(body, node);
    forget_groups(body, node);
    return count;
}

/* ---- joining ---- */

/* Cells that are added to the body or removed from it together, and their new labels. */
enum { CHANGE_MOST = 16 };
struct change {
    int count;
    int64_t cell[CHANGE_MOST];
    int32_t label[CHANGE_MOST];
};

/* The number of groups at the nodes of the cells minus one, summed over the nodes. */
static int64_t pinches_about(struct label_body *body, const struct change *change)
{
    int corners = body->mesh->dim + 1, seen = 0;
    int32_t node[4 * CHANGE_MOST];
    int64_t count = 0;
    for (int i = 0; i < change->count * corners; i++) {
        int known = 0;
        node[seen] = body->mesh->cell[change->cell[i / corners] * corners + i % corners];
        while (node[known] != node[seen]) {
            known++;
        }
        if (known == seen) {
            int32_t groups = count_groups(body, node[seen++]);
            count += groups > 1 ? groups - 1 : 0;
        }
    }
    return count;
}

static void turn(struct label_body *body, const struct change *change)
{
    for (int i = 0; i < change->count; i++) {
        body->wanted[change->cell[i]] = !body->wanted[change->cell[i]];
    }
}

/* Make a change if it leaves at least `fewer` parts less that are connected by single nodes only. */
static bool try_change(struct label_body *body, const struct change *change, int64_t fewer)
{
    int64_t before = pinches_about(body, change);
    turn(body, change);
    if (pinches_about(body, change) > before - fewer) {
        turn(body, change);
        return false;
    }
    for (int i = 0; i < change->count; i++) {
        body->mesh->label[change->cell[i]] = change->label[i];
    }
    return true;
}

/* The shortest row of cells between interfaces, each with a face at the node in common with the next, from a
 * cell of the first group at the node to another group; they take the label of that cell. */
static void find_link(struct label_body *body, int64_t node, struct change *change)
{
    int corners = body->mesh->dim + 1;
    int64_t first = 0, last = 0, found = -1;
    change->count = 0;
    find_groups(body, node);
    for (int64_t i = body->star.ptr[node]; i < body->star.ptr[node + 1]; i++) {
        if (body->group[body->star.cell[i]] == 0) {
            body->stack[last++] = body->star.cell[i];
            body->from[body->star.cell[i]] = -1;
        }
    }
    while (first < last && found < 0) {
        int32_t cell = body->stack[first++];
        for (int k = 0; k < corners && found < 0; k++) {
            int32_t next = body->across[(int64_t)cell * corners + k];
            if (body->mesh->cell[(int64_t)cell * corners + k] == node || next < 0) {
                continue;
            }
            if (body->group[next] > 0 && body->group[cell] < 0) {
                found = cell;
            } else if (!body->wanted[next] && body->between[next] && body->group[next] == -1) {
                body->group[next] = -2;
                body->from[next] = cell;
                body->stack[last++] = next;
            }
        }
    }
    for (; found >= 0 && body->from[found] >= 0; found = body->from[found]) {
        if (change->count == CHANGE_MOST) {
            change->count = 0;
            break;
        }
        change->cell[change->count++] = found;
    }
    int32_t label = found >= 0 ? body->mesh->label[found] : 0;
    for (int i = 0; i < change->count; i++) {
        change->label[i] = label;
    }
    forget_groups(body, node);
}

/* The label beyond a face of a cell at which the body ends; 0 if there is no such face. */
static int32_t label_beyond(const struct label_body *body, int64_t cell)
{
    for (int k = 0; k <= body->mesh->dim; k++) {
        int32_t next = body->across[cell * (body->mesh->dim + 1) + k];
        if (next >= 0 && !body->wanted[next]) {
            return body->mesh->label[next];
        }
    }
    return 0;
}

/* A group at the node all cells of which lie between interfaces; they take the label beyond. */
static void find_tip(struct label_body *body, int64_t node, int32_t group, struct change *change)
{
    change->count = 0;
    find_groups(body, node);
    for (int64_t i = body->star.ptr[node]; i < body->star.ptr[node + 1]; i++) {
        int32_t cell = body->star.cell[i];
        if (body->group[cell] != group) {
            continue;
        }
        if (!body->between[cell] || change->count == CHANGE_MOST) {
            change->count = 0;
            break;
        }
        change->label[change->count] = label_beyond(body, cell);
        change->cell[change->count++] = cell;
    }
    forget_groups(body, node);
}

/* Whether two faces of a cell between interfaces that is left out are walls of the body, at less than 60
 * degrees, the least angle of the lattice's own cells: the tip of a crevice. Under load the walls of sharper
 * ones pass through each other. It takes the label of one of them. */
static bool is_crevice(const struct label_body *body, int64_t cell, struct change *change)
{
    int dim = body->mesh->dim, corners = dim + 1, walls = 0;
    double gradient[4][3], length[4];
    if (body->wanted[cell] || !body->between[cell]) {
        return false;
    }
    for (int k = 0; k < corners; k++) {
        int32_t next = body->across[cell * corners + k];
        label_cells_gradient(body->mesh, cell, k, gradient[k]);
        double square = vector_dot(dim, gradient[k], gradient[k]);
        length[k] = next >= 0 && body->wanted[next] ? sqrt(square) : 0;
        if (length[k] > 0) {
            walls++;
            *change = (struct change){1, {cell}, {body->mesh->label[next]}};
        }
    }
    for (int k = 0; k < corners; k++) {
        for (int l = k + 1; l < corners && length[k] > 0; l++) {
            double dot = vector_dot(dim, gradient[k], gradient[l]);
            if (length[l] > 0 && -dot > SAME_DIRECTION * length[k] * length[l]) {
                return true;
            }
        }
    }
    return walls > dim - 1;
}

/* Fill the tips of crevices where this leaves no more parts that are connected by single nodes only. */
static bool fill_crevices(struct label_body *body)
{
    bool changed = false;
    for (int64_t c = 0; c < body->mesh->cell_count; c++) {
        struct change change;
        changed = (is_crevice(body, c, &change) && try_change(body, &change, 0)) || changed;
    }
    return changed;
}

/* Join the parts at a node, or leave out a part that is only a tip. */
static bool join_at(struct label_body *body, int64_t node)
{
    struct change change;
    int32_t count = count_groups(body, node);
    if (count < 2) {
        return false;
    }
    find_link(body, node, &change);
    if (try_change(body, &change, 1)) {
        return true;
    }
    for (int32_t g = 0; g < count; g++) {
        find_tip(body, node, g, &change);
        if (try_change(body, &change, 1)) {
            return true;
        }
    }
    return false;
}

void label_cells_join(struct label_body *body)
{
    /* This ends: a change at a node leaves fewer nodes at which parts share only a node or an edge, and a
     * filled crevice adds none. */
    for (bool changed = true; changed;) {
        changed = fill_crevices(body);
        for (int64_t n = 0; n < body->mesh->node_count; n++) {
            changed = join_at(body, n) || changed;
        }
    }
    for (int64_t n = 0; n < body->mesh->node_count; n++) {
        body->mesh->hinges += count_groups(body, n) > 1;
    }
}

/* ---- cutting apart ---- */

/* Room for nodes. */
struct room {
    int64_t x, apart;
};

/* Give the cells of a body at a node a node of their own at the same place. */
static enum status part_body(struct label_body *body, int64_t node, int32_t part, struct room *room,
                             struct error *error)
{
    struct label_cells *mesh = body->mesh;
    int dim = mesh->dim, corners = dim + 1;
    int64_t fresh = mesh->node_count++;
    RETURN_IF_ERROR(GROW_ARRAY(&mesh->x, (fresh + 1) * dim, &room->x, error));
    RETURN_IF_ERROR(GROW_ARRAY(&body->apart, fresh + 1, &room->apart, error));
    memcpy(mesh->x + fresh * dim, mesh->x + node * dim, (size_t)dim * sizeof(double));
    body->apart[node] = body->apart[fresh] = true;
    for (int64_t j = body->star.ptr[node]; j < body->star.ptr[node + 1]; j++) {
        int32_t *corner = mesh->cell + (int64_t)body->star.cell[j] * corners;
        for (int k = 0; k < corners && body->group[body->star.cell[j]] == part; k++) {
            corner[k] = corner[k] == node ? (int32_t)fresh : corner[k];
        }
    }
    return STATUS_OK;
}

enum status label_cells_cut_apart(struct label_body *body, struct error *error)
{
    struct label_cells *mesh = body->mesh;
    int64_t nodes = mesh->node_count;
    struct room room = {nodes * mesh->dim, nodes};
    RETURN_IF_ERROR(NEW_ARRAY(&body->apart, nodes, error));
    for (int64_t n = 0; n < nodes; n++) {
        int32_t first = -1;
        for (int64_t i = body->star.ptr[n]; i < body->star.ptr[n + 1]; i++) {
            int32_t part = body->group[body->star.cell[i]];
            bool at_node = false;
            for (int k = 0; k <= mesh->dim; k++) {
                at_node = at_node || mesh->cell[(int64_t)body->star.cell[i] * (mesh->dim + 1) + k] == n;
            }
            first = first < 0 ? part : first;
            if (at_node && part >= 0 && part != first) {
                RETURN_IF_ERROR(part_body(body, n, part, &room, error));
            }
        }
        mesh->pinched += body->apart[n];
    }
    return STATUS_OK;
}
