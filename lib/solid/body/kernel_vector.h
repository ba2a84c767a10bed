/* Vectors of the force loop's kernels: those of the compiler (vector_size), so that any target compiles;
 * private to lib/solid. */
#pragma once

#include "base/processor.h"
#include "solid/body/body.h"

#include <stdint.h>
#include <string.h>

typedef double pair2 __attribute__((vector_size(16)));
typedef double quad4 __attribute__((vector_size(32)));

/* Points are taken LANES at a time: as many as fit into a register with AVX2, as longer vectors would go
 * through memory. Arrays over points are padded (BODY_POINT_PADDING), so that whole vectors may be read. */
#define LANES 4
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef float lanes_float __attribute__((vector_size(4 * LANES)));
typedef int32_t lanes_int __attribute__((vector_size(4 * LANES)));

/* Unaligned loads and stores. Copies by memcpy would go by halves, for which a load of the whole waits. */
#define LOAD(vector, from)                                                                                   \
    do {                                                                                                     \
        typedef __typeof__(vector) anywhere __attribute__((aligned(4), may_alias));                          \
        (vector) = *(const anywhere *)(from);                                                                \
    } while (0)
#define STORE(to, vector)                                                                                    \
    do {                                                                                                     \
        typedef __typeof__(vector) anywhere __attribute__((aligned(4), may_alias));                          \
        *(anywhere *)(to) = (vector);                                                                        \
    } while (0)
