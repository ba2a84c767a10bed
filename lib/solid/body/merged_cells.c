#include "solid/body/merged_cells.h"

#include "approx/cells/quality.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/stress.h"

#include <math.h>
#include <string.h>

/* Whether two cells have the same region and material model. */
static bool are_alike(const struct body_input *input, int64_t a, int64_t b)
{
    int32_t first = input->material[a], second = input->material[b];
    return first == second || (input->group != NULL && input->group[first] == input->group[second] &&
                               input->materials[first].model == input->materials[second].model);
}

static bool is_larger(const double *volume, int64_t a, int64_t b)
{
    return volume[a] > volume[b] || (!(volume[a] < volume[b]) && a < b);
}

/* Make b the partner of a if it is the largest so far; partner[a] == a: none yet. */
static void propose(const struct body_input *input, const double *volume, int64_t a, int64_t b,
                    int64_t *partner)
{
    if (are_alike(input, a, b) && (partner[a] == a || is_larger(volume, b, partner[a]))) {
        partner[a] = b;
    }
}

/* Follow partners from a cell to a cell without partner, or to the larger of two that are partners of each
 * other. There are no other cycles, as a cell is not larger than the partner of its partner. */
static int64_t end_of(const double *volume, const int64_t *partner, int64_t cell)
{
    int64_t next = partner[cell];
    while (next != cell && (partner[next] != cell || is_larger(volume, next, cell))) {
        cell = next;
        next = partner[cell];
    }
    return cell;
}

/* root[point_count]: for each of the caller's cells a cell that represents those it is merged with; itself if
 * it is alone. */
static enum status find_merged(const struct body_input *input, int64_t *root, struct error *error)
{
    const struct faces *faces = input->faces;
    const struct cells *cells = &input->cells;
    NEW_SCRATCH(bool, poor, cells->count, error);
    NEW_SCRATCH(double, volume, cells->count, error);
    NEW_SCRATCH(int64_t, partner, cells->count, error);
    NEW_SCRATCH(int64_t, size, cells->count, error);
    for (int64_t c = 0; c < cells->count; c++) {
        partner[c] = c;
        size[c] = 1;
        volume[c] = fmax(0.0, input->weight[c]); /* nan: 0 */
        poor[c] = cell_quality(cells, c, NULL) < POOR_QUALITY;
    }
    for (int64_t f = 0; f < faces->count; f++) {
        int64_t first = faces->cell[2 * f], second = faces->cell[2 * f + 1];
        if (first >= 0 && second >= 0 && first < cells->count && second < cells->count) {
            if (poor[first]) {
                propose(input, volume, first, second, partner);
            }
            if (poor[second]) {
                propose(input, volume, second, first, partner);
            }
        }
    }
    for (int64_t c = 0; c < cells->count; c++) {
        int64_t end = end_of(volume, partner, c);
        root[c] = end == c || size[end] < MERGED_MOST_CELLS ? end : c;
        size[end] += root[c] != c;
    }
    return STATUS_OK;
}

/* Let cells at a junction that are alone, of one part of it, of one region and law, have one root as well.
 * kept[point_count]: k of each cell, 1 of those that are alone. */
static enum status join_junctions(const struct body_input *input, int64_t *root, double *kept,
                                  struct error *error)
{
    int32_t parts = 0;
    int64_t cells = input->point_count;
    SCRATCH int64_t *last = NULL; /* of each part of the junction: its last root, from 1 on; 0: none */
    NEW_SCRATCH(int64_t, before, cells, error); /* of such a root: the one before it */
    NEW_SCRATCH(int64_t, size, cells, error);
    for (int64_t c = 0; c < cells; c++) {
        size[root[c]]++;
    }
    for (int64_t c = 0; c < cells; c++) {
        bool alone = size[root[c]] == 1;
        kept[c] = alone ? 1.0 : 0.0;
        parts =
            alone && input->junction != NULL && input->junction[c] >= parts ? input->junction[c] + 1 : parts;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&last, parts, error));
    for (int64_t c = 0; c < cells && parts > 0; c++) {
        int32_t part = input->junction[c];
        if (part < 0 || kept[c] < 1.0) {
            continue;
        }
        int64_t to = last[part];
        while (to != 0 && (!are_alike(input, to - 1, c) || size[to - 1] == GROUP_MOST_CELLS)) {
            to = before[to - 1];
        }
        if (to == 0) {
            before[c] = last[part];
            last[part] = c + 1;
        } else {
            root[c] = to - 1;
            size[to - 1]++;
            kept[c] = kept[to - 1] = JUNCTION_KEPT;
        }
    }
    return STATUS_OK;
}

