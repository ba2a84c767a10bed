/* A partial sum of a symmetric block matrix whose rows and columns are the coarse fields (coarse_space.h);
 * private to lib/solid/preconditioner. Only the blocks between its own list of centres are stored. */
#pragma once

#include "base/ranks.h"
#include "base/status.h"

#include <stdint.h>

struct centre_sums {
    int64_t numbers;      /* rows and columns of a block: fields of a centre times directions */
    int64_t centre_count; /* of the coarse space */
    int64_t count, room;  /* centres that have blocks; blocks are allocated for `room` of them */
    int32_t *centre;      /* centre_count: these */
    int32_t *place;       /* centre_count: where a centre is among these, or -1 */
    double *block; /* packed lower triangle: the block of places i >= k is number i (i + 1) / 2 + k. Its
                      rows are the fields of the centre of the higher number, its columns the other's */
};

/* No centre has a block yet. Errors, here and below: STATUS_SYSTEM (memory). */
MUST_CHECK enum status centre_sums_begin(int64_t centre_count, int64_t numbers, struct centre_sums *sums,
                                         struct error *error);
void centre_sums_free(struct centre_sums *sums);

/* Allocate blocks, which are zero, for `more` further centres. */
MUST_CHECK enum status centre_sums_make_room(struct centre_sums *sums, int64_t more, struct error *error);

/* The number of the block between two places. */
static inline int64_t centre_sums_pair(int64_t i, int64_t k)
{
    return i > k ? i * (i + 1) / 2 + k : k * (k + 1) / 2 + i;
}

/* The place of a centre; one without gets the next. There must be room. */
static inline int64_t centre_sums_place(struct centre_sums *sums, int32_t centre)
{
    if (sums->place[centre] < 0) {
        sums->place[centre] = (int32_t)sums->count;
        sums->centre[sums->count++] = centre;
    }
    return sums->place[centre];
}
/* The block between two centres. */
static inline double *centre_sums_block(struct centre_sums *sums, int32_t one, int32_t other)
{
    int64_t place = centre_sums_place(sums, one), other_place = centre_sums_place(sums, other);
    return sums->block + centre_sums_pair(place, other_place) * sums->numbers * sums->numbers;
}

/* Collective. All processes receive the sums of one, which the others have begun and left empty. */
MUST_CHECK enum status centre_sums_send(const struct ranks *ranks, int owner, struct centre_sums *sums,
                                        struct error *error);

/* matrix[size * size] += the sums, in its lower triangle of blocks; size = centre_count * numbers. */
void centre_sums_add(const struct centre_sums *sums, double *matrix);

/* Set the upper triangle from the lower triangle of blocks. Diagonal blocks, given in full, become their
 * symmetric parts. */
void centre_sums_mirror(int64_t centre_count, int64_t numbers, double *matrix);
