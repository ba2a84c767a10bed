#include "solid/operators/field_averages.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* A table that is copied into the rows of a matrix from `first_row` on. */
struct copy {
    const struct field_averages_input *input;
    const struct average_table *table;
    const bool *wanted;
    int64_t first, last; /* columns */
    int64_t first_row;
    int64_t *place; /* of each of the caller's rows among those of the table */
    bool lets_go;   /* the table is not needed afterwards */
};

static bool copies_row(const struct copy *copy, int64_t f)
{
    return copy->wanted == NULL || copy->wanted[copy->first_row + copy->place[f]];
}

static bool copies_entry(const struct copy *copy, int64_t i)
{
    int32_t node = copy->input->place[copy->table->idx[i]];
    return node >= copy->first && node < copy->last;
}

/* length[r]: the number of entries that row r of the matrix gets, for each row of this table. */
static void measure_rows(const struct copy *copy, int64_t *length)
{
    const int64_t *ptr = copy->table->ptr;
    bool all = copy->first == 0 && copy->last == copy->input->node_count;
    for (int64_t f = 0; f < copy->table->row_count; f++) {
        int64_t count = copies_row(copy, f) && all ? ptr[f + 1] - ptr[f] : 0;
        for (int64_t i = ptr[f]; i < ptr[f + 1] && copies_row(copy, f) && !all; i++) {
            count += copies_entry(copy, i);
        }
        length[copy->first_row + copy->place[f]] = count;
    }
}

/* Copy the table in its own order, so that its memory can be released step by step. */
static void copy_rows(const struct copy *copy, struct sparse *matrix)
{
    enum { STEP = 1 << 20 };
    const struct average_table *table = copy->table;
    int64_t gone = 0;
    for (int64_t f = 0; f < table->row_count; f++) {
        int64_t at = matrix->ptr[copy->first_row + copy->place[f]];
        for (int64_t i = table->ptr[f]; i < table->ptr[f + 1] && copies_row(copy, f); i++) {
            if (copies_entry(copy, i)) {
                matrix->idx[at] = copy->input->place[table->idx[i]];
                matrix->value[at++] = table->phi[i];
            }
        }
        if (copy->lets_go && table->ptr[f + 1] - gone >= STEP) {
            memory_give_back(table->idx + gone, STEP * sizeof *table->idx);
            memory_give_back(table->phi + gone, STEP * sizeof *table->phi);
            gone += STEP;
        }
    }
}

enum status field_averages_copy(const struct field_averages_input *input, const bool *wanted, int64_t first,
                                int64_t last, struct sparse *matrix, struct error *error)
{
    struct copy copies[2] = {{0}};
    int64_t edges = input->tables[0].row_count, rows = edges + input->tables[1].row_count, entries = 0;
    *matrix = (struct sparse){0};
    NEW_SCRATCH(int64_t, length, rows, error);
    NEW_SCRATCH(int64_t, place, rows, error);
    for (int k = 0; k < 2; k++) {
        const struct average_table *table = &input->tables[k];
        copies[k] = (struct copy){
            input, table, wanted, first, last, k * edges, place + k * edges, k == 0 && input->lets_go};
        for (int64_t r = 0; r < table->row_count; r++) {
            copies[k].place[table->order[r]] = r;
        }
        measure_rows(&copies[k], length);
    }
    for (int64_t r = 0; r < rows; r++) {
        entries += length[r];
    }
    RETURN_IF_ERROR(sparse_new(rows, input->node_count, entries, matrix, error));
    for (int64_t r = 0; r < rows; r++) {
        matrix->ptr[r + 1] = matrix->ptr[r] + length[r];
    }
    copy_rows(&copies[0], matrix);
    copy_rows(&copies[1], matrix);
    return STATUS_OK;
}

/* Set of_use: the rows that each cell uses, edges, then vertices, then boundary faces. */
static enum status match_uses(const struct field_averages_input *input, struct field_averages *averages,
                              struct error *error)
{
    int64_t *index_of = NULL; /* the body's index of each of the caller's rows */
    int32_t *of_use = averages->of_use, *of_face = of_use + field_averages_faces(averages, input->dim);
    int stride = VECTOR_STRIDE(input->dim);
    for (int k = 0; k < 2; k++) {
        const struct average_table *table = &input->tables[k];
        int64_t first = k * input->tables[0].row_count;
        RETURN_IF_ERROR(NEW_ARRAY(&index_of, table->row_count, error));
        for (int64_t r = 0; r < table->row_count; r++) {
            index_of[table->order[r]] = first + r;
        }
        int64_t count = input->cell_count * (k == 0 ? CELL_EDGES(input->dim) : input->dim + 1);
        for (int64_t i = 0; i < count; i++) {
            *of_use++ = (int32_t)(index_of[table->row_of_use[i]] * stride);
        }
        for (int64_t f = 0; k == 0 && f < input->face_count; f++) {
            of_face[f] = (int32_t)(index_of[input->face_row[f]] * stride);
        }
        free(index_of);
        index_of = NULL;
    }
    return STATUS_OK;
}

