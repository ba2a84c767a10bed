#include "approx/labels/label_cells_private.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cut moves a point if it is nearer than this share of the edge's length. For edges along the axes and half
 * diagonals of cubes: Labelle and Shewchuk 2007, section 3, for the best bound of the angles. For diagonals
 * of sides, where leaves of two sizes meet, and for triangles: values between these. */
static const double near_axis = 0.24999, near_cube = 0.41189, near_side = 0.3, near_plane = 0.35;

/* Count the edges of cells between points of different labels; store them if the array exists. */
static int64_t collect(const struct lattice *lattice, int64_t *key)
{
    int corners = lattice->dim + 1;
    int64_t count = 0;
    for (int64_t c = 0; c < lattice->cell_count; c++) {
        const int32_t *node = lattice->cell + c * corners;
        for (int k = 0; k < corners; k++) {
            for (int l = k + 1; l < corners; l++) {
                int64_t a = node[k], b = node[l];
                if (lattice->label[a] == lattice->label[b]) {
                    continue;
                }
                if (key != NULL) {
                    key[count] = a < b ? a << 32 | b : b << 32 | a;
                }
                count++;
            }
        }
    }
    return count;
}

static enum status find_edges(struct lattice *lattice, struct error *error)
{
    int64_t count = collect(lattice, NULL);
    NEW_SCRATCH(int64_t, key, count, error);
    collect(lattice, key);
    lattice->edge_count = sort_distinct(count, key);
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->end, 2 * lattice->edge_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->cut, lattice->edge_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->on, lattice->node_count, error));
    for (int64_t e = 0; e < lattice->edge_count; e++) {
        lattice->end[2 * e] = (int32_t)(key[e] >> 32);
        lattice->end[2 * e + 1] = (int32_t)(key[e] & UINT32_MAX);
    }
    return lists_by_row(lattice->edge_count, 2, lattice->end, lattice->node_count, &lattice->edge_ptr,
                        &lattice->edge_idx, error);
}

/* The edge between two nodes, -1 when it is not cut. */
static int64_t lattice_edge(const struct lattice *lattice, int32_t p, int32_t q)
{
    for (int64_t i = lattice->edge_ptr[p]; i < lattice->edge_ptr[p + 1]; i++) {
        int64_t edge = lattice->edge_idx[i];
        if (lattice->cut[edge] > 0 && (lattice->end[2 * edge] == q || lattice->end[2 * edge + 1] == q)) {
            return edge;
        }
    }
    return -1;
}

/* Whether there is no interface between two labels: they are the same, or both are left out. */
static bool same_side(const struct lattice *lattice, int32_t a, int32_t b)
{
    return a == b || (!lattice->keep[a] && !lattice->keep[b]);
}

/* The function whose zero is the interface between two labels: the difference of their shares. Between the
 * body and its outside, it is the difference of the largest shares of labels of the body and of others, so
 * that a thin layer of a third label at the surface does not move the surface. */
static double difference(const struct lattice *lattice, const struct label_mix *mix, int32_t a, int32_t b)
{
    if (lattice->keep[a] != lattice->keep[b]) {
        a = label_largest(mix, lattice->keep, lattice->keep[a]);
        b = label_largest(mix, lattice->keep, lattice->keep[b]);
    }
    return label_share(mix, a) - label_share(mix, b);
}

/* The fraction of an edge at which this difference ceases to be positive (`strictly`), or becomes negative;
 * *after: its value there. */
static double change(const struct lattice *lattice, int64_t edge, bool strictly, double *after)
{
    const int32_t *end = lattice->end + 2 * edge;
    const double *p = lattice->x + (int64_t)end[0] * lattice->dim;
    const double *q = lattice->x + (int64_t)end[1] * lattice->dim;
    double low = 0, high = 1;
    *after = -1;
    for (int step = 0; step < 16; step++) {
        double t = (low + high) / 2, x[3];
        struct label_mix mix;
        vector_between(lattice->dim, p, q, t, x);
        labels_mix(lattice->labels, x, &mix);
        double value = difference(lattice, &mix, lattice->label[end[0]], lattice->label[end[1]]);
        if (strictly ? value > 0 : value >= 0) {
            low = t;
        } else {
            high = t;
            *after = value;
        }
    }
    return (low + high) / 2;
}

/* The fraction of an edge at which the interface lies. If a third label lies between the two, both shares are
 * 0 over an interval: its middle. */
