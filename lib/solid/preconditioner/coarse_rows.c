#include "solid/preconditioner/coarse_rows.h"

#include "base/memory.h"
#include "base/processor.h"

#include <string.h>

enum status coarse_rows_begin(const struct coarse_space *coarse, struct coarse_rows *rows,
                              struct error *error)
{
    int64_t groups = coarse->group_count;
    *rows = (struct coarse_rows){.coarse = coarse};
    RETURN_IF_ERROR(NEW_ARRAY(&rows->group, groups, error));
    RETURN_IF_ERROR(NEW_ARRAY(&rows->place, groups, error));
    memset(rows->place, -1, (size_t)groups * sizeof *rows->place);
    return NEW_ARRAY(&rows->value, groups, error);
}

void coarse_rows_free(struct coarse_rows *rows)
{
    FREE_ALL(rows->group, rows->place, rows->value);
    *rows = (struct coarse_rows){0};
}

void coarse_rows_clear(struct coarse_rows *rows)
{
    for (int64_t i = 0; i < rows->count; i++) {
        rows->place[rows->group[i]] = -1;
    }
    rows->count = 0;
}

/* The values of a group, zero at first. */
static double (*values_of(struct coarse_rows *rows, int32_t group))[COARSE_MOST_NUMBERS]
{
    if (rows->place[group] < 0) {
        rows->place[group] = (int32_t)rows->count;
        rows->group[rows->count] = group;
        memset(rows->value[rows->count++], 0, sizeof *rows->value);
    }
    return rows->value[rows->place[group]];
}

/* The dimension is known when compiling, here and below. */
KERNEL_INLINE void add(struct coarse_rows *rows, int dim, int64_t node, int count, const double *block)
{
    const struct coarse_space *coarse = rows->coarse;
    for (int64_t i = coarse->shares.ptr[node]; i < coarse->shares.ptr[node + 1]; i++) {
        double(*to)[COARSE_MOST_NUMBERS] = values_of(rows, coarse->shares.idx[i]), value[4];
        coarse_space_values(coarse, node, coarse->shares.idx[i], coarse->shares.value[i], value);
        for (int r = 0; r < count; r++) {
            for (int k = 0; k < (dim + 1) * dim; k++) {
                to[r][k] += block[r * dim + k % dim] * value[k / dim];
            }
        }
    }
}

ALL_SETS void coarse_rows_add(struct coarse_rows *rows, int64_t node, int count, const double *block)
{
    if (rows->coarse->dim == 2) {
        add(rows, 2, node, count, block);
    } else {
        add(rows, 3, node, count, block);
    }
}

void coarse_rows_add_average(struct coarse_rows *rows, const struct average *average, double factor,
                             int count, const double *direction)
{
    double block[COARSE_MOST_ROWS * 3];
    for (int64_t i = 0; i < average->length; i++) {
        for (int k = 0; k < count * rows->coarse->dim; k++) {
            block[k] = factor * average->phi[i] * direction[k];
        }
        coarse_rows_add(rows, average->idx[i], count, block);
    }
}

void coarse_rows_widen(const struct coarse_rows *rows, struct profile *profile)
{
    int64_t first = profile->count;
    for (int64_t i = 0; i < rows->count; i++) {
        first = rows->group[i] < first ? rows->group[i] : first;
    }
    for (int64_t i = 0; i < rows->count; i++) {
        int64_t *of_group = &profile->first[rows->group[i]];
        *of_group = first < *of_group ? first : *of_group;
    }
}

KERNEL_INLINE void square(const struct coarse_rows *rows, int dim, int row, double factor,
                          const struct profile *profile, double *matrix)
{
    int numbers = (dim + 1) * dim;
    for (int64_t s = 0; s < rows->count; s++) {
        int64_t stride = profile_stride(profile, rows->group[s]);
        for (int64_t t = 0; t < rows->count; t++) {
            if (rows->group[t] > rows->group[s]) {
                continue;
            }
            const double *upper = rows->value[s][row], *lower = rows->value[t][row];
            double *to = profile_block(profile, rows->group[s], rows->group[t], matrix);
            for (int i = 0; i < numbers; i++, to += stride) {
                double scaled = factor * upper[i];
                for (int k = 0; k < numbers; k++) {
                    to[k] += scaled * lower[k];
                }
            }
        }
    }
}

ALL_SETS void coarse_rows_square(const struct coarse_rows *rows, int row, double factor,
                                 const struct profile *profile, double *matrix)
{
    if (rows->coarse->dim == 2) {
        square(rows, 2, row, factor, profile, matrix);
    } else {
        square(rows, 3, row, factor, profile, matrix);
    }
}

KERNEL_INLINE void multiply(const struct coarse_rows *rows, int dim, int64_t node,
                            const struct profile *profile, double *matrix)
{
    const struct coarse_space *coarse = rows->coarse;
    int numbers = (dim + 1) * dim;
    for (int64_t i = coarse->shares.ptr[node]; i < coarse->shares.ptr[node + 1]; i++) {
        int32_t group = coarse->shares.idx[i];
        int64_t stride = profile_stride(profile, group);
        double value[4];
        coarse_space_values(coarse, node, group, coarse->shares.value[i], value);
        for (int64_t t = 0; t < rows->count; t++) {
            if (rows->group[t] > group) {
                continue;
            }
            double *to = profile_block(profile, group, rows->group[t], matrix);
            for (int k = 0; k < numbers; k++, to += stride) {
                const double *product = rows->value[t][k % dim];
                for (int j = 0; j < numbers; j++) {
                    to[j] += value[k / dim] * product[j];
                }
            }
        }
    }
}

ALL_SETS void coarse_rows_multiply(const struct coarse_rows *rows, int64_t node,
                                   const struct profile *profile, double *matrix)
{
    if (rows->coarse->dim == 2) {
        multiply(rows, 2, node, profile, matrix);
    } else {
        multiply(rows, 3, node, profile, matrix);
    }
}
