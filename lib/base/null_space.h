/* The null space of linear conditions on unknowns in blocks, such as the rigid motions of the parts of a
 * body. Conditions come one by one; each takes a direction out of an orthonormal basis. Blocks that no
 * condition joins have bases of their own, so that what is small or held stays cheap. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct null_space {
    int32_t blocks;
    int size;         /* unknowns of a block */
    int most;         /* columns of a basis */
    bool complete;    /* false: a condition was left out, as a basis would have had more columns */
    int32_t *group;   /* blocks: a block that represents the group of this one */
    int32_t *next;    /* blocks: the next block of the group, in a ring */
    int *columns;     /* blocks: of the basis of its group */
    double **basis;   /* blocks: size * columns, the rows of the basis that are its own */
    double *value;    /* blocks * size: the condition that is being collected, */
    int32_t *touched; /* and the blocks that it is on */
    int32_t touched_count;
    bool *is_touched; /* blocks */
};

/* Without conditions: every motion is free. STATUS_SYSTEM for memory, here and below. */
MUST_CHECK enum status null_space_begin(int32_t blocks, int size, int most, struct null_space *space,
                                        struct error *error);
void null_space_free(struct null_space *space);

/* Collect a condition: its coefficients on a block become larger by factor * value[size]. */
void null_space_add(struct null_space *space, int32_t block, double factor, const double *value);

/* Impose the condition that was collected: (sum of coefficients . unknowns) = 0. It counts as met already
 * where it changes by less than `least` over all unit vectors of the null space. The next one begins. */
MUST_CHECK enum status null_space_impose(struct null_space *space, double least, struct error *error);