static double cut_of(const struct lattice *lattice, int64_t edge)
{
    double after, first = change(lattice, edge, true, &after);
    return after < 0 ? first : (first + change(lattice, edge, false, &after)) / 2;
}

static double near_end(const struct lattice *lattice, int64_t edge)
{
    const int32_t *p = lattice->place + 3 * (int64_t)lattice->end[2 * edge];
    const int32_t *q = lattice->place + 3 * (int64_t)lattice->end[2 * edge + 1];
    int along = (p[0] != q[0]) + (p[1] != q[1]) + (p[2] != q[2]);
    return lattice->dim == 2 ? near_plane : along == 1 ? near_axis : along == 2 ? near_side : near_cube;
}

static double length_of(const struct lattice *lattice, int64_t edge)
{
    const int32_t *end = lattice->end + 2 * edge;
    return vector_distance(lattice->dim, lattice->x + (int64_t)end[1] * lattice->dim,
                           lattice->x + (int64_t)end[0] * lattice->dim);
}

/* A point was moved onto an interface: the edges that end there are no longer cut, except those to a third
 * label whose interface is far away. */
static void take_cuts(struct lattice *lattice, int64_t node, int32_t beyond)
{
    for (int64_t i = lattice->edge_ptr[node]; i < lattice->edge_ptr[node + 1]; i++) {
        int64_t edge = lattice->edge_idx[i];
        const int32_t *end = lattice->end + 2 * edge;
        int32_t label = lattice->label[end[0] == node ? end[1] : end[0]];
        double near = near_end(lattice, edge);
        if (lattice->cut[edge] > 0 && !same_side(lattice, label, beyond)) {
            double cut = cut_of(lattice, edge), t = end[0] == node ? cut : 1 - cut;
            t = t < near ? 0 : fmin(t, 1 - near);
            lattice->cut[edge] = t == 0 ? 0 : end[0] == node ? t : 1 - t;
        } else {
            lattice->cut[edge] = 0;
        }
    }
}

/* Move a point onto the nearest of the cuts that lie near it. */
static void snap(struct lattice *lattice, int64_t node)
{
    int dim = lattice->dim;
    int64_t best = -1;
    double least = INFINITY, fraction = 0;
    for (int64_t i = lattice->edge_ptr[node]; i < lattice->edge_ptr[node + 1]; i++) {
        int64_t edge = lattice->edge_idx[i];
        double cut = lattice->cut[edge], t = lattice->end[2 * edge] == node ? cut : 1 - cut;
        if (cut > 0 && t < near_end(lattice, edge) && t * length_of(lattice, edge) < least) {
            least = t * length_of(lattice, edge);
            fraction = t;
            best = edge;
        }
    }
    if (best < 0) {
        return;
    }
    const int32_t *end = lattice->end + 2 * best;
    const double *other = lattice->x + (int64_t)(end[0] == node ? end[1] : end[0]) * dim;
    lattice->on[node] = true;
    double *own = lattice->x + node * dim;
    vector_between(dim, own, other, fraction, own);
    take_cuts(lattice, node, lattice->label[end[0] == node ? end[1] : end[0]]);
}

enum status lattice_cut(struct lattice *lattice, struct error *error)
{
    RETURN_IF_ERROR(find_edges(lattice, error));
#pragma omp parallel for schedule(dynamic, 256)
    for (int64_t e = 0; e < lattice->edge_count; e++) {
        bool cut =
            !same_side(lattice, lattice->label[lattice->end[2 * e]], lattice->label[lattice->end[2 * e + 1]]);
        lattice->cut[e] = cut ? cut_of(lattice, e) : 0;
    }
    for (int64_t n = 0; n < lattice->node_count; n++) {
        snap(lattice, n);
    }
    return STATUS_OK;
}

/* Pieces of one cell of the lattice: each of its six edges doubles them at most. */
enum { MOST_PIECES = 64 };
struct pieces {
    int count, corners;
    int32_t node[MOST_PIECES][4];
};

/* The cells of a lattice that are cut. */
struct cutting {
    const struct lattice *lattice;
    struct label_cells *mesh;
    bool *between;                               /* of each cell: whether all its nodes lie on interfaces */
    int64_t cell_room, label_room, between_room; /* allocated */
    int64_t node_count;                          /* nodes of the lattice, then of cuts */
    double *x;                                   /* node_count * dim, m */
    int32_t *cut_node;                           /* lattice->edge_count: the node of each edge's cut */
};

