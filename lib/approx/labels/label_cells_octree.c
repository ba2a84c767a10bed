#include "approx/labels/label_cells_private.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static int64_t cubes(const int64_t count[3])
{
    return count[0] * count[1] * count[2];
}

static bool within(const int64_t count[3], const int64_t at[3])
{
    return at[0] >= 0 && at[0] < count[0] && at[1] >= 0 && at[1] < count[1] && at[2] >= 0 && at[2] < count[2];
}

static int64_t index_of(const int64_t count[3], const int64_t at[3])
{
    return (at[2] * count[1] + at[1]) * count[0] + at[0];
}

/* Mark all cubes that touch a marked one, along each axis in turn. */
static enum status dilate(const int64_t count[3], bool *marked, struct error *error)
{
    SCRATCH bool *before = NULL;
    int64_t total = cubes(count), stride = 1;
    enum status status = NEW_ARRAY(&before, total, error);
    for (int d = 0; d < 3 && status == STATUS_OK; d++) {
        memcpy(before, marked, (size_t)total * sizeof *marked);
        for (int64_t i = 0; i < total; i++) {
            int64_t at = i / stride % count[d];
            marked[i] =
                before[i] || (at > 0 && before[i - stride]) || (at + 1 < count[d] && before[i + stride]);
        }
        stride *= count[d];
    }
    return status;
}

enum status octree_make(int levels, const int64_t count[3], uint8_t *wish, struct octree *octree,
                        struct error *error)
{
    *octree = (struct octree){.levels = levels};
    for (int l = levels - 1; l >= 0; l--) {
        for (int d = 0; d < 3; d++) {
            octree->count[l][d] = count[d] >> (levels - 1 - l);
        }
    }
    for (int l = levels - 1; l > 0; l--) {
        /* Cubes that touch a split one, or a wish with `around`, have at least this level: their parents are
         * split. */
        const int64_t *fine = octree->count[l], *coarse = octree->count[l - 1];
        NEW_SCRATCH(bool, marked, cubes(fine), error);
        for (int64_t i = 0; i < cubes(fine); i++) {
            marked[i] = (l < levels - 1 && octree->split[l][i]) || wish[i] == OCTREE_WISH(l, true);
        }
        RETURN_IF_ERROR(dilate(fine, marked, error));
        RETURN_IF_ERROR(NEW_ARRAY(&octree->split[l - 1], cubes(coarse), error));
        for (int64_t i = 0; i < cubes(fine); i++) {
            const int64_t at[3] = {i % fine[0], i / fine[0] % fine[1], i / fine[0] / fine[1]};
            const int64_t parent = index_of(coarse, (const int64_t[]){at[0] / 2, at[1] / 2, at[2] / 2});
            bool first = (at[0] | at[1] | at[2]) % 2 == 0;
            bool *split = &octree->split[l - 1][parent];
            *split = *split || marked[i] || wish[i] >= OCTREE_WISH(l, false);
            /* Parents take the largest wish, in place: their index is at most that of their children. */
            wish[parent] = first || wish[i] > wish[parent] ? wish[i] : wish[parent];
        }
    }
    return STATUS_OK;
}

void octree_free(struct octree *octree)
{
    for (int l = 0; l < OCTREE_MOST_LEVELS; l++) {
        free(octree->split[l]);
    }
    *octree = (struct octree){0};
}

static bool is_split(const struct octree *octree, int level, const int64_t at[3])
{
    return level < octree->levels - 1 && within(octree->count[level], at) &&
           octree->split[level][index_of(octree->count[level], at)];
}

/* Whether the octree has a cube of this level there, as a leaf or split. */
static bool exists(const struct octree *octree, int level, const int64_t at[3])
{
    const int64_t parent[3] = {at[0] / 2, at[1] / 2, at[2] / 2};
    return within(octree->count[level], at) && (level == 0 || is_split(octree, level - 1, parent));
}

/* A leaf, one of its sides, and the callback for its tetrahedra. */
struct side {
    const struct octree *octree;
    int level;
    int32_t size;    /* half the edge of the leaf, in halves of the finest edge */
    int64_t at[3];   /* the leaf */
    int axis, upper; /* the side */
    octree_visitor *visit;
    void *context;
};

static void centre_of(const int64_t at[3], int32_t size, int32_t centre[3])
{
    for (int d = 0; d < 3; d++) {
        centre[d] = (int32_t)(2 * at[d] + 1) * size;
    }
}

