/* Vectors of the force loop's kernels: those of the compiler (vector_size), so that any target compiles;
 * private to lib/solid. */
#pragma once

#include "base/processor.h"
#include "solid/body/body.h"

#include <stdint.h>
#include <string.h>

typedef double pair2 __attribute__((vector_size(16)));
typedef double quad4 __attribute__((vector_size(32)));

/* Points are taken LANES at a time; arrays over points are padded by LANES, so that whole vectors may be
 * read. */
#define LANES BODY_POINT_PADDING
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef float lanes_float __attribute__((vector_size(4 * LANES)));
typedef int32_t lanes_int __attribute__((vector_size(4 * LANES)));

/* Unaligned loads and stores as copies, which compilers turn into single instructions. */
#define LOAD(vector, from) memcpy(&(vector), (from), sizeof(vector))
#define STORE(to, vector) memcpy((to), &(vector), sizeof(vector))

/* Transpose the 4 x 4 matrix whose rows these are. */
KERNEL_INLINE void transpose(quad4 row[4])
{
    quad4 a = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
    quad4 b = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
    quad4 c = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
    quad4 d = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
    row[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    row[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    row[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/* Component a of four vectors, in the lanes of x[a]. */
KERNEL_INLINE void load_components(const double *const from[4], int dim, quad4 x[4])
{
    if (dim == 2) {
        pair2 v[4];
        for (int r = 0; r < 4; r++) {
            LOAD(v[r], from[r]);
        }
        pair2 first = __builtin_shufflevector(v[0], v[1], 0, 2);
        pair2 last = __builtin_shufflevector(v[2], v[3], 0, 2);
        x[0] = __builtin_shufflevector(first, last, 0, 1, 2, 3);
        first = __builtin_shufflevector(v[0], v[1], 1, 3);
        last = __builtin_shufflevector(v[2], v[3], 1, 3);
        x[1] = __builtin_shufflevector(first, last, 0, 1, 2, 3);
    } else {
        for (int r = 0; r < 4; r++) {
            LOAD(x[r], from[r]);
        }
        transpose(x);
    }
}

/* The converse: the four vectors, one behind the other, VECTOR_STRIDE(dim) apart. */
KERNEL_INLINE void store_components(const quad4 x[4], int dim, double *to)
{
    if (dim == 2) {
        quad4 first = __builtin_shufflevector(x[0], x[1], 0, 4, 1, 5);
        quad4 last = __builtin_shufflevector(x[0], x[1], 2, 6, 3, 7);
        STORE(to, first);
        STORE(to + 4, last);
    } else {
        quad4 row[4] = {x[0], x[1], x[2], {0.0}};
        transpose(row);
        for (int r = 0; r < 4; r++) {
            STORE(to + r * VECTOR_STRIDE(3), row[r]);
        }
    }
}
