/* What all unit tests share: tests that list themselves, checks, and pseudo-random numbers. */
#pragma once

#include "base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* ---- tests ---- */

/* A test is written as TEST(name) { ... }; RUN_TESTS, behind the last one, makes the program that runs them
 * in the order of the file. */
static struct CMUnitTest unit_tests[64];
static size_t unit_test_count;

/* What zeros() has given the test that runs. */
struct unit_memory {
    struct unit_memory *next;
    _Alignas(16) char bytes[];
};
static struct unit_memory *unit_memory;

static inline int unit_free(__attribute__((unused)) void **state)
{
    while (unit_memory != NULL) {
        struct unit_memory *next = unit_memory->next;
        free(unit_memory);
        unit_memory = next;
    }
    return 0;
}

static inline void unit_list(struct CMUnitTest test)
{
    if (unit_test_count < sizeof unit_tests / sizeof *unit_tests) {
        unit_tests[unit_test_count] = test;
    }
    unit_test_count++;
}

#define TEST(name)                                                                                           \
    static void name(void **state);                                                                          \
    __attribute__((constructor)) static void list_##name(void)                                               \
    {                                                                                                        \
        unit_list((struct CMUnitTest)cmocka_unit_test_teardown(name, unit_free));                            \
    }                                                                                                        \
    static void name(__attribute__((unused)) void **state)

/* The same in two dimensions, and in three: TEST_IN_EACH_DIM(name) { ... dim ... }. */
#define TEST_IN_EACH_DIM(name)                                                                               \
    static void name(int dim);                                                                               \
    TEST(name##_2d)                                                                                          \
    {                                                                                                        \
        name(2);                                                                                             \
    }                                                                                                        \
    TEST(name##_3d)                                                                                          \
    {                                                                                                        \
        name(3);                                                                                             \
    }                                                                                                        \
    static void name(int dim)

/* Before the first test and behind the last one, or NULL: int setup(void **state), which returns 0. */
#define RUN_TESTS(setup, teardown)                                                                           \
    int main(void)                                                                                           \
    {                                                                                                        \
        return unit_run((setup), (teardown));                                                                \
    }

static inline int unit_run(CMFixtureFunction setup, CMFixtureFunction teardown)
{
    if (unit_test_count > sizeof unit_tests / sizeof *unit_tests) {
        print_error("%zu tests: there is room for fewer\n", unit_test_count);
        return 1;
    }
    return unit_test_count == 0
               ? 0
               : _cmocka_run_group_tests("tests", unit_tests, unit_test_count, setup, teardown);
}

/* ---- checks ---- */

/* |value - expected| <= tolerance; NaN fails. */
#define NEAR_TO(value, expected, tolerance) near_to((value), (expected), (tolerance), __func__, __LINE__)

static inline void near_to(double value, double expected, double tolerance, const char *where, int line)
{
    if (!(fabs(value - expected) <= tolerance)) {
        fail_msg("%s:%d: %.17g is not %.17g within %g", where, line, value, expected, tolerance);
    }
}

/* The same of each of values[count] and expected[count]; NULL: zeros. */
#define ALL_NEAR(count, values, expected, tolerance)                                                         \
    all_near((count), (values), (expected), (tolerance), __func__, __LINE__)

static inline void all_near(int64_t count, const double *values, const double *expected, double tolerance,
                            const char *where, int line)
{
    for (int64_t i = 0; i < count; i++) {
        near_to(values[i], expected != NULL ? expected[i] : 0.0, tolerance, where, line);
    }
}

/* value <= bound; NaN fails. */
#define AT_MOST(value, bound)                                                                                \
    do {                                                                                                     \
        double at_most_value = (value), at_most_bound = (bound);                                             \
        if (!(at_most_value <= at_most_bound)) {                                                             \
            fail_msg("%s:%d: %s: %g is not at most %g", __func__, __LINE__, #value, at_most_value,           \
                     at_most_bound);                                                                         \
        }                                                                                                    \
    } while (0)

/* An expression with &error in it, which is the check's own, has the status STATUS_OK. */
#define GOOD(expression)                                                                                     \
    do {                                                                                                     \
        struct error error = {""};                                                                           \
        enum status good_status = (expression);                                                              \
        if (good_status != STATUS_OK) {                                                                      \
            fail_msg("%s:%d: status %d: %s", __func__, __LINE__, (int)good_status, error.text);              \
        }                                                                                                    \
    } while (0)

/* Such an expression fails with this status, and a message that has this text in it. */
#define FAILS(expression, status, message)                                                                   \
    do {                                                                                                     \
        struct error error = {""};                                                                           \
        assert_int_equal((expression), (status));                                                            \
        if (strstr(error.text, (message)) == NULL) {                                                         \
            fail_msg("%s:%d: '%s' does not say '%s'", __func__, __LINE__, error.text, (message));            \
        }                                                                                                    \
    } while (0)

/* The same, and the message is this text. */
#define FAILS_WITH(expression, status, message)                                                              \
    do {                                                                                                     \
        struct error error = {""};                                                                           \
        assert_int_equal((expression), (status));                                                            \
        assert_string_equal(error.text, (message));                                                          \
    } while (0)

/* ---- memory and random numbers ---- */

/* Zeros, with room for one more, for an owner that frees them. */
static inline void *array_or_fail(int64_t count, size_t size)
{
    void *array = calloc((size_t)count + 1, size);
    assert_non_null(array);
    return array;
}
#define ARRAY(pointer, count) ((pointer) = array_or_fail((count), sizeof *(pointer)))

/* Zeros that are freed when the test ends. */
static inline void *zeros(int64_t count, size_t size)
{
    struct unit_memory *memory = calloc(1, sizeof *memory + ((size_t)count + 1) * size);
    assert_non_null(memory);
    memory->next = unit_memory;
    unit_memory = memory;
    return memory->bytes;
}

/* A stream of pseudo-random numbers (Knuth's 64-bit congruential generator), the same everywhere. */
struct random {
    uint64_t state;
};

static inline double uniform(struct random *random, double low, double high)
{
    random->state = random->state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(random->state >> 11) * 0x1p-53;
}
