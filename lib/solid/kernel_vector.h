/* Vectors of the force loop's kernels: those of the compiler (vector_size), so that any target compiles;
 * private to lib/solid. */
#ifndef SOLID_KERNEL_VECTOR_H
#define SOLID_KERNEL_VECTOR_H

#include "solid/body.h"

#include <stdint.h>
#include <string.h>

#define KERNEL_INLINE static inline __attribute__((always_inline))

typedef double pair2 __attribute__((vector_size(16)));
typedef double quad4 __attribute__((vector_size(32)));
typedef float pair2_float __attribute__((vector_size(8)));
typedef float quad4_float __attribute__((vector_size(16)));

/* Points are taken LANES at a time; arrays over points are padded by LANES, so that whole vectors may be
 * read. */
#define LANES BODY_POINT_PADDING
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef float lanes_float __attribute__((vector_size(4 * LANES)));
typedef int32_t lanes_int __attribute__((vector_size(4 * LANES)));

/* Unaligned loads and stores as copies, which compilers turn into single instructions. */
#define LOAD(vector, from) memcpy(&(vector), (from), sizeof(vector))
#define STORE(to, vector) memcpy((to), &(vector), sizeof(vector))

/* Ask for the bytes first .. last of an array, into the second cache, which will be read a block later: what
 * waits for memory then runs beside the arithmetic of this block. */
KERNEL_INLINE void prefetch(const void *array, int64_t first, int64_t last)
{
    for (uintptr_t at = (uintptr_t)array + (uintptr_t)first; at < (uintptr_t)array + (uintptr_t)last;
         at += 64) {
        __builtin_prefetch((const void *)at, 0, 2);
    }
}

#endif
