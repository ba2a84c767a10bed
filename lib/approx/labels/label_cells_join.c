/* Places where parts of the body share only a node or an edge. */
#include "approx/labels/label_cells_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Number the groups of cells at a node that are connected by faces at it; returns the number of groups. */
static int32_t find_groups(struct label_cells_keeping *keeping, const struct label_cells_star *star,
                           int64_t node)
{
    int32_t count = 0;
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        if (keeping->wanted[star->cell[i]] && keeping->group[star->cell[i]] < 0) {
            label_cells_flood(keeping, star->cell[i], count++, node);
        }
    }
    return count;
}

static void forget_groups(struct label_cells_keeping *keeping, const struct label_cells_star *star,
                          int64_t node)
{
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        keeping->group[star->cell[i]] = -1;
    }
}

static int32_t count_groups(struct label_cells_keeping *keeping, const struct label_cells_star *star,
                            int64_t node)
{
    int32_t count = find_groups(keeping, star, node);
    forget_groups(keeping, star, node);
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
static int64_t pinches_about(struct label_cells_keeping *keeping, const struct label_cells_star *star,
                             const struct change *change)
{
    int corners = keeping->cells.dim + 1, seen = 0;
    int32_t node[4 * CHANGE_MOST];
    int64_t count = 0;
    for (int i = 0; i < change->count * corners; i++) {
        int known = 0;
        node[seen] = keeping->cells.node[change->cell[i / corners] * corners + i % corners];
        while (node[known] != node[seen]) {
            known++;
        }
        if (known == seen) {
            int32_t groups = count_groups(keeping, star, node[seen++]);
            count += groups > 1 ? groups - 1 : 0;
        }
    }
    return count;
}

static void turn(struct label_cells_keeping *keeping, const struct change *change)
{
    for (int i = 0; i < change->count; i++) {
        keeping->wanted[change->cell[i]] = !keeping->wanted[change->cell[i]];
    }
}

/* Make a change if it leaves at least `fewer` parts less that are connected by single nodes only. */
static bool try_change(struct label_cells_keeping *keeping, const struct label_cells_star *star,
                       const struct change *change, int64_t fewer)
{
    int64_t before = pinches_about(keeping, star, change);
    turn(keeping, change);
    if (pinches_about(keeping, star, change) > before - fewer) {
        turn(keeping, change);
        return false;
    }
    for (int i = 0; i < change->count; i++) {
        keeping->mesh->label[change->cell[i]] = change->label[i];
    }
    return true;
}

/* The shortest row of cells between interfaces, each with a face at the node in common with the next, from a
 * cell of the first group at the node to another group; they take the label of that cell. */
static void find_link(struct label_cells_keeping *keeping, const struct label_cells_star *star, int64_t node,
                      struct change *change)
{
    int corners = keeping->cells.dim + 1;
    int64_t first = 0, last = 0, found = -1;
    change->count = 0;
    find_groups(keeping, star, node);
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        if (keeping->group[star->cell[i]] == 0) {
            keeping->stack[last++] = star->cell[i];
            keeping->from[star->cell[i]] = -1;
        }
    }
    while (first < last && found < 0) {
        int32_t cell = keeping->stack[first++];
        for (int k = 0; k < corners && found < 0; k++) {
            int32_t next = keeping->across[(int64_t)cell * corners + k];
            if (keeping->cells.node[(int64_t)cell * corners + k] == node || next < 0) {
                continue;
            }
            if (keeping->group[next] > 0 && keeping->group[cell] < 0) {
                found = cell;
            } else if (!keeping->wanted[next] && keeping->between[next] && keeping->group[next] == -1) {
                keeping->group[next] = -2;
                keeping->from[next] = cell;
                keeping->stack[last++] = next;
            }
        }
    }
    for (; found >= 0 && keeping->from[found] >= 0; found = keeping->from[found]) {
        if (change->count == CHANGE_MOST) {
            change->count = 0;
            break;
        }
        change->cell[change->count++] = found;
    }
    int32_t label = found >= 0 ? keeping->mesh->label[found] : 0;
    for (int i = 0; i < change->count; i++) {
        change->label[i] = label;
    }
    forget_groups(keeping, star, node);
}

/* The label beyond a face of a cell at which the body ends; 0 if there is no such face. */
static int32_t label_beyond(const struct label_cells_keeping *keeping, int64_t cell)
{
    for (int k = 0; k <= keeping->cells.dim; k++) {
        int32_t next = keeping->across[cell * (keeping->cells.dim + 1) + k];
        if (next >= 0 && !keeping->wanted[next]) {
            return keeping->mesh->label[next];
        }
    }
    return 0;
}

/* A group at the node all cells of which lie between interfaces; they take the label beyond. */
static void find_tip(struct label_cells_keeping *keeping, const struct label_cells_star *star, int64_t node,
                     int32_t group, struct change *change)
{
    change->count = 0;
    find_groups(keeping, star, node);
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        int32_t cell = star->cell[i];
        if (keeping->group[cell] != group) {
            continue;
        }
        if (!keeping->between[cell] || change->count == CHANGE_MOST) {
            change->count = 0;
            break;
        }
        change->label[change->count] = label_beyond(keeping, cell);
        change->cell[change->count++] = cell;
    }
    forget_groups(keeping, star, node);
}

