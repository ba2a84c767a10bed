#include "base/null_space.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status null_space_begin(int32_t blocks, int size, int most, struct null_space *space,
                             struct error *error)
{
    *space = (struct null_space){.blocks = blocks, .size = size, .most = most, .complete = true};
    RETURN_IF_ERROR(NEW_ARRAY(&space->group, blocks, error));
    RETURN_IF_ERROR(NEW_ARRAY(&space->next, blocks, error));
    RETURN_IF_ERROR(NEW_ARRAY(&space->columns, blocks, error));
    RETURN_IF_ERROR(NEW_ARRAY(&space->basis, blocks, error));
    RETURN_IF_ERROR(NEW_ARRAY(&space->value, (int64_t)blocks * size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&space->touched, blocks, error));
    RETURN_IF_ERROR(NEW_ARRAY(&space->is_touched, blocks, error));
    for (int32_t b = 0; b < blocks; b++) {
        space->group[b] = space->next[b] = b;
        space->columns[b] = size;
        RETURN_IF_ERROR(NEW_ARRAY(&space->basis[b], (int64_t)size * size, error));
        for (int k = 0; k < size; k++) {
            space->basis[b][k * (size + 1)] = 1.0;
        }
    }
    return STATUS_OK;
}

void null_space_free(struct null_space *space)
{
    for (int32_t b = 0; b < space->blocks && space->basis != NULL; b++) {
        free(space->basis[b]);
    }
    FREE_ALL(space->group, space->next, space->columns, space->basis, space->value, space->touched,
             space->is_touched);
    *space = (struct null_space){0};
}

void null_space_add(struct null_space *space, int32_t block, double factor, const double *value)
{
    if (!space->is_touched[block]) {
        space->is_touched[block] = true;
        space->touched[space->touched_count++] = block;
    }
    add_scaled(space->size, factor, value, space->value + (int64_t)block * space->size);
}

/* Insert columns of zeros before and behind the columns of a group's blocks. */
static enum status widen(struct null_space *space, int32_t of, int before, int behind, struct error *error)
{
    int32_t b = of;
    do {
        int columns = space->columns[b], wide = before + columns + behind;
        double *basis = NULL;
        RETURN_IF_ERROR(NEW_ARRAY(&basis, (int64_t)space->size * wide, error));
        for (int i = 0; i < space->size; i++) {
            memcpy(basis + (int64_t)i * wide + before, space->basis[b] + (int64_t)i * columns,
                   (size_t)columns * sizeof *basis);
        }
        free(space->basis[b]);
        space->basis[b] = basis;
        space->columns[b] = wide;
        b = space->next[b];
    } while (b != of);
    return STATUS_OK;
}

/* Merge the groups of two blocks. */
static enum status join(struct null_space *space, int32_t a, int32_t b, struct error *error)
{
    int of_a = space->columns[a], of_b = space->columns[b];
    RETURN_IF_ERROR(widen(space, a, 0, of_b, error));
    RETURN_IF_ERROR(widen(space, b, of_a, 0, error));
    for (int32_t k = space->next[b]; k != b; k = space->next[k]) {
        space->group[k] = space->group[a];
    }
    space->group[b] = space->group[a];
    int32_t next = space->next[a];
    space->next[a] = space->next[b];
    space->next[b] = next;
    return STATUS_OK;
}

/* Remove the direction v[columns], of length `length`, from the basis of a group: a Householder reflection
 * maps it to the last column, which is dropped. v is overwritten. */
static void take_out(struct null_space *space, int32_t of, double length, double *v)
{
    int columns = space->columns[of], last = columns - 1;
    v[last] += copysign(length, v[last]);
    double factor = 2.0 / vector_dot(columns, v, v);
    int32_t b = of;
    do {
        double *row = space->basis[b], *to = space->basis[b];
        for (int i = 0; i < space->size; i++, row += columns, to += last) {
            double along = factor * vector_dot(columns, v, row);
            for (int k = 0; k < last; k++) {
                to[k] = row[k] - along * v[k];
            }
        }
        space->columns[b] = last;
        b = space->next[b];
    } while (b != of);
}

/* Merge the groups of the blocks that the condition touches. *of: one of these blocks; -1 if all are held, or
 * if the basis would be too large. */
static enum status gather(struct null_space *space, int32_t *of, struct error *error)
{
    *of = -1;
    for (int32_t i = 0; i < space->touched_count; i++) {
        int32_t b = space->touched[i];
        if (space->columns[b] == 0 || (*of >= 0 && space->group[b] == space->group[*of])) {
            continue;
        }
        if (*of < 0) {
            *of = b;
        } else if (space->columns[b] + space->columns[*of] <= space->most) {
            RETURN_IF_ERROR(join(space, *of, b, error));
        } else {
            space->complete = false;
            *of = -1;
            return STATUS_OK;
        }
    }
    return STATUS_OK;
}

enum status null_space_impose(struct null_space *space, double least, struct error *error)
{
    int32_t of;
    RETURN_IF_ERROR(gather(space, &of, error));
    int columns = of < 0 ? 0 : space->columns[of];
    NEW_SCRATCH(double, v, columns, error);
    for (int32_t i = 0; i < space->touched_count; i++) {
        int32_t b = space->touched[i];
        double *value = space->value + (int64_t)b * space->size;
        for (int k = 0; k < space->size && columns > 0 && space->columns[b] > 0; k++) {
            add_scaled(columns, value[k], space->basis[b] + (int64_t)k * columns, v);
        }
        memset(value, 0, (size_t)space->size * sizeof *value);
        space->is_touched[b] = false;
    }
    space->touched_count = 0;
    double length = sqrt(vector_dot(columns, v, v));
    if (length > least) {
        take_out(space, of, length, v);
    }
    return STATUS_OK;
}
