#include "io/msh_build.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>

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

static int compare_faces(const void *left, const void *right)
{
    const struct msh_face *a = left;
    const struct msh_face *b = right;
    int nodes = compare_numbers(2, a->rest, b->rest);
    return nodes != 0 ? nodes : compare_numbers(1, &a->cell, &b->cell);
}

static bool same_nodes(const struct msh_face *a, const struct msh_face *b)
{
    return a->rest[0] == b->rest[0] && a->rest[1] == b->rest[1];
}

/* Visit every face of every cell: count it (fill = false) or store it under its lowest node. */
static void visit_faces(struct msh_faces *faces, int64_t cell_count, int64_t at[], bool fill)
{
    int dim = faces->dim;
    for (int64_t c = 0; c < cell_count; c++) {
        for (int i = 0; i <= dim; i++) {
            int32_t node[3] = {-1, -1, -1};
            face_of(dim, &faces->cells[c * (dim + 1)], i, node);
            bool odd = sort_nodes(dim, node);
            if (fill) {
                faces->face[at[node[0]]] = (struct msh_face){{node[1], node[2]}, (int32_t)c, (int8_t)i, odd};
            }
            at[node[0]]++;
        }
    }
}

static void find_overlap(const struct msh_faces *faces, int64_t node_count, struct msh_overlap *overlap)
{
    *overlap = (struct msh_overlap){{-1, -1}};
    for (int64_t n = 0; n < node_count; n++) {
        for (int64_t f = faces->ptr[n] + 1; f < faces->ptr[n + 1]; f++) {
            const struct msh_face *face = &faces->face[f];
            bool third = f >= faces->ptr[n] + 2 && same_nodes(face, face - 2);
            if (same_nodes(face, face - 1) && (face->odd == face[-1].odd || third)) {
                *overlap = (struct msh_overlap){{face[-1].cell, face->cell}};
                return;
            }
        }
    }
}

enum status msh_faces_make(struct msh_faces *faces, int dim, int64_t node_count, int64_t cell_count,
                           const int32_t cells[], struct msh_overlap *overlap, struct error *error)
{
    enum status status = STATUS_OK;
    int64_t *at = NULL;
    *faces = (struct msh_faces){.dim = dim, .cells = cells};
    TRY(NEW_ARRAY(&faces->ptr, node_count + 1, error));
    TRY(NEW_ARRAY(&faces->face, cell_count * (dim + 1), error));
    TRY(NEW_ARRAY(&at, node_count, error));
    visit_faces(faces, cell_count, faces->ptr + 1, false);
    for (int64_t n = 0; n < node_count; n++) {
        faces->ptr[n + 1] += faces->ptr[n];
        at[n] = faces->ptr[n];
    }
    visit_faces(faces, cell_count, at, true);
    for (int64_t n = 0; n < node_count; n++) {
        qsort(&faces->face[faces->ptr[n]], (size_t)(faces->ptr[n + 1] - faces->ptr[n]), sizeof *faces->face,
              compare_faces);
    }
    find_overlap(faces, node_count, overlap);
done:
    free(at);
    if (status != STATUS_OK) {
        msh_faces_free(faces);
    }
    return status;
}

void msh_faces_free(struct msh_faces *faces)
{
    FREE_ALL(faces->ptr, faces->face);
    *faces = (struct msh_faces){0};
}

int64_t msh_faces_find(const struct msh_faces *faces, const int32_t node[], int *count)
{
    int32_t key[3] = {-1, -1, -1};
    for (int k = 0; k < faces->dim; k++) {
        key[k] = node[k];
    }
    (void)sort_nodes(faces->dim, key);
    int64_t first = -1;
    *count = 0;
    for (int64_t f = faces->ptr[key[0]]; f < faces->ptr[key[0] + 1]; f++) {
        if (faces->face[f].rest[0] == key[1] && faces->face[f].rest[1] == key[2]) {
            first = first < 0 ? f : first;
            ++*count;
        }
    }
    return first;
}

void msh_face_nodes(const struct msh_faces *faces, int64_t face, int32_t node[])
{
    const struct msh_face *found = &faces->face[face];
    face_of(faces->dim, &faces->cells[found->cell * (faces->dim + 1)], found->opposite, node);
}
