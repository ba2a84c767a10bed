/* What the tests of lib/solid and of boundary averages share: checks, random numbers, and small bodies. */
#ifndef TESTS_SOLID_FIXTURE_H
#define TESTS_SOLID_FIXTURE_H

#include "base/status.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* |value - expected| <= tolerance; NaN fails. */
#define NEAR_TO(value, expected, tolerance) near_to((value), (expected), (tolerance), __func__, __LINE__)

static inline void near_to(double value, double expected, double tolerance, const char *where, int line)
{
    if (!(fabs(value - expected) <= tolerance)) {
        fail_msg("%s:%d: %.17g is not %.17g within %g", where, line, value, expected, tolerance);
    }
}

#define AT_MOST(value, bound)                                                                                \
    do {                                                                                                     \
        double at_most_value = (value), at_most_bound = (bound);                                             \
        if (!(at_most_value <= at_most_bound)) {                                                             \
            fail_msg("%s:%d: %s: %g is not at most %g", __func__, __LINE__, #value, at_most_value,           \
                     at_most_bound);                                                                         \
        }                                                                                                    \
    } while (0)

#define GOOD(expression)                                                                                     \
    do {                                                                                                     \
        struct error *good_error = &error;                                                                   \
        enum status good_status = (expression);                                                              \
        if (good_status != STATUS_OK) {                                                                      \
            fail_msg("%s:%d: status %d: %s", __func__, __LINE__, (int)good_status, good_error->text);        \
        }                                                                                                    \
    } while (0)

/* A stream of pseudo-random numbers (Knuth's 64-bit congruential generator), the same everywhere. */
struct random {
    uint64_t state;
};

static inline double uniform(struct random *random, double low, double high)
{
    random->state = random->state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(random->state >> 11) * 0x1p-53;
}

#endif
