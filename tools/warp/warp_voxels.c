#include "warp/warp_voxels.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* place[]: the position in the other state that corresponds to x; outside of the body x itself. */
static void find_place(const struct warp_job *job, int64_t v, const double x[3], double place[3],
                       struct warp_report *report)
{
    int dim = job->motion->cells.dim;
    double residual = 0;
    memcpy(place, x, 3 * sizeof *x);
    if (job->owner[v] < 0) {
        return;
    }
    if (job->inverse) {
        motion_place(job->motion, job->owner[v], x, place);
    } else if (!motion_inverse(job->motion, job->owner[v], x, job->tolerance, place, &residual)) {
        report->inexact++;
    }
    report->moved++;
    report->farthest = fmax(report->farthest, vector_distance(dim, place, x));
    report->inconsistency = fmax(report->inconsistency, residual);
}

/* Set the value of the moved image at voxel v, that of the source at `place`. */
static void put_value(const struct warp_job *job, int64_t v, const double place[3],
                      struct warp_report *report)
{
    size_t components = job->result->components;
    double voxel[3], *value = job->result->values + (size_t)v * components;
    bool outside = job->owner[v] < 0, vacated = outside && job->other[v] >= 0;
    double given = !outside ? NAN : vacated && !isnan(job->vacated) ? job->vacated : job->fill;
    report->vacated += vacated;
    report->left += vacated && isnan(given);
    image_map(&job->source_voxel[0][0], place, voxel);
    if (isnan(given) && image_sample(job->source, job->method, voxel, value)) {
        return;
    }
    report->beyond += isnan(given);
    for (size_t c = 0; c < components; c++) {
        value[c] = !isnan(given) ? given : isnan(job->fill) ? 0 : job->fill;
    }
}

static void do_row(const struct warp_job *job, int64_t row, struct warp_report *report)
{
    struct image *result = job->result;
    int64_t width = (int64_t)result->size[0], height = (int64_t)result->size[1];
    int64_t j = row % height, k = row / height;
    for (int64_t i = 0; i < width; i++) {
        int64_t v = row * width + i;
        const double voxel[3] = {(double)i, (double)j, (double)k};
        double x[3], place[3];
        image_world(result, voxel, x);
        find_place(job, v, x, place, report);
        if (job->source != NULL) {
            put_value(job, v, place, report);
            continue;
        }
        for (int c = 0; c < 3; c++) { /* to ITK's axes and unit */
            int axis = job->axes->world[c];
            result->values[3 * v + axis] = (axis < 2 ? -1e3 : 1e3) * (place[c] - x[c]);
        }
    }
}

void warp_voxels(const struct warp_job *job, struct warp_report *report)
{
    int64_t rows = (int64_t)(job->result->size[1] * job->result->size[2]);
#pragma omp parallel for schedule(dynamic, 16)
    for (int64_t row = 0; row < rows; row++) {
        struct warp_report own = {0};
        do_row(job, row, &own);
#pragma omp critical
        {
            report->moved += own.moved, report->vacated += own.vacated, report->left += own.left;
            report->beyond += own.beyond, report->inexact += own.inexact;
            report->farthest = fmax(report->farthest, own.farthest);
            report->inconsistency = fmax(report->inconsistency, own.inconsistency);
        }
    }
}
