/* Cuts in faces where three labels meet. */
#include "approx/labels/label_cells_cut_private.h"
#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Whether an edge between two corners of a piece leads from a cut to a third label. */
static bool is_second(const struct cutting *cutting, int32_t cut, int32_t point)
{
    const struct lattice *lattice = cutting->lattice;
    if (cut < lattice->node_count || cut >= lattice->node_count + cutting->cuts ||
        point >= lattice->node_count || lattice->on[point]) {
        return false;
    }
    const int32_t *end = lattice->end + 2 * (int64_t)cutting->cut_edge[cut - lattice->node_count];
    int32_t label = lattice->label[point];
    return !same_side(lattice, label, lattice->label[end[0]]) &&
           !same_side(lattice, label, lattice->label[end[1]]);
}

static int compare_seconds(const void *left, const void *right)
{
    return compare_numbers(2, left, right);
}

enum status cutting_again(struct cutting *cutting, struct cutting_pieces *pieces, struct error *error)
{
    for (int i = 0; i < pieces->count; i++) {
        for (int kl = 0; kl < pieces->corners * pieces->corners; kl++) {
            struct second_cut key = {pieces->node[i][kl / pieces->corners],
                                     pieces->node[i][kl % pieces->corners], -1};
            if (!is_second(cutting, key.cut, key.point)) {
                continue;
            }
            if (cutting->searching) {
                RETURN_IF_ERROR(
                    GROW_ARRAY(&cutting->second, cutting->seconds + 1, &cutting->second_room, error));
                cutting->second[cutting->seconds++] = key;
                continue;
            }
            const struct second_cut *found =
                bsearch(&key, cutting->second, (size_t)cutting->seconds, sizeof key, compare_seconds);
            if (found != NULL && found->node >= 0 &&
                !cutting_bisect(pieces, key.cut, key.point, found->node)) {
                return fail(error, STATUS_INPUT,
                            "a cell of the lattice has too many pieces: another spacing?");
            }
        }
    }
    return STATUS_OK;
}

/* The place of a second cut, as a share of the way from the first cut: the place where the label of the point
 * begins. 0: near the first cut. */
static double second_change(const struct cutting *cutting, const struct second_cut *second)
{
    const struct lattice *lattice = cutting->lattice;
    const int32_t *end = lattice->end + 2 * (int64_t)cutting->cut_edge[second->cut - lattice->node_count];
    const double *from = cutting->x + (int64_t)second->cut * lattice->dim,
                 *to = cutting->x + (int64_t)second->point * lattice->dim;
    double most = 0;
    for (int k = 0; k < 2; k++) {
        int32_t a = lattice->label[end[k]], b = lattice->label[second->point];
        if (lattice->keep[a] || lattice->keep[b]) {
            most = fmax(most, lattice_change(lattice, from, to, a, b));
        }
    }
    return most < LATTICE_NEAR ? 0 : fmin(most, 1 - LATTICE_NEAR);
}

enum status cutting_seconds(struct cutting *cutting, struct error *error)
{
    const struct lattice *lattice = cutting->lattice;
    int dim = lattice->dim;
    int64_t count = 0;
    if (cutting->seconds > 0) {
        qsort(cutting->second, (size_t)cutting->seconds, sizeof *cutting->second, compare_seconds);
    }
    for (int64_t s = 0; s < cutting->seconds; s++) {
        if (s == 0 || compare_seconds(&cutting->second[s], &cutting->second[s - 1]) != 0) {
            cutting->second[count++] = cutting->second[s];
        }
    }
    cutting->seconds = count;
    RETURN_IF_ERROR(RESIZE_ARRAY(&cutting->x, (cutting->node_count + count + 1) * dim, error));
    double *x = cutting->x;
    for (int64_t s = 0; s < count; s++) {
        struct second_cut *second = &cutting->second[s];
        double share = second_change(cutting, second);
        for (int d = 0; d < dim && share > 0; d++) {
            double from = x[(int64_t)second->cut * dim + d], to = x[(int64_t)second->point * dim + d];
            x[cutting->node_count * dim + d] = from + share * (to - from);
        }
        second->node = share > 0 ? (int32_t)cutting->node_count++ : -1;
    }
    return STATUS_OK;
}
