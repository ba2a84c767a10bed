/* The scalar stiffness S of inverse_stiffness.h by rows up to the diagonal; private to lib/solid. */
#pragma once

#include "base/chunks.h"
#include "solid/preconditioner/inverse_stiffness.h"
#include "solid/preconditioner/scalar_stiffness.h"

/* Consecutive rows. */
struct lower_piece {
    int32_t *idx;
    double *value;
    int64_t count, capacity; /* entries */
};

/* The lower triangle of S with its diagonal, by rows: those of a range of own nodes, and further rows that
 * are needed. */
struct lower {
    struct scalar_stiffness stiffness;
    int64_t *begin, *end; /* of each row in its piece; equal: the row does not exist yet */
    uint8_t *piece_of;    /* piece of each row */
    int piece_count;
    struct lower_piece piece[2 * CHUNKS_MOST + 1];
    double *diagonal; /* of the rows made so far, in the body's order */
    double least;     /* least diagonal entry */
};

/* A row of S up to the diagonal: columns, ascending, and values. */
struct lower_row {
    int64_t count;
    const int32_t *idx;
    const double *value;
};
static inline struct lower_row lower_row(const struct lower *lower, int64_t i)
{
    const struct lower_piece *piece = &lower->piece[lower->piece_of[i]];
    int64_t begin = lower->begin[i];
    return (struct lower_row){lower->end[i] - begin, piece->idx + begin, piece->value + begin};
}

/* Prepare for a system; there are no rows yet, and `least` is 0. */
MUST_CHECK enum status lower_begin(const struct solid_system *system, struct lower *lower,
                                   struct error *error);
void lower_free(struct lower *lower);

/* Make the rows of own nodes (body_share.h) from `first` to before `last` in the body's order, in place of
 * earlier ones. Threaded. */
MUST_CHECK enum status lower_make(int64_t first, int64_t last, struct lower *lower, struct error *error);

/* Make the wanted rows of own nodes that do not exist yet. wanted[node_count]: by the caller's numbers. */
MUST_CHECK enum status lower_add(const bool *wanted, struct lower *lower, struct error *error);

/* Set `least` from the diagonal, after all rows have been made; false if a diagonal entry is less. */
bool lower_set_least(struct lower *lower);

/* With several processes: fetch the wanted rows of S that other processes have made. */
MUST_CHECK enum status lower_fetch(const bool *wanted, struct lower *lower, struct error *error);

/* S_ij, j <= i; 0 if there is no such entry. */
double lower_entry(const struct lower *lower, int32_t i, int32_t j);
