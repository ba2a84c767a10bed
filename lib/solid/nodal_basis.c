#include "solid/nodal_basis.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/memory.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Added to the diagonal of the normal equations, by its largest entry: bounds the amplification of noise in
 * nearly dependent rows. */
static const double ridge = 1e-5;
enum { NODES_FOR_THREAD = 4000 };
enum { MOST_SIDES = 5 }; /* right-hand sides: e_i, and dim + 1 conditions */

/* P in CSR, the caller's. */
struct table {
    int dim;
    int64_t node_count;
    const double *X;
    const int64_t *ptr;
    const int32_t *idx;
    const double *phi;
};

/* What one thread works with. */
struct work {
    int32_t *place;                  /* node_count: column of the local matrix, or -1 */
    int64_t rows_capacity, capacity; /* of the two below; of the matrix */
    double *gram, *sides;            /* n * n; MOST_SIDES * n */
    double *matrix;                  /* n rows of `width` */
    int64_t width;
};

static enum status reserve(struct work *work, int64_t n, int64_t width, struct error *error)
{
    enum status status = STATUS_OK;
    if (n > work->rows_capacity) {
        free(work->gram);
        free(work->sides);
        work->gram = work->sides = NULL;
        TRY(NEW_ARRAY(&work->gram, n * n, error));
        TRY(NEW_ARRAY(&work->sides, MOST_SIDES * n, error));
        work->rows_capacity = n;
    }
    if (n * width > work->capacity) {
        free(work->matrix);
        work->matrix = NULL;
        TRY(NEW_ARRAY(&work->matrix, 2 * n * width, error));
        work->capacity = 2 * n * width;
    }
    work->width = width;
    memset(work->matrix, 0, (size_t)(n * width) * sizeof *work->matrix);
done:
    return status;
}

static void free_work(struct work *work)
{
    free(work->place);
    free(work->gram);
    free(work->sides);
    free(work->matrix);
}

/* The rows of P that row i of Q combines, as a dense matrix over the columns that they have. */
static enum status gather_rows(const struct table *table, int64_t i, struct work *work, struct error *error)
{
    enum status status;
    int64_t first = table->ptr[i], n = table->ptr[i + 1] - first, width = 0;
    for (int64_t k = 0; k < n; k++) {
        int32_t row = table->idx[first + k];
        for (int64_t l = table->ptr[row]; l < table->ptr[row + 1]; l++) {
            int32_t *place = &work->place[table->idx[l]];
            *place = *place < 0 ? (int32_t)width++ : *place;
        }
    }
    TRY(reserve(work, n, width, error));
    for (int64_t k = 0; k < n; k++) {
        int32_t row = table->idx[first + k];
        for (int64_t l = table->ptr[row]; l < table->ptr[row + 1]; l++) {
            work->matrix[k * width + work->place[table->idx[l]]] = table->phi[l];
        }
    }
done:
    return status;
}

/* Normal equations: gram = A A^T, and the right-hand sides A e_i, 1, x_j - x_i. Clears work->place. */
static void make_equations(const struct table *table, int64_t i, struct work *work)
{
    int64_t first = table->ptr[i], n = table->ptr[i + 1] - first, width = work->width;
    int32_t own = work->place[i];
    double most = 0.0;
    for (int64_t k = 0; k < n; k++) {
        const double *a = work->matrix + k * width;
        for (int64_t l = 0; l <= k; l++) {
            const double *b = work->matrix + l * width;
            double sum = 0.0;
            for (int64_t c = 0; c < width; c++) {
                sum += a[c] * b[c];
            }
            work->gram[k * n + l] = work->gram[l * n + k] = sum;
        }
        most = fmax(most, work->gram[k * n + k]);
        int32_t node = table->idx[first + k];
        work->sides[k] = own >= 0 ? a[own] : 0.0;
        work->sides[n + k] = 1.0;
        for (int d = 0; d < table->dim; d++) {
            work->sides[(2 + d) * n + k] =
                table->X[(int64_t)node * table->dim + d] - table->X[i * table->dim + d];
        }
    }
    for (int64_t k = 0; k < n; k++) {
        work->gram[k * n + k] += ridge * most;
        for (int64_t l = table->ptr[table->idx[first + k]]; l < table->ptr[table->idx[first + k] + 1]; l++) {
            work->place[table->idx[l]] = -1;
        }
    }
}

/* q = y - sum_c z_c m_c, with gram y = A e_i, gram z_c = C_c, such that C q = (1, 0): false where the nodes
 * do not span the space. */
static bool keep_linear_fields(int dim, int64_t n, const double *gram, double *sides, double *q)
{
    double condition[16], multiplier[4], z[4 * 512];
    int count = dim + 1;
    if (n > 512) {
        return false;
    }
    memcpy(z, sides + n, (size_t)(count * n) * sizeof *z);
    dense_solve(n, gram, sides);
    for (int c = 0; c < count; c++) {
        dense_solve(n, gram, z + c * n);
    }
    for (int c = 0; c < count; c++) {
        const double *C = sides + (1 + c) * n;
        multiplier[c] = c == 0 ? -1.0 : 0.0;
        for (int64_t k = 0; k < n; k++) {
            multiplier[c] += C[k] * sides[k];
        }
        for (int d = 0; d < count; d++) {
            condition[c * count + d] = 0.0;
            for (int64_t k = 0; k < n; k++) {
                condition[c * count + d] += C[k] * z[d * n + k];
            }
        }
    }
    if (!dense_factorise(count, condition)) {
        return false;
    }
    dense_solve(count, condition, multiplier);
    for (int64_t k = 0; k < n; k++) {
        q[k] = sides[k];
        for (int c = 0; c < count; c++) {
            q[k] -= z[c * n + k] * multiplier[c];
        }
    }
    return true;
}

