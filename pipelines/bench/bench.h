/* What the benchmarks share: repeats and their percentiles, a plain read of as many bytes in the same run,
 * and the rows of bench.tsv. Programs of pipelines/bench/ print rows; pipelines/bench.mk puts the header
 * above. */
#pragma once

#include "base/status.h"

#include <stdint.h>

#define BENCH_MOST_REPEATS 1000

/* CPU time where one thread works, so that what else runs on the machine does not count; else wall time. */
enum bench_clock { BENCH_CPU, BENCH_WALL };

/* Seconds that each repeat took, ascending. */
struct bench_times {
    enum bench_clock clock;
    int count;
    double seconds[BENCH_MOST_REPEATS];
};

/* One line of the table. */
struct bench_row {
    const char *kernel, *size;
    int threads;
    double pairs;           /* of one repeat; 0: the kernel has none, and the figures are per byte */
    double bytes;           /* read and written by one repeat */
    double rate;            /* of one repeat: points, or bytes / 1e6 */
    const char *unit;       /* of rate per second: "points/s", "MB/s" */
    double memory_per_node; /* bytes held; 0: not measured */
};

/* Time, s. */
double bench_now(enum bench_clock clock);

/* Run until `least` seconds and at least 5 repeats are spent; the first run, which warms caches, is not
 * counted. The program ends with the status and message of a repeat that fails. */
void bench_repeat(enum bench_clock clock, double least,
                  enum status (*run)(void *context, struct error *error), void *context,
                  struct bench_times *times);

/* Percentile (0 .. 100) of the repeats. */
double bench_percentile(const struct bench_times *times, double percent);

/* Seconds of a plain read (a sum) of that many bytes by that many threads: the quickest of several. */
double bench_plain_read(enum bench_clock clock, double bytes, int threads);

/* Print a row: times are per pair, least and percentiles in ns. */
void bench_print(const struct bench_row *row, const struct bench_times *times);

/* Print the message and end the program unless the status is STATUS_OK. */
void bench_check(enum status status, const struct error *error);
