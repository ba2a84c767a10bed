/* Numbers as text, against printf and strtod of the C library, on hard cases and random bit patterns. */
#include "unit.h"

#include "io/stream/stream_private.h"

#include <float.h>
#include <stdio.h>

/* xorshift64: the same numbers in every run. */
static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

static void check_double(double value)
{
    char text[SECTION_NUMBER + 1], expected[64];
    double again;
    size_t length = section_print(&(struct section){.type = TYPE_F8, .data = &value}, 0, text);
    assert_true(length <= SECTION_NUMBER);
    text[length] = '\0';
    snprintf(expected, sizeof expected, "%.17g", value);
    assert_string_equal(text, expected);
    assert_ptr_equal(number_parse_double(text, text + length, &again), text + length);
    assert_memory_equal(&value, &again, sizeof value);
}

static void check_float(float value)
{
    char text[SECTION_NUMBER + 1], expected[64];
    float again;
    size_t length = section_print(&(struct section){.type = TYPE_F4, .data = &value}, 0, text);
    text[length] = '\0';
    snprintf(expected, sizeof expected, "%.9g", (double)value);
    assert_string_equal(text, expected);
    assert_ptr_equal(number_parse_float(text, text + length, &again), text + length);
    assert_memory_equal(&value, &again, sizeof value);
}

static void check_text(const char *text)
{
    double value;
    float narrow;
    const char *end = text + strlen(text);
    double expected = strtod(text, NULL);
    float expected_narrow = strtof(text, NULL);
    if (isfinite(expected)) {
        assert_ptr_equal(number_parse_double(text, end, &value), end);
        assert_memory_equal(&value, &expected, sizeof value);
    } else {
        assert_null(number_parse_double(text, end, &value));
    }
    if (isfinite(expected_narrow)) {
        assert_ptr_equal(number_parse_float(text, end, &narrow), end);
        assert_memory_equal(&narrow, &expected_narrow, sizeof narrow);
    } else {
        assert_null(number_parse_float(text, end, &narrow));
    }
}

static void check_value(const char *text)
{
    check_double(strtod(text, NULL));
    check_float((float)fmin(fabs(strtod(text, NULL)), (double)FLT_MAX));
}

static void refuse_double(const char *text)
{
    double value;
    assert_null(number_parse_double(text, text + strlen(text), &value));
}

static void refuse_integer(const char *text)
{
    int64_t value;
    assert_null(number_parse_integer(text, text + strlen(text), INT64_MIN, INT64_MAX, &value));
}

/* Each of the words between bars. */
static void for_each(const char *words, void (*check)(const char *word))
{
    char word[64];
    for (size_t length; words != NULL; words = words[length] == '|' ? words + length + 1 : NULL) {
        length = strcspn(words, "|");
        snprintf(word, sizeof word, "%.*s", (int)length, words);
        check(word);
    }
}

TEST(hard_values)
{
    for_each("0|-0|5e-324|2.2250738585072014e-308|1.7976931348623157e308|-1.7976931348623157e308|"
             "2.2250738585072011e-308|1e22|1e23|0.1|0.3|0.33333333333333331|9.5|99999999999999990|1e16|"
             "1e17|1e-4|1e-5|123456|1e100|9007199254740993|2.2204460492503131e-16|1.7976931348623155e308",
             check_value);
    for (int binary = -1074; binary < 1024; binary++) {
        check_double(ldexp(1.0, binary));
        check_double(nextafter(ldexp(1.0, binary), 0));
        check_double(ldexp(0.75, binary + 1 > 1023 ? 1023 : binary + 1));
    }
    for (int binary = -149; binary < 128; binary++) {
        check_float(ldexpf(1.0F, binary));
        check_float(nextafterf(ldexpf(1.0F, binary), 0));
    }
    for (int decimal = -330; decimal < 309; decimal++) {
        char text[32];
        snprintf(text, sizeof text, "1e%d", decimal);
        check_text(text);
        check_double(strtod(text, NULL));
    }
}

