/* Bins over the facets of a rigid surface. */
#include "base/memory.h"
#include "solid/rigid_private.h"

static struct box facet_box(const struct rigid_surface *surface, int64_t f)
{
    int dim = surface->dim;
    struct box box = box_of(dim, 0, NULL);
    for (int k = 0; k < dim; k++) {
        box_add(&box, 1, surface->vertex + (int64_t)surface->facet[f * dim + k] * dim);
    }
    return box;
}

/* The box of a facet in bins: first[3] to last[3], both included. */
static void facet_bins(const struct rigid_surface *surface, int64_t f, int64_t first[3], int64_t last[3])
{
    struct box box = facet_box(surface, f);
    first[2] = last[2] = 0;
    for (int a = 0; a < surface->dim; a++) {
        double most = (double)(surface->bins[a] - 1);
        first[a] = (int64_t)fmin((box.low[a] - surface->origin[a]) / surface->bin, most);
        last[a] = (int64_t)fmin((box.high[a] - surface->origin[a]) / surface->bin, most);
    }
}

/* Whether the facet's plane passes near a bin: large facets do not fill all bins of their box. */
static bool passes_near(const struct rigid_surface *surface, int64_t f, const int64_t at[3])
{
    int dim = surface->dim;
    double height = 0.0;
    const double *x0 = surface->vertex + (int64_t)surface->facet[f * dim] * dim;
    for (int a = 0; a < dim; a++) {
        double centre = surface->origin[a] + ((double)at[a] + 0.5) * surface->bin;
        height += (centre - x0[a]) * surface->normal[f * dim + a];
    }
    return fabs(height) <= 0.9 * surface->bin;
}

/* Visit the bins of every facet: count them in counts[bin], or with `fill` store the facet at counts[bin]++.
 */
static void visit_bins(struct rigid_surface *surface, int64_t *counts, bool fill)
{
    int64_t first[3], last[3], at[3];
    for (int64_t f = 0; f < surface->facet_count; f++) {
        facet_bins(surface, f, first, last);
        for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
            for (at[1] = first[1]; at[1] <= last[1]; at[1]++) {
                for (at[2] = first[2]; at[2] <= last[2]; at[2]++) {
                    if (!passes_near(surface, f, at)) {
                        continue;
                    }
                    int64_t bin = (at[0] * surface->bins[1] + at[1]) * surface->bins[2] + at[2];
                    if (fill) {
                        surface->in_bin[counts[bin]] = (int32_t)f;
                    }
                    counts[bin]++;
                }
            }
        }
    }
}

/* Bins of the facets' mean size, but no more than a few for each facet. */
static void size_bins(struct rigid_surface *surface, const struct box *box)
{
    int dim = surface->dim;
    double mean = 0.0, most = 8.0 * (double)surface->facet_count + 64.0, bins;
    for (int64_t f = 0; f < surface->facet_count; f++) {
        struct box facet = facet_box(surface, f);
        mean += box_side(&facet) / (double)surface->facet_count;
    }
    surface->bin = mean;
    do {
        bins = 1.0;
        for (int a = 0; a < 3; a++) {
            double along = a < dim ? fmax(1.0, ceil((box->high[a] - box->low[a]) / surface->bin)) : 1.0;
            bins *= along;
            surface->bins[a] = along <= most ? (int64_t)along : 1;
            surface->origin[a] = a < dim ? box->low[a] : 0.0;
        }
        surface->bin *= bins > most ? 1.25 : 1.0;
    } while (bins > most);
}

enum status rigid_fill_bins(struct rigid_surface *surface, const struct box *box, struct error *error)
{
    enum status status;
    size_bins(surface, box);
    int64_t count = surface->bins[0] * surface->bins[1] * surface->bins[2];
    /* Counted two places on, so that filling leaves the starts where they belong. */
    TRY(NEW_ARRAY(&surface->start, count + 2, error));
    visit_bins(surface, surface->start + 2, false);
    for (int64_t b = 0; b < count; b++) {
        surface->start[b + 2] += surface->start[b + 1];
    }
    TRY(NEW_ARRAY(&surface->in_bin, surface->start[count + 1], error));
    visit_bins(surface, surface->start + 1, true);
done:
    return status;
}