/* A cut edge of a cell, and its rank among the cuts of the cell: edges with larger order[0] are cut first;
 * among equal ones those with lower order[1], then those with lower number. */
struct bisection {
    int32_t end[2], node;
    double order[2];
};

static bool on_interface(const struct cutting *cutting, int32_t node)
{
    return node >= cutting->lattice->node_count || cutting->lattice->on[node];
}

/* The label of a piece: that of its points off the interfaces, or else that at its middle. A piece whose
 * points off the interfaces are all left out is left out, too, so that gaps stay open. */
static int32_t label_of(const struct cutting *cutting, const int32_t *node)
{
    const struct lattice *lattice = cutting->lattice;
    int dim = lattice->dim;
    bool left_out = true;
    double middle[3];
    for (int k = 0; k <= dim; k++) {
        if (!on_interface(cutting, node[k])) {
            return lattice->label[node[k]];
        }
        left_out = left_out && node[k] < lattice->node_count && !lattice->keep[lattice->label[node[k]]];
    }
    vector_middle(dim, cutting->x, dim + 1, node, middle);
    return left_out ? lattice->label[node[0]] : labels_at(lattice->labels, middle);
}

static enum status append(struct cutting *cutting, const int32_t *node, struct error *error)
{
    struct label_cells *mesh = cutting->mesh;
    int32_t label = label_of(cutting, node);
    int corners = mesh->dim + 1;
    RETURN_IF_ERROR(GROW_ARRAY(&mesh->cell, (mesh->cell_count + 1) * corners, &cutting->cell_room, error));
    RETURN_IF_ERROR(GROW_ARRAY(&mesh->label, mesh->cell_count + 1, &cutting->label_room, error));
    RETURN_IF_ERROR(GROW_ARRAY(&cutting->between, mesh->cell_count + 1, &cutting->between_room, error));
    memcpy(mesh->cell + mesh->cell_count * corners, node, (size_t)corners * sizeof *node);
    cutting->between[mesh->cell_count] = true;
    for (int k = 0; k < corners; k++) {
        cutting->between[mesh->cell_count] =
            cutting->between[mesh->cell_count] && on_interface(cutting, node[k]);
    }
    mesh->label[mesh->cell_count++] = label;
    return STATUS_OK;
}

/* The order in which edges are cut. Neighbours must agree on it for the edges of a common face. Long edges
 * are first; of two equal diagonals of cubes in a face, the one whose ends are at an even place (the parity
 * rule of Labelle and Shewchuk 2007, section 3). In 2D faces are edges, and the shorter diagonal is first. */
static void set_order(const struct cutting *cutting, const int32_t *node, struct bisection *bisection)
{
    const struct lattice *lattice = cutting->lattice;
    if (lattice->dim == 2) {
        for (int k = 0; k < 3; k++) {
            const double *x = cutting->x + 2 * (int64_t)node[k],
                         *cut = cutting->x + 2 * (int64_t)bisection->node;
            if (node[k] != bisection->end[0] && node[k] != bisection->end[1]) {
                bisection->order[0] = -hypot(x[0] - cut[0], x[1] - cut[1]);
            }
        }
        return;
    }
    const int32_t *p = lattice->place + 3 * (int64_t)bisection->end[0];
    const int32_t *q = lattice->place + 3 * (int64_t)bisection->end[1];
    int32_t size = abs(p[0] - q[0]), sum = 0;
    for (int d = 0; d < 3; d++) {
        bisection->order[0] += (double)(p[d] - q[d]) * (p[d] - q[d]);
        sum += size > 0 ? p[d] / (2 * size) + q[d] / (2 * size) : 0;
    }
    bisection->order[1] = sum % 2;
}

static bool comes_before(const struct bisection *a, const struct bisection *b)
{
    if (a->order[0] != b->order[0]) {
        return a->order[0] > b->order[0];
    }
    return a->order[1] != b->order[1] ? a->order[1] < b->order[1] : a->node < b->node;
}