TEST(hard_texts)
{
    for_each("9007199254740993|9007199254740992.9999999999999|9007199254740993.0000000000001|0.1e1|"
             "00000000000000000000000001.5|.5|5.|-.5e-3|+7|1e400|1e-400|1e99999999999999999999|"
             "0e99999999999999999999|0e50|-0e-100|0.000e23|2.4703282292062327e-324|"
             "2.4703282292062328e-324|1.7976931348623158e308|1.7976931348623159e308|3.4028235677973366e38|"
             "3.4028235677973365e38|1.00000005960464477539062|1.000000059604644775390625|"
             "1.00000005960464477539063|0.000000000000000000000000000000000000001|18446744073709551615|"
             "18446744073709551616|123456789012345678901234567890|8.5899345920000005e9",
             check_text);
    /* Halfway between two doubles, written in full, and a little beside. */
    char text[1200];
    for (int binary = -60; binary < 60; binary += 7) {
        double value = ldexp(1.0 + DBL_EPSILON, binary);
        int length = snprintf(text, sizeof text, "%.160f", value);
        check_text(text);
        assert_true(length < (int)sizeof text);
    }
    for_each("|-|+|.|e5|1e|1e+|--1|1.2.3|0x1|1_0|infinity|nan(1)|1f|1,5|NaN0|- 1", refuse_double);
}

TEST(random_bit_patterns)
{
    uint64_t random = 88172645463325252U;
    for (int i = 0; i < 100000; i++) {
        uint64_t bits = next_random(&random);
        uint32_t few = (uint32_t)(next_random(&random) >> 32);
        double value;
        float narrow;
        memcpy(&value, &bits, sizeof value);
        memcpy(&narrow, &few, sizeof narrow);
        if (isfinite(value)) {
            check_double(value);
        }
        if (isfinite(narrow)) {
            check_float(narrow);
            check_double((double)narrow);
        }
        check_double((double)(bits >> 40) / 1000);
    }
}

/* Random decimals, many of them close to the middle between two doubles or floats. */
TEST(random_decimals)
{
    uint64_t random = 2463534242U;
    char text[80];
    for (int i = 0; i < 100000; i++) {
        uint64_t bits = next_random(&random);
        int digits = (int)(next_random(&random) % 24);
        int power = (int)(next_random(&random) % 660) - 340;
        snprintf(text, sizeof text, "%.*se%d", digits + 1, "31415926535897932384626433", power);
        check_text(text);
        snprintf(text, sizeof text, "%llu.%llue%d", (unsigned long long)(bits >> (bits & 63)),
                 (unsigned long long)(next_random(&random) >> (bits >> 58)), power / 8);
        check_text(text);
        float narrow = (float)(bits >> 20) * 1e-6F;
        snprintf(text, sizeof text, "%.17g", ((double)narrow + (double)nextafterf(narrow, INFINITY)) / 2);
        check_text(text);
    }
}

TEST(integers)
{
    static const int64_t values[] = {0, 1, -1, 9, 10, 99, 100, INT32_MIN, INT32_MAX, INT64_MIN, INT64_MAX};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char text[SECTION_NUMBER + 1], expected[32];
        int64_t again;
        size_t length = section_print(&(struct section){.type = TYPE_I8, .data = (void *)(uintptr_t)values},
                                      (int64_t)i, text);
        text[length] = '\0';
        snprintf(expected, sizeof expected, "%lld", (long long)values[i]);
        assert_string_equal(text, expected);
        assert_ptr_equal(number_parse_integer(text, text + length, INT64_MIN, INT64_MAX, &again),
                         text + length);
        assert_int_equal(again, values[i]);
    }
    for_each("|-|1.0|1e3|0x1|99999999999999999999|9223372036854775808|-9223372036854775809|"
             "18446744073709551616|1a|1\r",
             refuse_integer);
}

RUN_TESTS(NULL, NULL)
