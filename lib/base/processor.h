/* Kernels that are compiled for several instruction sets, and which of these the processor runs. */
#pragma once

/* A part of such kernels. */
#define KERNEL_INLINE static inline __attribute__((always_inline))

/* A function that is compiled for each of these; the processor's own is chosen when the program starts. gcc
 * dispatches on levels of x86-64 since version 12. */
#if defined(__x86_64__) && (defined(__clang__) || __GNUC__ >= 12)
#define HAS_SETS 1
#define ALL_SETS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define HAS_SETS 0
#define ALL_SETS
#endif

/* The one of these that this processor runs. */
const char *processor_best_set(void);
