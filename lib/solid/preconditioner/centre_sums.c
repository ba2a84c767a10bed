#include "solid/preconditioner/centre_sums.h"

#include "base/memory.h"

#include <string.h>

enum { MORE_ROOM = 4 }; /* centres beyond those asked for, so that room is not made for each */

enum status centre_sums_begin(int64_t centre_count, int64_t numbers, struct centre_sums *sums,
                              struct error *error)
{
    *sums = (struct centre_sums){.numbers = numbers, .centre_count = centre_count};
    RETURN_IF_ERROR(NEW_ARRAY(&sums->centre, centre_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&sums->place, centre_count, error));
    memset(sums->place, -1, (size_t)centre_count * sizeof *sums->place);
    return STATUS_OK;
}

void centre_sums_free(struct centre_sums *sums)
{
    FREE_ALL(sums->centre, sums->place, sums->block);
    *sums = (struct centre_sums){0};
}

enum status centre_sums_make_room(struct centre_sums *sums, int64_t more, struct error *error)
{
    int64_t wanted = sums->count + more, entries = sums->numbers * sums->numbers;
    int64_t before = centre_sums_pair(sums->room, 0) * entries;
    if (wanted <= sums->room) {
        return STATUS_OK;
    }
    int64_t room = wanted + MORE_ROOM, values = centre_sums_pair(room, 0) * entries;
    RETURN_IF_ERROR(RESIZE_ARRAY(&sums->block, values, error));
    memset(sums->block + before, 0, (size_t)(values - before) * sizeof *sums->block);
    sums->room = room;
    return STATUS_OK;
}

enum status centre_sums_send(const struct ranks *ranks, int owner, struct centre_sums *sums,
                             struct error *error)
{
    SCRATCH int64_t *count = NULL;
    int processes = ranks_count(ranks);
    if (processes == 1) { /* nothing to send */
        return STATUS_OK;
    }
    RETURN_IF_ERROR(ranks_list(ranks, sums->count, &count, error));
    NEW_SCRATCH(int64_t, first, processes + 1, error);
    enum status status = STATUS_OK;
    if (ranks_rank(ranks) != owner) {
        status = centre_sums_make_room(sums, count[owner], error);
    }
    RETURN_IF_ERROR(ranks_agree(ranks, status, error));
    sums->count = count[owner];
    for (int r = owner + 1; r <= processes; r++) {
        first[r] = 1; /* the owner's share is everything */
    }
    ranks_gather(ranks, sums->centre, (size_t)sums->count * sizeof *sums->centre, first);
    ranks_gather(ranks, sums->block,
                 (size_t)(centre_sums_pair(sums->count, 0) * sums->numbers * sums->numbers) *
                     sizeof *sums->block,
                 first);
    for (int64_t i = 0; i < sums->count; i++) {
        sums->place[sums->centre[i]] = (int32_t)i;
    }
    return STATUS_OK;
}

void centre_sums_add(const struct centre_sums *sums, double *matrix)
{
    int64_t numbers = sums->numbers, size = sums->centre_count * numbers;
    const double *block = sums->block;
    for (int64_t i = 0; i < sums->count; i++) {
        for (int64_t k = 0; k <= i; k++, block += numbers * numbers) {
            int64_t above = sums->centre[i] > sums->centre[k] ? sums->centre[i] : sums->centre[k];
            int64_t below = sums->centre[i] + sums->centre[k] - above;
            double *to = matrix + above * numbers * size + below * numbers;
            for (int64_t j = 0; j < numbers * numbers; j++) {
                to[j / numbers * size + j % numbers] += block[j];
            }
        }
    }
}

void centre_sums_mirror(int64_t centre_count, int64_t numbers, double *matrix)
{
    int64_t size = centre_count * numbers;
    for (int64_t i = 0; i < size; i++) {
        for (int64_t k = 0; k < i; k++) {
            double *here = &matrix[i * size + k], *across = &matrix[k * size + i];
            *here = i / numbers == k / numbers ? 0.5 * (*here + *across) : *here;
            *across = *here;
        }
    }
}
