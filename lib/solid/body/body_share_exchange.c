/* What the processes of a body send each other in an evaluation, and behind it. */
#include "solid/body/body.h"

void body_share_gather(const struct body_share *share, void *items, size_t size, const int64_t *first)
{
    if (share->ranks != NULL) {
#pragma omp master
        ranks_gather(share->ranks, items, size, first);
#pragma omp barrier
    }
}

void body_share_exchange(const struct body_share *share, struct halo *halo, int width, double *x)
{
    if (share->ranks != NULL) {
#pragma omp master
        halo_exchange(halo, width, x);
#pragma omp barrier
    }
}

void body_share_collect_pressures(struct body *body)
{
    ranks_gather(body->share.ranks, body->volumes.pressure, sizeof *body->volumes.pressure,
                 body->share.volume_first);
}

void body_share_collect(struct body *body)
{
    const struct body_share *share = &body->share;
    int components = body->dim * body->dim;
    for (int k = 0; k < components; k++) {
        ranks_gather(share->ranks, body->F + k * body->point_count, sizeof *body->F, share->point_first);
        if (body->smoothed) {
            ranks_gather(share->ranks, body->cells.interpolant + k * body->point_count, sizeof *body->F,
                         share->point_first);
        }
    }
    ranks_gather(share->ranks, body->J, sizeof *body->J, share->point_first);
    body_collect_history(body);
    if (body->averaged) {
        ranks_gather(share->ranks, body->volumes.change, sizeof *body->volumes.change, share->point_first);
        body_share_collect_pressures(body);
    }
    if (body->averaged && body->volumes.slope != NULL) {
        ranks_gather(share->ranks, body->volumes.slope, sizeof *body->volumes.slope, share->volume_first);
    }
    if (body->averaged && body->volumes.direct != NULL) {
        ranks_gather(share->ranks, body->volumes.direct, sizeof *body->volumes.direct, share->point_first);
    }
}