/* Row i of Q; of the identity where none can be found. */
static enum status make_row(const struct table *table, int64_t i, struct work *work, double *q,
                            struct error *error)
{
    enum status status;
    int64_t first = table->ptr[i], n = table->ptr[i + 1] - first;
    TRY(gather_rows(table, i, work, error));
    make_equations(table, i, work);
    if (!dense_factorise(n, work->gram) || !keep_linear_fields(table->dim, n, work->gram, work->sides, q)) {
        for (int64_t k = 0; k < n; k++) {
            q[k] = table->idx[first + k] == i ? 1.0 : 0.0;
        }
    }
done:
    return status;
}

static enum status make_rows(const struct table *table, int64_t begin, int64_t end, double *value,
                             struct error *error)
{
    enum status status;
    struct work work = {0};
    TRY(NEW_ARRAY(&work.place, table->node_count, error));
    for (int64_t n = 0; n < table->node_count; n++) {
        work.place[n] = -1;
    }
    for (int64_t i = begin; i < end; i++) {
        TRY(make_row(table, i, &work, value + table->ptr[i], error));
    }
done:
    free_work(&work);
    return status;
}

enum status nodal_basis_build(int dim, int64_t node_count, const double *X, const int64_t *ptr,
                              const int32_t *idx, const double *phi, struct nodal_basis *basis,
                              struct error *error)
{
    enum status status;
    struct table table = {dim, node_count, X, ptr, idx, phi};
    struct chunks chunks = chunks_of(node_count, NODES_FOR_THREAD);
    struct error errors[CHUNKS_MOST];
    enum status of_chunk[CHUNKS_MOST];
    *basis = (struct nodal_basis){.dim = dim};
    TRY(sparse_new(node_count, node_count, ptr[node_count], &basis->matrix, error));
    memcpy(basis->matrix.ptr, ptr, (size_t)(node_count + 1) * sizeof *ptr);
    memcpy(basis->matrix.idx, idx, (size_t)ptr[node_count] * sizeof *idx);
#pragma omp parallel for schedule(dynamic) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        of_chunk[c] = make_rows(&table, chunks_begin(&chunks, c), chunks_begin(&chunks, c + 1),
                                basis->matrix.value, &errors[c]);
    }
    for (int64_t c = 0; c < chunks.count; c++) {
        if (of_chunk[c] != STATUS_OK) {
            *error = errors[c];
            status = of_chunk[c];
            goto done;
        }
    }
    status = sparse_transpose(&basis->matrix, &basis->transposed, error);
done:
    if (status != STATUS_OK) {
        nodal_basis_free(basis);
    }
    return status;
}

double nodal_basis_magnification(const struct nodal_basis *basis)
{
    const struct sparse *matrix = &basis->matrix;
    double sum = 0.0;
    for (int64_t i = 0; i < matrix->ptr[matrix->row_count]; i++) {
        sum += fabs(matrix->value[i]);
    }
    return sum / (double)matrix->row_count;
}

void nodal_basis_free(struct nodal_basis *basis)
{
    sparse_free(&basis->matrix);
    sparse_free(&basis->transposed);
}

void nodal_basis_apply(const struct nodal_basis *basis, const double *v, double *u)
{
    sparse_apply(&basis->matrix, basis->dim, v, u);
}

void nodal_basis_apply_transposed(const struct nodal_basis *basis, const double *f, double *v)
{
    sparse_apply(&basis->transposed, basis->dim, f, v);
}

enum status nodal_basis_transform_rows(const struct nodal_basis *basis, const struct constraint_rows *rows,
                                       struct constraint_rows *transformed, struct error *error)
{
    enum status status = STATUS_OK;
    int64_t *at = NULL;
    int32_t *idx = NULL;
    double *phi = NULL;
    constraint_rows_init(transformed, rows->dim);
    TRY(NEW_ARRAY(&at, basis->matrix.row_count, error));
    TRY(NEW_ARRAY(&idx, basis->matrix.row_count, error));
    TRY(NEW_ARRAY(&phi, basis->matrix.row_count, error));
    memset(at, -1, (size_t)basis->matrix.row_count * sizeof *at);
    for (int64_t l = 0, r = 0; l < rows->list_count; l++) {
        struct average average = constraint_rows_average(rows, r);
        int64_t length = 0;
        for (int64_t i = 0; i < average.length; i++) {
            int32_t node = average.idx[i];
            for (int64_t k = basis->matrix.ptr[node]; k < basis->matrix.ptr[node + 1]; k++) {
                int32_t column = basis->matrix.idx[k];
                if (at[column] < 0) {
                    at[column] = length;
                    idx[length] = column;
                    phi[length++] = 0.0;
                }
                phi[at[column]] += average.phi[i] * basis->matrix.value[k];
            }
        }
        for (int64_t i = 0; i < length; i++) {
            at[idx[i]] = -1;
        }
        for (; r < rows->first[l + 1]; r++) {
            TRY(constraint_rows_add(transformed, length, idx, phi, rows->direction + r * rows->dim,
                                    rows->target[r], rows->curve[r], rows->section[r], rows->node[r], error));
        }
    }
done:
    free(at);
    free(idx);
    free(phi);
    if (status != STATUS_OK) {
        constraint_rows_free(transformed);
    }
    return status;
}