/* The cuts of a cell in their order. */
static int find_bisections(const struct cutting *cutting, const int32_t *node, struct bisection bisections[6])
{
    const struct lattice *lattice = cutting->lattice;
    int count = 0;
    for (int k = 0; k <= lattice->dim; k++) {
        for (int l = k + 1; l <= lattice->dim; l++) {
            int64_t edge = lattice->label[node[k]] != lattice->label[node[l]]
                               ? lattice_edge(lattice, node[k], node[l])
                               : -1;
            if (edge < 0) {
                continue;
            }
            struct bisection fresh = {.end = {node[k], node[l]}, .node = cutting->cut_node[edge]};
            set_order(cutting, node, &fresh);
            int at = count++;
            for (; at > 0 && comes_before(&fresh, &bisections[at - 1]); at--) {
                bisections[at] = bisections[at - 1];
            }
            bisections[at] = fresh;
        }
    }
    return count;
}

/* Bisect an edge of all pieces that have it. */
static void bisect(struct pieces *pieces, int32_t p, int32_t q, int32_t middle)
{
    for (int i = 0, before = pieces->count; i < before; i++) {
        int first = -1, second = -1;
        for (int k = 0; k < pieces->corners; k++) {
            first = pieces->node[i][k] == p ? k : first;
            second = pieces->node[i][k] == q ? k : second;
        }
        if (first >= 0 && second >= 0) {
            memcpy(pieces->node[pieces->count], pieces->node[i], sizeof pieces->node[i]);
            pieces->node[i][first] = middle;
            pieces->node[pieces->count++][second] = middle;
        }
    }
}

/* Cut one cell of the lattice, and append its pieces. */
static enum status cut_cell(struct cutting *cutting, const int32_t *node, struct error *error)
{
    struct pieces pieces = {.count = 1, .corners = cutting->lattice->dim + 1};
    struct bisection bisections[6];
    memcpy(pieces.node[0], node, (size_t)pieces.corners * sizeof *node);
    int count = find_bisections(cutting, node, bisections);
    for (int b = 0; b < count; b++) {
        bisect(&pieces, bisections[b].end[0], bisections[b].end[1], bisections[b].node);
    }
    for (int i = 0; i < pieces.count; i++) {
        RETURN_IF_ERROR(append(cutting, pieces.node[i], error));
    }
    return STATUS_OK;
}

/* Number the cuts behind the nodes of the lattice. */
static enum status set_nodes(struct cutting *cutting, struct error *error)
{
    const struct lattice *lattice = cutting->lattice;
    int dim = lattice->dim;
    int64_t *count = &cutting->node_count;
    *count = lattice->node_count;
    RETURN_IF_ERROR(NEW_ARRAY(&cutting->cut_node, lattice->edge_count, error));
    for (int64_t e = 0; e < lattice->edge_count; e++) {
        cutting->cut_node[e] = -1;
        if (lattice->cut[e] > 0) {
            cutting->cut_node[e] = (int32_t)(*count)++;
        }
    }
    if (*count > INT32_MAX / 2) {
        return fail(error, STATUS_INPUT, "more than 1073741823 nodes: a larger spacing?");
    }
    RETURN_IF_ERROR(NEW_ARRAY(&cutting->x, *count * dim, error));
    memcpy(cutting->x, lattice->x, (size_t)(lattice->node_count * dim) * sizeof *cutting->x);
    for (int64_t e = 0; e < lattice->edge_count; e++) {
        const double *from = lattice->x + (int64_t)lattice->end[2 * e] * dim;
        const double *to = lattice->x + (int64_t)lattice->end[2 * e + 1] * dim;
        for (int d = 0; d < dim && lattice->cut[e] > 0; d++) {
            cutting->x[(int64_t)cutting->cut_node[e] * dim + d] =
                from[d] + lattice->cut[e] * (to[d] - from[d]);
        }
    }
    return STATUS_OK;
}

static void cutting_free(struct cutting *cutting)
{
    FREE_ALL(cutting->x, cutting->cut_node, cutting->between);
}

enum status lattice_cells(const struct lattice *lattice, struct label_cells *mesh, bool **between,
                          struct error *error)
{
    FREED_BY(cutting_free) struct cutting cutting = {.lattice = lattice, .mesh = mesh};
    *mesh = (struct label_cells){.dim = lattice->dim, .unsized = lattice->unsized};
    RETURN_IF_ERROR(set_nodes(&cutting, error));
    for (int64_t c = 0; c < lattice->cell_count; c++) {
        RETURN_IF_ERROR(cut_cell(&cutting, lattice->cell + c * (lattice->dim + 1), error));
    }
    mesh->x = array_take(&cutting.x);
    mesh->node_count = cutting.node_count;
    *between = array_take(&cutting.between);
    return label_cells_compact(mesh, error);
}
