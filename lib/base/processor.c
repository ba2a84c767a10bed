#include "base/processor.h"

#include <string.h>

bool processor_has(const char *set)
{
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (strcmp(set, "avx512") == 0) {
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    }
    if (strcmp(set, "avx2") == 0) {
        return __builtin_cpu_supports("avx2");
    }
    if (strcmp(set, "fma") == 0) {
        return __builtin_cpu_supports("fma");
    }
#endif
    return strcmp(set, "plain") == 0;
}

const char *processor_best_set(void)
{
    return processor_has("avx512") ? "avx512" : processor_has("avx2") ? "avx2" : "plain";
}
