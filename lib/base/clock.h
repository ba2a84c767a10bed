/* A stopwatch for cost reports. It never enters a result. */
#pragma once

#include <omp.h>

/* Seconds of a clock that only goes forward. */
static inline double clock_seconds(void)
{
    return omp_get_wtime();
}
