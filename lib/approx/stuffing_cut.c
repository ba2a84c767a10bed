#include "approx/stuffing_private.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pieces of one cell of the lattice: each of its six edges doubles them at most. */
enum { PIECES_MOST = 64 };

struct cutting {
    const struct lattice *lattice;
    struct stuffing *stuffing;
    int64_t room; /* cells allocated */
    double *x;    /* points + cuts: coordinates, m */
};

/* An edge of a cell that is cut. */
struct bisection {
    int32_t end[2], node;
    double order;
};

static bool on_interface(const struct cutting *cutting, int32_t node)
{
    return node >= cutting->lattice->points || cutting->lattice->on[node];
}

/* Six times the volume (2D: twice the area) of a simplex. */
static double signed_size(const struct cutting *cutting, const int32_t *node)
{
    int dim = cutting->lattice->dim;
    double e[3][3] = {{0}};
    for (int k = 0; k < dim; k++) {
        for (int d = 0; d < dim; d++) {
            e[k][d] = cutting->x[(int64_t)node[k + 1] * dim + d] - cutting->x[(int64_t)node[0] * dim + d];
        }
    }
    if (dim == 2) {
        return e[0][0] * e[1][1] - e[0][1] * e[1][0];
    }
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
           e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* The label of a piece: that of its points off the interfaces, or where there are none the one at its middle.
 */
static int32_t label_of(const struct cutting *cutting, const int32_t *node)
{
    int dim = cutting->lattice->dim;
    double middle[3] = {0};
    for (int k = 0; k <= dim; k++) {
        if (!on_interface(cutting, node[k])) {
            return cutting->lattice->label[node[k]];
        }
        for (int d = 0; d < dim; d++) {
            middle[d] += cutting->x[(int64_t)node[k] * dim + d] / (dim + 1);
        }
    }
    return labels_at(cutting->lattice->labels, middle);
}

static enum status append(struct cutting *cutting, const int32_t *node, struct error *error)
{
    struct stuffing *stuffing = cutting->stuffing;
    int32_t label = label_of(cutting, node);
    int corners = stuffing->dim + 1;
    if (label == 0) {
        return STATUS_OK;
    }
    if (stuffing->cell_count == cutting->room) {
        int64_t room = cutting->room + cutting->room / 2 + 1024;
        int32_t *cell = array_grow(stuffing->cell, room * corners, sizeof *cell);
        if (cell == NULL) {
            return fail_memory(error, "cells");
        }
        stuffing->cell = cell;
        int32_t *labels = array_grow(stuffing->label, room, sizeof *labels);
        if (labels == NULL) {
            return fail_memory(error, "labels of cells");
        }
        stuffing->label = labels;
        cutting->room = room;
    }
    memcpy(stuffing->cell + stuffing->cell_count * corners, node, (size_t)corners * sizeof *node);
    stuffing->label[stuffing->cell_count++] = label;
    return STATUS_OK;
}

/* In the plane no neighbour depends on the order: the shorter diagonal goes first. */
static double order_in_plane(const struct cutting *cutting, const struct bisection *bisection,
                             const int32_t *node)
{
    double length = 0;
    for (int k = 0; k < 3; k++) {
        if (node[k] != bisection->end[0] && node[k] != bisection->end[1]) {
            for (int d = 0; d < 2; d++) {
                double step =
                    cutting->x[2 * (int64_t)node[k] + d] - cutting->x[2 * (int64_t)bisection->node + d];
                length += step * step;
            }
        }
    }
    return length;
}

/* The cuts of a cell in their order. */
static int find_bisections(const struct cutting *cutting, const int32_t *node, struct bisection bisections[6])
{
    const struct lattice *lattice = cutting->lattice;
    int count = 0;
    for (int k = 0; k <= lattice->dim; k++) {
        for (int l = k + 1; l <= lattice->dim; l++) {
            int64_t first;
            int order;
            int64_t edge = lattice_edge(lattice, node[k], node[l], &first, &order);
            if (lattice->cut_node[edge] < 0) {
                continue;
            }
            struct bisection fresh = {
                {node[k], node[l]}, (int32_t)lattice->points + lattice->cut_node[edge], order};
            if (lattice->dim == 2) {
                fresh.order = order_in_plane(cutting, &fresh, node);
            }
            int at = count++;
            for (; at > 0 && bisections[at - 1].order > fresh.order; at--) {
                bisections[at] = bisections[at - 1];
            }
            bisections[at] = fresh;
        }
    }
    return count;
}

/* Cut one cell of the lattice, and append its pieces. */
static enum status cut_cell(struct cutting *cutting, int32_t node[4], struct error *error)
{
    const struct lattice *lattice = cutting->lattice;
    int corners = lattice->dim + 1, count = 1;
    int32_t piece[PIECES_MOST][4];
    struct bisection bisections[6];
    bool outside = true, all_on = true;
    for (int k = 0; k < corners; k++) {
        bool on = lattice->on[node[k]];
        all_on = all_on && on;
        outside = outside && (on || lattice->label[node[k]] == 0);
    }
    if (outside && !all_on) {
        return STATUS_OK;
    }
    memcpy(piece[0], node, sizeof piece[0]);
    if (signed_size(cutting, node) < 0) {
        piece[0][0] = node[1];
        piece[0][1] = node[0];
    }
    int bisection_count = find_bisections(cutting, node, bisections);
    for (int b = 0; b < bisection_count; b++) {
        int before = count;
        for (int i = 0; i < before; i++) {
            int first = -1, second = -1;
            for (int k = 0; k < corners; k++) {
                first = piece[i][k] == bisections[b].end[0] ? k : first;
                second = piece[i][k] == bisections[b].end[1] ? k : second;
            }
            if (first >= 0 && second >= 0) {
                memcpy(piece[count], piece[i], sizeof piece[count]);
                piece[i][first] = bisections[b].node;
                piece[count++][second] = bisections[b].node;
            }
        }
    }
    for (int i = 0; i < count; i++) {
        enum status status = append(cutting, piece[i], error);
        if (status != STATUS_OK) {
            return status;
        }
    }
    return STATUS_OK;
}

/* Tetrahedra about the edges of cubes: each with an edge between two centres. */
static enum status cut_at_corner(struct cutting *cutting, int64_t corner, struct error *error)
{
    const struct lattice *lattice = cutting->lattice;
    static const int ring[5][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}, {-1, -1}};
    struct lattice_index index = lattice_index(lattice, corner);
    for (int d = 0; d < 3; d++) {
        if (index.at[d] < 1 || index.at[d] > lattice->count[d] - 2) {
            return STATUS_OK;
        }
    }
    for (int d = 0; d < 3; d++) {
        struct lattice_index next = index;
        next.at[d]++;
        for (int r = 0; r < 4; r++) {
            int32_t node[4] = {(int32_t)corner, (int32_t)lattice_point(lattice, &next)};
            for (int m = 0; m < 2; m++) {
                struct lattice_index centre = index;
                centre.centre = true;
                centre.at[(d + 1) % 3] += ring[r + m][0];
                centre.at[(d + 2) % 3] += ring[r + m][1];
                node[2 + m] = (int32_t)lattice_point(lattice, &centre);
            }
            enum status status = cut_cell(cutting, node, error);
            if (status != STATUS_OK) {
                return status;
            }
        }
    }
    return STATUS_OK;
}

