/* The scalar stiffness S of inverse_factor.h by rows up to the diagonal; private to lib/solid. */
#ifndef SOLID_LOWER_STIFFNESS_H
#define SOLID_LOWER_STIFFNESS_H

#include "base/chunks.h"
#include "solid/inverse_factor.h"

/* Rows one behind the other. */
struct lower_piece {
    int32_t *idx;
    double *value;
    int64_t count, capacity; /* entries */
};

/* S up to its diagonal, by rows: those of own nodes, by stretches of them, and such others as are needed. */
struct lower {
    int64_t *begin, *end; /* of each row in its piece */
    uint8_t *piece_of;    /* each row: its piece */
    int piece_count;      /* the last one: rows of other processes' nodes */
    struct lower_piece piece[CHUNKS_MOST + 1];
    double least; /* on the diagonal */
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

/* The rows of this process's nodes (body_share.h), by several threads. */
MUST_CHECK enum status lower_make(const struct solid_system *system, struct lower *lower,
                                  struct error *error);
void lower_free(struct lower *lower);

/* Of several processes: the rows of S that are wanted (wanted[node_count]) and that others have. */
MUST_CHECK enum status lower_fetch(const struct solid_system *system, const bool *wanted, struct lower *lower,
                                   struct error *error);

/* S_ij, j <= i; 0 where there is no such entry. */
double lower_entry(const struct lower *lower, int32_t i, int32_t j);

#endif
