/* The loop over the voxels of a moved image, or of the field as an image. */
#pragma once

#include "images/images.h"

#include "approx/field/motion.h"

/* Values for voxels outside of the moved body, by their label in the image. */
enum { WARP_MOST_LABELS = 256 };
struct warp_values {
    int count;
    double label[WARP_MOST_LABELS], value[WARP_MOST_LABELS];
    bool others; /* all other voxels have the value: */
    double other;
};

/* The options of a run. */
struct warp_request {
    enum image_method method;
    bool field, inverse, verbose;
    struct warp_values fill, vacated;
    char section[32]; /* u, u.frame.K */
};

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
    const struct warp_request *request;
    const struct image *source; /* NULL: the field is written */
    double source_voxel[3][4];
    const struct motion *motion;
    const int32_t *owner,
        *other;       /* cell of each voxel in the state of the result; and in the other state, or NULL */
    double tolerance; /* m */
    const struct image_axes *axes;
    struct image *result;
};

/* Find the value of each voxel of the result, and count. */
void warp_voxels(const struct warp_job *job, struct warp_report *report);