/* The triangle above the edge from a point to the next in its row, and the one above the next point. */
static enum status cut_above(struct cutting *cutting, int64_t point, struct error *error)
{
    const struct lattice *lattice = cutting->lattice;
    struct lattice_index index = lattice_index(lattice, point);
    if (index.at[0] + 2 >= lattice->count[0] || index.at[1] + 1 >= lattice->count[1]) {
        return STATUS_OK;
    }
    int32_t p = (int32_t)point, above = (int32_t)(point + lattice->count[0] + (index.at[1] & 1));
    int32_t up[4] = {p, p + 1, above}, down[4] = {p + 1, above + 1, above};
    enum status status = cut_cell(cutting, up, error);
    return status == STATUS_OK ? cut_cell(cutting, down, error) : status;
}

static void set_nodes(struct cutting *cutting)
{
    const struct lattice *lattice = cutting->lattice;
    int dim = lattice->dim;
    memcpy(cutting->x, lattice->x, (size_t)(lattice->points * dim) * sizeof *cutting->x);
    for (int64_t p = 0; p < lattice->points; p++) {
        struct lattice_index index = lattice_index(lattice, p);
        for (int n = 0; n < (dim == 2 ? 3 : index.centre ? 3 : 11); n++) {
            int64_t edge = dim == 2       ? 3 * p + n
                           : index.centre ? 11 * lattice->corners + 3 * (p - lattice->corners) + n
                                          : 11 * p + n;
            struct lattice_index next = index;
            if (lattice->cut_node[edge] < 0) {
                continue;
            }
            if (dim == 2) {
                next.at[0] += n == 0 ? 1 : (index.at[1] & 1) - (n == 2);
                next.at[1] += n > 0;
            } else if (n < 3) {
                next.at[n]++;
            } else {
                next.centre = true;
                for (int d = 0; d < 3; d++) {
                    next.at[d] += ((n - 3) >> d & 1) - 1;
                }
            }
            const double *from = lattice->x + p * dim, *to = lattice->x + lattice_point(lattice, &next) * dim;
            double *x = cutting->x + (lattice->points + lattice->cut_node[edge]) * dim;
            for (int d = 0; d < dim; d++) {
                x[d] = from[d] + lattice->cut[edge] * (to[d] - from[d]);
            }
        }
    }
}

