/* Kernels over the rows of sparse operators, and what goes in and out of them; private to lib/solid. */
#pragma once

#include "solid/body/kernel.h"
#include "solid/body/kernel_vector.h"

/* y_r = sum_j A_rj x_j of vectors VECTOR_STRIDE(dim) apart, in four partial sums, as one would be bound by
 * the latency of the additions; the transpose; and the sums of the forces of uses, which are dim apart: the
 * fourth number of each is the next one's, and the fourth of their sums nothing. */
#define ROW_KERNELS(dim, vector)                                                                             \
    KERNEL_INLINE void apply_rows_##dim(const struct sparse *matrix, int64_t begin, int64_t end,             \
                                        const double *x, double *restrict y)                                 \
    {                                                                                                        \
        for (int64_t r = begin; r < end; r++) {                                                              \
            vector sum[4] = {{0.0}}, at;                                                                     \
            int64_t i = matrix->ptr[r], last = matrix->ptr[r + 1];                                           \
            for (; i + 4 <= last; i += 4) {                                                                  \
                for (int k = 0; k < 4; k++) {                                                                \
                    LOAD(at, x + (int64_t)matrix->idx[i + k] * VECTOR_STRIDE(dim));                          \
                    sum[k] += matrix->value[i + k] * at;                                                     \
                }                                                                                            \
            }                                                                                                \
            for (; i < last; i++) {                                                                          \
                LOAD(at, x + (int64_t)matrix->idx[i] * VECTOR_STRIDE(dim));                                  \
                sum[0] += matrix->value[i] * at;                                                             \
            }                                                                                                \
            sum[0] = (sum[0] + sum[1]) + (sum[2] + sum[3]);                                                  \
            STORE(y + r * VECTOR_STRIDE(dim), sum[0]);                                                       \
        }                                                                                                    \
    }                                                                                                        \
    KERNEL_INLINE void apply_transposed_##dim(const struct row_operator *rows,                               \
                                              const struct row_stripe *stripe, const double *x,              \
                                              double *restrict y)                                            \
    {                                                                                                        \
        const struct sparse *table = &rows->matrix;                                                          \
        const int32_t *idx = table->idx;                                                                     \
        const double *of = table->value;                                                                     \
        memset(y + stripe->begin * VECTOR_STRIDE(dim), 0,                                                    \
               (size_t)((stripe->end - stripe->begin) * VECTOR_STRIDE(dim)) * sizeof *y);                    \
        for (int64_t k = 0; k < stripe->row_count; k++) {                                                    \
            bool is_cut = stripe->row[k] < 0;                                                                \
            int64_t r = is_cut ? -1 - stripe->row[k] : stripe->row[k];                                       \
            vector value, sum;                                                                               \
            LOAD(value, x + r * VECTOR_STRIDE(dim));                                                         \
            for (int64_t i = table->ptr[r], last = table->ptr[r + 1]; i < last; i++) {                       \
                if (is_cut && (idx[i] < stripe->begin || idx[i] >= stripe->end)) {                           \
                    continue;                                                                                \
                }                                                                                            \
                double *to = y + (int64_t)idx[i] * VECTOR_STRIDE(dim);                                       \
                LOAD(sum, to);                                                                               \
                sum += of[i] * value;                                                                        \
                STORE(to, sum);                                                                              \
            }                                                                                                \
        }                                                                                                    \
    }                                                                                                        \
    KERNEL_INLINE void sum_parts_##dim(struct field_averages *averages, int64_t begin, int64_t end)          \
    {                                                                                                        \
        for (int64_t r = begin; r < end; r++) {                                                              \
            vector sum = {0.0}, force;                                                                       \
            for (int64_t i = averages->part_ptr[r]; i < averages->part_ptr[r + 1]; i++) {                    \
                LOAD(force, averages->part_force + (int64_t)averages->part[i] * (dim));                      \
                sum += force;                                                                                \
            }                                                                                                \
            STORE(averages->force + r * VECTOR_STRIDE(dim), sum);                                            \
        }                                                                                                    \
    }
ROW_KERNELS(2, pair2)
ROW_KERNELS(3, quad4)

/* F of the points of a block, I + du/dx: component a of the derivative along k stands in row q dim + k. */
KERNEL_INLINE void kernel_point_gradients(struct body *body, const struct block *block, int dim)
{
    for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
        const double *derivative = body->derivative + q * dim * VECTOR_STRIDE(dim);
        for (int a = 0; a < dim; a++) {
            for (int k = 0; k < dim; k++) {
                body->F[(a * dim + k) * body->point_count + q] =
                    (a == k ? 1.0 : 0.0) + derivative[k * VECTOR_STRIDE(dim) + a];
            }
        }
    }
}

/* Weighted stresses of a block in the same rows, for the transpose. */
KERNEL_INLINE void kernel_point_forces(struct body *body, const struct block *block, int dim,
                                       const block_rows P)
{
    for (int64_t i = 0; i < block->point_count; i++) {
        double *derivative = body->derivative + (block->first_point + i) * dim * VECTOR_STRIDE(dim);
        for (int a = 0; a < dim; a++) {
            for (int k = 0; k < dim; k++) {
                derivative[k * VECTOR_STRIDE(dim) + a] = P[a * dim + k][i];
            }
        }
    }
}
