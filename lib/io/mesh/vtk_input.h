/* Unstructured grids of VTK: shared by vtk_read.c, vtu_read.c, vtu_data.c, vtk_input.c and vtk_groups.c;
 * private to lib/io. The readers fill a struct vtk_input, vtk_build makes nodes, elements and groups of it.
 */
#pragma once

#include "io/image/image_private.h"
#include "io/mesh/msh_private.h"

#include <math.h>

/* What arrays are of. */
enum vtk_kind {
    VTK_OTHER,
    VTK_POINTS,
    VTK_CONNECTIVITY,
    VTK_OFFSETS,
    VTK_TYPES,
    VTK_OF_CELLS,
    VTK_OF_POINTS,
    VTK_OF_FIELD
};

struct vtk_array {
    enum vtk_kind kind;
    char name[INPUT_NAME + 1];
    int64_t components, count; /* count: of all its numbers */
    double *value;             /* count */
};

struct vtk_input {
    struct msh_reader *r;
    int64_t point_count, cell_count;
    int64_t count, room;
    struct vtk_array *arrays;
};

/* Whether an array of that name, kind and type (NULL: no numbers) is of use: else it need not be read. Where
 * it may be missed, it is noted as left out. */
bool vtk_is_wanted(struct vtk_input *v, const struct vtk_array *array, const struct nifti_type *type);

/* Add an array of `count` numbers, zeros as yet; NULL after a failure. */
struct vtk_array *vtk_add(struct vtk_input *v, const struct vtk_array *array, int64_t count);

/* Fill an array from words of text. */
void vtk_fill_text(struct msh_reader *r, struct vtk_array *array, const struct nifti_type *type,
                   const char **at, const char *end);

/* The whole number that a number of the grid is; -1: it is none, or too large. */
static inline int64_t vtk_whole(double number)
{
    return fabs(number) < 9e15 && number == rint(number) ? (int64_t)number : -1;
}

/* Where the bytes of an array of a VTU file are, and how they lie there. */
struct vtu_source {
    const char *at, *end;
    bool base64, swap, compressed;
    int word;     /* bytes of each number of the head: 4 or 8 */
    int64_t most; /* bytes that there may be, unpacked */
};

/* The bytes of an array, uncompressed and out of base64; to be freed also on failure. (vtu_data.c) */
struct vtu_bytes {
    char *bytes;
    int64_t size;
};

/* Make the mesh; free the arrays. */
void vtk_build(struct vtk_input *v);
