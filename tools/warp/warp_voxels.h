/* The loop over the voxels of a moved image, or of the field as an image. */
#pragma once

#include "images/images.h"

#include "approx/field/motion.h"

/* The outcome: numbers of voxels, and largest values. */
struct warp_report {
    int64_t moved, vacated, beyond; /* in the moved body; uncovered; with a place outside of the image */
    int64_t left;                   /* uncovered, with their old value */
    int64_t doubly, inexact;        /* in two cells; whose place was not found */
    double farthest;                /* displacement, m */
    double inconsistency;           /* |place(X) - x|, m */
};

/* The input of the loop over voxels. */
struct warp_job {
    enum image_method method;
    bool inverse;
    double fill, vacated;       /* values outside of the moved body, and where it has been; NAN: not given */
    const struct image *source; /* NULL: the field is written */
    double source_voxel[3][4];
    const struct motion *motion;
    const int32_t *owner,
        *other;       /* cell of each voxel in the state of the result; and in the other state, or NULL */
    double tolerance; /* m */
    const struct image_axes *axes;
    struct image *result;
};

/* Find the value of each voxel of the result, and add to the report. */
void warp_voxels(const struct warp_job *job, struct warp_report *report);
