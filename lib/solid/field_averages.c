#include "solid/field_averages.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Rows of a table, from number `first_row` on; *at counts the entries. Without the matrix's arrays nothing
 * else is done. */
static void copy_rows(const struct field_averages_input *input, const struct average_table *table,
                      const bool *wanted, int64_t first, int64_t last, int64_t first_row, int64_t *at,
                      struct sparse *matrix)
{
    for (int64_t r = 0; r < table->row_count; r++) {
        int64_t from = table->order[r];
        bool copied = wanted == NULL || wanted[first_row + r];
        for (int64_t i = table->ptr[from]; copied && i < table->ptr[from + 1]; i++) {
            int32_t node = input->place[table->idx[i]];
            if (node < first || node >= last) {
                continue;
            }
            if (matrix->ptr != NULL) {
                matrix->idx[*at] = node;
                matrix->value[*at] = table->phi[i];
            }
            ++*at;
        }
        if (matrix->ptr != NULL) {
            matrix->ptr[first_row + r + 1] = *at;
        }
    }
}

enum status field_averages_copy(const struct field_averages_input *input, const bool *wanted, int64_t first,
                                int64_t last, struct sparse *matrix, struct error *error)
{
    enum status status;
    const struct average_table *faces = &input->tables[0], *nodes = &input->tables[1];
    int64_t at = 0, rows = faces->row_count + nodes->row_count;
    *matrix = (struct sparse){0};
    if (wanted == NULL && first == 0 && last == input->node_count) {
        at = faces->ptr[faces->row_count] + nodes->ptr[nodes->row_count];
    } else {
        copy_rows(input, faces, wanted, first, last, 0, &at, matrix);
        copy_rows(input, nodes, wanted, first, last, faces->row_count, &at, matrix);
    }
    TRY(sparse_new(rows, input->node_count, at, matrix, error));
    at = 0;
    copy_rows(input, faces, wanted, first, last, 0, &at, matrix);
    copy_rows(input, nodes, wanted, first, last, faces->row_count, &at, matrix);
done:
    return status;
}

/* Set of_corner: the rows that each corner uses. */
static enum status match_corners(const struct field_averages_input *input, struct field_averages *averages,
                                 struct error *error)
{
    enum status status = STATUS_OK;
    int64_t *index_of = NULL; /* the body's index of each of the caller's rows */
    int32_t *of_corner = averages->of_corner;
    for (int k = 0; k < 2; k++) {
        const struct average_table *table = &input->tables[k];
        int64_t first = k * input->tables[0].row_count;
        TRY(NEW_ARRAY(&index_of, table->row_count, error));
        for (int64_t r = 0; r < table->row_count; r++) {
            index_of[table->order[r]] = first + r;
        }
        int64_t count = input->corner_count * (k == 0 ? FACE_ROWS(input->dim) : 1);
        for (int64_t i = 0; i < count; i++) {
            *of_corner++ = (int32_t)(index_of[table->row_of_corner[i]] * VECTOR_STRIDE(input->dim));
        }
        free(index_of);
        index_of = NULL;
    }
done:
    return status;
}

/* The corners of each row. */
static enum status list_corners(int dim, struct field_averages *averages, struct error *error)
{
    enum status status;
    int64_t rows = averages->row_count, of_faces = averages->corner_count * FACE_ROWS(dim);
    int64_t looks = of_faces + averages->corner_count;
    TRY(NEW_ARRAY(&averages->corner_ptr, rows + 2, error));
    TRY(NEW_ARRAY(&averages->corner, looks, error));
    for (int64_t i = 0; i < looks; i++) {
        averages->corner_ptr[averages->of_corner[i] / VECTOR_STRIDE(dim) + 2]++;
    }
    for (int64_t r = 0; r < rows; r++) {
        averages->corner_ptr[r + 2] += averages->corner_ptr[r + 1];
    }
    for (int64_t i = 0; i < looks; i++) {
        averages->corner[averages->corner_ptr[averages->of_corner[i] / VECTOR_STRIDE(dim) + 1]++] =
            (int32_t)(i < of_faces ? i / FACE_ROWS(dim) : i - of_faces + averages->corner_count);
    }
done:
    return status;
}

enum status field_averages_build(const struct field_averages_input *input, struct field_averages *averages,
                                 struct error *error)
{
    enum status status;
    const struct average_table *faces = &input->tables[0], *nodes = &input->tables[1];
    int64_t rows = faces->row_count + nodes->row_count, stride = VECTOR_STRIDE(input->dim);
    int64_t looks = input->corner_count * (FACE_ROWS(input->dim) + 1);
    *averages = (struct field_averages){.corner_count = input->corner_count, .row_count = rows};
    if (rows > INT32_MAX / stride || looks > INT32_MAX) {
        return fail(error, STATUS_INPUT, "%lld faces and nodes: too many", (long long)rows);
    }
    TRY(NEW_ARRAY_UNTOUCHED(&averages->value, rows * stride, error));
    TRY(NEW_ARRAY_UNTOUCHED(&averages->force, rows * stride, error));
    TRY(NEW_ARRAY(&averages->of_corner, looks, error));
    TRY(NEW_ARRAY_UNTOUCHED(&averages->corner_force, 2 * input->corner_count * stride, error));
    TRY(match_corners(input, averages, error));
    TRY(list_corners(input->dim, averages, error));
done:
    if (status != STATUS_OK) {
        field_averages_free(averages);
    }
    return status;
}

enum status field_averages_drop_copied(struct field_averages *averages, struct error *error)
{
    enum status status = STATUS_OK;
    struct sparse *fetched = &averages->fetched;
    struct average_table *faces = &averages->given[0];
    const int64_t *ptr = averages->matrix.ptr;
    int64_t at = 0, begin = 0;
    bool *kept = NULL;
    if (fetched->ptr == NULL) {
        return STATUS_OK;
    }
    TRY(NEW_ARRAY(&kept, fetched->row_count, error));
    for (int64_t r = 0; r < fetched->row_count; r++) {
        kept[faces->order[r]] = ptr[r] == ptr[r + 1];
    }
    for (int64_t f = 0; f < fetched->row_count; f++) {
        int64_t end = fetched->ptr[f + 1], length = kept[f] ? end - begin : 0;
        memmove(fetched->idx + at, fetched->idx + begin, (size_t)length * sizeof *fetched->idx);
        memmove(fetched->value + at, fetched->value + begin, (size_t)length * sizeof *fetched->value);
        begin = end;
        fetched->ptr[f + 1] = at += length;
    }
    int32_t *idx = array_grow(fetched->idx, at + 1, sizeof *idx);
    fetched->idx = idx != NULL ? idx : fetched->idx;
    double *value = array_grow(fetched->value, at + 1, sizeof *value);
    fetched->value = value != NULL ? value : fetched->value;
    faces->idx = fetched->idx;
    faces->phi = fetched->value;
done:
    free(kept);
    return status;
}

void field_averages_free(struct field_averages *averages)
{
    sparse_free(&averages->matrix);
    sparse_free(&averages->transposed);
    sparse_free(&averages->fetched);
    free(averages->value);
    free(averages->force);
    free(averages->of_corner);
    free(averages->corner_force);
    free(averages->corner_ptr);
    free(averages->corner);
    free(averages->face_order);
    *averages = (struct field_averages){0};
}
