#include "solid/body/kernel.h"

#include "base/processor.h"
#include "solid/body/kernel_cells.h"
#include "solid/body/kernel_prony.h"
#include "solid/body/kernel_sparse.h"

/* The call with DIM as a constant, so that it is compiled for each dimension; and with RELAXES, for
 * viscoelastic blocks and others. */
#define FOR_DIM(dim, call)                                                                                   \
    do {                                                                                                     \
        if ((dim) == 2) {                                                                                    \
            enum { DIM = 2 };                                                                                \
            call;                                                                                            \
        } else {                                                                                             \
            enum { DIM = 3 };                                                                                \
            call;                                                                                            \
        }                                                                                                    \
    } while (0)

#define FOR_KIND(body, b, call)                                                                              \
    do {                                                                                                     \
        if ((body)->blocks[b].relaxes) {                                                                     \
            enum { RELAXES = true };                                                                         \
            FOR_DIM((body)->dim, call);                                                                      \
        } else {                                                                                             \
            enum { RELAXES = false };                                                                        \
            FOR_DIM((body)->dim, call);                                                                      \
        }                                                                                                    \
    } while (0)

ALL_SETS void force_apply(int dim, const struct sparse *matrix, int64_t begin, int64_t end, const double *x,
                          double *y)
{
    dim == 2 ? apply_rows_2(matrix, begin, end, x, y) : apply_rows_3(matrix, begin, end, x, y);
}

ALL_SETS void force_apply_transposed(int dim, const struct row_operator *rows, int64_t stripe,
                                     const double *x, double *y)
{
    dim == 2 ? apply_transposed_2(rows, &rows->stripes[stripe], x, y)
             : apply_transposed_3(rows, &rows->stripes[stripe], x, y);
}

ALL_SETS void force_sum_parts(int dim, struct field_averages *averages, int64_t begin, int64_t end)
{
    dim == 2 ? sum_parts_2(averages, begin, end) : sum_parts_3(averages, begin, end);
}

ALL_SETS void force_point_gradients(struct body *body, int64_t b)
{
    FOR_DIM(body->dim, kernel_point_gradients(body, &body->blocks[b], DIM));
    FOR_DIM(body->dim, kernel_determinants(body, &body->blocks[b], DIM));
}

ALL_SETS void force_point_neo_hookean(const struct body *body, int64_t b, block_rows P)
{
    FOR_DIM(body->dim, kernel_neo_hookean(body, &body->blocks[b], DIM, P));
}

ALL_SETS void force_point_forces(struct body *body, int64_t b, const block_rows P)
{
    FOR_DIM(body->dim, kernel_point_forces(body, &body->blocks[b], DIM, P));
}

ALL_SETS void force_cell_gradients(struct body *body, int64_t b)
{
    FOR_DIM(body->dim, kernel_cell_gradients(body, &body->blocks[b], DIM));
}

ALL_SETS void force_cell_neo_hookean(const struct body *body, int64_t b, block_rows P, block_rows T)
{
    FOR_KIND(body, b, kernel_cell_neo_hookean(body, &body->blocks[b], DIM, RELAXES, P, T));
}

ALL_SETS void force_cell_forces(struct body *body, int64_t b, block_rows P, block_rows T)
{
    FOR_KIND(body, b, kernel_cell_forces(body, b, DIM, RELAXES, P, T));
}

ALL_SETS void force_prony_state(const struct body *body, int64_t b, prony_rows X, prony_rows x)
{
    FOR_DIM(body->dim, kernel_prony_state(body, &body->blocks[b], DIM, X, x));
}
