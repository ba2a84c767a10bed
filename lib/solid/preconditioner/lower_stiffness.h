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

/* The lower triangle of S with its diagonal, by rows: those of a range of own nodes, and the others that are
 * needed. */
struct lower {
    struct scalar_stiffness stiffness;
    int64_t *begin, *end; /* of each row in its piece; none: the same */
    uint8_t *piece_of;    /* each row: its piece */
    int piece_count;
    struct lower_piece piece[2 * CHUNKS_MOST + 1];
    double *diagonal; /* of all rows so far, in the body's order */
    double least;     /* on the diagonal */
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

/* No rows yet; least 0. */
MUST_CHECK enum status lower_begin(const struct solid_system *system, struct lower *lower,
                                   struct error *error);
void lower_free(struct lower *lower);

/* The rows of own nodes (body_share.h) from `first` to before `last` in the body's order, by several threads,
 * in place of those that are there. */
MUST_CHECK enum status lower_make(int64_t first, int64_t last, struct lower *lower, struct error *error);

/* Add those rows of own nodes that are wanted (wanted[node_count], the caller's numbers) and have not been
 * made. */
MUST_CHECK enum status lower_add(const bool *wanted, struct lower *lower, struct error *error);

/* Set `least` from the diagonal, when all rows have been made; false where it is above some of that. */
bool lower_set_least(struct lower *lower);

/* With several processes: fetch the wanted rows of S that other processes have made. */
MUST_CHECK enum status lower_fetch(const bool *wanted, struct lower *lower, struct error *error);

/* S_ij, j <= i; 0 where there is no such entry. */
double lower_entry(const struct lower *lower, int32_t i, int32_t j);
