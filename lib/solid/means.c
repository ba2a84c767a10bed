#include "solid/means.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* The corners of each row. */
static enum status list_corners(struct means *means, int64_t corner_count, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&means->corner_ptr, means->pairs.row_count + 2, error));
    TRY(NEW_ARRAY(&means->corner, corner_count, error));
    for (int64_t i = 0; i < corner_count; i++) {
        means->corner_ptr[means->of_corner[i] + 2]++;
    }
    for (int64_t r = 0; r < means->pairs.row_count; r++) {
        means->corner_ptr[r + 2] += means->corner_ptr[r + 1];
    }
    for (int64_t i = 0; i < corner_count; i++) {
        means->corner[means->corner_ptr[means->of_corner[i] + 1]++] = (int32_t)i;
    }
done:
    return status;
}

enum status means_build(const struct pairs_input *input, int64_t corner_count, const int32_t *of_corner,
                        struct means *means, struct error *error)
{
    enum status status;
    struct pairs_input cut = *input;
    int64_t *first_row = NULL;
    *means = (struct means){0};
    cut.block_count = (input->row_count + PAIRS_MAX_ROWS - 1) / PAIRS_MAX_ROWS;
    TRY(NEW_ARRAY(&first_row, cut.block_count + 1, error));
    for (int64_t b = 0; b < cut.block_count; b++) {
        first_row[b] = b * PAIRS_MAX_ROWS;
    }
    first_row[cut.block_count] = input->row_count;
    cut.first_row = first_row;
    TRY(pairs_build(&cut, &means->pairs, error));
    TRY(NEW_ARRAY(&means->value, input->row_count * PAIRS_STRIDE(input->dim), error));
    TRY(NEW_ARRAY(&means->of_corner, corner_count, error));
    TRY(NEW_ARRAY(&means->corner_force, corner_count * PAIRS_STRIDE(input->dim), error));
    memcpy(means->of_corner, of_corner, (size_t)corner_count * sizeof *of_corner);
    TRY(list_corners(means, corner_count, error));
done:
    free(first_row);
    if (status != STATUS_OK) {
        means_free(means);
    }
    return status;
}

void means_free(struct means *means)
{
    pairs_free(&means->pairs);
    free(means->value);
    free(means->of_corner);
    free(means->corner_force);
    free(means->corner_ptr);
    free(means->corner);
    *means = (struct means){0};
}
