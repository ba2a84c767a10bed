/* A symmetric matrix between the coarse fields of some centres (coarse_space.h), as a sum that is made in
 * parts; private to lib/solid/preconditioner. Each part knows the centres that it has blocks between, so that
 * it is small where these are few. */
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
    double *block; /* numbers * numbers for each pair of places i >= k, row by row of the pairs: its rows
                      are the fields of the higher centre */
};

/* No centre has a block yet. Errors, here and below: STATUS_SYSTEM (memory). */
MUST_CHECK enum status centre_sums_begin(int64_t centre_count, int64_t numbers, struct centre_sums *sums,
                                         struct error *error);
void centre_sums_free(struct centre_sums *sums);

/* Allocate blocks, which are zero, for `more` further centres. */
MUST_CHECK enum status centre_sums_make_room(struct centre_sums *sums, int64_t more, struct error *error);

/* The place of the pair of places i and k. */
static inline int64_t centre_sums_pair(int64_t i, int64_t k)
{
    return i > k ? i * (i + 1) / 2 + k : k * (k + 1) / 2 + i;
}

/* The block between two centres; there must be room for those that have none yet. */
static inline int64_t centre_sums_place(struct centre_sums *sums, int32_t centre)
{
    if (sums->place[centre] < 0) {
        sums->place[centre] = (int32_t)sums->count;
        sums->centre[sums->count++] = centre;
    }
    return sums->place[centre];
}
static inline double *centre_sums_block(struct centre_sums *sums, int32_t one, int32_t other)
{
    int64_t pair = centre_sums_pair(centre_sums_place(sums, one), centre_sums_place(sums, other));
    return sums->block + pair * sums->numbers * sums->numbers;
}

/* Collective. All processes receive the sums of one, which the others have begun and left empty. */
MUST_CHECK enum status centre_sums_send(const struct ranks *ranks, int owner, struct centre_sums *sums,
                                        struct error *error);

/* matrix[size * size] += the sums, in its lower triangle of blocks; size = centre_count * numbers. */
void centre_sums_add(const struct centre_sums *sums, double *matrix);

/* Complete a matrix of which the lower triangle of blocks is known, of blocks on the diagonal all. These
 * become symmetric. */
void centre_sums_mirror(int64_t centre_count, int64_t numbers, double *matrix);
