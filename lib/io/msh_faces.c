#include "io/msh_build.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* The face opposite to node i of a positively oriented simplex, oriented outward. */
static const int8_t outward2[3][2] = {{1, 2}, {2, 0}, {0, 1}};
static const int8_t outward3[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static void face_of(int dim, const int32_t cell[], int opposite, int32_t node[])
{
    for (int k = 0; k < dim; k++) {
        node[k] = cell[dim == 2 ? outward2[opposite][k] : outward3[opposite][k]];
    }
}

/* Sort two or three nodes; true when that took an odd number of swaps. */
static bool sort_nodes(int dim, int32_t node[])
{
    bool odd = false;
    for (int i = 1; i < dim; i++) {
        for (int j = i; j > 0 && node[j] < node[j - 1]; j--) {
            int32_t swap = node[j];
            node[j] = node[j - 1];
            node[j - 1] = swap;
            odd = !odd;
        }
    }
    return odd;
}

static bool same_nodes(const struct msh_face *a, const struct msh_face *b)
{
    return compare_numbers(3, a->node, b->node) == 0;
}

static int compare_faces(const void *left, const void *right)
{
    const struct msh_face *a = left;
    const struct msh_face *b = right;
    int nodes = compare_numbers(3, a->node, b->node);
    return nodes != 0 ? nodes : compare_numbers(1, &a->cell, &b->cell);
}

static void find_overlap(const struct msh_faces *faces, struct msh_overlap *overlap)
{
    *overlap = (struct msh_overlap){{-1, -1}};
    for (int64_t f = 1; f < faces->count; f++) {
        const struct msh_face *face = &faces->face[f];
        bool third = f >= 2 && same_nodes(face, face - 2);
        if (same_nodes(face, face - 1) && (face->odd == face[-1].odd || third)) {
            *overlap = (struct msh_overlap){{face[-1].cell, face->cell}};
            return;
        }
    }
}

enum status msh_faces_make(struct msh_faces *faces, int dim, int64_t cell_count, const int32_t cells[],
                           struct msh_overlap *overlap, struct error *error)
{
    *faces = (struct msh_faces){.dim = dim, .cells = cells, .count = cell_count * (dim + 1)};
    RETURN_IF_ERROR(NEW_ARRAY(&faces->face, faces->count, error));
    for (int64_t f = 0; f < faces->count; f++) {
        struct msh_face *face = &faces->face[f];
        *face = (struct msh_face){
            .node = {-1, -1, -1}, .cell = (int32_t)(f / (dim + 1)), .opposite = (int8_t)(f % (dim + 1))};
        face_of(dim, &cells[f / (dim + 1) * (dim + 1)], face->opposite, face->node);
        face->odd = sort_nodes(dim, face->node);
    }
    qsort(faces->face, (size_t)faces->count, sizeof *faces->face, compare_faces);
    find_overlap(faces, overlap);
    return STATUS_OK;
}

void msh_faces_free(struct msh_faces *faces)
{
    free(faces->face);
    *faces = (struct msh_faces){0};
}

int64_t msh_faces_find(const struct msh_faces *faces, const int32_t node[], int *count)
{
    struct msh_face wanted = {.node = {-1, -1, -1}, .cell = -1};
    memcpy(wanted.node, node, (size_t)faces->dim * sizeof *node);
    (void)sort_nodes(faces->dim, wanted.node);
    int64_t low = 0, high = faces->count;
    while (low < high) { /* the first face that does not come before the one wanted */
        int64_t middle = low + (high - low) / 2;
        if (compare_faces(&faces->face[middle], &wanted) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    *count = 0;
    while (low + *count < faces->count && same_nodes(&faces->face[low + *count], &wanted)) {
        ++*count;
    }
    return *count > 0 ? low : -1;
}

void msh_face_nodes(const struct msh_faces *faces, int64_t face, int32_t node[])
{
    const struct msh_face *found = &faces->face[face];
    face_of(faces->dim, &faces->cells[found->cell * (faces->dim + 1)], found->opposite, node);
}
