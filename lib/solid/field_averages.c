#include "solid/field_averages.h"

#include "base/memory.h"

#include <stdlib.h>

/* The rows of a table, from number `first` on; *at counts the entries. */
static void copy_rows(const struct average_table *table, const int32_t *place, int64_t first, int64_t *at,
                      struct sparse *matrix)
{
    for (int64_t r = 0; r < table->row_count; r++) {
        int64_t from = table->order[r];
        for (int64_t i = table->ptr[from]; i < table->ptr[from + 1]; i++, ++*at) {
            matrix->idx[*at] = place[table->idx[i]];
            matrix->value[*at] = table->phi[i];
        }
        matrix->ptr[first + r + 1] = *at;
    }
}

/* place[count]: where each of the caller's rows stands, from `first` on. */
static enum status invert(int64_t count, const int64_t *order, int64_t first, int64_t **place,
                          struct error *error)
{
    enum status status = NEW_ARRAY(place, count, error);
    for (int64_t i = 0; status == STATUS_OK && i < count; i++) {
        (*place)[order[i]] = first + i;
    }
    return status;
}

/* The averages over the faces from rows at `place`. */
static enum status make_means(const struct field_averages_input *input, const int64_t *place,
                              struct field_averages *averages, struct error *error)
{
    enum status status;
    const struct faces *faces = input->faces;
    int rows = FACE_ROWS(input->dim);
    struct sparse *means = &averages->means;
    TRY(sparse_new(faces->count, faces->row_count, faces->count * rows, means, error));
    for (int64_t i = 0; i < faces->count * rows; i++) {
        means->idx[i] = (int32_t)place[faces->row[input->face_order[i / rows] * rows + i % rows]];
        means->value[i] = 1.0 / rows;
        means->ptr[i / rows + 1] = i + 1;
    }
    TRY(sparse_transpose(means, &averages->spread, error));
done:
    return status;
}

/* Which value each corner looks at, as of_corner has it. */
static enum status match_corners(const struct field_averages_input *input, struct field_averages *averages,
                                 struct error *error)
{
    enum status status = STATUS_OK;
    const struct average_table *rows = &input->tables[0], *nodes = &input->tables[1];
    int64_t *of_row = NULL, *of_face = NULL, *of_node = NULL;
    int stride = VECTOR_STRIDE(input->dim);
    TRY(invert(rows->row_count, rows->order, 0, &of_row, error));
    TRY(invert(nodes->row_count, nodes->order, rows->row_count, &of_node, error));
    if (FACE_ROWS(input->dim) > 1) {
        TRY(make_means(input, of_row, averages, error));
        TRY(invert(input->faces->count, input->face_order, averages->matrix.row_count, &of_face, error));
    }
    for (int64_t i = 0; i < input->corner_count; i++) {
        int64_t face = input->face_of_corner[i];
        averages->of_corner[i] =
            (int32_t)((of_face != NULL ? of_face[face] : of_row[input->faces->row[face]]) * stride);
        averages->of_corner[input->corner_count + i] = (int32_t)(of_node[input->node_of_corner[i]] * stride);
    }
done:
    free(of_row);
    free(of_face);
    free(of_node);
    return status;
}

/* The corners of each value. */
static enum status list_corners(int dim, struct field_averages *averages, struct error *error)
{
    enum status status;
    int64_t count = averages->count, corners = 2 * averages->corner_count;
    TRY(NEW_ARRAY(&averages->corner_ptr, count + 2, error));
    TRY(NEW_ARRAY(&averages->corner, corners, error));
    for (int64_t i = 0; i < corners; i++) {
        averages->corner_ptr[averages->of_corner[i] / VECTOR_STRIDE(dim) + 2]++;
    }
    for (int64_t r = 0; r < count; r++) {
        averages->corner_ptr[r + 2] += averages->corner_ptr[r + 1];
    }
    for (int64_t i = 0; i < corners; i++) {
        averages->corner[averages->corner_ptr[averages->of_corner[i] / VECTOR_STRIDE(dim) + 1]++] =
            (int32_t)i;
    }
done:
    return status;
}

enum status field_averages_build(const struct field_averages_input *input, struct field_averages *averages,
                                 struct error *error)
{
    enum status status;
    const struct average_table *faces = &input->tables[0], *nodes = &input->tables[1];
    int64_t rows = faces->row_count + nodes->row_count, at = 0, stride = VECTOR_STRIDE(input->dim);
    int64_t count = rows + (FACE_ROWS(input->dim) > 1 ? input->faces->count : 0);
    *averages = (struct field_averages){.count = count, .corner_count = input->corner_count};
    if (count > INT32_MAX / stride || input->corner_count > INT32_MAX / 2) {
        return fail(error, STATUS_INPUT, "%lld faces and nodes: too many", (long long)count);
    }
    TRY(sparse_new(rows, input->node_count, faces->ptr[faces->row_count] + nodes->ptr[nodes->row_count],
                   &averages->matrix, error));
    copy_rows(faces, input->place, 0, &at, &averages->matrix);
    copy_rows(nodes, input->place, faces->row_count, &at, &averages->matrix);
    TRY(NEW_ARRAY(&averages->value, count * stride, error));
    TRY(NEW_ARRAY(&averages->force, count * stride, error));
    TRY(NEW_ARRAY(&averages->of_corner, 2 * input->corner_count, error));
    TRY(NEW_ARRAY(&averages->corner_force, 2 * input->corner_count * stride, error));
    TRY(match_corners(input, averages, error));
    TRY(list_corners(input->dim, averages, error));
done:
    if (status != STATUS_OK) {
        field_averages_free(averages);
    }
    return status;
}

enum status field_averages_transpose(struct field_averages *averages, struct error *error)
{
    return sparse_transpose(&averages->matrix, &averages->transposed, error);
}

void field_averages_free(struct field_averages *averages)
{
    sparse_free(&averages->matrix);
    sparse_free(&averages->transposed);
    sparse_free(&averages->means);
    sparse_free(&averages->spread);
    free(averages->value);
    free(averages->force);
    free(averages->of_corner);
    free(averages->corner_force);
    free(averages->corner_ptr);
    free(averages->corner);
    *averages = (struct field_averages){0};
}