/* Corner 0 to 3 of the side, in cyclic order. */
static void corner_of(const struct side *side, int corner, int32_t point[3])
{
    static const int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    int d = side->axis, e = (d + 1) % 3, f = (d + 2) % 3;
    point[d] = (int32_t)(2 * (side->at[d] + side->upper)) * side->size;
    point[e] = (int32_t)(2 * (side->at[e] + around[corner][0])) * side->size;
    point[f] = (int32_t)(2 * (side->at[f] + around[corner][1])) * side->size;
}

/* Two leaves of one size: a tetrahedron for each edge of their common side, or two if smaller leaves halve
 * the edge. */
static enum status between_equals(const struct side *side, const int64_t beyond[3])
{
    static const int outward[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    int e = (side->axis + 1) % 3, f = (side->axis + 2) % 3;
    int32_t corner[4][3], first[3], second[3];
    centre_of(side->at, side->size, corner[0]);
    centre_of(beyond, side->size, corner[1]);
    for (int edge = 0; edge < 4; edge++) {
        int64_t here[3], there[3];
        memcpy(here, side->at, sizeof here);
        memcpy(there, beyond, sizeof there);
        here[e] += outward[edge][0];
        here[f] += outward[edge][1];
        there[e] += outward[edge][0];
        there[f] += outward[edge][1];
        bool halved = is_split(side->octree, side->level, here) || is_split(side->octree, side->level, there);
        corner_of(side, edge, first);
        corner_of(side, (edge + 1) % 4, second);
        memcpy(corner[2], first, sizeof first);
        memcpy(corner[3], second, sizeof second);
        if (halved) {
            for (int d = 0; d < 3; d++) {
                corner[3][d] = (first[d] + second[d]) / 2;
            }
            RETURN_IF_ERROR(side->visit(side->context, (const int32_t(*)[3])corner));
            memcpy(corner[2], corner[3], sizeof first);
            memcpy(corner[3], second, sizeof second);
        }
        RETURN_IF_ERROR(side->visit(side->context, (const int32_t(*)[3])corner));
    }
    return STATUS_OK;
}

/* The neighbour of the leaf is larger: its side is cut along the diagonal from the middle of the larger side.
 * Each triangle makes a tetrahedron with each of the two centres. */
static enum status join_larger(const struct side *side, const int64_t beyond[3])
{
    const int64_t larger[3] = {beyond[0] / 2, beyond[1] / 2, beyond[2] / 2};
    int32_t corner[4][3], middle[3];
    int at = 0;
    centre_of(larger, 2 * side->size, middle);
    for (int k = 0; k < 4; k++) {
        corner_of(side, k, corner[0]);
        int e = (side->axis + 1) % 3, f = (side->axis + 2) % 3;
        at = corner[0][e] == middle[e] && corner[0][f] == middle[f] ? k : at;
    }
    for (int triangle = 0; triangle < 2; triangle++) {
        for (int centre = 0; centre < 2; centre++) {
            corner_of(side, at, corner[0]);
            corner_of(side, (at + 1 + triangle) % 4, corner[1]);
            corner_of(side, (at + 2 + triangle) % 4, corner[2]);
            if (centre == 0) {
                centre_of(side->at, side->size, corner[3]);
            } else {
                memcpy(corner[3], middle, sizeof middle);
            }
            RETURN_IF_ERROR(side->visit(side->context, (const int32_t(*)[3])corner));
        }
    }
    return STATUS_OK;
}

enum status octree_cells(const struct octree *octree, octree_visitor *visit, void *context)
{
    for (int level = 0; level < octree->levels; level++) {
        const int64_t *count = octree->count[level];
        struct side side = {octree, level, 1 << (octree->levels - 1 - level), {0}, 0, 0, visit, context};
        for (int64_t i = 0; i < cubes(count); i++) {
            side.at[0] = i % count[0];
            side.at[1] = i / count[0] % count[1];
            side.at[2] = i / count[0] / count[1];
            bool leaf = exists(octree, level, side.at) && !is_split(octree, level, side.at);
            for (int s = 0; s < 6 && leaf; s++) {
                int64_t beyond[3] = {side.at[0], side.at[1], side.at[2]};
                side.axis = s / 2;
                side.upper = s % 2;
                beyond[side.axis] += side.upper ? 1 : -1;
                if (!within(count, beyond)) {
                    continue;
                }
                if (!exists(octree, level, beyond)) {
                    RETURN_IF_ERROR(join_larger(&side, beyond));
                } else if (side.upper && !is_split(octree, level, beyond)) {
                    RETURN_IF_ERROR(between_equals(&side, beyond));
                }
            }
        }
    }
    return STATUS_OK;
}
