#include "solid/body/body.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

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
static int64_t number_parts(struct body *body, int64_t b, int64_t count, const int32_t *row_of_use,
                            int32_t *row_of_part, int64_t *number)
{
    struct field_averages *averages = &body->cells.averages;
    const struct block *block = &body->blocks[b];
    int64_t begin[USE_KINDS], end[USE_KINDS], first = averages->part_first[b] = count;
    field_averages_uses(averages, body->dim, block->first_point, block->first_point + block->point_count,
                        begin, end);
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

enum status field_averages_list(struct body *body, struct error *error)
{
    struct field_averages *averages = &body->cells.averages;
    int64_t rows = averages->row_count, count = 0;
    int64_t uses = field_averages_faces(averages, body->dim) + averages->face_count;
    NEW_SCRATCH(int32_t, row_of_use, uses, error);
    NEW_SCRATCH(int32_t, row_of_part, uses, error);
    NEW_SCRATCH(int64_t, number, rows, error);
    for (int64_t i = 0; i < uses; i++) {
        row_of_use[i] = averages->of_use[i] / VECTOR_STRIDE(body->dim);
    }
    RETURN_IF_ERROR(lists_by_row(uses, 1, row_of_use, rows, &averages->use_ptr, &averages->use, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->part_first, body->block_count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->part_of_use, uses, error));
    memset(number, -1, (size_t)rows * sizeof *number);
    for (int64_t b = 0; b < body->block_count; b++) {
        count = number_parts(body, b, count, row_of_use, row_of_part, number);
    }
    averages->part_first[body->block_count] = count;
    RETURN_IF_ERROR(NEW_ARRAY(&averages->part_force, count * body->dim + 1, error));
    return lists_by_row(count, 1, row_of_part, rows, &averages->part_ptr, &averages->part, error);
}

int64_t field_averages_face(const struct field_averages *averages, int64_t q)
{
    return first_from(averages->face_cell, 0, averages->face_count, q);
}

void field_averages_free(struct field_averages *averages)
{
    FREE_ALL(averages->value, averages->force, averages->of_use, averages->use_ptr, averages->use,
             averages->part_first, averages->part_of_use, averages->part_force, averages->part_ptr,
             averages->part, averages->face_cell, averages->face_vertex, averages->face_gradient,
             averages->edge_order);
    *averages = (struct field_averages){0};
}
