#include "solid/means.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Groups of a block: as many means as a block of points has points. */
enum { BLOCK_GROUPS = PAIRS_MAX_ROWS / MEANS_GROUP };

/* The table with the lists of each group united. */
struct united {
    int64_t group_count;
    int64_t *ptr; /* group_count + 1 */
    int32_t *idx;
    double *phi;         /* MEANS_GROUP for each pair; zero where a mean has not the node */
    int32_t *corners;    /* group_count: the most corners of a mean */
    int64_t *order;      /* group_count: as they come in the table */
    int64_t *first_row;  /* blocks + 1 */
    int32_t *corners_of; /* row_count: of each of the caller's rows */
    int64_t *place_of;   /* row_count: group * MEANS_GROUP + lane in the table */
};

static void united_free(struct united *united)
{
    void *arrays[] = {united->ptr,   united->idx,       united->phi,        united->corners,
                      united->order, united->first_row, united->corners_of, united->place_of};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
}

/* The caller's row in lane r of a group, before groups are ordered; -1 beyond the last. */
static int64_t row_at(const struct means_input *input, int64_t group, int lane)
{
    int64_t at = group * MEANS_GROUP + lane;
    return at < input->row_count ? input->order[at] : -1;
}

static enum status unite(const struct means_input *input, struct united *united, struct error *error)
{
    enum status status;
    int64_t *at = NULL, pairs = input->ptr[input->row_count]; /* at: where each node stands in the lists */
    united->group_count = (input->row_count + MEANS_GROUP - 1) / MEANS_GROUP;
    TRY(NEW_ARRAY(&at, input->node_count, error));
    TRY(NEW_ARRAY(&united->ptr, united->group_count + 1, error));
    TRY(NEW_ARRAY(&united->idx, pairs, error));
    for (int64_t n = 0; n < input->node_count; n++) {
        at[n] = -1;
    }
    for (int64_t g = 0; g < united->group_count; g++) {
        int64_t first = united->ptr[g], end = first;
        for (int r = 0; r < MEANS_GROUP && row_at(input, g, r) >= 0; r++) {
            int64_t row = row_at(input, g, r);
            for (int64_t i = input->ptr[row]; i < input->ptr[row + 1]; i++) {
                if (at[input->idx[i]] < first) {
                    united->idx[end] = input->idx[i];
                    at[input->idx[i]] = end++;
                }
            }
        }
        united->ptr[g + 1] = end;
    }
    TRY(NEW_ARRAY(&united->phi, united->ptr[united->group_count] * MEANS_GROUP, error));
    for (int64_t g = 0; g < united->group_count; g++) {
        for (int64_t i = united->ptr[g]; i < united->ptr[g + 1]; i++) {
            at[united->idx[i]] = i;
        }
        for (int r = 0; r < MEANS_GROUP && row_at(input, g, r) >= 0; r++) {
            int64_t row = row_at(input, g, r);
            for (int64_t i = input->ptr[row]; i < input->ptr[row + 1]; i++) {
                united->phi[at[input->idx[i]] * MEANS_GROUP + r] = input->phi[i];
            }
        }
    }
done:
    free(at);
    return status;
}

/* Blocks of groups, in each those alike together; and so the place of each row. */
static enum status order_groups(const struct means_input *input, struct united *united, struct error *error)
{
    enum status status;
    int64_t groups = united->group_count;
    TRY(NEW_ARRAY(&united->corners, groups, error));
    TRY(NEW_ARRAY(&united->order, groups, error));
    TRY(NEW_ARRAY(&united->first_row, groups / BLOCK_GROUPS + 2, error));
    TRY(NEW_ARRAY(&united->corners_of, input->row_count, error));
    TRY(NEW_ARRAY(&united->place_of, input->row_count, error));
    for (int64_t i = 0; i < input->corner_count; i++) {
        united->corners_of[input->row_of_corner[i]]++;
    }
    for (int64_t g = 0; g < groups; g++) {
        united->order[g] = g;
        for (int r = 0; r < MEANS_GROUP && row_at(input, g, r) >= 0; r++) {
            int32_t corners = united->corners_of[row_at(input, g, r)];
            united->corners[g] = corners > united->corners[g] ? corners : united->corners[g];
        }
    }
    for (int64_t first = 0, block = 0; first < groups; first += BLOCK_GROUPS) {
        int64_t count = groups - first < BLOCK_GROUPS ? groups - first : BLOCK_GROUPS;
        pairs_sort_rows(count, united->order + first, united->ptr, united->corners);
        united->first_row[++block] = first + count;
    }
    for (int64_t g = 0; g < groups; g++) {
        for (int r = 0; r < MEANS_GROUP && row_at(input, united->order[g], r) >= 0; r++) {
            united->place_of[row_at(input, united->order[g], r)] = g * MEANS_GROUP + r;
        }
    }
done:
    return status;
}

/* Which value each corner looks at, and the corners of each group. */
static enum status list_corners(const struct means_input *input, const struct united *united,
                                struct means *means, struct error *error)
{
    enum status status;
    int64_t groups = united->group_count;
    int32_t *filled = united->corners_of; /* from here on: how many of each row have been listed */
    TRY(NEW_ARRAY(&means->of_corner, input->corner_count, error));
    TRY(NEW_ARRAY(&means->corner_ptr, groups + 1, error));
    for (int64_t g = 0; g < groups; g++) {
        means->corner_ptr[g + 1] = means->corner_ptr[g] + united->corners[united->order[g]];
    }
    TRY(NEW_ARRAY(&means->corner, means->corner_ptr[groups] * MEANS_GROUP, error));
    for (int64_t i = 0; i < means->corner_ptr[groups] * MEANS_GROUP; i++) {
        means->corner[i] = (int32_t)input->corner_count;
    }
    memset(filled, 0, (size_t)input->row_count * sizeof *filled);
    for (int64_t i = 0; i < input->corner_count; i++) {
        int32_t row = input->row_of_corner[i];
        int64_t group = united->place_of[row] / MEANS_GROUP, lane = united->place_of[row] % MEANS_GROUP;
        means->of_corner[i] = (int32_t)(group * input->dim * MEANS_GROUP + lane);
        means->corner[(means->corner_ptr[group] + filled[row]++) * MEANS_GROUP + lane] = (int32_t)i;
    }
done:
    return status;
}

enum status means_build(const struct means_input *input, struct means *means, struct error *error)
{
    enum status status;
    struct united united = {0};
    *means = (struct means){0};
    TRY(unite(input, &united, error));
    TRY(order_groups(input, &united, error));
    struct pairs_input pairs = {.dim = input->dim,
                                .width = MEANS_GROUP,
                                .node_count = input->node_count,
                                .row_count = united.group_count,
                                .row = united.order,
                                .ptr = united.ptr,
                                .idx = united.idx,
                                .value = united.phi,
                                .place = input->place,
                                .block_count = (united.group_count + BLOCK_GROUPS - 1) / BLOCK_GROUPS,
                                .first_row = united.first_row,
                                .single = input->single};
    TRY(pairs_build(&pairs, &means->pairs, error));
    TRY(NEW_ARRAY(&means->value, united.group_count * MEANS_GROUP * input->dim, error));
    TRY(NEW_ARRAY(&means->corner_force, (input->corner_count + 1) * PAIRS_STRIDE(input->dim), error));
    TRY(list_corners(input, &united, means, error));
done:
    united_free(&united);
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
