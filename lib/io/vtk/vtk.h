/* Writing node clouds with cells and fields for ParaView (VTK XML). */
#pragma once

#include "base/names.h"
#include "io/stream/stream.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A view of nodes and cells. */
struct vtk_mesh {
    int dim; /* 2 or 3 */
    int64_t node_count;
    const double *x; /* node_count x dim */
    int64_t cell_count;
    const int32_t *node;  /* cell_count x (dim + 1); NULL: one vertex cell for each node */
    struct names regions; /* not to be freed */
};

/* A view of a field on nodes or cells. */
struct vtk_field {
    const char *name;
    bool of_cells;
    const struct section *section; /* one row for each node or cell; attribute cols= names the components */
};

/* Whether the columns of a section are those of a symmetric tensor, by their names: xx, yy, zz, xy and, in
 * 3D, xz and yz, in any order. from[6] receives the column of xx, yy, zz, xy, yz, xz, VTK's order; -1 for yz
 * and xz in 2D, which are zero. */
bool vtk_tensor(const struct section *section, int64_t from[6]);

/* Write a VTK XML unstructured grid: data inline, base64 of little-endian values, or as text. Vectors of 2D
 * meshes (two floating columns) are padded to three; symmetric tensors have six components in VTK's order.
 * Each region is an array "region.NAME" of the field data with its index. Errors of the file stay in it. */
void vtu_write(FILE *file, const struct vtk_mesh *mesh, int64_t field_count, const struct vtk_field *fields,
               bool text);

/* Write a ParaView collection: `count` files (relative to it) with their times. */
void pvd_write(FILE *file, int64_t count, char *const names[], const double *times);