/* Number the nodes of cells anew, without those of no cell; x is replaced. */
static enum status compact(struct cutting *cutting, int64_t count, struct error *error)
{
    struct stuffing *stuffing = cutting->stuffing;
    int dim = stuffing->dim;
    int32_t *number = NULL;
    enum status status;
    TRY(NEW_ARRAY(&number, count, error));
    for (int64_t i = 0; i < stuffing->cell_count * (dim + 1); i++) {
        number[stuffing->cell[i]] = 1;
    }
    for (int64_t n = 0; n < count; n++) {
        if (number[n] != 0) {
            memmove(cutting->x + stuffing->node_count * dim, cutting->x + n * dim,
                    (size_t)dim * sizeof(double));
            number[n] = (int32_t)stuffing->node_count++;
        }
    }
    for (int64_t i = 0; i < stuffing->cell_count * (dim + 1); i++) {
        stuffing->cell[i] = number[stuffing->cell[i]];
    }
    stuffing->x = cutting->x;
    cutting->x = NULL;
done:
    free(number);
    return status;
}

enum status lattice_cells(const struct lattice *lattice, struct stuffing *stuffing, struct error *error)
{
    struct cutting cutting = {.lattice = lattice, .stuffing = stuffing};
    enum status status;
    int64_t count = lattice->points + lattice->cuts;
    *stuffing = (struct stuffing){.dim = lattice->dim};
    if (count > INT32_MAX) {
        return fail(error, STATUS_INPUT, "spacing %g m: more than 2147483647 nodes: larger?",
                    lattice->spacing);
    }
    TRY(NEW_ARRAY(&cutting.x, count * lattice->dim, error));
    set_nodes(&cutting);
    for (int64_t p = 0; p < lattice->corners; p++) {
        TRY(lattice->dim == 3 ? cut_at_corner(&cutting, p, error) : cut_above(&cutting, p, error));
    }
    TRY(compact(&cutting, count, error));
done:
    free(cutting.x);
    if (status != STATUS_OK) {
        stuffing_free(stuffing);
    }
    return status;
}
