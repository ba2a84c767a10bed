/* Unstructured grids of VTK; private to lib/io. vtk_read.c and vtu_read.c fill a struct vtk_input, vtk_build
 * makes nodes, elements and groups of it. */
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
    const struct nifti_type *type; /* NULL: it is not read */
    int64_t components, count;     /* count: of all its numbers; as long as they are not there: as many as
                                      there should be, -1: any */
    int64_t offset;                /* of a VTU file's in its appended data */
    double *value;                 /* count */
};

struct vtk_input {
    struct msh_reader *r;
    int64_t point_count, cell_count;
    int64_t count, room;
    struct vtk_array *arrays;
};

/* Whether an array of that name, kind and type is of use: else it need not be read. Where it may be missed,
 * it is noted as left out. */
bool vtk_is_wanted(struct vtk_input *v, const struct vtk_array *array);

/* Add an array of `count` numbers, zeros as yet; NULL after a failure. */
struct vtk_array *vtk_add(struct vtk_input *v, const struct vtk_array *array, int64_t count);

/* Fill an array from words of text. */
void vtk_fill_text(struct msh_reader *r, struct vtk_array *array, const char **at, const char *end);

/* The whole number that a number of the grid is; -1: it is none, or too large. */
static inline int64_t vtk_whole(double number)
{
    return fabs(number) < 9e15 && number == rint(number) ? (int64_t)number : -1;
}

/* Make the mesh; free the arrays. */
void vtk_build(struct vtk_input *v);