/* Reorder the body's points so that the members of a group are consecutive, and list the groups. */
static enum status order_groups(const int64_t *root, const double *kept, struct body *body,
                                struct error *error)
{
    struct smoothed_cells *smoothed = &body->cells;
    int64_t cells = body->point_count, at = 0, grouped = 0;
    SCRATCH int64_t *first = NULL;
    for (int64_t c = 0; c < cells; c++) {
        grouped += root[c] != c;
        smoothed->merged_count += root[c] != c && kept[c] <= 0.0;
    }
    if (grouped == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&smoothed->kept, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&first, cells, error)); /* lists of the cells of each root; 0: none */
    NEW_SCRATCH(int64_t, next, cells, error);
    RETURN_IF_ERROR(NEW_ARRAY(&smoothed->group, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&smoothed->group_end, cells, error));
    for (int64_t c = cells - 1; c >= 0; c--) {
        if (root[c] != c) {
            next[c] = first[root[c]];
            first[root[c]] = c + 1;
        }
    }
    int64_t roots = 0;
    for (int64_t q = 0; q < cells; q++) { /* the roots in their order */
        int64_t c = body->order.points[q];
        if (root[c] == c) {
            body->order.points[roots++] = c;
        }
    }
    memmove(body->order.points + cells - roots, body->order.points,
            (size_t)roots * sizeof *body->order.points);
    for (int64_t k = cells - roots; k < cells; k++) { /* each followed by the other cells of its group */
        int64_t c = body->order.points[k], begin = at;
        body->order.points[at++] = c;
        for (int64_t i = first[c]; i != 0; i = next[i - 1]) {
            body->order.points[at++] = i - 1;
        }
        for (int64_t q = begin; q < at; q++) {
            smoothed->group[q] = (int32_t)begin;
            smoothed->group_end[q] = (int32_t)at;
            smoothed->kept[q] = kept[c];
        }
    }
    return STATUS_OK;
}

enum status merged_cells_build(const struct body_input *input, struct body *body, struct error *error)
{
    NEW_SCRATCH(int64_t, root, body->point_count, error);
    NEW_SCRATCH(double, kept, body->point_count, error);
    RETURN_IF_ERROR(find_merged(input, root, error));
    RETURN_IF_ERROR(join_junctions(input, root, kept, error));
    return order_groups(root, kept, body, error);
}

int merged_cells_domain(const struct body *body, int64_t q, int32_t node, struct domain *domain)
{
    int dim = body->dim, number = -1;
    double gradient[12];
    domain->first = smoothed_cells_group(body, q);
    domain->end = smoothed_cells_group_end(body, q);
    domain->count = 0;
    domain->weight = 0.0;
    for (int64_t c = domain->first; c < domain->end; c++) {
        domain->weight += body->weight[c];
    }
    for (int64_t c = domain->first; c < domain->end; c++) {
        smoothed_cells_linear_gradients(body, c, gradient);
        for (int k = 0; k <= dim; k++) {
            int32_t own = smoothed_cells_node(body, c, k);
            int at = 0;
            while (at < domain->count && domain->node[at] != own) {
                at++;
            }
            if (at == domain->count) {
                domain->node[domain->count++] = own;
                memset(domain->gradient[at], 0, sizeof domain->gradient[at]);
            }
            if (own == node && c < q) {
                return -1;
            }
            number = own == node ? at : number;
            add_scaled(dim, body->weight[c] / domain->weight, gradient + k * dim, domain->gradient[at]);
        }
    }
    return number;
}

/* Replace the rows of a group of cells by what they keep and the rest of their mean, or by what they keep and
 * the shares w_i / W of the rest of their sum. */
static void average_rows(const struct body *body, const struct block *block, int64_t begin, int64_t end,
                         bool sum, block_rows rows)
{
    const double *weight = body->weight;
    double whole = 0.0, kept = body->cells.kept[begin];
    for (int64_t q = begin; q < end; q++) {
        whole += weight[q];
    }
    for (int k = 0; k < body->dim * body->dim; k++) {
        double *row = rows[k] - block->first_point, mean = 0.0;
        for (int64_t q = begin; q < end; q++) {
            mean += (sum ? 1.0 : weight[q]) * row[q];
        }
        mean *= (1.0 - kept) / whole;
        for (int64_t q = begin; q < end; q++) {
            row[q] = kept * row[q] + (sum ? weight[q] : 1.0) * mean;
        }
    }
}

/* The next group of several cells of a block, from *begin on; false: there is none. */
static bool next_group(const struct body *body, const struct block *block, int64_t *begin, int64_t *end)
{
    int64_t last = block->first_point + block->point_count;
    for (; *begin < last; *begin = *end) {
        *end = body->cells.group_end[*begin];
        if (*end > *begin + 1) {
            return true;
        }
    }
    return false;
}

/* det F and J of a cell from rows of its block. */
static void set_ratios(const struct body *body, int64_t i, const block_rows F, const block_rows interpolant,
                       double *determinants, double *J)
{
    double f[9], h[9], C[9];
    stress_matrix(body->dim, &F[0][i], BLOCK_MOST_POINTS, f);
    stress_matrix(body->dim, &interpolant[0][i], BLOCK_MOST_POINTS, h);
    cofactor(h, C);
    determinants[i] = determinant(f);
    J[i] = determinant(h);
    for (int k = 0; k < 9; k++) {
        J[i] -= C[k] * (h[k] - f[k]);
    }
}

void merged_cells_gradients(const struct body *body, const struct block *block, block_rows F,
                            block_rows interpolant, double *determinants, double *J)
{
    for (int64_t begin = block->first_point, end; next_group(body, block, &begin, &end); begin = end) {
        average_rows(body, block, begin, end, false, F);
        average_rows(body, block, begin, end, false, interpolant);
        for (int64_t q = begin; q < end; q++) {
            set_ratios(body, q - block->first_point, (const double(*)[BLOCK_MOST_POINTS])F,
                       (const double(*)[BLOCK_MOST_POINTS])interpolant, determinants, J);
        }
    }
}

void merged_cells_stresses(const struct body *body, const struct block *block, block_rows P, block_rows T)
{
    for (int64_t begin = block->first_point, end; next_group(body, block, &begin, &end); begin = end) {
        average_rows(body, block, begin, end, true, P);
        average_rows(body, block, begin, end, true, T);
    }
}
