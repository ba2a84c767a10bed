#include "approx/steep_bound.h"

#include "approx/steep_kernel.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Pivots must exceed H so many times. */
static const double pivot_per_regularisation = 1e3;
/* The least squared support radius, as a share of the largest, in whose scale floats place the candidates. */
static const double least_share_of_reach2 = 1e-2;
/* The bound is raised for H and for the round-off of floats. */
static const double allowance = 1.1;

/* Rows of scratch, see struct steep_group: dim, 1, STEEP_LANES and STEEP_LANES of them. */
enum {
    ROW_OF_RATIO = 3,
    ROW_OF_WEIGHT,
    ROW_OF_SHARE = ROW_OF_WEIGHT + STEEP_LANES,
    STEEP_ROWS = ROW_OF_SHARE + STEEP_LANES
};

void steep_work_free(struct steep_work *work)
{
    free(work->values);
    *work = (struct steep_work){0};
}

static enum status reserve(struct steep_work *work, int64_t count, struct error *error)
{
    enum status status = STATUS_OK;
    if (count > work->capacity) {
        free(work->values);
        work->capacity = 0;
        TRY(NEW_ARRAY(&work->values, 2 * count * STEEP_ROWS, error));
        work->capacity = 2 * count;
    }
    if (work->kernels == NULL) {
        work->kernels = steep_kernels_select();
    }
done:
    return status;
}

/* H in the scale of a group: at most that of a point, whose scale is no larger. */
static void ask_for_pivots(const struct mls *mls, struct steep_group *group)
{
    double scale4 = group->scale * group->scale * group->scale * group->scale;
    for (int k = 0; k < MLS_MAX_BASIS; k++) {
        int second = k - 1 - mls->dim;
        bool regularised = mls->basis == BASIS_MODIFIED && second >= 0 && second < MLS_MAX_SECOND;
        double mu = regularised ? mls->mu[second] / (mls->mu_absolute ? scale4 : 1.0) : 0.0;
        group->least_pivot[k] = (float)(pivot_per_regularisation * mu);
    }
}

/* Candidates around `origin`; false where there are none, or their radii differ too much for floats. */
static bool place_group(const struct mls *mls, const struct candidates *candidates, const double *origin,
                        struct steep_work *work, struct steep_group *group)
{
    double most = 0.0, least = INFINITY;
    float *place = work->values, *ratio = place + ROW_OF_RATIO * work->capacity;
    for (int64_t i = 0; i < candidates->list.count; i++) {
        most = candidates->reach2[i] > most ? candidates->reach2[i] : most;
        least = candidates->reach2[i] < least ? candidates->reach2[i] : least;
    }
    if (!(most > 0.0) || !(least > least_share_of_reach2 * most) || !isfinite(most)) {
        return false;
    }
    *group = (struct steep_group){.count = candidates->list.count,
                                  .scale = sqrt(most),
                                  .place = place,
                                  .ratio = ratio,
                                  .weight = place + ROW_OF_WEIGHT * work->capacity,
                                  .share = place + ROW_OF_SHARE * work->capacity,
                                  .stride = work->capacity};
    double inverse = 1.0 / group->scale;
    for (int a = 0; a < mls->dim; a++) {
        for (int64_t i = 0; i < group->count; i++) {
            double difference = candidates->place[a * candidates->capacity + i] - origin[a];
            place[a * work->capacity + i] = (float)(difference * inverse);
        }
    }
    for (int64_t i = 0; i < group->count; i++) {
        ratio[i] = (float)(most / candidates->reach2[i]);
    }
    ask_for_pivots(mls, group);
    return true;
}

/* Bounds of the points from `first` on, STEEP_LANES of them or what there is. */
static void bound_some(steep_kernel *kernel, struct steep_group *group, int dim, int64_t first, int64_t count,
                       const double *x, double *bound)
{
    float place[3 * STEEP_LANES], result[STEEP_LANES];
    for (int l = 0; l < STEEP_LANES; l++) {
        int64_t p = first + l < count ? first + l : count - 1;
        for (int a = 0; a < dim; a++) {
            place[a * STEEP_LANES + l] = (float)((x[p * dim + a] - x[a]) / group->scale);
        }
    }
    kernel(group, place, result);
    for (int l = 0; l < STEEP_LANES && first + l < count; l++) {
        bound[first + l] = allowance * (double)result[l] / group->scale;
    }
}

enum status steep_bounds(const struct mls *mls, const struct candidates *candidates, int64_t count,
                         const double *x, struct steep_work *work, double *bound, struct error *error)
{
    enum status status;
    struct steep_group group;
    int space = mls->dim - 2;
    for (int64_t p = 0; p < count; p++) {
        bound[p] = INFINITY;
    }
    TRY(reserve(work, candidates->list.count, error));
    if (mls->weight == WEIGHT_QUARTIC && place_group(mls, candidates, x, work, &group)) {
        steep_kernel *kernel =
            mls->basis == BASIS_LINEAR ? work->kernels->linear[space] : work->kernels->quadratic[space];
        for (int64_t first = 0; first < count; first += STEEP_LANES) {
            bound_some(kernel, &group, mls->dim, first, count, x, bound);
        }
    }
done:
    return status;
}
