#include "approx/cells/renumber.h"

#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

struct sort_key {
    uint64_t place;
    int64_t index;
    int32_t group;
};

static int compare_keys(const void *left, const void *right)
{
    const struct sort_key *a = left, *b = right;
    int groups = compare_int32(&a->group, &b->group);
    int places = (a->place > b->place) - (a->place < b->place);
    return groups != 0 ? groups : places != 0 ? places : compare_int64(&a->index, &b->index);
}

/* The Morton code of a point: the bits of its coordinates, interleaved. */
static uint64_t morton(int dim, const double *x, const double *low, double extent)
{
    uint64_t place = 0, cell[3];
    const int bits = 20;
    for (int a = 0; a < dim; a++) {
        cell[a] = (uint64_t)((x[a] - low[a]) / extent * ((1 << bits) - 1));
    }
    for (int b = bits - 1; b >= 0; b--) {
        for (int a = 0; a < dim; a++) {
            place = place << 1 | (cell[a] >> b & 1);
        }
    }
    return place;
}

enum status renumber_morton(int dim, int64_t count, const double *x, const int32_t *group, int64_t *order,
                            struct error *error)
{
    struct box box = box_of(dim, count, x);
    double extent = fmax(1e-300, box_side(&box));
    NEW_SCRATCH(struct sort_key, keys, count, error);
    for (int64_t i = 0; i < count; i++) {
        keys[i] =
            (struct sort_key){morton(dim, x + i * dim, box.low, extent), i, group != NULL ? group[i] : 0};
    }
    qsort(keys, (size_t)count, sizeof *keys, compare_keys);
    for (int64_t i = 0; i < count; i++) {
        order[i] = keys[i].index;
    }
    return STATUS_OK;
}
