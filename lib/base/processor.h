/* What the processor can do, for kernels that are compiled for several instruction sets. */
#ifndef BASE_PROCESSOR_H
#define BASE_PROCESSOR_H

#include <stdbool.h>

/* Whether it runs code for "plain" (always), "avx2", "avx512" (its f, dq, vl and bw) or "fma"; false for any
 * other name. */
bool processor_has(const char *set);

/* The last of "plain", "avx2", "avx512" that it runs. */
const char *processor_best_set(void);

#endif