/* Whether two faces of a cell between interfaces that is left out are walls of the body, at less than 60
 * degrees, the least angle of the lattice's own cells: the tip of a crevice. Under load the walls of sharper
 * ones pass through each other. It takes the label of one of them. */
static bool is_crevice(const struct label_cells_keeping *keeping, int64_t cell, struct change *change)
{
    int dim = keeping->cells.dim, corners = dim + 1, walls = 0;
    double gradient[4][3], length[4];
    if (keeping->wanted[cell] || !keeping->between[cell]) {
        return false;
    }
    for (int k = 0; k < corners; k++) {
        int32_t next = keeping->across[cell * corners + k];
        label_cells_gradient(keeping->mesh, cell, k, gradient[k]);
        double square = vector_dot(dim, gradient[k], gradient[k]);
        length[k] = next >= 0 && keeping->wanted[next] ? sqrt(square) : 0;
        if (length[k] > 0) {
            walls++;
            *change = (struct change){1, {cell}, {keeping->mesh->label[next]}};
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
static bool fill_crevices(struct label_cells_keeping *keeping, const struct label_cells_star *star)
{
    bool changed = false;
    for (int64_t c = 0; c < keeping->cells.count; c++) {
        struct change change;
        changed = (is_crevice(keeping, c, &change) && try_change(keeping, star, &change, 0)) || changed;
    }
    return changed;
}

/* Join the parts at a node, or leave out a part that is only a tip. */
static bool join_at(struct label_cells_keeping *keeping, const struct label_cells_star *star, int64_t node)
{
    struct change change;
    int32_t count = count_groups(keeping, star, node);
    if (count < 2) {
        return false;
    }
    find_link(keeping, star, node, &change);
    if (try_change(keeping, star, &change, 1)) {
        return true;
    }
    for (int32_t g = 0; g < count; g++) {
        find_tip(keeping, star, node, g, &change);
        if (try_change(keeping, star, &change, 1)) {
            return true;
        }
    }
    return false;
}

void label_cells_join(struct label_cells_keeping *keeping, const struct label_cells_star *star)
{
    /* This ends: a change at a node leaves fewer nodes at which parts share only a node or an edge, and a
     * filled crevice adds none. */
    for (bool changed = true; changed;) {
        changed = fill_crevices(keeping, star);
        for (int64_t n = 0; n < keeping->mesh->node_count; n++) {
            changed = join_at(keeping, star, n) || changed;
        }
    }
    for (int64_t n = 0; n < keeping->mesh->node_count; n++) {
        keeping->mesh->hinges += count_groups(keeping, star, n) > 1;
    }
}

/* ---- cutting apart ---- */

/* Room for nodes. */
struct room {
    int64_t x, apart;
};

/* Give the cells of a body at a node a node of their own at the same place. */
static enum status part_body(struct label_cells_keeping *keeping, const struct label_cells_star *star,
                             int64_t node, int32_t body, struct room *room, struct error *error)
{
    struct label_cells *mesh = keeping->mesh;
    int dim = mesh->dim, corners = dim + 1;
    int64_t fresh = mesh->node_count++;
    RETURN_IF_ERROR(GROW_ARRAY(&mesh->x, (fresh + 1) * dim, &room->x, error));
    RETURN_IF_ERROR(GROW_ARRAY(&keeping->apart, fresh + 1, &room->apart, error));
    memcpy(mesh->x + fresh * dim, mesh->x + node * dim, (size_t)dim * sizeof(double));
    keeping->apart[node] = keeping->apart[fresh] = true;
    for (int64_t j = star->ptr[node]; j < star->ptr[node + 1]; j++) {
        int32_t *corner = mesh->cell + (int64_t)star->cell[j] * corners;
        for (int k = 0; k < corners && keeping->group[star->cell[j]] == body; k++) {
            corner[k] = corner[k] == node ? (int32_t)fresh : corner[k];
        }
    }
    return STATUS_OK;
}

enum status label_cells_cut_apart(struct label_cells_keeping *keeping, const struct label_cells_star *star,
                                  struct error *error)
{
    struct label_cells *mesh = keeping->mesh;
    int64_t nodes = mesh->node_count;
    struct room room = {nodes * mesh->dim, nodes};
    RETURN_IF_ERROR(NEW_ARRAY(&keeping->apart, nodes, error));
    for (int64_t n = 0; n < nodes; n++) {
        int32_t first = -1;
        for (int64_t i = star->ptr[n]; i < star->ptr[n + 1]; i++) {
            int32_t body = keeping->group[star->cell[i]];
            bool at_node = false;
            for (int k = 0; k <= mesh->dim; k++) {
                at_node = at_node || mesh->cell[(int64_t)star->cell[i] * (mesh->dim + 1) + k] == n;
            }
            first = first < 0 ? body : first;
            if (at_node && body >= 0 && body != first) {
                RETURN_IF_ERROR(part_body(keeping, star, n, body, &room, error));
            }
        }
        mesh->pinched += keeping->apart[n];
    }
    keeping->cells.node_count = mesh->node_count;
    keeping->cells.x = mesh->x;
    return STATUS_OK;
}