void field_averages_uses(const struct field_averages *averages, int dim, int64_t first, int64_t last,
                         int64_t begin[USE_KINDS], int64_t end[USE_KINDS])
{
    int64_t edges = CELL_EDGES(dim), vertices = field_averages_vertices(averages, dim),
            faces = field_averages_faces(averages, dim);
    begin[USE_EDGES] = first * edges;
    end[USE_EDGES] = last * edges;
    begin[USE_VERTICES] = vertices + first * (dim + 1);
    end[USE_VERTICES] = vertices + last * (dim + 1);
    begin[USE_FACES] = faces + field_averages_face(averages, first);
    end[USE_FACES] = faces + field_averages_face(averages, last);
}

/* Number the parts of block b by their first uses, from `count` on, and set part_of_use. row_of_use,
 * row_of_part: row of each; number[row_count]: scratch, below `count`. Returns the next number. */
static int64_t number_parts(const struct field_averages_input *input, struct field_averages *averages,
                            int64_t b, int64_t count, const int32_t *row_of_use, int32_t *row_of_part,
                            int64_t *number)
{
    int64_t begin[USE_KINDS], end[USE_KINDS], first = averages->part_first[b] = count;
    field_averages_uses(averages, input->dim, input->block_first[b], input->block_first[b + 1], begin, end);
    for (int kind = 0; kind < USE_KINDS; kind++) {
        for (int64_t i = begin[kind]; i < end[kind]; i++) {
            int32_t row = row_of_use[i];
            if (number[row] < first) {
                number[row] = count;
                row_of_part[count++] = row;
            }
            averages->part_of_use[i] = (uint16_t)(number[row] - first);
        }
    }
    return count;
}

/* The uses of each row, and the parts of each block and row. */
static enum status list_uses(const struct field_averages_input *input, struct field_averages *averages,
                             struct error *error)
{
    int64_t uses = averages->use_count, rows = averages->row_count, blocks = input->block_count, count = 0;
    NEW_SCRATCH(int32_t, row_of_use, uses, error);
    NEW_SCRATCH(int32_t, row_of_part, uses, error);
    NEW_SCRATCH(int64_t, number, rows, error);
    for (int64_t i = 0; i < uses; i++) {
        row_of_use[i] = averages->of_use[i] / VECTOR_STRIDE(input->dim);
    }
    RETURN_IF_ERROR(lists_by_row(uses, 1, row_of_use, rows, &averages->use_ptr, &averages->use, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->part_first, blocks + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->part_of_use, uses, error));
    memset(number, -1, (size_t)rows * sizeof *number);
    averages->block_count = blocks;
    for (int64_t b = 0; b < blocks; b++) {
        count = number_parts(input, averages, b, count, row_of_use, row_of_part, number);
    }
    averages->part_first[blocks] = count;
    RETURN_IF_ERROR(NEW_ARRAY(&averages->part_force, count * input->dim + 1, error));
    return lists_by_row(count, 1, row_of_part, rows, &averages->part_ptr, &averages->part, error);
}

int64_t field_averages_face(const struct field_averages *averages, int64_t q)
{
    return first_from(averages->face_cell, 0, averages->face_count, q);
}

enum status field_averages_build(const struct field_averages_input *input, struct field_averages *averages,
                                 struct error *error)
{
    const struct average_table *edges = &input->tables[0], *nodes = &input->tables[1];
    int64_t rows = edges->row_count + nodes->row_count, stride = VECTOR_STRIDE(input->dim);
    int64_t uses = input->cell_count * (CELL_EDGES(input->dim) + input->dim + 1) + input->face_count;
    *averages = (struct field_averages){.cell_count = input->cell_count,
                                        .use_count = uses,
                                        .row_count = rows,
                                        .face_count = input->face_count,
                                        .face_cell = input->face_cell,
                                        .face_vertex = input->face_vertex};
    if (rows > INT32_MAX / stride || uses > INT32_MAX) {
        return fail(error, STATUS_INPUT, "%lld edges and nodes: too many", (long long)rows);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&averages->value, rows * stride, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->force, rows * stride, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->of_use, uses, error));
    RETURN_IF_ERROR(match_uses(input, averages, error));
    return list_uses(input, averages, error);
}

void field_averages_free(struct field_averages *averages)
{
    FREE_ALL(averages->value, averages->force, averages->of_use, averages->use_ptr, averages->use,
             averages->part_first, averages->part_of_use, averages->part_force, averages->part_ptr,
             averages->part, averages->face_cell, averages->face_vertex, averages->face_gradient,
             averages->edge_order);
    *averages = (struct field_averages){0};
}
